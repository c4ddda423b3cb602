//! What the name of a column says: its unit, and whether it holds times, numbers of rows, or a
//! channel's values.
//!
//! A unit stands in brackets (`Time (ms)`, `CH2[V]`), behind `in`, a slash or an underline (`in s`,
//! `U/V`, `time_s`), in a row of its own, or is the name itself (`second`, `Volt`). Prefixes from
//! nano to mega are taken into account.

use crate::scope::Source;

/// What a column is by its name.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum ColumnRole {
    /// Times, or the frequencies of a spectrum.
    Abscissa,
    /// Numbers of rows, if its values are such.
    Index,
    /// The other half of an envelope, labels, uncertainties, raw levels: not a channel's values.
    Extra,
    /// A quantity that is certainly no voltage, without a unit.
    OtherQuantity,
    /// Values, of the channel that the name tells.
    Values(Option<Source>),
    /// No name.
    Nameless,
}

/// A unit as a column's numbers need it: `SI = number * factor * 10^power`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColumnUnit {
    /// Without prefix: `V`, `s`, `N`.
    pub(super) text: &'static str,
    pub(super) power: i32,
    /// What is no power of ten (1).
    pub(super) factor: f64,
}

impl ColumnUnit {
    /// Whether it is minutes or hours.
    pub(super) fn is_minutes(&self) -> bool {
        self.factor > 1.0
    }

    /// Whether it is one of an abscissa.
    pub(super) fn is_abscissa(&self) -> bool {
        matches!(self.text, "s" | "Hz")
    }
}

/// A column's name, taken apart.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ColumnName {
    pub(super) role: ColumnRole,
    pub(super) unit: Option<ColumnUnit>,
    /// A unit that is written there and not known.
    pub(super) unknown_unit: Option<String>,
}

/// Spellings of units in full, with the unit and the power of ten.
const WORDS: [(&str, &str, i32); 28] = [
    ("second", "s", 0),
    ("seconds", "s", 0),
    ("sec", "s", 0),
    ("secs", "s", 0),
    ("S", "s", 0),
    ("mS", "s", -3),
    ("uS", "s", -6),
    ("µS", "s", -6),
    ("nS", "s", -9),
    ("msec", "s", -3),
    ("usec", "s", -6),
    ("µsec", "s", -6),
    ("nsec", "s", -9),
    ("millisecond", "s", -3),
    ("milliseconds", "s", -3),
    ("microsecond", "s", -6),
    ("microseconds", "s", -6),
    ("nanoseconds", "s", -9),
    ("volt", "V", 0),
    ("volts", "V", 0),
    ("v", "V", 0),
    ("mv", "V", -3),
    ("uv", "V", -6),
    ("millivolt", "V", -3),
    ("millivolts", "V", -3),
    ("newton", "N", 0),
    ("newtons", "N", 0),
    ("hertz", "Hz", 0),
];

/// Symbols that take prefixes.
const SYMBOLS: [&str; 11] = ["dB", "Hz", "Pa", "m/s^2", "m/s²", "V", "s", "N", "C", "A", "W"];
const PREFIXES: [(&str, i32); 9] = [
    ("", 0),
    ("m", -3),
    ("u", -6),
    ("µ", -6),
    ("\u{3bc}", -6),
    ("n", -9),
    ("p", -12),
    ("k", 3),
    ("M", 6),
];
const MINUTES: [&str; 4] = ["min", "mins", "minute", "minutes"];
const HOURS: [&str; 4] = ["h", "hr", "hour", "hours"];

