//! The layout for reader and writer: header rows, the two domains, and the rules that the header's
//! numbers obey. Equations and sources: the module above.

use crate::quantity::c_exponential;
use crate::scope::Source;
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Decimals of every number in the header but the trigger point.
pub(super) const DECIMALS: usize = 6;
/// Decimals of the trigger point in the header.
pub(super) const TRIGGER_POINT_DECIMALS: usize = 12;
/// Points in one horizontal division.
const POINTS_PER_DIVISION: f64 = 250.0;
/// Vertical scale of every FFT (dB/div).
const DECIBELS_PER_DIVISION: f64 = 10.0;
/// The last printed digit of an ordinate (V; dB for an FFT).
const ORDINATE_DIGIT: f64 = 1e-5;
/// Largest relative error of a number printed with [`DECIMALS`].
pub(super) const PRINTING_ERROR: f64 = 5e-7;
/// Slack for the round-off of a few operations in double precision, relative.
pub(super) const ROUND_OFF: f64 = 1e-9;

/// How a capture's note begins that keeps another spelling of its source: `FFT` of the
/// TBS1000B-EDU, `REF1` of the TDS2024C.
const SPELLING: &str = "the file calls this trace ";

/// The note that keeps `text`, the file's own spelling of `source`; none for the usual one.
pub(super) fn spelling_note(source: Source, text: &str) -> Option<String> {
    (source.to_string() != text).then(|| format!("{SPELLING}{text}"))
}

/// The source as the capture's own file spells it.
pub(super) fn spelling(source: Source, notes: &[String]) -> String {
    let kept = notes.iter().find_map(|note| note.strip_prefix(SPELLING));
    let same = |text: &&str| source_of(text) == Some(source);
    kept.filter(same).map_or_else(|| source.to_string(), str::to_owned)
}

/// The source that a native file names.
pub(super) fn source_of(text: &str) -> Option<Source> {
    match text {
        "FFT" => Some(Source::Math),
        "REF1" => Some(Source::Reference('A')),
        "REF2" => Some(Source::Reference('B')),
        "REF3" => Some(Source::Reference('C')),
        "REF4" => Some(Source::Reference('D')),
        _ => Source::from_name(text)
            .filter(|source| source.to_string() == text)
            .filter(|source| !matches!(source, Source::Channel(5..))),
    }
}

/// A number as a header prints it: a spectrum's are rounded half up, as 4882.8125 Hz,
/// `4.882813e+03`, shows.
pub(super) fn printed(value: f64, domain: Domain) -> String {
    let value = if domain == Domain::Frequency && value > 0.0 { value.next_up() } else { value };
    c_exponential(value, DECIMALS)
}

/// Whether `text` is `value` as a header prints it; at 1 GS/s the firmware rounds the half down.
pub(super) fn spells(value: f64, domain: Domain, text: &str) -> bool {
    printed(value, domain) == text || c_exponential(value, DECIMALS) == text
}

/// How a capture's note begins that keeps another spelling of its interval.
const INTERVAL_SPELLING: &str = "the file gives the interval as ";

/// The note that keeps `text`, the file's own spelling of an interval; none for the usual one.
pub(super) fn interval_note(value: f64, domain: Domain, text: &str) -> Option<String> {
    let is_other = spells(value, domain, text) && printed(value, domain) != text;
    is_other.then(|| format!("{INTERVAL_SPELLING}{text}"))
}

/// The interval as the capture's own file spells it.
pub(super) fn interval_spelling(value: f64, domain: Domain, notes: &[String]) -> String {
    let kept = notes.iter().find_map(|note| note.strip_prefix(INTERVAL_SPELLING));
    let same = kept.filter(|text| spells(value, domain, text));
    same.map_or_else(|| printed(value, domain), str::to_owned)
}

pub(super) const RECORD_LENGTH: &str = "Record Length";
pub(super) const SAMPLE_INTERVAL: &str = "Sample Interval";
pub(super) const TRIGGER_POINT: &str = "Trigger Point";
pub(super) const SOURCE: &str = "Source";
pub(super) const VERTICAL_UNITS: &str = "Vertical Units";
pub(super) const VERTICAL_SCALE: &str = "Vertical Scale";
pub(super) const VERTICAL_OFFSET: &str = "Vertical Offset";
pub(super) const HORIZONTAL_UNITS: &str = "Horizontal Units";
pub(super) const HORIZONTAL_SCALE: &str = "Horizontal Scale";
pub(super) const POINT_FORMAT: &str = "Pt Fmt";
pub(super) const Y_ZERO: &str = "Yzero";
pub(super) const PROBE: &str = "Probe Atten";
pub(super) const MODEL: &str = "Model Number";
pub(super) const SERIAL: &str = "Serial Number";
pub(super) const FIRMWARE: &str = "Firmware Version";

/// Keys of the header rows.
const KEYS: [&str; 18] = [
    RECORD_LENGTH,
    SAMPLE_INTERVAL,
    TRIGGER_POINT,
    "",
    "",
    "",
    SOURCE,
    VERTICAL_UNITS,
    VERTICAL_SCALE,
    VERTICAL_OFFSET,
    HORIZONTAL_UNITS,
    HORIZONTAL_SCALE,
    POINT_FORMAT,
    Y_ZERO,
    PROBE,
    MODEL,
    SERIAL,
    FIRMWARE,
];

/// Keys of the old header rows: without model and serial number.
const OLD_KEYS: [&str; 16] = {
    let mut keys = [FIRMWARE; 16];
    let (same, _) = keys.split_at_mut(15);
    same.copy_from_slice(KEYS.split_at(15).0);
    keys
};

