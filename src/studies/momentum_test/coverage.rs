//! Whether stated uncertainties are true: many blind calibrations, each with a sensor, readings and
//! noise of its own.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::design::{Designer, TestDesign};
use super::simulation::TestError;
use crate::analysis::calibration::Calibration;
use crate::sensor::Circuit;

/// Sensitivity and time constant are off the sensor's data by up to this, evenly: 90 % of it at
/// most, lest a pulse saturate (1).
const MAX_HIDDEN_DEVIATION: f64 = 0.09;
/// Stream of what is hidden.
const HIDDEN_STREAM: u128 = 1 << 71;

/// How well blind calibrations do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coverage {
    /// Number of calibrations.
    pub repeats: u32,
    /// How many of them came to no result.
    pub failed: u32,
    /// Mean of found over true sensitivity, less 1 (1).
    pub bias: f64,
    /// Standard deviation of that mean (1).
    pub bias_u: f64,
    /// Share of stated 95 % intervals that contain the truth (1).
    pub coverage_95: f64,
    /// Mean stated expanded uncertainty (95 %), relative (1).
    #[serde(rename = "mean_U95_relative")]
    pub mean_expanded: f64,
    /// Largest of them (1).
    #[serde(rename = "largest_U95_relative")]
    pub largest_expanded: f64,
    /// The same bias for the raw voltage's integral (1).
    pub naive_bias: f64,
    /// Share of intervals as wide around that which contain the truth (1).
    pub naive_coverage_95: f64,
    /// Mean of found over true time constant, less 1 (1).
    pub tau_bias: f64,
    /// Impacts that were left out, of all.
    pub impacts_left_out: u32,
}

/// Sums over calibrations.
#[derive(Default)]
struct Sums {
    ratios: Vec<f64>,
    inside: f64,
    naive: f64,
    naive_inside: f64,
    u: f64,
    largest_u: f64,
    tau: f64,
    left_out: u32,
}

impl Sums {
    fn add(&mut self, found: &Calibration, truth: Circuit) {
        let off = |s: f64| (s - truth.sensitivity).abs();
        let within = |s: f64| f64::from(u8::from(off(s) <= found.expanded()));
        let relative = found.expanded() / found.sensitivity;
        self.ratios.push(found.sensitivity / truth.sensitivity);
        self.inside += within(found.sensitivity);
        self.naive += found.naive / truth.sensitivity - 1.0;
        self.naive_inside += within(found.naive);
        self.u += relative;
        self.largest_u = self.largest_u.max(relative);
        self.tau += found.tau / truth.time_constant - 1.0;
        let left_out = found.impacts.iter().filter(|impact| impact.exclusion.is_some()).count();
        self.left_out += u32::try_from(left_out).unwrap_or(u32::MAX);
    }
}

/// Repeats `candidate`'s calibration blind.
///
/// # Errors
/// [`TestError`] for impacts that cannot be simulated.
pub fn coverage(
    designer: &Designer,
    candidate: &TestDesign,
    repeats: u32,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Result<Coverage, TestError> {
    let (striker, truths, setup) = designer.prepare(candidate)?;
    let mut hidden = Pcg64::new(u128::from(seed), HIDDEN_STREAM);
    let mut sums = Sums::default();
    let data = designer.circuit().unwrap_or(Circuit { sensitivity: 1.0, time_constant: 1e-3 });
    for repeat in 1..=repeats {
        let mut off = || {
            let share: f64 = StandardUniform.sample(&mut hidden);
            1.0 + MAX_HIDDEN_DEVIATION * (2.0 * share - 1.0)
        };
        let truth = Circuit {
            sensitivity: data.sensitivity * off(),
            time_constant: data.time_constant * off(),
        };
        let blind = designer.blind(&striker, &truths, truth, (&setup, repeat));
        if let Ok(found) = blind.calibrate() {
            sums.add(&found, truth);
        }
        progress(f64::from(repeat) / f64::from(repeats));
    }
    let count = sums.ratios.len() as f64;
    let mean = sums.ratios.iter().sum::<f64>() / count;
    let squares: f64 = sums.ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum();
    Ok(Coverage {
        repeats,
        failed: repeats - u32::try_from(sums.ratios.len()).unwrap_or(repeats),
        bias: mean - 1.0,
        bias_u: (squares / (count - 1.0) / count).sqrt(),
        coverage_95: sums.inside / count,
        mean_expanded: sums.u / count,
        largest_expanded: sums.largest_u,
        naive_bias: sums.naive / count,
        naive_coverage_95: sums.naive_inside / count,
        tau_bias: sums.tau / count,
        impacts_left_out: sums.left_out,
    })
}
