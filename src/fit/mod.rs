//! Finds numbers of a scene from measured traces: weighted least squares on what the scope shows of
//! them.
//!
//! The model is the whole bench: chain, sensor with its droop, front end (`forward`); noise and
//! rounding to levels are the samples' standard deviations. The trigger's time after the contact is
//! always found along, since the scope's clock runs freely, and each channel's offset; its gain
//! follows with a prior from the data sheet and the sensor's file, where it is not exact. Minimum
//! by Levenberg and Marquardt from several starts, each in the valley where its traces fit best in
//! time, where need be over ever longer parts of the records; covariance `s^2 (J^T J)^-1` with the
//! residual variance, and what rounding adds on quiet scopes (`covariance`); a profile of what is
//! badly determined (`profile`). Source of the propagation: JCGM 100:2008; W. H. Press et al.,
//! "Numerical Recipes", 3rd ed. (2007), sections 15.5 and 15.6. Uncertainties are those of noise
//! and rounding: they hold where the model does, which the residual variance and the residuals'
//! correlation from sample to sample tell.

pub mod blind;
mod covariance;
mod error;
mod forward;
mod model;
mod options;
mod profile;
mod records;
mod report;
mod search;

pub use error::FitError;
pub use options::FitOptions;
pub use profile::Profile;
pub use records::Records;
pub use report::{ChannelResult, FitReport, Nuisance, Parameter};

use std::time::Instant;

use crate::analysis::least_squares::{LeastSquaresError, Minimum, minimise};
use crate::measurement::compare::ComparedShot;
use crate::measurement::compare::mapping::Assignment;
use crate::numeric::intervals::NORMAL_95;
use crate::scene::adjust::{Adjustable, AdjustableNumber};
use crate::scene::random_inputs::RandomInputs;
use model::TraceModel;
use options::{EXPECTED_STEPS, INPUT_STOP_CRITERIA, MAX_DURATIONS, SAMPLE_RANGE, STOP_CRITERIA};

/// A fit with its traces.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Numbers for people and scripts.
    pub report: FitReport,
    /// The measured traces.
    pub records: Records,
    /// Traces of the fitted scene, one a channel (V).
    pub shown: Vec<Vec<f64>>,
    /// The scene's other uncertain inputs, which moved within what is known of them.
    pub inputs: RandomInputs,
    /// Where they are, in their standard uncertainties (1).
    pub scores: Vec<f64>,
}