/// Which header rows a file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum HeaderLayout {
    /// 18 rows, model and serial number among them.
    Named,
    /// 16 rows; seen with firmware v6.08.
    Old,
}

impl HeaderLayout {
    /// The keys of the header rows from row 1 on; empty for a row without one.
    pub(super) fn keys(self) -> &'static [&'static str] {
        match self {
            Self::Named => &KEYS,
            Self::Old => &OLD_KEYS,
        }
    }

    /// How many rows carry the header.
    pub(super) fn rows(self) -> u32 {
        self.keys().len() as u32
    }
}

/// Domain of the columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Domain {
    /// Volts over seconds.
    Time,
    /// Decibels over hertz: an FFT.
    Frequency,
}

impl Domain {
    pub(super) fn from_units(y_unit: &str, x_unit: &str) -> Option<Self> {
        [Self::Time, Self::Frequency]
            .into_iter()
            .find(|domain| domain.y_unit() == y_unit && domain.x_unit() == x_unit)
    }

    pub(super) fn x_unit(self) -> &'static str {
        match self {
            Self::Time => "s",
            Self::Frequency => "Hz",
        }
    }

    pub(super) fn y_unit(self) -> &'static str {
        match self {
            Self::Time => "V",
            Self::Frequency => "dB",
        }
    }

    /// Points in a record.
    pub(super) fn record_length(self) -> u16 {
        match self {
            Self::Time => 2500,
            Self::Frequency => 1024,
        }
    }
}

/// The numbers of a header.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Numbers {
    /// From one point to the next (s; Hz for an FFT).
    pub(super) interval: f64,
    /// Index of the trigger (1).
    pub(super) trigger_point: f64,
    /// Vertical scale (V/div; dB/div for an FFT).
    pub(super) scale: f64,
    /// Where zero stands, upward from the screen's centre (V).
    pub(super) offset: f64,
    /// Time base (s/div; Hz/div for an FFT).
    pub(super) horizontal_scale: f64,
    /// Value of level zero (dB); 0 in the time domain.
    pub(super) y_zero: f64,
    /// Probe attenuation (1).
    pub(super) probe: f64,
}

/// A number of a header that cannot be.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Violation {
    /// The header row.
    pub(super) key: &'static str,
    /// Its number.
    pub(super) found: f64,
    /// The allowed values.
    pub(super) expected: String,
}

impl Numbers {
    /// One digitiser level (V; dB for an FFT).
    pub(super) fn level(&self) -> f64 {
        self.scale / LEVELS_PER_DIVISION
    }

    /// The first number that breaks the rules of `domain`.
    pub(super) fn violation(&self, domain: Domain) -> Option<Violation> {
        let special = match domain {
            Domain::Time => self.time_rules(),
            Domain::Frequency => self.frequency_rules(),
        };
        self.common_rules()
            .into_iter()
            .chain(special)
            .find(|rule| !rule.kept)
            .map(|rule| rule.violation)
    }

    fn common_rules(&self) -> [Rule; 7] {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let above_zero = |key, value| Rule::new(key, value, positive(value), "above 0");
        let finite = |key, value: f64| Rule::new(key, value, value.is_finite(), "a finite number");
        let probe = self.probe.is_finite() && self.probe >= 0.0;
        [
            above_zero(SAMPLE_INTERVAL, self.interval),
            above_zero(VERTICAL_SCALE, self.scale),
            above_zero(HORIZONTAL_SCALE, self.horizontal_scale),
            finite(TRIGGER_POINT, self.trigger_point),
            finite(VERTICAL_OFFSET, self.offset),
            finite(Y_ZERO, self.y_zero),
            Rule::new(PROBE, self.probe, probe, "0 or above"),
        ]
    }

    fn time_rules(&self) -> [Rule; 3] {
        let smallest = ORDINATE_DIGIT * LEVELS_PER_DIVISION;
        let scale = format!("above {smallest} V/div, or five decimals do not resolve levels");
        let division = POINTS_PER_DIVISION * self.interval;
        let width = format!("{}, 250 sample intervals", c_exponential(division, DECIMALS));
        let horizontal = near(self.horizontal_scale, division);
        [
            Rule::new(VERTICAL_SCALE, self.scale, self.scale > smallest, &scale),
            Rule::new(HORIZONTAL_SCALE, self.horizontal_scale, horizontal, &width),
            Rule::zero(Y_ZERO, self.y_zero, "0 in the time domain"),
        ]
    }

    fn frequency_rules(&self) -> [Rule; 3] {
        let ten = near(self.scale, DECIBELS_PER_DIVISION);
        [
            Rule::new(VERTICAL_SCALE, self.scale, ten, "10 dB/div in an FFT"),
            Rule::zero(TRIGGER_POINT, self.trigger_point, "0 in an FFT"),
            Rule::zero(VERTICAL_OFFSET, self.offset, "0 in an FFT"),
        ]
    }
}

/// One rule and whether it is kept.
struct Rule {
    kept: bool,
    violation: Violation,
}

impl Rule {
    fn new(key: &'static str, found: f64, kept: bool, expected: &str) -> Self {
        let expected = expected.to_owned();
        Self { kept, violation: Violation { key, found, expected } }
    }

    fn zero(key: &'static str, found: f64, expected: &str) -> Self {
        Self::new(key, found, found == 0.0, expected)
    }
}

/// Equal within two roundings to the header's digits.
fn near(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 2.0 * PRINTING_ERROR * expected.abs()
}
