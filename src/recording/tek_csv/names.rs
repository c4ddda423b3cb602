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
    /// Factor beside the power of ten (1).
    pub(super) factor: f64,
}

impl ColumnUnit {
    /// Whether its factor is more than a power of ten: minutes, hours, psi.
    pub(super) fn has_factor(&self) -> bool {
        self.factor > 1.0
    }

    /// What one of it is in the unit without prefix (unit).
    pub(super) fn size(&self) -> f64 {
        let power = 10f64.powi(self.power.abs());
        self.factor * if self.power < 0 { 1.0 / power } else { power }
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
    /// The word for a channel and its number, where the name is one: `voltage` and 0 of
    /// `Voltage_0`, `v` and none of `v`.
    pub(super) numbered: Option<(String, Option<u32>)>,
}

/// Spellings of units in full, with the unit and the power of ten; short ones as they are written
/// here, long ones in any case.
const WORDS: [(&str, &str, i32); 53] = [
    ("second", "s", 0),
    ("seconds", "s", 0),
    ("sec", "s", 0),
    ("secs", "s", 0),
    ("sekunden", "s", 0),
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
    ("kilonewton", "N", 3),
    ("hertz", "Hz", 0),
    ("hz", "Hz", 0),
    ("ampere", "A", 0),
    ("amperes", "A", 0),
    ("amps", "A", 0),
    ("milliampere", "A", -3),
    ("watt", "W", 0),
    ("pascal", "Pa", 0),
    ("coulomb", "C", 0),
    ("meter", "m", 0),
    ("metre", "m", 0),
    ("millimeter", "m", -3),
    ("millimetre", "m", -3),
    ("micron", "m", -6),
    ("decibel", "dB", 0),
    ("cm", "m", -2),
    ("microstrain", "m/m", -6),
    ("ustrain", "m/m", -6),
    ("ue", "m/m", -6),
    ("ms^-2", "m/s^2", 0),
    ("ms-2", "m/s^2", 0),
    ("m s^-2", "m/s^2", 0),
    ("g_n", "g", 0),
    ("gn", "g", 0),
];

/// Symbols that take prefixes, and the unit as this program writes it.
const SYMBOLS: [(&str, &str); 20] = [
    ("dB", "dB"),
    ("Hz", "Hz"),
    ("Pa", "Pa"),
    ("bar", "bar"),
    ("m/s^2", "m/s^2"),
    ("m/s²", "m/s^2"),
    ("m/s2", "m/s^2"),
    ("m/s/s", "m/s^2"),
    ("m/s", "m/s"),
    ("m/m", "m/m"),
    ("strain", "m/m"),
    ("ε", "m/m"),
    ("ϵ", "m/m"),
    ("V", "V"),
    ("s", "s"),
    ("N", "N"),
    ("C", "C"),
    ("A", "A"),
    ("W", "W"),
    ("m", "m"),
];
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
/// Pounds a square inch (Pa): 0.45359237 kg, 9.80665 m/s², 0.0254 m.
const PSI: f64 = 6_894.757_293_168_36;

/// The unit that `text` spells.
pub(super) fn unit(text: &str) -> Option<ColumnUnit> {
    let text = text.trim().trim_matches(['(', ')', '[', ']', '"']).trim();
    let scaled = |unit: &'static str, factor| Some(ColumnUnit { text: unit, power: 0, factor });
    let simple = |unit: &'static str, power| Some(ColumnUnit { text: unit, power, factor: 1.0 });
    if let Some((_, unit, power)) = WORDS
        .iter()
        .find(|(word, ..)| *word == text || (word.len() > 2 && word.eq_ignore_ascii_case(text)))
    {
        return simple(unit, *power);
    }
    let is = |words: &[&str]| words.iter().any(|word| word.eq_ignore_ascii_case(text));
    if is(&MINUTES) {
        return scaled("s", 60.0);
    }
    if is(&HOURS) {
        return scaled("s", 3600.0);
    }
    if is(&["psi"]) {
        return scaled("Pa", PSI);
    }
    match text {
        "g" => return simple("g", 0),
        "HZ" => return simple("Hz", 0),
        _ => {}
    }
    SYMBOLS.iter().find_map(|(symbol, unit)| {
        let prefix = text.strip_suffix(symbol)?;
        let power = PREFIXES.iter().find(|(known, _)| *known == prefix)?.1;
        // A sample interval of megaseconds is a misspelt one of milliseconds.
        if *symbol == "s" && power > 0 {
            return None;
        }
        simple(unit, power)
    })
}

/// The unit of a row of units, in which a program may have numbered what occurs twice: `Volt1`,
/// `Volt.1`.
pub(super) fn unit_in_row(text: &str) -> Option<ColumnUnit> {
    let numbered = || {
        let word = text.trim().trim_end_matches(|c: char| c.is_ascii_digit());
        let word = word.strip_suffix(['.', '_', ' ']).unwrap_or(word);
        (word.len() > 2 && word.len() < text.trim().len()).then(|| unit(word)).flatten()
    };
    unit(text).or_else(numbered)
}

impl ColumnName {
    /// Takes `cell` apart; `below` stands beneath it in a row of units.
    pub(super) fn of(cell: &str, below: Option<&str>) -> Self {
        let cell = cell.trim().trim_start_matches(['#', '%', ';']).trim();
        let (base, written) = parted(cell);
        let below = below.filter(|text| !text.is_empty());
        let mut unit_of_text = match below {
            Some(text) => unit_in_row(text),
            None => written.as_deref().and_then(unit),
        };
        let written = below.map(str::to_owned).or(written);
        let unknown_unit = written.filter(|_| unit_of_text.is_none());
        let mut role = role(&base);
        if unit_of_text.is_none() && unknown_unit.is_none() && is_frequency(&base) {
            (unit_of_text, role) = (unit("Hz"), ColumnRole::Abscissa);
        }
        if let Some(unit) = &unit_of_text {
            let by_unit = |source| if unit.is_abscissa() { ColumnRole::Abscissa } else { source };
            role = match role {
                ColumnRole::Extra => ColumnRole::Extra,
                ColumnRole::Values(source) => by_unit(ColumnRole::Values(source)),
                _ => by_unit(ColumnRole::Values(None)),
            };
        }
        let numbered = numbered(&lowered(if base.is_empty() { cell } else { &base }));
        Self { role, unit: unit_of_text, unknown_unit, numbered }
    }

