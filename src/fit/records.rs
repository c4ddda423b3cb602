//! The measured traces as a fit takes them: one time axis, and a weight for each sample.
//!
//! A sample's standard deviation is the noise before the pulse, no less than what rounding leaves,
//! `q/sqrt(12)`. Samples at the converter's ends may lie beyond, and have no weight.
//!
//! Drift, mains hum and 1/f noise are what the baseline says of them
//! ([`crate::analysis::baseline`]): a mean at each sample and a sum of modes, each times an
//! independent number of standard deviation one. The samples behind the baseline then have the
//! covariance `C = 1 + F F^T` with the modes over `sigma` as columns of `F`; the baseline's own
//! samples have made the prediction, and have no weight in the fit. A fit by least squares takes
//! `W r` for the residuals `r`, with `W^T W = C^-1` (generalised least squares): mode by mode,
//! `W r -> W r - (1 - 1/sqrt(1 + |p|^2)) p (p^T W r)/|p|^2` with `p = W f` for mode `f`.
//!
//! 1/f noise that is too fast for the modes makes neighbouring residuals alike; a filter makes them
//! white first ([`crate::analysis::innovations`]). The baselines of all channels together decide
//! whether there is 1/f noise. They are too short for its amplitude, which is the most likely one
//! for the residuals of a first fit. If the residuals' variance exceeds the baselines' by more than
//! chance, they hold more than noise: the scene leaves something out.

use std::ops::Range;

use super::forward::TimeAxis;
use super::{FitError, FitOptions};
use crate::analysis::baseline::{Baseline, noise_of};
use crate::analysis::disturbance::{Disturbance, FOUND};
use crate::analysis::innovations::Innovations;
use crate::analysis::pulse::{Conditions, Pulse};
use crate::analysis::rounding::Rounding;
use crate::measurement::compare::ComparedShot;
use crate::measurement::compare::mapping::{Assignment, ChannelMapping, ChannelNames, wires};
use crate::measurement::metadata;
use crate::recording::Capture;
use crate::scene::{Scene, gain_u};
use crate::scope::VerticalSetup;

/// Residual variance up to which a fit may leave nothing but noise (1).
const MAX_RESIDUAL_VARIANCE: f64 = 1.3;
/// Standard deviations by which chance may change a variance or correlation at most (1).
pub const NOISE_DEVIATIONS: f64 = 4.0;
/// Largest variance of 1/f noise over that of white noise, averaged over the channels. Of the
/// intervals of 95 % for a speed, 94 % held the truth at a half, and 90 % at four
/// (`tests/it/laboratory/coverage.rs`) (1).
const MAX_PINK_VARIANCE: f64 = 1.0;
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
    /// Which samples of the whole record these are.
    pub range: Range<usize>,
    /// The samples (V).
    pub volts: Vec<f64>,
    /// Baselines (V).
    pub baseline: f64,
    /// Standard deviation of a sample (V).
    pub sigma: f64,
    /// One level (V).
    pub level: f64,
    /// Which samples are within the converter's range.
    pub counts: Vec<bool>,
    /// Samples of the baseline, which have made the prediction and have no weight in the fit.
    pub taken: Range<usize>,
    /// Noise and rounding before the pulse.
    pub rounding: Rounding,
    /// Samples that they were found from.
    pub quiet_samples: usize,
    /// The disturbance as found in the baseline; none on quiet scopes and in short baselines.
    pub found: Option<Disturbance>,
    /// What disturbs the samples, as the baseline predicts it, less its mean there (V).
    pub disturbance: Vec<f64>,
    /// Modes of its error (V).
    pub modes: Vec<Vec<f64>>,
    /// The filter that makes fast 1/f noise white, if there is any.
    pub innovations: Option<Innovations>,
    /// How residuals become white, for each mode: the share of a direction that is taken off, and
    /// the direction, a unit vector (1).
    pub whitening: Vec<(f64, Vec<f64>)>,
    /// Relative standard uncertainty of the channel's gain: 0 for an exact one, infinite where
    /// nothing is known (1).
    pub gain_u: f64,
}

impl ChannelRecord {
    /// Whether something, but not all, is known of the gain.
    pub fn has_prior(&self) -> bool {
        self.gain_u > 0.0 && self.gain_u.is_finite()
    }

