//! Propagation of distributions: all inputs drawn at once, many times.
//!
//! Every input is drawn from a normal distribution with its estimate and standard uncertainty; a
//! gain within limits evenly. Checked against the propagation of uncertainty: the ends of both 95 %
//! intervals agree to the numerical tolerance, half a unit of the last of two significant digits of
//! the standard uncertainty, or of one where the draws do not resolve two. Source: JCGM 101:2008,
//! clauses 7 and 8 (numerical tolerance: 7.9.2). Valid for any measurement equation; the ends of
//! the interval scatter by 0.6 % of the standard uncertainty with 200,000 draws. Student's t, which
//! the certificate adds, no draw has.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::equation::{MeasurementEquation, root_of_squares};
use crate::numeric::intervals::expanded_95;
use crate::numeric::statistics::{Moments, quantile};

/// Significant digits of the standard uncertainty that both propagations are to agree in, as far as
/// the draws resolve them.
const DIGITS: [i32; 2] = [2, 1];
/// Standard deviation of an end of the drawn interval times the root of the number of draws, over
/// the standard uncertainty of a normal distribution: `sqrt(p (1 - p))/phi(z)` at `p = 0.025` (1).
const END_SCATTER: f64 = 2.67;
/// Standard deviations of an end that the tolerance has to hold (1).
const END_DEVIATIONS: f64 = 3.0;
/// Stream of the draws.
const MONTE_CARLO_STREAM: u128 = 101;

/// Result of the draws.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MonteCarlo {
    /// Number of draws.
    pub draws: usize,
    /// Seed.
    pub seed: u64,
    /// Mean of the sensitivity (V/N).
    #[serde(rename = "mean_v_per_n")]
    pub mean: f64,
    /// Its standard deviation (V/N).
    #[serde(rename = "u_v_per_n")]
    pub u: f64,
    /// Where 2.5 % are below and 2.5 % above (V/N).
    #[serde(rename = "interval_95_v_per_n")]
    pub interval_95: [f64; 2],
    /// The same by the propagation of uncertainty of the same inputs (V/N).
    #[serde(rename = "propagated_95_v_per_n")]
    pub propagated_95: [f64; 2],
    /// Whether the draws confirm the propagation of uncertainty (JCGM 101, clause 8).
    #[serde(rename = "agrees_with_gum")]
    pub agrees: bool,
    /// Largest difference of the ends of both intervals (V/N).
    #[serde(rename = "difference_v_per_n")]
    pub difference: f64,
    /// Difference that is tolerated (V/N).
    #[serde(rename = "tolerance_v_per_n")]
    pub tolerance: f64,
}

/// Draws; none for none.
pub fn run(equation: &MeasurementEquation, draws: Draws) -> Option<MonteCarlo> {
    if draws.count < 2 {
        return None;
    }
    let mut stream = Pcg64::new(u128::from(draws.seed), MONTE_CARLO_STREAM);
    let mut inputs = equation.estimates().clone();
    let mut found: Vec<f64> = Vec::with_capacity(draws.count);
    for _ in 0..draws.count {
        for input in equation.inputs().iter().filter(|input| input.u > 0.0) {
            let deviate: f64 = if input.is_even {
                let share: f64 = StandardUniform.sample(&mut stream);
                3f64.sqrt() * (2.0 * share - 1.0)
            } else {
                StandardNormal.sample(&mut stream)
            };
            if let Some(value) = inputs.get_mut(input.kind, input.index) {
                *value = input.value + input.u * deviate;
            }
        }
        found.push(equation.evaluate(&inputs));
    }
    let Moments { mean, deviation: u, .. } = Moments::of(&found);
    found.sort_by(f64::total_cmp);
    let interval_95 = [quantile(&found, 0.025), quantile(&found, 0.975)];
    let parts: Vec<f64> = equation.budget().iter().map(|line| line.contribution).collect();
    let propagated = root_of_squares(&parts);
    let half_width = equation.half_width();
    let (center, half) = (equation.sensitivity(), expanded_95(propagated, half_width));
    let propagated_95 = [center - half, center + half];
    let apart = |end: usize| (interval_95[end] - propagated_95[end]).abs();
    let difference = apart(0).max(apart(1));
    let scatter = END_DEVIATIONS * END_SCATTER * propagated / (found.len() as f64).sqrt();
    let [fine, coarse] =
        DIGITS.map(|digits| 0.5 * 10f64.powi(propagated.log10().floor() as i32 - digits + 1));
    let tolerance = if fine >= scatter { fine } else { coarse };
    let agrees = difference <= tolerance;
    Some(MonteCarlo {
        draws: draws.count,
        seed: draws.seed,
        mean,
        u,
        interval_95,
        propagated_95,
        tolerance,
        difference,
        agrees,
    })
}

/// How the Monte-Carlo part is done.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Draws {
    /// Seed.
    pub seed: u64,
    /// Number of draws; 0 leaves the Monte-Carlo part out.
    pub count: usize,
}
