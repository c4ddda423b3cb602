//! Results of a fit, as in `fit --json`: names and units are part of the interface.

use crate::quantity::Uncertain;
use std::time::Instant;

use serde::Serialize;

use super::records::{ChannelRecord, NOISE_DEVIATIONS, Records, most_variance};
use super::{FitOptions, Profile};
use crate::analysis::disturbance::DisturbanceKind;
use crate::analysis::least_squares::{Minimum, squares};
use crate::measurement::compare::ComparedShot;
use crate::numeric::intervals::NORMAL_95;
use crate::scene::adjust::{Adjustable, AdjustableNumber};
use crate::scene::random_inputs::{RandomInput, RandomInputs};

/// Residuals of a model that is right do not follow one another by more than this (1).
const MAX_AUTOCORRELATION: f64 = 0.1;
/// A common rounding error of more than this, in squares of a level, makes neighbouring residuals
/// alike (1).
const QUIET: f64 = 1e-4;
/// An input that is farther from what is known of it is noted: by chance 1 in 400 is, in standard
/// uncertainties (1).
const FAR_OFF: f64 = 3.0;
/// Starts whose chi squared is within this share of the lowest found the same minimum (1).
const MINIMUM_TOLERANCE: f64 = 1e-3;

/// One freed number, or another one that the scene states as uncertain.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// Its path in the scene.
    pub path: String,
    /// Unit in which the scene states it; empty for a plain number.
    pub unit: String,
    /// How many SI units that is (unit).
    pub unit_in_si: f64,
    /// Where the fit started, or what the scene states, in SI units (unit).
    pub start: f64,
    /// The fitted value, in SI units (unit).
    pub value: f64,
    /// Its standard uncertainty, in SI units (unit).
    pub u: f64,
    /// Its expanded uncertainty for 95 %, in SI units (unit).
    #[serde(rename = "U95")]
    pub expanded: f64,
    /// The standard uncertainty, relative; none of a zero (1).
    pub u_relative: Option<f64>,
    /// 95 % interval of a normal distribution, in SI units (unit).
    pub interval_95: [f64; 2],
}

/// A nuisance parameter of the fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Nuisance {
    /// `trigger time`, `gain of CH1`, `offset of CH1`.
    pub name: String,
    /// What was found: seconds, a plain number, volts.
    #[serde(flatten)]
    pub found: Uncertain,
}

/// How well one channel is described.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelResult {
    /// The measured channel.
    pub name: String,
    /// The sensor, where known.
    pub sensor: Option<String>,
    /// Where that is known from.
    pub mapped_by: &'static str,
    /// Standard deviation that each sample was given (V).
    pub sigma_v: f64,
    /// Root mean square of measured less fitted (V).
    pub rms_v: f64,
    /// Largest of them (V).
    pub max_v: f64,
    /// Root mean square of measured less fitted, in levels (1).
    pub rms_lsb: f64,
    /// Largest of them, in levels (1).
    pub max_lsb: f64,
    /// Correlation of neighbouring residuals: near 0 where nothing but noise is left (1).
    pub lag_one: f64,
}

/// Results of a fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitReport {
    /// The measured recording.
    pub measured: String,
    /// The scene that was fitted.
    pub scene: String,
    /// The freed numbers.
    pub parameters: Vec<Parameter>,
    /// The nuisance parameters.
    pub nuisances: Vec<Nuisance>,
    /// Other numbers that the scene states as uncertain, which moved within what is known of them.
    pub inputs: Vec<Parameter>,
    /// Names of all parameters, in the order of the correlations.
    pub names: Vec<String>,
    /// Correlations of all parameters (1).
    pub correlation: Vec<Vec<f64>>,
    /// Their covariance, in products of their SI units (unit).
    pub covariance: Vec<Vec<f64>>,
    /// Sum of the weighted squared residuals (1).
    pub chi_squared: f64,
    /// Samples that count, less parameters.
    pub degrees_of_freedom: usize,
    /// Chi squared over the degrees of freedom; 1 where nothing but noise is left (1).
    pub residual_variance: f64,
    /// Whether nothing but noise is left; else the scene leaves something out, and no uncertainty
    /// holds.
    pub only_noise_is_left: bool,
    /// How well each channel is described.
    pub channels: Vec<ChannelResult>,
    /// Profiles of the badly determined numbers.
    pub profiles: Vec<Profile>,
    /// Chi squared that each start came to; none for one that came to nothing (1).
    pub starts: Vec<Option<f64>>,
    /// Simulations that it took.
    pub runs: u64,
    /// Wall time (s).
    pub wall_s: f64,
    /// Notes on guesses and warnings.
    pub notes: Vec<String>,
}

