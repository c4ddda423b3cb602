//! What a scene's `[uncertainty]` makes of its predictions: intervals, bands of traces, and each
//! input's share.
//!
//! `RandomInputs` are drawn by Latin hypercube: of `N` samples one lies in each `N`-th of every
//! input's distribution, in random order. Each sample is a whole bench, chain, sensors and scope,
//! without noise and rounding. Intervals are 2.5 and 97.5 % quantiles: of 40,000 values of the
//! regression on the inputs' standard scores with its curvature and residuals, where it explains 95
//! % of the variance, so that few runs are enough; else of the samples. Bands are the samples' own.
//! Shares come from the same linear regression, `share = R^2 (b_i)^2/sum of (b_j)^2`, with the
//! share `R^2` of the variance that the regression explains; what it leaves is not linear, or
//! interaction. Besides `[uncertainty]`, sensors' own `sensitivity_u` and `tau_u` are inputs, and
//! with `[effects.scope_errors]` each channel's gain and zero. Sources: M. D. `McKay`, R. J.
//! Beckman, W. J. Conover, Technometrics 21, 239 (1979); A. Saltelli et al., "Global Sensitivity
//! Analysis" (2008), section 1.2.5 (standardised regression coefficients); JCGM 101:2008. Valid
//! where outputs are nearly linear over the inputs' spread: the share that is left shows whether
//! they are.

mod joint;
mod normalised;
mod outputs;
mod regression;

pub use joint::JointTest;
pub use normalised::{InputMove, JudgedErrors, NormalisedError, judge, normalised_errors};
pub use outputs::{OutputInterval, TraceBand};
pub use regression::InputShare;

use std::time::Instant;

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::experiment::RunError;
use crate::experiment::parallel::{in_parallel, processors};
use crate::experiment::prediction::{Prediction, predict};
use crate::scene::Scene;
use crate::scene::SceneError;
use crate::scene::adjust::Adjustable;
use crate::scene::random_inputs::{RandomInput, RandomInputs, RandomInputsError};

/// Why a scene's uncertainty cannot be propagated.
#[derive(Debug, thiserror::Error)]
pub enum UncertaintyError {
    /// Nothing is uncertain.
    #[error(
        "found nothing uncertain in {scene}: give the scene a table [uncertainty], e.g. striker.speed = \"1 %\""
    )]
    Nothing {
        /// The scene.
        scene: String,
    },
    /// What it states is wrong.
    #[error(transparent)]
    Inputs(#[from] RandomInputsError),
    /// Too few samples gave a result.
    #[error("too few samples gave a result: more samples, or smaller uncertainties")]
    NoSamples,
    /// So many samples gave no result that those left are not drawn from what the scene states.
    #[error(
        "{failed} of {samples} samples gave no result: smaller uncertainties, or limits that the value cannot leave{}",
        reason.as_ref().map_or(String::new(), |reason| format!("; the first: {reason}"))
    )]
    Failed {
        /// Samples without one.
        failed: usize,
        /// All of them.
        samples: usize,
        /// Why the first has none.
        reason: Option<String>,
    },
    /// The scene cannot run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The scene is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

/// Samples that give no result may be this share of all (1).
const MAX_FAILED_SHARE: f64 = 0.02;
/// Accuracy of the samples' integration: far below any uncertainty of a bench (1).
const ACCURACY: f64 = 1e-5;
/// Samples of the outputs' regressions, which need no run: quantiles to 0.5 % of the interval's
/// half-width.
const LINEAR_SAMPLES: usize = 40_000;
/// Stream of the draws.
const SAMPLE_STREAM: u128 = 1 << 75;

/// How the samples are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SampleOptions {
    /// Number of samples.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
}

impl Default for SampleOptions {
    fn default() -> Self {
        Self { samples: 1000, seed: 1 }
    }
}

/// What an uncertain scene predicts.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct UncertainPrediction {
    /// The scene.
    pub scene: String,
    /// Number of samples.
    pub samples: usize,
    /// Seed of the draws.
    pub seed: u64,
    /// Samples that could not be run or did not trigger.
    pub failed: usize,
    /// Wall time (s).
    pub wall_s: f64,
    /// What varies.
    pub inputs: Vec<RandomInput>,
    /// Peaks, arrivals and speeds, each with its interval and its inputs' shares.
    pub outputs: Vec<OutputInterval>,
    /// Speeds over the distances of the scene's own numbers, as a measurement has them: plates that
    /// are drawn elsewhere change the delay alone.
    #[serde(skip)]
    pub speeds_as_measured: Vec<OutputInterval>,
    /// Bands of the channels' traces; empty where none were asked for.
    pub bands: Vec<TraceBand>,
}

/// Benches drawn from a scene's uncertainty, and what each predicts.
struct DrawnBenches {
    inputs: RandomInputs,
    scene: Scene,
    /// Of the scene as it is, and without the errors of gain and zero that its seed draws.
    as_run: Prediction,
    nominal: Prediction,
    /// Scores of each sample that gave a result, and its prediction.
    samples: Vec<(Vec<f64>, Prediction)>,
}

