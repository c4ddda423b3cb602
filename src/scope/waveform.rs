//! A record in the scope's memory: digitiser levels and the preamble that gives them
//! meaning. The two never part.

use std::fmt;
use std::ops::RangeInclusive;

use super::word::{Word, words};

/// Where a waveform comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Source {
    /// An input channel, counted from 1.
    Channel(u8),
    /// The math trace.
    Math,
    /// A reference memory, `A` to `D`.
    Reference(char),
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel(number) => write!(f, "CH{number}"),
            Self::Math => write!(f, "MATH"),
            Self::Reference(letter) => write!(f, "REF{letter}"),
        }
    }
}

impl Source {
    /// Reads the name that files and commands use: `CH1`, `MATH`, `REFA`.
    pub fn from_name(name: &str) -> Option<Self> {
        let upper = name.trim().to_ascii_uppercase();
        if upper == "MATH" {
            return Some(Self::Math);
        }
        if let Some(letter) = upper.strip_prefix("REF") {
            let mut letters = letter.chars();
            let first = letters.next().filter(|c| ('A'..='D').contains(c))?;
            return letters.next().is_none().then_some(Self::Reference(first));
        }
        let number: u8 = upper.strip_prefix("CH")?.parse().ok()?;
        (1..=8).contains(&number).then_some(Self::Channel(number))
    }
}

impl Word for Source {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Channel(1), "CH1"),
        (Self::Channel(2), "CH2"),
        (Self::Channel(3), "CH3"),
        (Self::Channel(4), "CH4"),
        (Self::Math, "MATH"),
        (Self::Reference('A'), "REFA"),
        (Self::Reference('B'), "REFB"),
        (Self::Reference('C'), "REFC"),
        (Self::Reference('D'), "REFD"),
    ];

    fn exists(self, channels: u8) -> bool {
        match self {
            Self::Channel(number) => number <= channels,
            Self::Math => true,
            Self::Reference(letter) => ('A'..='D').take(channels.into()).any(|l| l == letter),
        }
    }
}

words! {
    /// How a channel's input reaches its amplifier.
    Coupling {
        /// Everything passes.
        Dc = "DC",
        /// A high-pass filter takes the mean away.
        Ac = "AC",
        /// The input is disconnected; the trace is the ground line.
        Ground = "GND",
    }
}

impl fmt::Display for Coupling {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}

/// The front panel's settings of one channel at the time of the acquisition.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct VerticalSetup {
    /// Vertical scale, probe included (V/div).
    pub scale: f64,
    /// Position of zero volts, upward from the screen's centre (div).
    pub position: f64,
    /// Input coupling; `None` if a file does not state it.
    pub coupling: Option<Coupling>,
    /// Whether the 20 MHz limiter is on; `None` if a file does not state it.
    pub bandwidth_limited: Option<bool>,
    /// Whether the trace is inverted; `None` if a file does not state it.
    pub inverted: Option<bool>,
    /// Probe attenuation: 1, 10, 100 or 1000 (1).
    pub probe: f64,
}

/// Kind of a record's points.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointFormat {
    /// One sample a point, `Y` in files.
    Sample,
    /// Minimum and maximum in turn, `ENV` in files.
    Envelope,
}

impl fmt::Display for PointFormat {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Sample => "Y",
            Self::Envelope => "ENV",
        })
    }
}

/// The numbers that turn levels into volts and indices into seconds, named as Tektronix names them.
///
/// `x(n) = x_zero + x_incr (n - pt_off)` and `y(n) = y_zero + y_mult (code(n) - y_off)`.
/// Source: Tektronix programmer manual 071-1075, `WFMPre` commands.
#[derive(Debug, Clone, PartialEq)]
pub struct Preamble {
    /// Time of the first point after the trigger (s; Hz for an FFT).
    pub x_zero: f64,
    /// From one point to the next (s; Hz for an FFT).
    pub x_incr: f64,
    /// Index of the point at `x_zero`; always 0 on this family.
    pub pt_off: u32,
    /// Unit of the abscissa, `s` or `Hz`.
    pub x_unit: String,
    /// One digitiser level (V; dB for an FFT).
    pub y_mult: f64,
    /// Value added after scaling (V; dB for an FFT).
    pub y_zero: f64,
    /// The level of zero volts (1).
    pub y_off: f64,
    /// Unit of the ordinate, `V` or `dB`.
    pub y_unit: String,
    /// Sample or envelope.
    pub pt_fmt: PointFormat,
}

impl Preamble {
    /// Bits of a converter whose level on `scale` (V/div) is `y_mult`, to the relative `tolerance`
    /// (1); none if no converter's is.
    pub fn bits(&self, scale: f64, tolerance: f64) -> Option<u8> {
        BITS.into_iter().find(|bits| {
            let level = scale / levels_per_division(*bits);
            (self.y_mult - level).abs() <= tolerance * level.abs()
        })
    }
}

/// One record: levels, their preamble, and the settings under which they were taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Waveform {
    /// The channel, math or reference trace.
    pub source: Source,
    /// Digitiser levels; from the family's 8-bit converter 25 to a division, -128 to 127.
    pub codes: Vec<i16>,
    /// The values as a file gives them, if the levels do not return them exactly; otherwise empty
    /// (unit).
    pub as_read: Vec<f64>,
    /// Scaling of levels and indices.
    pub preamble: Preamble,
    /// Channel settings.
    pub vertical: VerticalSetup,
    /// Time base (s/div; Hz/div for an FFT).
    pub horizontal_scale: f64,
    /// Index of the trigger in this record, possibly outside it and not whole (1).
    pub trigger_point: f64,
}