/// The unit that `text` spells.
pub(super) fn unit(text: &str) -> Option<ColumnUnit> {
    let text = text.trim().trim_matches(['(', ')', '[', ']']).trim();
    let simple = |unit: &'static str, power| Some(ColumnUnit { text: unit, power, factor: 1.0 });
    if let Some((_, unit, power)) = WORDS
        .iter()
        .find(|(word, ..)| *word == text || (word.len() > 2 && word.eq_ignore_ascii_case(text)))
    {
        return simple(unit, *power);
    }
    let is = |words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(text));
    if is(&MINUTES) {
        return Some(ColumnUnit { text: "s", power: 0, factor: 60.0 });
    }
    if is(&HOURS) {
        return Some(ColumnUnit { text: "s", power: 0, factor: 3600.0 });
    }
    if text == "g" {
        return simple("g", 0);
    }
    if matches!(text, "HZ" | "hz") {
        return simple("Hz", 0);
    }
    SYMBOLS.iter().find_map(|symbol| {
        let prefix = text.strip_suffix(symbol)?;
        let power = PREFIXES.iter().find(|(known, _)| *known == prefix)?.1;
        // A sample interval of megaseconds is a misspelt one of milliseconds.
        if *symbol == "s" && power > 0 {
            return None;
        }
        simple(if *symbol == "m/s²" { "m/s^2" } else { symbol }, power)
    })
}

impl ColumnName {
    /// Takes `cell` apart; `below` stands beneath it in a row of units.
    pub(super) fn of(cell: &str, below: Option<&str>) -> Self {
        let cell = cell.trim().trim_start_matches(['#', '%']).trim();
        let (base, written) = parted(cell);
        let written = below.filter(|text| !text.is_empty()).map(str::to_owned).or(written);
        let unit_of_text = written.as_deref().and_then(unit);
        let unknown_unit = written.filter(|_| unit_of_text.is_none());
        let mut role = role(&base);
        if let Some(unit) = &unit_of_text {
            let by_unit = |source| if unit.is_abscissa() { ColumnRole::Abscissa } else { source };
            role = match role {
                ColumnRole::Extra => ColumnRole::Extra,
                ColumnRole::Values(source) => by_unit(ColumnRole::Values(source)),
                _ => by_unit(ColumnRole::Values(None)),
            };
        }
        Self { role, unit: unit_of_text, unknown_unit }
    }
}

/// A name without its unit, and the unit.
fn parted(cell: &str) -> (String, Option<String>) {
    let with = |base: &str, unit: &str| (base.trim().to_owned(), Some(unit.trim().to_owned()));
    if let Some(inner) = cell.strip_suffix([')', ']'])
        && let Some((base, text)) = inner.rsplit_once(['(', '['])
    {
        // The brackets of `Voltage (CH1)` hold the channel.
        return match channel(&text.trim().to_ascii_lowercase()) {
            Some(_) if unit(text).is_none() && !is_abscissa(&lowered(base)) => {
                (text.trim().to_owned(), None)
            }
            Some(_) if unit(text).is_none() => (base.trim().to_owned(), None),
            _ => with(base, text),
        };
    }
    if let Some(text) = cell.strip_prefix("in ") {
        return with("", text);
    }
    if let Some((base, text)) = cell.rsplit_once(" in ") {
        return with(base, text);
    }
    for mark in ['/', '_', ' ', ':'] {
        let plain = |text: &str| {
            let is_mark = mark == '/' || !is_letter(text);
            unit(text).is_some_and(|unit| is_mark && (mark == '/' || !unit.is_minutes()))
        };
        if let Some((base, text)) = cell.rsplit_once(mark).filter(|(_, text)| plain(text)) {
            // The A of `Channel A` is a channel.
            if channel(&lowered(cell)).is_none() {
                return with(base, text);
            }
        }
    }
    if unit(cell).is_some() && !is_letter(cell) {
        return with("", cell);
    }
    // `Volt1` of a program that numbers its units, and `CH1V`.
    let word = cell.trim_end_matches(|c: char| c.is_ascii_digit());
    if word.len() > 1 && word.len() < cell.len() && unit(word).is_some() {
        return with(cell, word);
    }
    if let Some(base) = cell.strip_suffix('V').filter(|base| channel(&lowered(base)).is_some()) {
        return with(base, "V");
    }
    (cell.to_owned(), None)
}

/// Letters that are units, and names as well: `sensor_A`, `h`.
fn is_letter(text: &str) -> bool {
    matches!(text.trim(), "A" | "C" | "W" | "g" | "h")
}