    /// Whether its zero is a parameter: it is not where the disturbance contains it.
    pub fn has_offset(&self) -> bool {
        self.modes.is_empty()
    }

    /// Whether the sample at `index` has weight.
    pub fn weighs(&self, index: usize) -> bool {
        self.counts.get(index).is_some_and(|counts| *counts) && !self.taken.contains(&index)
    }

    /// The samples without the disturbance that the baseline predicts (V).
    pub fn undisturbed(&self) -> impl Iterator<Item = f64> {
        let volts = self.volts.iter().enumerate();
        volts.map(|(index, volts)| volts - self.disturbance.get(index).unwrap_or(&0.0))
    }

    /// Makes `residuals` white (1).
    pub fn whiten(&self, residuals: &mut [f64]) {
        self.innovations.iter().for_each(|filter| filter.whiten(residuals));
        for factor in &self.whitening {
            take_off(residuals, factor);
        }
    }

    /// A mode as it is in the residuals: over `sigma`, zero without weight, filtered (1).
    fn direction(&self, mode: &[f64]) -> Vec<f64> {
        let over_sigma =
            |(index, v): (usize, &f64)| if self.weighs(index) { v / self.sigma } else { 0.0 };
        let mut direction: Vec<f64> = mode.iter().enumerate().map(over_sigma).collect();
        self.innovations.iter().for_each(|filter| filter.whiten(&mut direction));
        direction
    }

    /// The disturbance as a fit finds it, from the whitened `residuals` that it leaves (V).
    pub fn fitted_disturbance(&self, residuals: &[f64]) -> Vec<f64> {
        let mut found = residuals.to_vec();
        self.whitening.iter().rev().for_each(|factor| take_off(&mut found, factor));
        let mut all = self.disturbance.clone();
        all.resize(residuals.len(), 0.0);
        for mode in &self.modes {
            let score: f64 = self.direction(mode).iter().zip(&found).map(|(m, r)| m * r).sum();
            all.iter_mut().zip(mode).for_each(|(value, m)| *value += score * m);
        }
        all
    }

    /// Weighs samples by the white and 1/f noise in the differences from the fitted traces `shown`
    /// (V). The result is the noise's variance over that found in the baseline (1).
    fn weigh_again(&mut self, shown: &[f64]) -> Option<f64> {
        let counts = self.counted();
        let left = self.volts.iter().zip(shown).zip(&counts);
        let left: Vec<f64> =
            left.map(|((v, shown), counts)| if *counts { v - shown } else { 0.0 }).collect();
        let known = self.found.as_ref()?;
        let found = known.with_noise_of(&left, &counts)?;
        let more = (found.sample_noise() / known.sample_noise()).powi(2);
        self.sigma = noise_of(found.sample_noise(), self.level);
        self.innovations = Some(found.innovations(self.sigma, &counts));
        self.weigh_by(found);
        Some(more)
    }

    /// Takes over what the `baseline` says of a disturbance.
    fn follow(&mut self, (baseline, found): (&Baseline, &Disturbance)) {
        let Range { start, end } = self.range;
        let inside = |index: usize| index.clamp(start, end) - start;
        self.taken = inside(baseline.end - baseline.samples)..inside(baseline.end);
        self.weigh_by(found.clone());
    }

    /// The samples that have weight.
    fn counted(&self) -> Vec<bool> {
        (0..self.volts.len()).map(|index| self.weighs(index)).collect()
    }

    /// Weighs samples by what is known of the disturbance `found`.
    fn weigh_by(&mut self, found: Disturbance) {
        let part = |values: Vec<f64>| values.get(self.range.clone()).unwrap_or_default().to_vec();
        let zeros = part(found.values()).into_iter();
        self.disturbance = zeros.map(|zero| zero - self.baseline).collect();
        self.modes = found.modes().into_iter().map(part).collect();
        self.found = Some(found);
        self.whitening.clear();
        for mode in &self.modes {
            let mut direction = self.direction(mode);
            self.whitening.iter().for_each(|factor| take_off(&mut direction, factor));
            let square: f64 = direction.iter().map(|v| v * v).sum();
            if square > 0.0 {
                let length = square.sqrt();
                for value in &mut direction {
                    *value /= length;
                }
                self.whitening.push((1.0 - 1.0 / (1.0 + square).sqrt(), direction));
            }
        }
    }
}

