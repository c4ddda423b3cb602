//! Finds numbers of a scene from measured traces: weighted least squares on what the scope shows of them.
//!
//! The model is the whole bench: chain, sensor with its droop, front end (`forward`); noise and rounding to levels are the samples'
//! standard deviations. The trigger's time after the contact is always found along, since the scope's clock runs freely; gains and
//! offsets of the channels on request. Minimum by Levenberg and Marquardt from several starts, each in the valley where its traces fit
//! best in time, where need be over ever longer parts of the records; covariance `s^2 (J^T J)^-1` with the residual variance; a profile of
//! what is badly determined (`profile`).
//! Source of the propagation: JCGM 100:2008; W. H. Press et al., "Numerical Recipes", 3rd ed. (2007), sections 15.5 and 15.6. Uncertainties
//! are those of noise and rounding: they hold where the model does, which the residual variance and the residuals' correlation from
//! sample to sample tell.

pub mod blind;
mod forward;
mod model;
mod profile;
mod records;
mod report;
mod search;

use std::ops::RangeInclusive;
use std::time::Instant;

use crate::analysis::gate::Gate;
use crate::analysis::least_squares::{LeastSquaresError, Limits, Minimum};
use crate::measurement::compare::Side;
use crate::measurement::compare::mapping::{Assignment, MappingError};
use crate::quantity::engineering;
use crate::scene::SceneError;
use crate::scene::adjust::{Adjustable, Knob};
use model::Model;
pub use profile::Profile;
pub use records::Records;
pub use report::{ChannelResult, FitReport, Nuisance, Parameter};

/// Half the width of a 95 % interval of the normal distribution, in standard deviations (1).
pub const COVERAGE_95: f64 = 1.959_963_984_540_054;
/// A step that lowers chi squared by less than this share of it moves no parameter by a thousandth of its uncertainty (1).
const LIMITS: Limits = Limits { reduction: 1e-11, steps: 60 };
/// Samples in a scene's duration: fewer show no pulse, more are another experiment (1).
const SAMPLES: RangeInclusive<f64> = 16.0..=200_000.0;
/// Longest records, in durations of the scene (1).
const MOST_DURATIONS: f64 = 3.0;
/// Steps that a fit takes, as far as its progress bar knows (1).
const EXPECTED_STEPS: f64 = 10.0;

/// How a fit goes about it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Whether each channel has a gain of its own.
    pub gains: bool,
    /// Whether each channel has an offset of its own.
    pub offsets: bool,
    /// Number of starting points, the scene's numbers first.
    pub starts: u32,
    /// How far the other starting points lie at most, relative (1).
    pub spread: f64,
    /// Seed of the starting points.
    pub seed: u64,
    /// Accuracy of the integration (1).
    pub accuracy: f64,
    /// The part of the records that counts.
    pub gate: Gate,
    /// Whether every number of the scene is profiled, not only the badly determined.
    pub profile: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            gains: false,
            offsets: false,
            starts: 3,
            spread: 0.1,
            seed: 1,
            accuracy: 1e-7,
            gate: Gate::ALL,
            profile: false,
        }
    }
}

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// No channel belongs to the scene.
    #[error(transparent)]
    Mapping(#[from] MappingError),
    /// Channels that were not taken together.
    #[error(
        "{channel}: found other sample times than in the first channel, expected records of one trigger"
    )]
    Times {
        /// The channel.
        channel: String,
    },
    /// Nothing to fit.
    #[error("{channel}: found no sample to fit, expected some")]
    NoSamples {
        /// The channel.
        channel: String,
    },
    /// Records of another time scale than the scene's.
    #[error("found samples {} apart for a scene of {}, expected 16 to 200000 of them in its duration", engineering(*interval, "s", 3), engineering(*duration, "s", 3))]
    TimeScale {
        /// From one sample to the next (s).
        interval: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// Records that go on long after the scene has ended.
    #[error("found records of {}, expected at most {MOST_DURATIONS} durations of the scene, {}: --to leaves the rest out", engineering(*length, "s", 3), engineering(*duration, "s", 3))]
    TooLong {
        /// Length of the records (s).
        length: f64,
        /// The scene's duration (s).
        duration: f64,
    },
    /// A number to free that starts at zero.
    #[error("found {path} to start at zero, expected another start: --free \"{path}=VALUE\"")]
    Zero {
        /// The number's path.
        path: String,
    },
    /// A number that is freed twice.
    #[error("found {path} twice among the numbers to free, expected it once")]
    Twice {
        /// The number's path.
        path: String,
    },
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// No minimum from any start.
    #[error(transparent)]
    LeastSquares(#[from] LeastSquaresError),
    /// Traces do not tell a parameter.
    #[error(
        "found that these traces do not determine {parameter}{with}, expected them to: free less"
    )]
    Undetermined {
        /// The parameter.
        parameter: String,
        /// What it cannot be told from.
        with: String,
    },
}