fn lowered(text: &str) -> String {
    let text = text.trim().to_ascii_lowercase().replace(['_', '"', '\''], " ");
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    // pandas tells columns of the same name apart: `Time.1`.
    match text.rsplit_once('.') {
        Some((base, number)) if number.parse::<u8>().is_ok() && !base.is_empty() => base.to_owned(),
        _ => text,
    }
}

fn without_number(text: &str) -> &str {
    text.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end()
}

fn is_abscissa(base: &str) -> bool {
    const WORDS: [&str; 14] = [
        "time",
        "t",
        "x",
        "x-axis",
        "zeit",
        "tempo",
        "temps",
        "tiempo",
        "x axis",
        "timestamp",
        "frequency",
        "freq",
        "sekunden",
        "sec",
    ];
    base.starts_with("time ") || WORDS.contains(&without_number(base))
}

fn role(base: &str) -> ColumnRole {
    const INDEX: [&str; 14] = [
        "index", "idx", "#", "no", "no.", "nr", "nr.", "n", "i", "sample", "point", "row",
        "record", "sequence",
    ];
    const EXTRA: [&str; 12] = [
        "peak detect",
        "label",
        "std",
        "stdev",
        "sigma",
        "error",
        "uncertainty",
        "digital",
        "bus",
        "comment",
        "note",
        "raw",
    ];
    const OTHER: [&str; 23] = [
        "f",
        "force",
        "kraft",
        "temperature",
        "temp",
        "pressure",
        "druck",
        "current",
        "strom",
        "acceleration",
        "accel",
        "charge",
        "ladung",
        "displacement",
        "position",
        "distance",
        "weg",
        "velocity",
        "speed",
        "phase",
        "power",
        "mass",
        "frequenz",
    ];
    let base = lowered(base);
    let has = |words: &[&str]| words.iter().any(|word| base.contains(word));
    if base.is_empty() || base.starts_with("unnamed") {
        return ColumnRole::Nameless;
    }
    if let Some(source) = channel(&base) {
        return ColumnRole::Values(Some(source));
    }
    if is_abscissa(&base) {
        return ColumnRole::Abscissa;
    }
    let word = base.trim_end_matches('s');
    if INDEX.contains(&word) || base.starts_with("sample n") || base.starts_with("row n") {
        return ColumnRole::Index;
    }
    if base.starts_with("math") {
        return ColumnRole::Values(Some(Source::Math));
    }
    // `CH1 Peak Detect`, `ch1s`: more than a channel's name.
    let more = base.strip_prefix("ch").and_then(|rest| rest.chars().next());
    // Lines of a logic analyser: `D0` to `D15`.
    let is_line = base.strip_prefix('d').is_some_and(|rest| rest.parse::<u8>().is_ok());
    if is_line || has(&EXTRA) || more.is_some_and(|c| c.is_ascii_digit()) {
        return ColumnRole::Extra;
    }
    if OTHER.iter().any(|other| base.split([' ', '-']).any(|part| without_number(part) == *other)) {
        return ColumnRole::OtherQuantity;
    }
    ColumnRole::Values(None)
}

/// The channel that a name in small letters is: `ch3`, `channel 3`, `c3`, `channel c`, `3`, `v3`,
/// `math`, `refa`, `ref1`.
fn channel(base: &str) -> Option<Source> {
    const WORDS: [&str; 14] = [
        "channel", "chan", "ch", "kanal", "canal", "voie", "c", "", "voltage", "volts", "volt",
        "v", "u", "y",
    ];
    let base = base.trim();
    if matches!(base, "math" | "math1" | "m1" | "fft") {
        return Some(Source::Math);
    }
    if let Some(letter) = base.strip_prefix("ref") {
        return reference(letter.trim());
    }
    let at = base.len() - base.chars().last().filter(char::is_ascii_alphanumeric)?.len_utf8();
    let (word, last) = base.split_at_checked(at)?;
    let word = word.trim_end();
    let known = WORDS.contains(&word.trim_end_matches('.'));
    let last = last.chars().next()?;
    let number = match last {
        '1'..='8' if known => last.to_digit(10)?,
        'a'..='h' if matches!(word, "channel" | "kanal" | "canal") => last.to_digit(18)? - 9,
        _ => return None,
    };
    u8::try_from(number).ok().map(Source::Channel)
}