/// Takes the `share` of what goes along the unit vector `direction` off `residuals`.
fn take_off(residuals: &mut [f64], (share, direction): &(f64, Vec<f64>)) {
    let along: f64 = residuals.iter().zip(direction).map(|(r, d)| r * d).sum();
    residuals.iter_mut().zip(direction).for_each(|(r, d)| *r -= share * along * d);
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

    /// Whether the baselines of all channels together show 1/f noise beyond doubt.
    pub fn have_pink_noise(&self) -> bool {
        let found = self.list.iter().filter_map(|record| record.found.as_ref());
        found.map(|found| found.pink_evidence).sum::<f64>() > (FOUND / (1.0 - FOUND)).ln()
    }

    /// The records weighed by the white and 1/f noise in their differences from the fitted traces
    /// `shown` (V); none if there is more noise than in the baselines, by more than chance, or too
    /// much 1/f noise for intervals to hold.
    pub fn weighed_again(&self, shown: &[Vec<f64>]) -> Option<Self> {
        let mut again = self.clone();
        let records = again.list.iter_mut().zip(shown);
        let (names, more): (Vec<&str>, Vec<f64>) = records
            .filter_map(|(record, shown)| {
                let more = record.weigh_again(shown)?;
                Some((record.name.as_str(), more))
            })
            .unzip();
        let note =
            format!("{}: 1/f noise correlates samples; ± takes it into account", names.join(", "));
        again.notes.push(note);
        let count = more.len() as f64;
        let is_chance = more.iter().sum::<f64>() <= most_variance(self.quiet_samples()) * count;
        let found = again.list.iter().filter_map(|record| record.found.as_ref());
        let pink: f64 = found.map(|found| found.pink_share().powi(2)).sum();
        (is_chance && pink <= MAX_PINK_VARIANCE * count).then_some(again)
    }

    /// Number of samples of the shortest baseline.
    pub fn quiet_samples(&self) -> usize {
        self.list.iter().map(|record| record.quiet_samples).min().unwrap_or(0)
    }

    /// The scene's channels and their front panels.
    pub fn wanted(&self) -> Vec<(usize, VerticalSetup)> {
        self.list.iter().map(|record| (record.channel, record.vertical)).collect()
    }

    /// Number of samples that have weight among the first `horizon` of each record.
    pub fn counted(&self, horizon: usize) -> usize {
        let of = |record: &ChannelRecord| {
            (0..horizon.min(record.volts.len())).filter(|index| record.weighs(*index)).count()
        };
        self.list.iter().map(of).sum()
    }
}

/// Residual variance that chance may cause if the noise is known from a baseline of `quiet` samples
/// (1).
pub fn most_variance(quiet: usize) -> f64 {
    let by_chance = 1.0 + NOISE_DEVIATIONS * (2.0 / quiet.max(2) as f64).sqrt();
    MAX_RESIDUAL_VARIANCE.max(by_chance)
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
    let quiet = found.and_then(Result::ok).map(|pulse| pulse.baseline);
    let (baseline, sigma, rounding, quiet_samples) = if let Some(quiet) = &quiet {
        let Baseline { level, rms, rounding, samples, .. } = *quiet;
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
    let mut record = ChannelRecord {
        name,
        sensor: wire.sensor.clone(),
        mapped_by: wire.by,
        channel: wire.simulated,
        vertical,
        volts: all[range.clone()].to_vec(),
        range,
        baseline,
        sigma,
        level,
        counts,
        taken: 0..0,
        rounding,
        quiet_samples,
        found: None,
        disturbance: Vec::new(),
        modes: Vec::new(),
        innovations: None,
        whitening: Vec::new(),
        gain_u: 0.0,
    };
    if let Some((quiet, found)) = quiet.as_ref().and_then(|q| Some((q, q.disturbance.as_ref()?))) {
        record.follow((quiet, found));
        if found.is_found() {
            notes.push(format!(
                "{}: found {} before the pulse: fitted along with the signal; earth the probe, trigger on line, take more pre-trigger or a shorter time base",
                record.name,
                found.words()
            ));
        }
    }
    record
}