    /// A column without a name.
    pub(super) fn none() -> Self {
        Self { role: ColumnRole::Nameless, unit: None, unknown_unit: None, numbered: None }
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
    // `Voltage (V) - Plot 0`.
    if let Some((before, rest)) = cell.split_once(['(', '['])
        && let Some((text, after)) =
            rest.split_once([')', ']']).filter(|(text, _)| unit(text).is_some())
    {
        return with(&format!("{before}{after}"), text);
    }
    // `Time..s.`, as R writes `Time (s)`.
    if let Some((base, text)) = cell.strip_suffix('.').and_then(|cell| cell.rsplit_once(".."))
        && unit(text).is_some()
    {
        return with(base, text);
    }
    if let Some(text) = cell.strip_prefix("in ") {
        return with("", text);
    }
    if let Some((base, text)) = cell.rsplit_once(" in ") {
        return with(base, text);
    }
    if let Some((base, text)) = cell.rsplit_once(", ").filter(|(_, text)| unit(text).is_some()) {
        return with(base, text);
    }
    // `CH1_m/s` and `CH2_g`, as this program writes them.
    let is_own = |(base, text): &(&str, &str)| {
        unit(text).is_some_and(|unit| !unit.has_factor())
            && (text.contains('/') || channel(&lowered(base)).is_some())
    };
    if let Some((base, text)) = cell.rsplit_once('_').filter(is_own) {
        return with(base, text);
    }
    if let Some(parts) = behind_slash(cell) {
        return parts;
    }
    for mark in ['_', ' ', ':'] {
        let Some((base, text)) = cell.rsplit_once(mark) else { continue };
        let is_acceleration = text == "g" && base.to_ascii_lowercase().starts_with("acc");
        let known = unit(text).filter(|unit| !unit.has_factor() && !is_word(text));
        // The A of `Channel A` is a channel.
        if (known.is_some() || is_acceleration) && channel(&lowered(cell)).is_none() {
            return with(base, text);
        }
    }
    if unit(cell).is_some() && !is_word(cell) {
        return with("", cell);
    }
    // `Volt1` of a program that numbers its units, and `CH1V`.
    let word = cell.trim_end_matches(|c: char| c.is_ascii_digit());
    if word.len() > 1 && word.len() < cell.len() && unit(word).is_some() && !is_word(word) {
        return with(cell, word);
    }
    if let Some(base) = cell.strip_suffix('V').filter(|base| channel(&lowered(base)).is_some()) {
        return with(base, "V");
    }
    (cell.to_owned(), None)
}

/// A name and the unit behind its slash (ISO 80000-1), also one that is not known.
fn behind_slash(cell: &str) -> Option<(String, Option<String>)> {
    const LONGEST: usize = 12;
    let parts = |(base, text): (&str, &str)| (base.trim().to_owned(), Some(text.trim().to_owned()));
    let known = |(_, text): &(&str, &str)| unit(text).is_some();
    if let Some(found) = cell.split_once('/').filter(known).or(cell.rsplit_once('/').filter(known))
    {
        return Some(parts(found)).filter(|_| channel(&lowered(cell)).is_none());
    }
    // `U1/U2` and `Dev1/ai0` are names.
    let is_unit = |text: &str| {
        let text = text.trim();
        let is_part = |c: char| c.is_alphabetic() || matches!(c, '%' | '°' | '·' | '^' | '-');
        !text.is_empty() && text.chars().count() <= LONGEST && text.chars().all(is_part)
    };
    cell.rsplit_once('/').filter(|(base, text)| !base.is_empty() && is_unit(text)).map(parts)
}

/// Units that are names as well: `sensor_A`, `h`, `strain`.
fn is_word(text: &str) -> bool {
    matches!(text.trim(), "A" | "C" | "W" | "g" | "h" | "m" | "bar" | "strain")
}

fn lowered(text: &str) -> String {
    let text = text.trim().to_lowercase().replace(['_', '"', '\''], " ");
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
    const WORDS: [&str; 27] = [
        "time",
        "t",
        "x",
        "x-axis",
        "x axis",
        "x value",
        "x-value",
        "zeit",
        "tempo",
        "temps",
        "tiempo",
        "tijd",
        "tid",
        "czas",
        "čas",
        "aika",
        "idő",
        "zaman",
        "время",
        "时间",
        "時間",
        "timestamp",
        "time stamp",
        "sekunden",
        "secondes",
        "sec",
        "elapsed",
    ];
    // Settings of the time axis.
    const SETTINGS: [&str; 6] =
        ["time interval", "time base", "time div", "time/div", "time per", "time scale"];
    if SETTINGS.iter().any(|setting| base.starts_with(setting)) {
        return false;
    }
    base.starts_with("time ") || base.ends_with(" time") || WORDS.contains(&without_number(base))
}

fn is_frequency(base: &str) -> bool {
    matches!(without_number(&lowered(base)), "frequency" | "freq" | "frequenz" | "fréquence")
}

/// Names of columns of row numbers.
const INDEX: [&str; 14] = [
    "index", "idx", "#", "no", "no.", "nr", "nr.", "n", "i", "sample", "point", "row", "record",
    "sequence",
];
/// Words in names of columns beside the values of a channel.
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
/// Names of quantities that are values of no channel.
const OTHER: [&str; 30] = [
    "f",
    "strain",
    "dehnung",
    "epsilon",
    "stress",
    "humidity",
    "depth",
    "angle",
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

fn role(base: &str) -> ColumnRole {
    let base = lowered(base);
    let has = |words: &[&str]| words.iter().any(|word| base.contains(word));
    // A spreadsheet's or a program's own names of columns.
    let bare = without_number(&base);
    let is_placeholder =
        bare.len() < base.len() && ["col", "column", "var", "field"].contains(&bare);
    if base.is_empty() || base.starts_with("unnamed") || is_placeholder {
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
    // Lines of a logic analyser: `D0` to `D15`, `REF1_D3`.
    let last = base.rsplit(' ').next().unwrap_or_default();
    let is_line = last.strip_prefix('d').is_some_and(|rest| rest.parse::<u8>().is_ok());
    if numbered(&base).is_some() {
        return ColumnRole::Values(None);
    }
    if is_line || has(&EXTRA) || more.is_some_and(|c| c.is_ascii_digit()) {
        return ColumnRole::Extra;
    }
    if OTHER.iter().any(|other| base.split([' ', '-']).any(|part| without_number(part) == *other)) {
        return ColumnRole::OtherQuantity;
    }
    ColumnRole::Values(None)
}

/// The word for a channel and the number behind it; in small letters.
fn numbered(base: &str) -> Option<(String, Option<u32>)> {
    const WORDS: [&str; 16] = [
        "channel", "chan", "ch", "kanal", "canal", "voie", "c", "", "voltage", "volts", "volt",
        "v", "u", "y", "plot", "analog",
    ];
    const UNITS: [&str; 6] = ["voltage", "volts", "volt", "v", "data", "amplitude"];
    let base = base.trim();
    let parted = |base: &str| {
        let word = without_number(base).trim_end_matches(['.', ' ', '-']);
        let number = base.get(without_number(base).len()..).unwrap_or_default().trim();
        (word.to_owned(), number.parse().ok())
    };
    let (word, number) = parted(base);
    if WORDS.contains(&word.as_str()) {
        return Some((word, number)).filter(|(word, number)| !word.is_empty() || number.is_some());
    }
    // `CH1 Voltage`, and `Voltage CH1`.
    let ends = [base.split_once(' '), base.rsplit_once(' ').map(|(a, b)| (b, a))];
    ends.into_iter().flatten().find_map(|(name, quantity)| {
        let (word, number) = parted(name);
        let is_channel = matches!(word.as_str(), "ch" | "chan" | "channel" | "c");
        (is_channel && number.is_some() && UNITS.contains(&quantity)).then_some((word, number))
    })
}

/// The channel that a name in small letters is: `ch3`, `channel 3`, `c3`, `channel c`, `3`, `v3`,
/// `math`, `refa`, `ref1`.
fn channel(base: &str) -> Option<Source> {
    let base = base.trim();
    if matches!(base, "math" | "math1" | "m1" | "fft") {
        return Some(Source::Math);
    }
    if let Some(letter) = base.strip_prefix("ref") {
        return reference(letter.trim());
    }
    let words = ["channel", "kanal", "canal"];
    let letter = words.iter().find_map(|word| base.strip_prefix(word)).map(str::trim);
    let letter = letter.filter(|letter| letter.len() == 1).and_then(|letter| letter.chars().next());
    if let Some(letter @ 'a'..='h') = letter {
        return u8::try_from(u32::from(letter) - u32::from('a') + 1).ok().map(Source::Channel);
    }
    let (_, number) = numbered(base)?;
    number
        .filter(|number| (1..=8).contains(number))
        .and_then(|n| u8::try_from(n).ok())
        .map(Source::Channel)
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
            ("acc_g", none(), Some(("g", 0))),
            ("a/m/s^2", none(), Some(("m/s^2", 0))),
            ("a [mm/s²]", none(), Some(("m/s^2", -3))),
            ("strain/µε", none(), Some(("m/m", -6))),
            ("eps (um/m)", none(), Some(("m/m", -6))),
            ("strain (ue)", none(), Some(("m/m", -6))),
            ("p [bar]", none(), Some(("bar", 0))),
            ("p/mbar", none(), Some(("bar", -3))),
            ("w (mm)", none(), Some(("m", -3))),
            ("s [µm]", none(), Some(("m", -6))),
            ("Voltage (V) - Plot 0", none(), Some(("V", 0))),
            ("Time..ms.", ColumnRole::Abscissa, Some(("s", -3))),
            ("X_Value", ColumnRole::Abscissa, None),
            ("Freq", ColumnRole::Abscissa, Some(("Hz", 0))),
            ("CH1_Voltage(mV)", channel(1), Some(("V", -3))),
            ("ch0", none(), None),
            ("Voltage_0", none(), None),
            ("Dev1/ai0", none(), None),
            ("strain", ColumnRole::OtherQuantity, None),
            ("CH2[V]", channel(2), Some(("V", 0))),
            ("CH1_m/m", channel(1), Some(("m/m", 0))),
            ("CH2_m/s", channel(2), Some(("m/s", 0))),
            ("CH3_m/s^2", channel(3), Some(("m/s^2", 0))),
            ("CH4_g", channel(4), Some(("g", 0))),
            ("CH1_bar", channel(1), Some(("bar", 0))),
            ("CH1_m", channel(1), Some(("m", 0))),
            ("CH1_A", channel(1), Some(("A", 0))),
            ("MATH_W", ColumnRole::Values(Some(Source::Math)), Some(("W", 0))),
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
        assert_eq!(ColumnName::of("p [torr]", None).unknown_unit.as_deref(), Some("torr"));
        assert_eq!(ColumnName::of("p/torr", None).unknown_unit.as_deref(), Some("torr"));
        let zero = Some(("voltage".to_owned(), Some(0)));
        assert_eq!(ColumnName::of("Voltage_0 (V)", None).numbered, zero);
        assert_eq!(unit_in_row("Volt1").map(|unit| unit.text), Some("V"));
        assert_eq!(ColumnName::of("Time", Some("(ms)")).unit.map(|unit| unit.power), Some(-3));
        assert_eq!(unit("min").map(|unit| unit.factor), Some(60.0));
    }
}