/// A reference memory by letter or number.
pub(super) fn reference(letter: &str) -> Option<Source> {
    let first = letter.chars().next().filter(|_| letter.len() == 1)?.to_ascii_uppercase();
    match first {
        'A'..='D' => Some(Source::Reference(first)),
        '1'..='4' => Some(Source::Reference(
            ['A', 'B', 'C', 'D'].into_iter().nth(first as usize - '1' as usize)?,
        )),
        _ => None,
    }
}

/// The source that a file's own key or a user names.
pub(super) fn source(text: &str) -> Option<Source> {
    let text = text.trim();
    Source::from_name(text)
        .or_else(|| channel(&text.to_ascii_lowercase()).filter(|_| text.len() > 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_role_and_unit() {
        let channel = |number| ColumnRole::Values(Some(Source::Channel(number)));
        let none = || ColumnRole::Values(None);
        for (name, role, unit) in [
            ("Time (ms)", ColumnRole::Abscissa, Some(("s", -3))),
            ("Time (msec)", ColumnRole::Abscissa, Some(("s", -3))),
            ("t [s]", ColumnRole::Abscissa, Some(("s", 0))),
            ("[s]", ColumnRole::Abscissa, Some(("s", 0))),
            ("in s", ColumnRole::Abscissa, Some(("s", 0))),
            ("time_us", ColumnRole::Abscissa, Some(("s", -6))),
            ("t/µs", ColumnRole::Abscissa, Some(("s", -6))),
            ("sec", ColumnRole::Abscissa, Some(("s", 0))),
            ("t2", ColumnRole::Abscissa, None),
            ("Time.1", ColumnRole::Abscissa, None),
            ("x-axis", ColumnRole::Abscissa, None),
            ("F [N]", none(), Some(("N", 0))),
            ("Force (kN)", none(), Some(("N", 3))),
            ("Q (pC)", none(), Some(("C", -12))),
            ("a (g)", none(), Some(("g", 0))),
            ("CH2[V]", channel(2), Some(("V", 0))),
            ("C1 in V", channel(1), Some(("V", 0))),
            ("CH1V", channel(1), Some(("V", 0))),
            ("Channel 3 (V)", channel(3), Some(("V", 0))),
            ("Channel B", channel(2), None),
            ("Channel A", channel(1), None),
            ("Volt1", channel(1), Some(("V", 0))),
            ("v2", channel(2), None),
            ("2", channel(2), None),
            ("Voltage (CH4)", channel(4), None),
            ("CH8 (mV)", channel(8), Some(("V", -3))),
            ("piezo_mV", none(), Some(("V", -3))),
            ("MATH<CH1*CH2>", ColumnRole::Values(Some(Source::Math)), None),
            ("REF2", ColumnRole::Values(Some(Source::Reference('B'))), None),
            ("CH1 Peak Detect", ColumnRole::Extra, None),
            ("ch1s", ColumnRole::Extra, None),
            ("D15", ColumnRole::Extra, None),
            ("Unnamed: 0", ColumnRole::Nameless, None),
            ("samples", ColumnRole::Index, None),
            ("Force", ColumnRole::OtherQuantity, None),
            ("F", ColumnRole::OtherQuantity, None),
            ("piezo", none(), None),
        ] {
            let found = ColumnName::of(name, None);
            let told = found.unit.map(|unit| (unit.text, unit.power));
            assert_eq!((found.role, told), (role, unit), "{name}");
        }
        assert_eq!(ColumnName::of("p [bar]", None).unknown_unit.as_deref(), Some("bar"));
        assert_eq!(ColumnName::of("Time", Some("(ms)")).unit.map(|unit| unit.power), Some(-3));
        assert_eq!(unit("min").map(|unit| unit.factor), Some(60.0));
    }
}
