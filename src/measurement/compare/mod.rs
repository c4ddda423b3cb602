//! A measurement held against a simulation, channel by channel: brought onto one time axis, scored,
//! judged.
//!
//! One shift serves all channels, since a scope has one time base: speeds stay what they are. Gain
//! and offset are found and reported, and never taken out. Peaks and arrivals (half-rise) come from
//! the first pulse with the sensor's droop undone where its time constant is known; a measured
//! channel whose sensor is not known borrows the simulated one's. The other scores are those of
//! [`crate::analysis::comparison`]. JSON names and units are part of the interface.

mod compared_shot;
mod error;
pub mod mapping;
mod score;
pub mod score_limits;
mod scores;

pub use compared_shot::ComparedShot;
pub use error::CompareError;
pub use score::{ChannelScore, SpeedScore};

use serde::Serialize;

use super::arrivals::trigger_u;
use crate::analysis::arrival::Estimator;
use crate::analysis::comparison::{Pair, least_squares_shift};
use crate::quantity::Uncertain;
use compared_shot::scene_of;
use mapping::{Assignment, ChannelNames};
use score_limits::ScoreLimits;
use scores::ChannelPair;

/// How the two are brought onto one time axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Align {
    /// Trigger on trigger.
    Trigger,
    /// Arrival on arrival, half-rise, at the first channel that has one on both sides.
    #[default]
    Arrival,
    /// The shift with the least squared residuals over all channels, each in units of its simulated
    /// trace.
    LeastSquares,
}

impl Align {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Trigger => "trigger",
            Self::Arrival => "arrival",
            Self::LeastSquares => "least-squares",
        }
    }
}

/// All scores of one comparison.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// The measured recording.
    pub measured: String,
    /// The simulated recording.
    pub simulated: String,
    /// `trigger`, `arrival` or `least-squares`.
    pub align: &'static str,
    /// How much later all simulated traces were put (s).
    pub shift_s: f64,
    /// Standard uncertainty of the shift as the time between both triggers, each known to a sample
    /// interval; none for least squares (s).
    pub shift_u_s: Option<f64>,
    /// One a measured channel that has a partner.
    pub channels: Vec<ChannelScore>,
    /// Speeds between neighbouring sensors, from the top.
    pub speeds: Vec<SpeedScore>,
    /// The requested limits.
    pub tolerance: Vec<String>,
    /// Scores beyond the limits.
    pub failures: Vec<String>,
    /// `pass` or `fail`.
    pub verdict: &'static str,
    /// Notes on guesses and missing values.
    pub notes: Vec<String>,
}

/// A comparison with its traces, for pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Compared {
    /// The scores.
    pub comparison: Comparison,
    /// Both traces of each channel on the measured one's axis, in the unit of its score.
    pub pairs: Vec<Pair>,
    /// Zero of each channel's traces and standard deviation of one sample, measured and simulated;
    /// none without a pulse, in the unit of its score.
    pub quiet: Vec<Option<[Uncertain; 2]>>,
}

/// Holds `measured` against `simulated`.
///
/// # Errors
/// [`CompareError`] where no channels belong together, or where they have no time in common.
pub fn compare(
    measured: ComparedShot<'_>,
    simulated: ComparedShot<'_>,
    (align, assignments): (Align, &[Assignment]),
    tolerance: &ScoreLimits,
) -> Result<Compared, CompareError> {
    let mut notes = Vec::new();
    let ends = (ChannelNames::of(measured, &mut notes)?, ChannelNames::of(simulated, &mut notes)?);
    let wires = mapping::wires(&ends.0, &ends.1, assignments, &mut notes)?;
    let channels = wires.iter().map(|wire| ChannelPair::of(measured, simulated, wire, &mut notes));
    let channels = channels.collect::<Result<Vec<_>, _>>()?;
    let borrowed: Vec<&str> =
        channels.iter().filter(|c| c.borrowed).map(|c| c.name.as_str()).collect();
    if !borrowed.is_empty() {
        notes.push(format!(
            "{}: no calibration travels with the measurement; newtons and droop are the simulated sensor's",
            borrowed.join(", ")
        ));
    }
    let (align, shift_s, shift_u_s) = shift(&channels, align, &mut notes);
    let mut pairs = Vec::new();
    let mut scored = Vec::new();
    for (channel, wire) in channels.iter().zip(&wires) {
        let apart = || CompareError::Apart { channel: channel.name.clone(), shift_s };
        let pair = Pair::new(&channel.measured, &channel.simulated, shift_s).ok_or_else(apart)?;
        let score = channel.score(&pair, wire, shift_s);
        if !score.gain.value.is_finite() {
            return Err(CompareError::Flat { channel: channel.name.clone() });
        }
        scored.push(score);
        pairs.push(pair);
    }
    let speeds = scores::speeds(&channels, [measured, simulated], &mut notes);
    let mut failures = tolerance.failures(&scored, &speeds);
    failures.extend(clipped_failures(&scored));
    let comparison = Comparison {
        measured: measured.name.to_owned(),
        simulated: simulated.name.to_owned(),
        align: align.name(),
        shift_s,
        shift_u_s,
        channels: scored,
        speeds,
        tolerance: tolerance.words(),
        verdict: if failures.is_empty() { "pass" } else { "fail" },
        failures,
        notes,
    };
    let quiet = channels.iter().map(ChannelPair::quiet).collect();
    Ok(Compared { comparison, pairs, quiet })
}

/// Channels whose trace is unknown where the converter was driven to its ends: they never pass.
pub fn clipped_failures(channels: &[ChannelScore]) -> impl Iterator<Item = String> + '_ {
    channels.iter().filter(|score| score.clipped > 0).map(|score| {
        format!(
            "{}: {} samples clipped at the converter's ends; take more volts a division",
            score.name, score.clipped
        )
    })
}

/// The shift, by what it was found, and its uncertainty (s).
fn shift(
    channels: &[ChannelPair],
    align: Align,
    notes: &mut Vec<String>,
) -> (Align, f64, Option<f64>) {
    // Each trigger's level was crossed within the sample interval before the record's zero, on
    // average half of it before.
    let intervals = channels.first().map(|c| (c.measured.interval, c.simulated.interval));
    let (own, other) = intervals.unwrap_or((0.0, 0.0));
    let pulses = || channels.iter().filter_map(ChannelPair::pulses);
    let own_u = trigger_u(own, pulses().map(|(measured, _)| measured)).0;
    let other_u = trigger_u(other, pulses().map(|(_, simulated)| simulated)).0;
    let (at_triggers, triggers) = (0.5 * (other - own), own_u.hypot(other_u));
    let found = match align {
        Align::Trigger => Some((at_triggers, Some(triggers))),
        Align::Arrival => channels.iter().find_map(|channel| {
            let (measured, simulated) = channel.arrivals(Estimator::HalfRise)?;
            notes.push(format!("aligned by the arrival at {}", channel.name));
            let u = measured.u.hypot(simulated.u).hypot(triggers);
            Some((measured.value - simulated.value, Some(u)))
        }),
        Align::LeastSquares => {
            let traces: Vec<_> = channels.iter().map(ChannelPair::weighted).collect();
            least_squares_shift(&traces).map(|shift| (shift, None))
        }
    };
    if let Some((shift, u)) = found {
        return (align, shift, u);
    }
    notes.push(format!(
        "no alignment by {}: the triggers are taken for the same time",
        align.name()
    ));
    (Align::Trigger, at_triggers, Some(triggers))
}
