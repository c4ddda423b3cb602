//! Five thousand tables of known content: names, units and their notation, separators, decimal
//! marks, remarks, second tables, indices, columns that are no channels. Each is read with its
//! content, or refused: never read as something else.

use std::fmt::Write as _;

use hertzscope::recording::Capture;
use hertzscope::recording::tek_csv::read_all;
use hertzscope::scope::Source;

/// How many tables.
const TABLES: u64 = 5000;

/// Numbers that look random, the same in every run: `SplitMix64` (Steele, Lea, Flood 2014).
pub(crate) struct Draws(pub(crate) u64);

impl Draws {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    pub(crate) fn of<'a, T>(&mut self, list: &'a [T]) -> &'a T {
        &list[self.below(list.len())]
    }

    pub(crate) fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }
}

/// A unit as it is written, in SI, and its size.
type Unit = (&'static str, &'static str, f64);

const TIMES: [Unit; 5] =
    [("s", "s", 1.0), ("ms", "s", 1e-3), ("us", "s", 1e-6), ("µs", "s", 1e-6), ("ns", "s", 1e-9)];

const UNITS: [Unit; 22] = [
    ("V", "V", 1.0),
    ("V", "V", 1.0),
    ("V", "V", 1.0),
    ("mV", "V", 1e-3),
    ("uV", "V", 1e-6),
    ("A", "A", 1.0),
    ("mA", "A", 1e-3),
    ("g", "g", 1.0),
    ("m/s^2", "m/s^2", 1.0),
    ("m/s²", "m/s^2", 1.0),
    ("µε", "m/m", 1e-6),
    ("um/m", "m/m", 1e-6),
    ("bar", "bar", 1.0),
    ("MPa", "Pa", 1e6),
    ("N", "N", 1.0),
    ("kN", "N", 1e3),
    ("mm", "m", 1e-3),
    ("um", "m", 1e-6),
    ("pC", "C", 1e-12),
    // Not known: such a column may be left out, or the table be refused.
    ("torr", "", 1.0),
    ("°C", "", 1.0),
    ("furlong", "", 1.0),
];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Notation {
    Brackets,
    SquareBrackets,
    Slash,
    In,
    Row,
    RowInBrackets,
    RowAbove,
    Beside,
    Own,
}

/// A column of values: its name, source, unit, and printed numbers.
struct Channel {
    name: String,
    source: Source,
    unit: Unit,
    numbers: Vec<f64>,
}

struct Table {
    text: String,
    channels: Vec<Channel>,
    /// First time and interval (s).
    start: f64,
    interval: f64,
}

/// Names of channels and the sources they stand for.
fn names(kind: usize, count: usize) -> Vec<(String, Source)> {
    let words = ["piezo", "rod", "anvil", "striker"];
    (0..count)
        .map(|n| {
            let in_order = Source::Channel(n as u8 + 1);
            let letter = (b'A' + n as u8) as char;
            match kind {
                0 => (format!("CH{}", n + 1), in_order),
                1 => (format!("Channel {letter}"), in_order),
                2 => (format!("Voltage_{n}"), in_order),
                3 => (format!("ch{n}"), in_order),
                4 => (if n == 0 { "v".to_owned() } else { format!("v{n}") }, in_order),
                5 => (words[n].to_owned(), in_order),
                6 => (format!("C{}", n + 1), in_order),
                7 => (format!("CHAN{n}"), in_order),
                8 => (format!("CH{}", 2 * n + 1), Source::Channel(2 * n as u8 + 1)),
                9 => (format!("Channel {n}"), in_order),
                10 => (format!("ai{n}"), in_order),
                _ => (if n == 0 { "Volt".to_owned() } else { format!("Volt{n}") }, in_order),
            }
        })
        .collect()
}

