//! Does a fit find what is hidden, as well as it says? Scenes with hidden numbers are recorded,
//! noise, free clock and eight bits included, and fitted from the scene's own numbers.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::{FitError, FitOptions, FitReport, fit};
use crate::experiment::{Integration, RunError, facts, run};
use crate::measurement::compare::ComparedShot;
use crate::numeric::statistics::Coverage;
use crate::scene::adjust::{Adjustable, AdjustableNumber};
use crate::scene::random_inputs::RandomInputs;

/// Stream of what is hidden.
const BLIND_STREAM: u128 = 1 << 73;

/// How well blind fits do with one number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlindParameter {
    /// Its path in the scene.
    pub path: String,
    /// Share of stated 95 % intervals that contain the truth (1).
    pub coverage_95: f64,
    /// Mean of (found - true)/u: 0 without bias, give or take one over the root of the number of
    /// trials (1).
    pub bias: f64,
    /// Standard deviation of the same: 1 where uncertainties are right (1).
    pub spread: f64,
    /// Mean stated standard uncertainty, relative (1).
    pub mean_u_relative: f64,
}

/// How well blind fits do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BlindFits {
    /// Number of fits.
    pub trials: u32,
    /// How many of them came to no result.
    pub failed: u32,
    /// Largest relative distance of what is hidden from where the fit starts (1).
    pub spread: f64,
    /// Each number.
    pub parameters: Vec<BlindParameter>,
    /// Share of stated 95 % intervals that contain the truth, all numbers together (1).
    pub coverage_95: f64,
    /// Mean residual variance (1).
    pub residual_variance: f64,
    /// Simulations a fit (1).
    pub runs_per_fit: f64,
    /// Wall time a fit (s).
    pub seconds_per_fit: f64,
}

/// Why there is no blind test.
#[derive(Debug, thiserror::Error)]
pub enum BlindError {
    /// The fit's own problem.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// A scene with hidden numbers cannot run.
    #[error(transparent)]
    Run(#[from] RunError),
    /// Not one trial came to a result.
    #[error("found no trial that came to a result, expected some: {last}")]
    None {
        /// The last problem.
        last: String,
    },
}

/// Hides numbers within `options.spread` of the scene's and fits them, `trials` times.
///
/// # Errors
/// [`BlindError`] where scenes cannot run, and where nothing could be found in any.
pub fn blind(
    scene: &Adjustable,
    knobs: &[AdjustableNumber],
    trials: u32,
    options: &FitOptions,
    progress: &mut dyn FnMut(f64),
) -> Result<BlindFits, BlindError> {
    super::check(knobs)?;
    let mut hidden = Pcg64::new(u128::from(options.seed), BLIND_STREAM);
    let mut coverages = vec![Coverage::default(); knobs.len()];
    let mut uncertainties = vec![0.0; knobs.len()];
    let (mut variance, mut runs, mut seconds, mut count) = (0.0, 0.0, 0.0, 0.0);
    let mut last = String::new();
    for trial in 0..trials {
        let truth: Vec<(&AdjustableNumber, f64)> = knobs
            .iter()
            .map(|knob| {
                let share: f64 = StandardUniform.sample(&mut hidden);
                (knob, knob.value * (1.0 + options.spread * (2.0 * share - 1.0)))
            })
            .collect();
        match one(scene, (knobs, &truth), (trial, &mut hidden), options)? {
            Ok(report) => {
                for (place, (found, (_, truth))) in report.parameters.iter().zip(&truth).enumerate()
                {
                    coverages[place].add(found.value, found.expanded, *truth, found.u);
                    uncertainties[place] += found.u_relative.unwrap_or(f64::NAN);
                }
                variance += report.residual_variance;
                let of_fit = report.runs as f64;
                runs += of_fit;
                seconds += report.wall_s;
                count += 1.0;
            }
            Err(error) => last = error.to_string(),
        }
        progress(f64::from(trial + 1) / f64::from(trials));
    }
    if count == 0.0 {
        return Err(BlindError::None { last });
    }
    let parameters: Vec<BlindParameter> = knobs
        .iter()
        .zip(&coverages)
        .zip(&uncertainties)
        .map(|((knob, coverage), sum)| parameter(knob, coverage, sum / count))
        .collect();
    let whole: f64 = parameters.iter().map(|p| p.coverage_95).sum();
    let coverage_95 = whole / parameters.len() as f64;
    let failed = trials - count as u32;
    Ok(BlindFits {
        trials,
        failed,
        spread: options.spread,
        parameters,
        coverage_95,
        residual_variance: variance / count,
        runs_per_fit: runs / count,
        seconds_per_fit: seconds / count,
    })
}

fn parameter(knob: &AdjustableNumber, coverage: &Coverage, mean_u_relative: f64) -> BlindParameter {
    let errors = coverage.errors();
    BlindParameter {
        path: knob.path.clone(),
        coverage_95: coverage.share(),
        bias: errors.mean,
        spread: if errors.count > 1 { errors.deviation } else { 0.0 },
        mean_u_relative,
    }
}

/// Records the scene with its hidden numbers, and fits; the inner error is the fit's.
fn one(
    scene: &Adjustable,
    (knobs, truth): (&[AdjustableNumber], &[(&AdjustableNumber, f64)]),
    (trial, hidden): (u32, &mut Pcg64),
    options: &FitOptions,
) -> Result<Result<FitReport, FitError>, BlindError> {
    let paths: Vec<&str> = knobs.iter().map(|knob| knob.path.as_str()).collect();
    let mut scene = scene.clone();
    let inputs = if options.exact_inputs {
        RandomInputs::default()
    } else {
        let whole = scene.scene().map_err(FitError::from)?;
        RandomInputs::of(&mut scene).map_err(FitError::from)?.beside(&paths, &whole)
    };
    let shares: Vec<f64> = inputs.list().iter().map(|_| StandardUniform.sample(hidden)).collect();
    let scores = inputs.scores(&shares);
    let mut hiding = inputs.scene(&scene, truth, &scores).map_err(FitError::from)?;
    hiding.seed = options.seed.wrapping_add(u64::from(trial));
    let integration = Integration::Accuracy(hiding.accuracy);
    let outcome = run(&hiding, integration, 1, &mut |_| ())?;
    let set = facts::recording(&hiding, integration, [outcome])?;
    let side = ComparedShot { name: "blind trial", set: &set, shot: &set.shots[0], scene: None };
    let once = FitOptions { starts: 1, ..*options };
    Ok(fit((&scene, knobs), side, &[], &once, &mut |_| ()).map(|fit| fit.report))
}
