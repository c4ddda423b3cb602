//! Whether stated uncertainties are true: many blind calibrations, each with a sensor, readings and
//! noise of its own.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::design::{Designer, TestDesign};
use super::result::Calibration;
use super::simulation::TestError;
use crate::numeric::intervals::NORMAL_95;
use crate::numeric::statistics::{Coverage, Moments};
use crate::sensor::Circuit;

/// Sensitivity and time constant are off the sensor's data by up to this, evenly: 90 % of it at
/// most, lest a pulse saturate (1).
const MAX_HIDDEN_DEVIATION: f64 = 0.09;
/// Stream of what is hidden.
const HIDDEN_STREAM: u128 = 1 << 71;

/// How well blind calibrations do.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CalibrationCoverage {
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
    sensitivities: Coverage,
    naive: Coverage,
    tau: Coverage,
    u: Vec<f64>,
    left_out: u32,
}

impl Sums {
    fn add(&mut self, found: &Calibration, truth: Circuit) {
        let (expanded, s) = (found.expanded, truth.sensitivity);
        self.sensitivities.add(found.sensitivity, expanded, s, s);
        self.naive.add(found.naive, expanded, s, s);
        let tau = truth.time_constant;
        self.tau.add(found.tau, NORMAL_95 * found.tau_u, tau, tau);
        self.u.push(expanded / found.sensitivity);
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
) -> Result<CalibrationCoverage, TestError> {
    let (striker, truths, setup) = designer.prepare(candidate)?;
    let mut hidden = Pcg64::new(u128::from(seed), HIDDEN_STREAM);
    let mut sums = Sums::default();
    let data = designer.circuit().unwrap_or(Circuit { sensitivity: 1.0, time_constant: 1e-3 });
    for repeat in 1..=repeats {
        let truth = hidden_circuit(data, &mut hidden);
        let blind = designer.blind(&striker, &truths, truth, (&setup, repeat));
        if let Ok(found) = blind.calibrate() {
            sums.add(&found, truth);
        }
        progress(f64::from(repeat) / f64::from(repeats));
    }
    let errors = sums.sensitivities.errors();
    Ok(CalibrationCoverage {
        repeats,
        failed: repeats - u32::try_from(errors.count).unwrap_or(repeats),
        bias: errors.mean,
        bias_u: errors.mean_u(),
        coverage_95: sums.sensitivities.share(),
        mean_expanded: Moments::of(&sums.u).mean,
        largest_expanded: sums.u.iter().copied().fold(0.0, f64::max),
        naive_bias: sums.naive.errors().mean,
        naive_coverage_95: sums.naive.share(),
        tau_bias: sums.tau.errors().mean,
        impacts_left_out: sums.left_out,
    })
}

/// A circuit off `data` by up to [`MAX_HIDDEN_DEVIATION`] in both numbers, evenly.
fn hidden_circuit(data: Circuit, hidden: &mut Pcg64) -> Circuit {
    let mut off = || {
        let share: f64 = StandardUniform.sample(hidden);
        1.0 + MAX_HIDDEN_DEVIATION * (2.0 * share - 1.0)
    };
    Circuit { sensitivity: data.sensitivity * off(), time_constant: data.time_constant * off() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a blind test hides is not the data sheet's: both numbers are even over 9 % on either
    /// side, with a standard deviation of `0.09/sqrt(3)`, and do not go together. A standard
    /// deviation of 10,000 draws is good to 1 %, a correlation to 0.01: four of these.
    #[test]
    fn hidden_values_are_off_the_data_sheet() {
        let data = Circuit { sensitivity: 2.0, time_constant: 4.0 };
        let mut hidden = Pcg64::new(3, HIDDEN_STREAM);
        let draws: Vec<[f64; 2]> = (0..10_000)
            .map(|_| {
                let found = hidden_circuit(data, &mut hidden);
                [found.sensitivity / 2.0 - 1.0, found.time_constant / 4.0 - 1.0]
            })
            .collect();
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| draws.iter().map(of).sum::<f64>() / 1e4;
        let u = 0.09 / 3f64.sqrt();
        for number in 0..2 {
            assert!(draws.iter().all(|draw| draw[number].abs() <= 0.09));
            assert!(mean(&|draw| draw[number]).abs() < 0.04 * u);
            let deviation = mean(&|draw| draw[number].powi(2)).sqrt();
            assert!((deviation / u - 1.0).abs() < 0.04, "{deviation}");
        }
        assert!((mean(&|draw| draw[0] * draw[1]) / (u * u)).abs() < 0.04);
    }
}
