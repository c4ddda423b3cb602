//! Settings of the math trace.

use crate::instrument::word::{Word as _, abbreviates, words};
use crate::scope::Source;

words! {
    /// Weight of the samples in a transform.
    FftWindow {
        /// Good for frequencies and transients.
        Hanning = "HANning",
        /// Good for amplitudes.
        FlatTop = "FLATtop",
        /// None.
        Rectangular = "RECTangular",
    }
}

/// Function of the math trace.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum MathFunction {
    /// Sum of two channels.
    Sum(u8, u8),
    /// First channel less the second.
    Difference(u8, u8),
    /// Spectrum of a channel.
    Fft(u8, FftWindow),
}

/// Pairs of channels that the original instrument adds and subtracts.
const PAIRS: [(u8, u8); 2] = [(1, 2), (3, 4)];

impl MathFunction {
    /// Reads a definition, e.g. `CH1 - CH2` or `FFT(CH1,HANNING)`; `None` for what this instrument
    /// has not.
    pub fn parse(definition: &str, channels: u8) -> Option<Self> {
        let text: String = definition.chars().filter(|c| !c.is_whitespace()).collect();
        let upper = text.to_ascii_uppercase();
        let channel = |name: &str| match Source::from_name(name) {
            Some(Source::Channel(number)) if number <= channels => Some(number),
            _ => None,
        };
        if let Some(inner) = upper.strip_prefix("FFT(").and_then(|rest| rest.strip_suffix(')')) {
            let (name, window) = inner.split_once(',').unwrap_or((inner, "HANNING"));
            let is_named = |(_, word): &&(FftWindow, &'static str)| abbreviates(window, word);
            let (window, _) = FftWindow::WORDS.iter().find(is_named)?;
            return Some(Self::Fft(channel(name)?, *window));
        }
        let sign = upper.find(['+', '-'])?;
        let (first, rest) = upper.split_at_checked(sign)?;
        let (a, b) = (channel(first)?, channel(rest.get(1..)?)?);
        let sum = rest.starts_with('+');
        let known =
            |(low, high): &(u8, u8)| (a, b) == (*low, *high) || (!sum && (b, a) == (*low, *high));
        PAIRS.iter().any(known).then_some(if sum {
            Self::Sum(a, b)
        } else {
            Self::Difference(a, b)
        })
    }

    /// Whether channel `number` is needed for it.
    pub fn uses(self, number: u8) -> bool {
        match self {
            Self::Sum(a, b) | Self::Difference(a, b) => a == number || b == number,
            Self::Fft(channel, _) => channel == number,
        }
    }

    /// The definition as the instrument writes it.
    pub fn definition(self) -> String {
        match self {
            Self::Sum(a, b) => format!("CH{a} + CH{b}"),
            Self::Difference(a, b) => format!("CH{a} - CH{b}"),
            Self::Fft(channel, window) => {
                format!("FFT(CH{channel},{})", window.word().to_ascii_uppercase())
            }
        }
    }
}

/// The math trace's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Math {
    /// Whether it is displayed.
    pub displayed: bool,
    /// Its function.
    pub function: MathFunction,
    /// Screen's centre in the spectrum, percent of it (1).
    pub fft_horizontal_position: f64,
    /// Horizontal zoom of the spectrum: 1, 2, 5 or 10 (1).
    pub fft_horizontal_scale: f64,
    /// Vertical position of the spectrum (div).
    pub fft_vertical_position: f64,
    /// Vertical zoom of the spectrum: 0.5, 1, 2, 5 or 10 (1).
    pub fft_vertical_scale: f64,
}

impl Default for Math {
    fn default() -> Self {
        Self {
            displayed: false,
            function: MathFunction::Difference(1, 2),
            fft_horizontal_position: 50.0,
            fft_horizontal_scale: 1.0,
            fft_vertical_position: 0.0,
            fft_vertical_scale: 1.0,
        }
    }
}
