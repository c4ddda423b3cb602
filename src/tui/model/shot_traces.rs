//! The traces of a shot, in volts or newtons, and the math trace.

use crate::instrument::math::combine;
use crate::measurement::force::{Forces, ForcesError, forces};
use crate::recording::{Capture, Shot, TraceSet};
use crate::scope::{Source, VerticalSetup, Waveform};
use crate::tui::axis::Steps;

/// Levels of a force that was turned into a record: as many as sixteen bits have on one side (1).
const FORCE_LEVELS: f64 = 32000.0;

/// A force as a record: levels of sixteen bits, on a scale that leaves the trace where its volts
/// stood.
fn as_record(volts: &Capture, forces: &Forces) -> Capture {
    let force = &forces.force;
    let largest = force.values.iter().fold(0.0, |most: f64, value| most.max(value.abs()));
    let level = if largest > 0.0 { largest / FORCE_LEVELS } else { 1.0 };
    let codes = force.values.iter().map(|value| (value / level).round() as i16).collect();
    let recorded = &volts.waveform;
    let sensitivity = forces.sensor.sensitivity.unwrap_or(1.0);
    let scale = Steps::OneTwoFive.at_least(recorded.vertical.scale / sensitivity);
    let mut preamble = recorded.preamble.clone();
    (preamble.y_mult, preamble.y_off, preamble.y_zero) = (level, 0.0, 0.0);
    "N".clone_into(&mut preamble.y_unit);
    let vertical = VerticalSetup { scale, ..recorded.vertical };
    let waveform = Waveform { codes, as_read: Vec::new(), preamble, vertical, ..recorded.clone() };
    Capture { waveform, ..volts.clone() }
}

/// The captures of a shot, as forces where `newtons` are asked for; with that, why one of them is
/// not.
pub(super) fn shot_traces(
    set: &TraceSet,
    shot: &Shot,
    newtons: bool,
) -> (Vec<Capture>, Option<String>) {
    let mut traces = shot.captures.clone();
    let mut missing = None;
    if newtons {
        for (trace, force) in traces.iter_mut().zip(forces(set, shot)) {
            match force {
                Ok(forces) => *trace = as_record(trace, &forces),
                Err(ForcesError::NoSensor { channel }) => {
                    missing = Some(format!(
                        "no calibration for {channel}: cannot show newtons (give one with --sensor)"
                    ));
                }
                Err(problem) => missing = Some(format!("cannot show newtons: {problem}")),
            }
        }
    }
    (traces, missing)
}

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