/// A minimum with what the report needs.
pub struct FittedMinimum<'a> {
    /// The minimum.
    pub minimum: &'a Minimum,
    /// Covariance of its parameters (1).
    pub covariance: Vec<Vec<f64>>,
    /// Their names.
    pub names: Vec<String>,
    /// The last of them: the scene's other uncertain inputs.
    pub inputs: &'a RandomInputs,
    /// Note on inputs that were held.
    pub taken_as_exact: Vec<String>,
    /// Profiles of some.
    pub profiles: Vec<Profile>,
    /// Chi squared of each start (1).
    pub starts: Vec<Option<f64>>,
    /// Simulations so far.
    pub runs: u64,
}

impl FittedMinimum<'_> {
    /// The report.
    pub fn report(
        self,
        (measured, scene): (ComparedShot<'_>, &Adjustable),
        knobs: &[AdjustableNumber],
        (records, options): (&Records, &FitOptions),
        began: Instant,
    ) -> FitReport {
        let u = |place: usize| self.covariance[place][place].sqrt();
        let x = &self.minimum.x;
        let parameters = knobs.iter().enumerate().map(|(place, knob)| {
            parameter(knob, x[place] * knob.value, u(place) * knob.value.abs())
        });
        let (list, scores) = (self.inputs.list(), &x[x.len() - self.inputs.count()..]);
        let others = self.inputs.first_values(scores);
        let first = x.len() - list.len();
        let inputs: Vec<Parameter> = (first..)
            .zip(list.iter().zip(others))
            .map(|(place, (input, (knob, value)))| Parameter {
                path: input.name.clone(),
                ..parameter(knob, value, u(place) * input.u)
            })
            .collect();
        let correlation = |i: usize, j: usize| {
            if i == j { 1.0 } else { self.covariance[i][j] / (u(i) * u(j)) }
        };
        let all = 0..x.len();
        let nuisances = nuisances(x, &u, (knobs.len(), records), options);
        let along = nuisances.iter().enumerate().map(|(place, nuisance)| {
            // What is searched for counts in samples, levels and shares.
            if u(knobs.len() + place) > 0.0 {
                nuisance.found.u / u(knobs.len() + place)
            } else {
                1.0
            }
        });
        let input_us = list.iter().map(|input| input.u);
        let units: Vec<f64> =
            knobs.iter().map(|knob| knob.value).chain(along).chain(input_us).collect();
        let covariance = |i: usize, j: usize| self.covariance[i][j] * units[i] * units[j];
        let channels: Vec<ChannelResult> = records
            .list
            .iter()
            .zip(self.minimum.residuals.chunks(records.axis.count))
            .map(|(record, residuals)| channel(record, residuals))
            .collect();
        let leftover = leftover(self.minimum, records, &channels);
        FitReport {
            measured: measured.name.to_owned(),
            scene: scene.name().to_owned(),
            parameters: parameters.collect(),
            nuisances,
            inputs,
            correlation: all
                .clone()
                .map(|i| all.clone().map(|j| correlation(i, j)).collect())
                .collect(),
            covariance: all
                .clone()
                .map(|i| all.clone().map(|j| covariance(i, j)).collect())
                .collect(),
            names: self.names,
            chi_squared: self.minimum.chi_squared,
            degrees_of_freedom: self.minimum.degrees_of_freedom,
            residual_variance: self.minimum.variance(),
            only_noise_is_left: leftover.is_none(),
            notes: [
                notes(records, leftover, &self.starts),
                far_off(self.inputs, scores),
                self.taken_as_exact,
            ]
            .concat(),
            channels,
            profiles: self.profiles,
            starts: self.starts,
            runs: self.runs,
            wall_s: began.elapsed().as_secs_f64(),
        }
    }
}

fn nuisances(
    x: &[f64],
    u: &dyn Fn(usize) -> f64,
    (knobs, records): (usize, &Records),
    options: &FitOptions,
) -> Vec<Nuisance> {
    let mut found = Vec::new();
    let mut place = knobs;
    let mut take = |name: String, scale: f64| {
        if let Some(value) = x.get(place) {
            let found_here = Uncertain::normal(value * scale, u(place) * scale);
            found.push(Nuisance { name, found: found_here });
        }
        place += 1;
    };
    take("trigger time".to_owned(), records.axis.interval);
    if records.time_base_u > 0.0 {
        take("time base".to_owned(), records.time_base_u);
    }
    let gains = records.list.iter().filter(|record| record.gain_u > 0.0);
    gains.for_each(|record| take(format!("gain of {}", record.name), 1.0));
    if options.offsets {
        let with_offset = records.list.iter().filter(|record| record.has_offset());
        with_offset.for_each(|r| take(format!("offset of {}", r.name), r.level));
    }
    found
}