/// Fits `knobs` of `scene` to `measured`; `progress` is called with the share of the work done, as
/// far as it can be foreseen.
///
/// # Errors
/// [`FitError`] if the measurement does not fit the scene, or if the traces do not determine
/// the parameters.
pub fn fit(
    (scene, knobs): (&Adjustable, &[AdjustableNumber]),
    measured: ComparedShot<'_>,
    assignments: &[Assignment],
    options: &FitOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<Fit, FitError> {
    let began = Instant::now();
    check(knobs)?;
    let freed_paths: Vec<&str> = knobs.iter().map(|knob| knob.path.as_str()).collect();
    let whole = scene.scene()?;
    let records = Records::of(measured, &whole, assignments, (options, &freed_paths))?;
    check_times(&records, whole.duration)?;
    let runs_a_step = 2.0 * f64::from(u32::try_from(knobs.len()).unwrap_or(u32::MAX)) + 1.0;
    let expected = f64::from(options.starts) * EXPECTED_STEPS * runs_a_step;
    let mut done = 0.0;
    let mut report = || {
        done += 1.0;
        progress((done / expected).min(0.99));
    };
    let freed = (options.offsets, options.accuracy);
    let mut scene = scene.clone();
    let inputs = if options.exact_inputs {
        RandomInputs::default()
    } else {
        RandomInputs::of(&mut scene)?.beside(&freed_paths, &whole)
    };
    let mut model = TraceModel::new(&scene, knobs, &records, freed, &mut report);
    let (minimum, starts) = search::best(&mut model, options)?;
    let mut minimum = with_inputs(&mut model, minimum, inputs)?;
    let again = with_noise(&mut model, &minimum)?;
    if let Some(again) = &again {
        model.records = again;
        let is_held = model.inputs.count() == 0;
        let criteria = if is_held { STOP_CRITERIA } else { INPUT_STOP_CRITERIA };
        minimum = minimise(&mut model, &minimum.x, criteria)?;
    }
    let used = model.records;
    let inputs = model.inputs.clone();
    let names = model.names();
    let shown = model.shown(&minimum.x).ok_or(LeastSquaresError::NoStart)?;
    let why = if options.gains { FREE_GAINS } else { "" };
    let covariance = covariance::of(&minimum, used, &shown)
        .map_err(|u| undetermined(&minimum, &names, u.parameter, why))?;
    check_intervals(knobs, &minimum, &covariance, why)?;
    // Inputs that the scene states are known: nothing is badly determined beside them.
    let found = &minimum.x[..minimum.x.len() - inputs.count()];
    let wanted = |place: usize| options.profile || profile::is_bad(found, &covariance, place);
    let mut profiles = Vec::new();
    for (place, knob) in knobs.iter().enumerate() {
        if wanted(place) {
            profiles.push(profile::of(
                &mut model,
                (&minimum, &covariance),
                (place, knob),
                STOP_CRITERIA,
            ));
        }
    }
    let runs = model.runs;
    let is_held = inputs.count() == 0;
    let taken_as_exact = is_held
        .then(|| records::taken_as_exact(&whole, &freed_paths))
        .flatten()
        .into_iter()
        .collect();
    let found = report::FittedMinimum {
        minimum: &minimum,
        covariance,
        names,
        inputs: &inputs,
        taken_as_exact,
        profiles,
        starts,
        runs,
    };
    let report = found.report((measured, &scene), knobs, (used, options), began);
    let scores = minimum.x[minimum.x.len() - inputs.count()..].to_vec();
    let records = again.unwrap_or(records);
    Ok(Fit { report, records, shown, inputs, scores })
}

/// The minimum near `minimum` where the scene's other uncertain `inputs` may move, too; the same
/// minimum, and no inputs, where steps do not lead there: the scene leaves something out.
fn with_inputs(
    model: &mut TraceModel<'_>,
    minimum: Minimum,
    inputs: RandomInputs,
) -> Result<Minimum, FitError> {
    if inputs.count() == 0 {
        return Ok(minimum);
    }
    let mut start = minimum.x.clone();
    start.extend(inputs.own_scores());
    model.inputs = inputs;
    match minimise(model, &start, INPUT_STOP_CRITERIA) {
        Err(LeastSquaresError::NotConverged { .. }) => {
            model.inputs = RandomInputs::default();
            Ok(minimum)
        }
        found => Ok(found?),
    }
}

/// The records with the 1/f noise that `minimum` leaves, if there is any.
fn with_noise(model: &mut TraceModel<'_>, minimum: &Minimum) -> Result<Option<Records>, FitError> {
    let records = model.records;
    if !records.have_pink_noise() {
        return Ok(None);
    }
    let shown = model.shown(&minimum.x).ok_or(LeastSquaresError::NoStart)?;
    Ok(records.weighed_again(&shown))
}

/// Refuses a minimum at which the data do not determine one of the `knobs`.
fn check_intervals(
    knobs: &[AdjustableNumber],
    minimum: &Minimum,
    covariance: &[Vec<f64>],
    why: &'static str,
) -> Result<(), FitError> {
    for (place, knob) in knobs.iter().enumerate() {
        let (value, u) = (minimum.x[place], covariance[place][place].sqrt());
        // An interval that holds zero, or no number, says nothing about a quantity that starts away
        // from zero.
        let is_determined = NORMAL_95 * u < value.abs();
        if !is_determined {
            let scaled = |x: f64| x * knob.value / knob.scale;
            let (value, u) = (scaled(value), scaled(NORMAL_95 * u));
            let u = if (0.01..1e4).contains(&u) { format!("{u:.2}") } else { format!("{u:.0e}") };
            let with = format!(" ({value:.3} ± {u} {})", knob.unit);
            return Err(FitError::Undetermined { parameter: knob.path.clone(), with, why });
        }
    }
    Ok(())
}

fn check(knobs: &[AdjustableNumber]) -> Result<(), FitError> {
    for (place, knob) in knobs.iter().enumerate() {
        let path = knob.path.clone();
        if knob.value == 0.0 {
            return Err(FitError::Zero { path });
        }
        if knobs[..place].iter().any(|other| other.path == path) {
            return Err(FitError::Twice { path });
        }
    }
    Ok(())
}

/// Refuses records that have nothing to do with a scene of this `duration` (s).
fn check_times(records: &Records, duration: f64) -> Result<(), FitError> {
    let interval = records.axis.interval;
    if !SAMPLE_RANGE.contains(&(duration / interval)) {
        return Err(FitError::TimeScale { interval, duration });
    }
    let length = records.axis.count as f64 * interval;
    if length > MAX_DURATIONS * duration {
        return Err(FitError::TooLong { length, duration });
    }
    Ok(())
}

/// What free gains leave. By Hertz's law the times of an uncompressed chain scale with
/// `(m^2 / (E^2 R v))^(1/5)`, and its forces have a factor of their own, which a gain takes in.
const FREE_GAINS: &str = "; with a free gain for each channel only times and shapes of pulses count, and of an uncompressed chain these determine E^2 v alone, modulus squared times speed: fix one of the two, or state what is known of the gains with --gain-u";

/// The parameter that is not determined, and the one that it goes with most.
fn undetermined(
    minimum: &Minimum,
    names: &[String],
    parameter: usize,
    why: &'static str,
) -> FitError {
    let columns = &minimum.columns;
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let own = columns.get(parameter).map_or(&[][..], Vec::as_slice);
    let likeness = |other: usize| {
        let other = &columns[other];
        (product(own, other) / (product(own, own) * product(other, other)).sqrt()).abs()
    };
    let others = (0..parameter).filter(|other| likeness(*other).is_finite());
    let nearest = others.max_by(|a, b| likeness(*a).total_cmp(&likeness(*b)));
    let name = |place: usize| names.get(place).cloned().unwrap_or_default();
    FitError::Undetermined {
        parameter: name(parameter),
        with: nearest.map_or_else(String::new, |other| format!(" beside {}", name(other))),
        why,
    }
}