/// Bits that a converter can have; the family has 8, and levels have at most 16.
pub const BITS: RangeInclusive<u8> = 8..=16;
/// Bits of the family's converter.
pub const FAMILY_BITS: u8 = 8;
/// Lowest level of the family's converter; a sample that reads it may have been cut off.
pub const LOWEST_CODE: i16 = -128;
/// Highest level of the family's converter; a sample that reads it may have been cut off.
pub const HIGHEST_CODE: i16 = 127;
/// Levels of the family's converter in one vertical division, which are also the dots of its screen
/// (1).
pub const LEVELS_PER_DIVISION: f64 = 25.0;

/// Levels of a converter of `bits` in one of the family's (1).
pub fn finer_levels(bits: u8) -> f64 {
    f64::from(bits.saturating_sub(FAMILY_BITS)).exp2()
}

/// Levels of a converter of `bits` in one vertical division (1).
pub fn levels_per_division(bits: u8) -> f64 {
    LEVELS_PER_DIVISION * finer_levels(bits)
}

/// Lowest to highest level of a converter of `bits`; a sample that reads one of the two may have
/// been cut off.
pub fn codes(bits: u8) -> RangeInclusive<i16> {
    let unused = BITS.end().saturating_sub(bits);
    i16::MIN >> unused..=i16::MAX >> unused
}

impl Waveform {
    /// Abscissa of point `index`: time after the trigger (s), or frequency of an FFT bin (Hz).
    pub fn time(&self, index: usize) -> f64 {
        self.preamble.x_zero
            + self.preamble.x_incr * (index as f64 - f64::from(self.preamble.pt_off))
    }

    /// Ordinate of point `index`, `None` beyond the record (V, or dB for an FFT).
    pub fn volts(&self, index: usize) -> Option<f64> {
        let of_code = || self.codes.get(index).map(|code| self.volts_of(*code));
        self.as_read.get(index).copied().or_else(of_code)
    }

    /// The ordinates of all points (V, or dB for an FFT).
    pub fn values(&self) -> impl Iterator<Item = f64> + '_ {
        (0..self.codes.len()).filter_map(|index| self.volts(index))
    }

    /// Lowest and highest ordinate; none of an empty record (V, or dB for an FFT).
    pub fn extremes(&self) -> Option<[f64; 2]> {
        self.values().fold(None, |found, value| match found {
            None => Some([value; 2]),
            Some([low, high]) => Some([value.min(low), value.max(high)]),
        })
    }

    /// Bits of the converter that the levels come from: a division has as many levels as a
    /// converter of these bits gives it, and no level is beyond that converter's. None if there is
    /// no such converter.
    pub fn bits(&self) -> Option<u8> {
        const ROUND_OFF: f64 = 1e-6;
        let bits = self.preamble.bits(self.vertical.scale, ROUND_OFF)?;
        let range = codes(bits);
        self.codes.iter().all(|code| range.contains(code)).then_some(bits)
    }

    /// Heights of all points above the screen's centre in dots, 25 a division (1).
    pub fn heights(&self) -> impl Iterator<Item = f64> + '_ {
        let (bits, vertical) = (self.bits_on_screen(), &self.vertical);
        self.codes.iter().zip(self.values()).map(move |(code, value)| match bits {
            Some(bits) => f64::from(*code) / finer_levels(bits),
            None => LEVELS_PER_DIVISION * (value / vertical.scale + vertical.position),
        })
    }

    /// Height of zero above the screen's centre in dots, 25 a division (1).
    pub fn ground(&self) -> f64 {
        match self.bits_on_screen() {
            Some(bits) => self.preamble.y_off / finer_levels(bits),
            None => LEVELS_PER_DIVISION * self.vertical.position,
        }
    }

    /// Height of the ordinate `value` (V, or dB for an FFT) above the screen's centre in dots, 25 a
    /// division (1).
    pub fn height_of(&self, value: f64) -> f64 {
        let p = &self.preamble;
        let level = (value - p.y_zero) / p.y_mult + p.y_off;
        level / finer_levels(self.bits().unwrap_or(FAMILY_BITS))
    }

    /// Bits of the converter whose levels the screen shows; none for values of other levels.
    fn bits_on_screen(&self) -> Option<u8> {
        self.bits().or((self.preamble.x_unit != "s").then_some(FAMILY_BITS))
    }

    /// Size of a digitiser level (V, or dB for an FFT).
    pub fn volts_of(&self, code: i16) -> f64 {
        let p = &self.preamble;
        (f64::from(code) - p.y_off) * p.y_mult + p.y_zero
    }

    /// Number of clipped points: at the lowest or highest level of the converter if the levels are
    /// a converter's, otherwise at the ends of 16 bits.
    pub fn clipped(&self) -> usize {
        self.clipped_points().count()
    }

    /// The places of these points, from the first.
    pub fn clipped_points(&self) -> impl Iterator<Item = usize> + '_ {
        // The ends of 16 bits stand for values beyond the range of any converter.
        let range = codes(self.bits().unwrap_or(*BITS.end()));
        let is_at_an_end = move |code: &i16| code == range.start() || code == range.end();
        let codes = self.codes.iter().enumerate();
        codes.filter(move |(_, code)| is_at_an_end(code)).map(|(place, _)| place)
    }
}
