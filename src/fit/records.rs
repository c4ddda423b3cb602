//! The measured traces as a fit takes them: one time axis, and a weight for each sample.
//!
//! A sample's standard deviation is the noise before the pulse, no less than what rounding leaves, `q/sqrt(12)`. Samples at the
//! converter's ends may lie beyond, and have no weight.

use super::FitError;
use super::forward::TimeAxis;
use crate::analysis::gate::Gate;
use crate::analysis::pulse::{Conditions, Pulse};
use crate::measurement::compare::ComparedShot;
use crate::measurement::compare::mapping::{Assignment, ChannelMapping, ChannelNames, wires};
use crate::recording::Capture;
use crate::scene::Scene;
use crate::scope::VerticalSetup;
use crate::scope::waveform::{HIGHEST_CODE, LOWEST_CODE};

/// Intervals and starts that differ by less than this, in samples, are the same (1).
const INTERVAL_TOLERANCE: f64 = 1e-6;

/// One channel.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelRecord {
    /// The measured channel.
    pub name: String,
    /// The sensor, where known.
    pub sensor: Option<String>,
    /// Where it is known from that it is.
    pub mapped_by: &'static str,
    /// Place of the scene's channel.
    pub channel: usize,
    /// The front panel under which it was taken.
    pub vertical: VerticalSetup,
    /// The samples (V).
    pub volts: Vec<f64>,
    /// Baselines (V).
    pub baseline: f64,
    /// Standard deviation of a sample (V).
    pub sigma: f64,
    /// One level (V).
    pub level: f64,
    /// Which samples count.
    pub counts: Vec<bool>,
}

/// All channels that belong to the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Records {
    /// Their common time axis.
    pub axis: TimeAxis,
    /// The channels.
    pub list: Vec<ChannelRecord>,
    /// Notes on guesses and on omitted records.
    pub notes: Vec<String>,
}

impl Records {
    /// The captures of `measured` that belong to sensors of `scene`, inside `gate`.
    ///
    /// # Errors
    /// [`FitError`] where no channel belongs to the scene, and where records do not share their times.
    pub fn of(
        measured: ComparedShot<'_>,
        scene: &Scene,
        assignments: &[Assignment],
        gate: Gate,
    ) -> Result<Self, FitError> {
        let mut notes = Vec::new();
        let from = ChannelNames::of(measured, &mut notes)?;
        let wires = wires(&from, &ChannelNames::of_scene(scene), assignments, &mut notes)?;
        let mut found: Option<TimeAxis> = None;
        let mut list = Vec::new();
        for wire in &wires {
            let capture = &measured.shot.captures[wire.measured];
            let name = capture.waveform.source.to_string();
            let Some(trace) = capture.trace() else { continue };
            let range = gate.range(&trace);
            let axis = TimeAxis {
                start: trace.time(range.start),
                interval: trace.interval,
                count: range.len(),
            };
            let common = *found.get_or_insert(axis);
            let near = |a: f64, b: f64| (a - b).abs() <= INTERVAL_TOLERANCE * common.interval;
            if axis.count != common.count
                || !near(axis.start, common.start)
                || !near(axis.interval, common.interval)
            {
                return Err(FitError::Times { channel: name });
            }
            if axis.count == 0 || !(axis.interval > 0.0 && axis.interval.is_finite()) {
                return Err(FitError::NoSamples { channel: name });
            }
            list.push(record(capture, wire, scene, (range, &mut notes)));
        }
        let axis =
            found.ok_or_else(|| FitError::NoSamples { channel: measured.name.to_owned() })?;
        Ok(Self { axis, list, notes })
    }

    /// The scene's channels and their front panels.
    pub fn wanted(&self) -> Vec<(usize, VerticalSetup)> {
        self.list.iter().map(|record| (record.channel, record.vertical)).collect()
    }

    /// Number of samples that count among the first `horizon` of each record.
    pub fn counted(&self, horizon: usize) -> usize {
        let counts = self.list.iter().flat_map(|record| record.counts.iter().take(horizon));
        counts.filter(|counts| **counts).count()
    }
}

fn record(
    capture: &Capture,
    wire: &ChannelMapping,
    scene: &Scene,
    (range, notes): (std::ops::Range<usize>, &mut Vec<String>),
) -> ChannelRecord {
    let waveform = &capture.waveform;
    let name = waveform.source.to_string();
    let level = waveform.preamble.y_mult.abs();
    let all: Vec<f64> = waveform.codes.iter().map(|code| waveform.volts_of(*code)).collect();
    let conditions = Conditions { level, ..Conditions::default() };
    let found = capture.trace().map(|trace| Pulse::find(&trace, conditions));
    let (baseline, sigma) = if let Some(Ok(pulse)) = found {
        (pulse.baseline.level, pulse.noise)
    } else {
        notes.push(format!(
            "{name}: no quiet time before a pulse to take noise from; samples weigh by rounding alone"
        ));
        (all.first().copied().unwrap_or(0.0), level / 12f64.sqrt())
    };
    let of_scene = scene.scope.channels.get(wire.simulated).and_then(Option::as_ref);
    let mut vertical = waveform.vertical;
    if let Some(channel) = of_scene {
        // What the file does not tell is as in the scene.
        vertical.coupling = vertical.coupling.or(channel.vertical.coupling);
        vertical.bandwidth_limited =
            vertical.bandwidth_limited.or(channel.vertical.bandwidth_limited);
        vertical.inverted = vertical.inverted.or(channel.vertical.inverted);
    }
    let clipped = waveform.clipped() > 0;
    let ends = |code: &i16| clipped && matches!(*code, LOWEST_CODE | HIGHEST_CODE);
    let counts: Vec<bool> = waveform.codes[range.clone()].iter().map(|code| !ends(code)).collect();
    let lost = counts.iter().filter(|counts| !**counts).count();
    if lost > 0 {
        notes.push(format!("{name}: {lost} samples at the converter's ends have no weight"));
    }
    ChannelRecord {
        name,
        sensor: wire.sensor.clone(),
        mapped_by: wire.by,
        channel: wire.simulated,
        vertical,
        volts: all[range].to_vec(),
        baseline,
        sigma,
        level,
        counts,
    }
}