impl DrawnBenches {
    fn of(
        adjustable: &mut Adjustable,
        options: SampleOptions,
        traces: bool,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Self, UncertaintyError> {
        let inputs = RandomInputs::of(adjustable)?;
        if inputs.count() == 0 {
            return Err(UncertaintyError::Nothing { scene: adjustable.name().to_owned() });
        }
        let mut scenes = vec![adjustable.scene()?, inputs.without_errors(adjustable)?];
        let mut scores: Vec<Vec<f64>> = Vec::new();
        let mut reason = None;
        for sample in hypercube(inputs.count(), options) {
            let sample = inputs.scores(&sample);
            // A sample beyond what a key allows, such as a negative mass, is none.
            match inputs.scene(adjustable, &[], &sample) {
                Ok(scene) => {
                    scenes.push(scene);
                    scores.push(sample);
                }
                Err(error) => reason = reason.or_else(|| Some(error.to_string())),
            }
        }
        let count = scenes.len();
        let work = |scene: &Scene| predict(scene, ACCURACY, traces);
        let done = |finished: usize| progress(finished as f64 / count as f64);
        let mut found = in_parallel(processors(), &scenes, &work, &done).into_iter();
        let mut next = || found.next().transpose()?.ok_or(UncertaintyError::NoSamples);
        let (as_run, nominal) = (next()?, next()?);
        let pairs = scores.into_iter().zip(found);
        let samples: Vec<_> =
            pairs.filter_map(|(scores, found)| Some((scores, found.ok()?))).collect();
        let failed = options.samples - samples.len();
        if failed as f64 > MAX_FAILED_SHARE * options.samples as f64 {
            return Err(UncertaintyError::Failed { failed, samples: options.samples, reason });
        }
        if samples.len() <= inputs.count() + 1 {
            return Err(UncertaintyError::NoSamples);
        }
        Ok(Self { inputs, scene: scenes.swap_remove(0), as_run, nominal, samples })
    }

    fn pairs(&self) -> Vec<(&[f64], &Prediction)> {
        self.samples.iter().map(|(scores, found)| (scores.as_slice(), found)).collect()
    }

    fn bands(&self) -> Vec<TraceBand> {
        outputs::bands(&self.scene, &self.nominal, &self.pairs())
    }
}

/// Where 95 % of the traces of `adjustable` lie.
///
/// # Errors
/// As [`uncertain_prediction`].
pub fn trace_bands(
    adjustable: &mut Adjustable,
    options: SampleOptions,
) -> Result<Vec<TraceBand>, UncertaintyError> {
    Ok(DrawnBenches::of(adjustable, options, true, &|_| ())?.bands())
}

/// Predicts `adjustable` with its uncertainty, with bands of traces if `bands`.
///
/// # Errors
/// [`UncertaintyError`] for an `[uncertainty]` that names nothing, or nothing at all, and where the
/// scene itself cannot be run.
pub fn uncertain_prediction(
    adjustable: &mut Adjustable,
    options: SampleOptions,
    bands: bool,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<UncertainPrediction, UncertaintyError> {
    let began = Instant::now();
    let drawn = DrawnBenches::of(adjustable, options, bands, progress)?;
    let inputs = &drawn.inputs;
    let many = SampleOptions { samples: LINEAR_SAMPLES, seed: options.seed.wrapping_add(1) };
    let many: Vec<Vec<f64>> =
        hypercube(inputs.count(), many).iter().map(|sample| inputs.scores(sample)).collect();
    let outputs =
        outputs::intervals([&drawn.nominal, &drawn.as_run], &drawn.pairs(), (inputs.list(), &many));
    let as_measured = |found: &Prediction| outputs::over_nominal_distances(found, &drawn.nominal);
    let speeds: Vec<Prediction> =
        drawn.samples.iter().map(|(_, found)| as_measured(found)).collect();
    let speeds: Vec<(&[f64], &Prediction)> =
        drawn.samples.iter().zip(&speeds).map(|((s, _), found)| (s.as_slice(), found)).collect();
    let own = [as_measured(&drawn.nominal), as_measured(&drawn.as_run)];
    let speeds_as_measured =
        outputs::intervals([&own[0], &own[1]], &speeds, (inputs.list(), &many));
    Ok(UncertainPrediction {
        speeds_as_measured,
        scene: adjustable.name().to_owned(),
        samples: options.samples,
        seed: options.seed,
        failed: options.samples - drawn.samples.len(),
        outputs,
        bands: if bands { drawn.bands() } else { Vec::new() },
        inputs: inputs.list().to_vec(),
        wall_s: began.elapsed().as_secs_f64(),
    })
}

/// A Latin hypercube of `inputs` dimensions: each sample's shares of the distributions, from 0 to 1
/// (1).
fn hypercube(inputs: usize, options: SampleOptions) -> Vec<Vec<f64>> {
    let count = options.samples;
    let mut numbers = Pcg64::new(u128::from(options.seed), SAMPLE_STREAM);
    let mut even = move || -> f64 { StandardUniform.sample(&mut numbers) };
    let mut samples = vec![Vec::with_capacity(inputs); count];
    for _ in 0..inputs {
        let mut places: Vec<usize> = (0..count).collect();
        // Fisher and Yates.
        for last in (1..count).rev() {
            let other = (even() * (last + 1) as f64) as usize;
            places.swap(last, other.min(last));
        }
        for (sample, place) in samples.iter_mut().zip(places) {
            sample.push((place as f64 + even()) / count as f64);
        }
    }
    samples
}
