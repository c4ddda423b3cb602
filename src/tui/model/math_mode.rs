//! Modes of the math trace.

use crate::instrument::math::combine;
use crate::recording::Capture;
use crate::scope::Source;

/// Mode of the math trace, in the order of its key.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MathMode {
    /// Nothing.
    #[default]
    Off,
    /// First channel of a pair less the second.
    Difference(u8, u8),
    /// The sum of a pair.
    Sum(u8, u8),
}

/// The key's order: what the instrument's menu offers.
const MODES: [MathMode; 7] = [
    MathMode::Off,
    MathMode::Difference(1, 2),
    MathMode::Difference(2, 1),
    MathMode::Sum(1, 2),
    MathMode::Difference(3, 4),
    MathMode::Difference(4, 3),
    MathMode::Sum(3, 4),
];

impl MathMode {
    /// The next one.
    pub fn next(self) -> Self {
        let here = MODES.iter().position(|mode| *mode == self).unwrap_or(0);
        MODES.get(here + 1).copied().unwrap_or(Self::Off)
    }

    /// As the instrument writes it.
    pub fn name(self) -> String {
        match self {
            Self::Off => "off".to_owned(),
            Self::Difference(a, b) => format!("CH{a}-CH{b}"),
            Self::Sum(a, b) => format!("CH{a}+CH{b}"),
        }
    }

    pub(super) fn trace(self, captures: &[Capture]) -> Option<Capture> {
        let (a, b, sign) = match self {
            Self::Off => return None,
            Self::Difference(a, b) => (a, b, -1.0),
            Self::Sum(a, b) => (a, b, 1.0),
        };
        let find = |number| captures.iter().find(|c| c.waveform.source == Source::Channel(number));
        let first = find(a)?;
        let waveform = combine(&first.waveform, &find(b)?.waveform, sign)?;
        Some(Capture { waveform, ..first.clone() })
    }
}