#[allow(clippy::too_many_lines, reason = "the forms in one list, each drawn where it is applied")]
fn table(seed: u64) -> Table {
    let mut draws = Draws(seed);
    let rows = 12 + draws.below(30);
    let separator = *draws.of(&[",", ";", "\t", "  "]);
    let comma = separator != "," && draws.chance(30);
    let notations = [
        Notation::Brackets,
        Notation::Brackets,
        Notation::SquareBrackets,
        Notation::Slash,
        Notation::In,
        Notation::Row,
        Notation::RowInBrackets,
        Notation::RowAbove,
        Notation::Beside,
        Notation::Own,
    ];
    // Blanks split names, and columns of nothing.
    let simple = [Notation::Brackets, Notation::SquareBrackets, Notation::Slash, Notation::Row];
    let notation = *if separator == "  " { draws.of(&simple) } else { draws.of(&notations) };
    let time_unit = *draws.of(&TIMES);
    let step = *draws.of(&[1.0, 0.5, 0.25, 2.0, 0.004]);
    let first = draws.below(20) as f64 - 10.0;
    let count = 1 + draws.below(4);
    let kind = draws.below(12);
    let mut channels: Vec<Channel> = names(kind, count)
        .into_iter()
        .map(|(name, source)| Channel {
            name,
            source,
            unit: *draws.of(&UNITS),
            numbers: (0..rows).map(|_| (draws.below(121) as f64 - 60.0) * 0.04).collect(),
        })
        .collect();
    if separator == "  " {
        for channel in &mut channels {
            channel.name = channel.name.replace(' ', "");
        }
    }
    // Names without a channel's number: those that are read are numbered.
    if matches!(kind, 5 | 10) {
        let known = channels.iter_mut().filter(|channel| !channel.unit.1.is_empty());
        known.zip(1..).for_each(|(channel, number)| channel.source = Source::Channel(number));
    }
    let exponent = draws.chance(30);
    let number = |value: f64| {
        let text = if exponent { format!("{value:.5E}") } else { format!("{value:.4}") };
        if comma { text.replace('.', ",") } else { text }
    };
    let named = |name: &str, unit: &str| match notation {
        Notation::Brackets if separator == "  " => format!("{name}({unit})"),
        Notation::SquareBrackets if separator == "  " => format!("{name}[{unit}]"),
        Notation::Brackets => format!("{name} ({unit})"),
        Notation::SquareBrackets => format!("{name} [{unit}]"),
        Notation::Slash => format!("{name}/{unit}"),
        Notation::In => format!("{name} in {unit}"),
        _ => name.to_owned(),
    };
    let bare = |unit: &str| match notation {
        Notation::RowInBrackets => format!("({unit})"),
        _ => unit.to_owned(),
    };
    let time_name = *draws.of(&["Time", "time", "t", "Zeit", "TIME", "X_Value"]);
    let index = (draws.chance(25) && separator != "  ").then(|| draws.below(600));
    let peak = draws.chance(10) && separator != "  ";
    let label = draws.chance(10) && separator != "  ";
    let mut text = String::new();
    for _ in 0..draws.below(3) {
        let remark = *draws.of(&[
            "# shot 12 of the drop tower",
            "# sampled at noon, lab 3",
            "Model,XYZ1000",
            "",
        ]);
        let _ = writeln!(text, "{}", remark.replace(',', separator));
    }
    let mark = if text.starts_with('#') && draws.chance(50) { "# " } else { "" };
    // Names, then units in rows of their own.
    let mut head: Vec<String> = Vec::new();
    let mut below: Vec<String> = Vec::new();
    if index.is_some() {
        head.push((*draws.of(&["", "Index", "n", "sample"])).to_owned());
        below.push(String::new());
    }
    head.push(named(time_name, time_unit.0));
    below.push(bare(time_unit.0));
    let beside = notation == Notation::Beside;
    if beside {
        head.push(String::new());
    }
    for channel in &channels {
        head.push(named(&channel.name, channel.unit.0));
        below.push(bare(channel.unit.0));
        if beside {
            head.push(String::new());
        }
    }
    if peak {
        head.push("CH1 Peak Detect".to_owned());
        below.push(bare("V"));
        if beside {
            head.push(String::new());
        }
    }
    if label {
        head.push("label".to_owned());
        below.push(String::new());
    }
    let (head, below) = (head.join(separator), below.join(separator));
    match notation {
        Notation::Row | Notation::RowInBrackets => {
            let _ = writeln!(text, "{mark}{head}\n{mark}{below}");
        }
        Notation::RowAbove if index.is_none() && !peak && !label => {
            let _ = writeln!(text, "{below}\n{head}");
        }
        Notation::RowAbove => {
            let _ = writeln!(text, "{head}\n{below}");
        }
        _ => {
            let _ = writeln!(text, "{mark}{head}");
        }
    }
    let own = |value: f64, unit: &str| match notation {
        Notation::Own => format!("{} {unit}", number(value)),
        Notation::Beside => format!("{}{separator}{unit}", number(value)),
        _ => number(value),
    };
    for row in 0..rows {
        let mut cells: Vec<String> = Vec::new();
        if let Some(from) = index {
            cells.push((from + row).to_string());
        }
        cells.push(own((first + row as f64) * step, time_unit.0));
        cells.extend(channels.iter().map(|channel| own(channel.numbers[row], channel.unit.0)));
        if peak {
            cells.push(own(1.5, "V"));
        }
        if label {
            cells.push("idle".to_owned());
        }
        let _ = writeln!(text, "{}", cells.join(separator));
    }
    match draws.below(10) {
        0 => {
            let _ = writeln!(text, "\nFrequency (Hz){separator}FFT (dB)");
            for row in 0..6 {
                let _ = writeln!(text, "{}{separator}{}", number(f64::from(row)), number(-20.5));
            }
        }
        1 => text.push_str("End of file\n"),
        _ => {}
    }
    let start = first * step * time_unit.2;
    Table { text, channels, start, interval: step * time_unit.2 }
}