fn channel(record: &ChannelRecord, residuals: &[f64]) -> ChannelResult {
    let weighs = |index: &usize| record.weighs(*index);
    let counted = (0..record.volts.len()).filter(weighs).count().max(1) as f64;
    let whole = squares(residuals);
    let rms_v = (whole / counted).sqrt() * record.sigma;
    let max_v = residuals.iter().fold(0.0, |most: f64, r| most.max(r.abs())) * record.sigma;
    let neighbours: f64 = residuals.windows(2).map(|pair| pair[0] * pair[1]).sum();
    ChannelResult {
        name: record.name.clone(),
        sensor: record.sensor.clone(),
        mapped_by: record.mapped_by,
        sigma_v: record.sigma,
        rms_v,
        max_v,
        rms_lsb: rms_v / record.level,
        max_lsb: max_v / record.level,
        lag_one: if whole > 0.0 { neighbours / whole } else { 0.0 },
    }
}

fn parameter(knob: &AdjustableNumber, value: f64, u: f64) -> Parameter {
    Parameter {
        path: knob.path.clone(),
        unit: knob.unit.clone(),
        unit_in_si: knob.scale,
        start: knob.value,
        value,
        u,
        expanded: NORMAL_95 * u,
        u_relative: (value != 0.0).then(|| u / value.abs()),
        interval_95: [value - NORMAL_95 * u, value + NORMAL_95 * u],
    }
}

/// Notes on inputs that are far from what the scene states.
fn far_off(inputs: &RandomInputs, scores: &[f64]) -> Vec<String> {
    let far = inputs.list().iter().zip(scores).filter(|(_, score)| score.abs() > FAR_OFF);
    let note = |(input, score): (&RandomInput, &f64)| {
        format!(
            "{} came out {score:+.1} of its standard uncertainties from what the scene states: check it",
            input.name
        )
    };
    far.map(note).collect()
}

/// What says that more than noise is left, if anything does.
fn leftover(minimum: &Minimum, records: &Records, channels: &[ChannelResult]) -> Option<String> {
    let variance = minimum.variance();
    // Rounding errors follow one another on a quiet scope, and count so.
    let is_quiet = |record: &ChannelRecord| record.rounding.common() > QUIET * record.level.powi(2);
    let follows = |(channel, record): &(&ChannelResult, &ChannelRecord)| {
        let by_chance = NOISE_DEVIATIONS / (record.volts.len().max(1) as f64).sqrt();
        channel.lag_one.abs() > MAX_AUTOCORRELATION.max(by_chance) && !is_quiet(record)
    };
    let following: Vec<_> = channels.iter().zip(&records.list).filter(follows).collect();
    let has_pink = |record: &ChannelRecord| {
        record.found.as_ref().is_some_and(|found| found.found.contains(&DisturbanceKind::Pink))
    };
    let is_pink = !following.is_empty() && following.iter().all(|(_, record)| has_pink(record));
    let following: Vec<&str> = following.iter().map(|(channel, _)| channel.name.as_str()).collect();
    if variance <= most_variance(records.quiet_samples()) && following.is_empty() {
        return None;
    }
    let which =
        if following.is_empty() { String::new() } else { format!(" in {}", following.join(", ")) };
    let why = if is_pink {
        "1/f noise correlates samples, and uncertainties do not hold: earth the probe, or average"
    } else {
        "the scene leaves something out, and uncertainties do not hold"
    };
    Some(format!("more than noise is left{which} (residual variance {variance:.3}): {why}"))
}

fn notes(records: &Records, leftover: Option<String>, starts: &[Option<f64>]) -> Vec<String> {
    let mut notes = records.notes.clone();
    notes.extend(leftover);
    // The minimum itself may be another one: with other inputs, or with the noise found there.
    let lowest = starts.iter().flatten().copied().fold(f64::INFINITY, f64::min);
    let same =
        |chi: &&Option<f64>| chi.is_some_and(|chi| chi <= lowest * (1.0 + MINIMUM_TOLERANCE));
    let agree = starts.iter().filter(same).count();
    if agree < starts.len() {
        notes.push(format!("{agree} of {} starts came to the lowest minimum", starts.len()));
    }
    notes
}