/// A fit with its traces.
#[derive(Debug, Clone, PartialEq)]
pub struct Fit {
    /// Numbers for people and scripts.
    pub report: FitReport,
    /// What was measured.
    pub records: Records,
    /// What the fitted scene shows, one trace a channel (V).
    pub shown: Vec<Vec<f64>>,
}

/// Fits `knobs` of `scene` to `measured`; `progress` hears the share of the work done, as far as it can be foreseen.
///
/// # Errors
/// [`FitError`] where measurement and scene do not belong together, and where the traces do not tell the numbers.
pub fn fit(
    (scene, knobs): (&Adjustable, &[Knob]),
    measured: Side<'_>,
    assignments: &[Assignment],
    options: &Options,
    progress: &mut dyn FnMut(f64),
) -> Result<Fit, FitError> {
    let began = Instant::now();
    check(knobs)?;
    let records = Records::of(measured, &scene.scene()?, assignments, options.gate)?;
    check_times(&records, scene.scene()?.duration)?;
    let runs_a_step = 2.0 * f64::from(u32::try_from(knobs.len()).unwrap_or(u32::MAX)) + 1.0;
    let expected = f64::from(options.starts) * EXPECTED_STEPS * runs_a_step;
    let mut done = 0.0;
    let mut report = || {
        done += 1.0;
        progress((done / expected).min(0.99));
    };
    let freed = ((options.gains, options.offsets), options.accuracy);
    let mut model = Model::new(scene, knobs, &records, freed, &mut report);
    let (minimum, starts) = search::best(&mut model, options)?;
    let names = model.names();
    let covariance =
        minimum.covariance().map_err(|u| undetermined(&minimum, &names, u.parameter))?;
    let wanted = |place: usize| options.profile || profile::is_bad(&minimum.x, &covariance, place);
    let mut profiles = Vec::new();
    for (place, knob) in knobs.iter().enumerate() {
        if wanted(place) {
            profiles.push(profile::of(&mut model, (&minimum, &covariance), (place, knob), LIMITS));
        }
    }
    let shown = model.shown(&minimum.x).ok_or(LeastSquaresError::NoStart)?;
    let runs = model.runs;
    let found = report::Found { minimum: &minimum, covariance, names, profiles, starts, runs };
    let report = found.report((measured, scene), knobs, (&records, options), began);
    Ok(Fit { report, records, shown })
}

fn check(knobs: &[Knob]) -> Result<(), FitError> {
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
#[allow(clippy::cast_precision_loss, reason = "records are far shorter than 2^53 samples")]
fn check_times(records: &Records, duration: f64) -> Result<(), FitError> {
    let interval = records.axis.interval;
    if !SAMPLES.contains(&(duration / interval)) {
        return Err(FitError::TimeScale { interval, duration });
    }
    let length = records.axis.count as f64 * interval;
    if length > MOST_DURATIONS * duration {
        return Err(FitError::TooLong { length, duration });
    }
    Ok(())
}

/// The parameter that cannot be told, and the one that it goes with most.
fn undetermined(minimum: &Minimum, names: &[String], parameter: usize) -> FitError {
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
    }
}