/// Why `capture` is not a channel of `table`; none if it is one.
fn misread(table: &Table, capture: &Capture) -> Option<String> {
    let waveform = &capture.waveform;
    // A column in an unknown unit is none.
    let mut known = table.channels.iter().filter(|channel| !channel.unit.1.is_empty());
    let Some(channel) = known.find(|channel| channel.source == waveform.source) else {
        return Some(format!("a channel {} that is not there", waveform.source));
    };
    let (_, unit, size) = channel.unit;
    if waveform.preamble.y_unit != unit {
        return Some(format!("{} in {}", waveform.source, waveform.preamble.y_unit));
    }
    if waveform.codes.len() != channel.numbers.len() {
        return Some(format!("{} points", waveform.codes.len()));
    }
    let interval = waveform.preamble.x_incr;
    if (interval / table.interval - 1.0).abs() > 1e-3
        || (waveform.time(0) - table.start).abs() > 0.1 * table.interval
    {
        return Some(format!("times {} + n {interval}", waveform.time(0)));
    }
    let largest = channel.numbers.iter().fold(0f64, |most, value| most.max(value.abs())) * size;
    channel.numbers.iter().enumerate().find_map(|(index, number)| {
        let found = waveform.volts(index).expect("inside");
        let off = (found - number * size).abs() > 1e-4 * largest;
        off.then(|| format!("{} is {found} at {index}, not {}", waveform.source, number * size))
    })
}

#[test]
fn generated_tables_are_never_misread() {
    let (mut read, mut refusals) = (0, Vec::new());
    for seed in 0..TABLES {
        let table = table(seed);
        match read_all(table.text.as_bytes(), "table.csv") {
            Err(error) => refusals.push((seed, error.to_string())),
            Ok(captures) => {
                read += 1;
                for capture in &captures {
                    if let Some(what) = misread(&table, capture) {
                        panic!("table {seed}: {what}\n{}\n{:?}", table.text, capture.notes);
                    }
                }
                let known = table.channels.iter().filter(|channel| !channel.unit.1.is_empty());
                let missing = known.filter(|channel| {
                    !captures.iter().any(|capture| capture.waveform.source == channel.source)
                });
                let missing: Vec<&str> = missing.map(|channel| channel.name.as_str()).collect();
                assert!(missing.is_empty(), "table {seed}: without {missing:?}\n{}", table.text);
            }
        }
    }
    // Tables of which no channel has a known unit are refused, and few others.
    let known = |seed: u64| table(seed).channels.iter().any(|channel| !channel.unit.1.is_empty());
    refusals.retain(|(seed, _)| known(*seed));
    let shown: Vec<String> = refusals
        .iter()
        .take(5)
        .map(|(seed, error)| format!("{seed}: {error}\n{}", table(*seed).text))
        .collect();
    assert!(refusals.len() < read / 50, "{} of {read}:\n{}", refusals.len(), shown.join("\n"));
}
