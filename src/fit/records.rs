//! The measured traces as a fit takes them: one time axis, and a weight for each sample.
//!
//! A sample's standard deviation is the noise before the pulse, no less than what rounding leaves,
//! `q/sqrt(12)`. Samples at the converter's ends may lie beyond, and have no weight.

use super::forward::TimeAxis;
use super::{FitError, FitOptions};
use crate::analysis::baseline::{Baseline, noise_of};
use crate::analysis::pulse::{Conditions, Pulse};
use crate::analysis::rounding::Rounding;
use crate::measurement::compare::ComparedShot;
use crate::measurement::compare::mapping::{Assignment, ChannelMapping, ChannelNames, wires};
use crate::measurement::metadata;
use crate::recording::Capture;
use crate::scene::{Scene, gain_u};
use crate::scope::VerticalSetup;

/// Paths that the note on inputs taken as exact names.
const MAX_SHOWN_INPUTS: usize = 4;
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
    /// Noise and rounding before the pulse.
    pub rounding: Rounding,
    /// Samples that they were found from.
    pub quiet_samples: usize,
    /// Relative standard uncertainty of the channel's gain: 0 for an exact one, infinite where
    /// nothing is known (1).
    pub gain_u: f64,
}

impl ChannelRecord {
    /// Whether something, but not all, is known of the gain.
    pub fn has_prior(&self) -> bool {
        self.gain_u > 0.0 && self.gain_u.is_finite()
    }
}

/// All channels that belong to the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Records {
    /// Their common time axis.
    pub axis: TimeAxis,
    /// The channels.
    pub list: Vec<ChannelRecord>,
    /// Relative standard uncertainty of the axis' times, 0 for exact ones (1).
    pub time_base_u: f64,
    /// Notes on guesses and on omitted records.
    pub notes: Vec<String>,
}

impl Records {
    /// The captures of `measured` that belong to sensors of `scene`, inside `gate`.
    ///
    /// # Errors
    /// [`FitError`] where no channel belongs to the scene, and where records do not share their
    /// times.
    pub fn of(
        measured: ComparedShot<'_>,
        scene: &Scene,
        assignments: &[Assignment],
        (options, freed): (&FitOptions, &[&str]),
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
            if trace.unit != "V" {
                return Err(FitError::NotVolts { channel: name, unit: trace.unit });
            }
            let range = options.gate.range(&trace);
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
            let mut record = record(capture, wire, scene, (range, &mut notes));
            record.gain_u = gain_of(measured, scene, &record, (options, freed));
            list.push(record);
        }
        let axis =
            found.ok_or_else(|| FitError::NoSamples { channel: measured.name.to_owned() })?;
        notes.extend(gain_note(&list));
        let is_exact = metadata::is_scope_exact(measured.set);
        let by_file = if is_exact { 0.0 } else { scene.scope.model.accuracy.time / 3f64.sqrt() };
        Ok(Self { axis, list, time_base_u: options.time_base_u.unwrap_or(by_file), notes })
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

/// How well the gain of a channel is known: as `options` say, or by the scope's data sheet and the
/// sensor's file.
fn gain_of(
    measured: ComparedShot<'_>,
    scene: &Scene,
    record: &ChannelRecord,
    (options, freed): (&FitOptions, &[&str]),
) -> f64 {
    if options.gains {
        return f64::INFINITY;
    }
    if let Some(u) = options.gain_u {
        return u;
    }
    let placed = scene.sensors.iter().find(|placed| Some(&placed.name) == record.sensor.as_ref());
    let known = placed.map(|placed| placed.sensor.measured).unwrap_or_default();
    // Where the scene states it, it is one of the scene's inputs.
    let is_input = placed.is_some_and(|placed| {
        let path = format!("sensors.{}.sensitivity", placed.name);
        freed.contains(&path.as_str()) || scene.states_uncertainty_of(&path)
    });
    let sensitivity = known.sensitivity_u.filter(|_| !is_input).unwrap_or(0.0);
    let number = record.name.trim_start_matches("CH").parse().unwrap_or(0);
    let scope = if metadata::is_scope_exact(measured.set) {
        0.0
    } else {
        gain_u(&scene.scope.model, number, &record.vertical, known.chain)
    };
    scope.hypot(sensitivity)
}

/// The note on inputs whose uncertainty the scene states, and a fit that holds them does not count.
pub fn taken_as_exact(scene: &Scene, freed: &[&str]) -> Option<String> {
    let others = scene.uncertainty.iter().map(|input| input.path.as_str());
    let others: Vec<&str> = others.filter(|path| !freed.contains(path)).collect();
    let shown = others.iter().take(MAX_SHOWN_INPUTS).copied().collect::<Vec<_>>().join(", ");
    let more = match others.len().saturating_sub(MAX_SHOWN_INPUTS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    (!others.is_empty())
        .then(|| format!("± does not include the scene's [uncertainty] of {shown}{more}"))
}

fn gain_note(list: &[ChannelRecord]) -> Option<String> {
    let known: Vec<String> = list
        .iter()
        .filter(|record| record.has_prior())
        .map(|record| format!("{} {:.2} %", record.name, 100.0 * record.gain_u))
        .collect();
    (!known.is_empty()).then(|| {
        format!(
            "gains follow within their standard uncertainty, by data sheet and sensor: {}",
            known.join(", ")
        )
    })
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
    let all: Vec<f64> = waveform.values().collect();
    let conditions = Conditions { level, ..Conditions::default() };
    let found = capture.trace().map(|trace| Pulse::find(&trace, conditions));
    let (baseline, sigma, rounding, quiet_samples) = if let Some(Ok(pulse)) = found {
        let Baseline { level, rms, rounding, samples, .. } = pulse.baseline;
        (level, noise_of(rms, rounding.level), rounding, samples)
    } else {
        notes.push(format!(
            "{name}: no quiet time before a pulse to take noise from; samples weigh by rounding alone"
        ));
        let silent = Rounding { level, noise: 0.0 };
        (all.first().copied().unwrap_or(0.0), silent.sample(), silent, 0)
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
    let mut counts = vec![true; waveform.codes.len()];
    for place in waveform.clipped_points() {
        counts[place] = false;
    }
    let counts = counts[range.clone()].to_vec();
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
        rounding,
        quiet_samples,
        gain_u: 0.0,
    }
}
