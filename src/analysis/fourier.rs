//! Discrete Fourier transforms of real numbers and their inverse.
//!
//! `X[k] = sum over j of x[j] exp(-2 pi i j k/N)`, `k` from 0 to `N/2`; the inverse divides by `N`.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

/// Makes transforms; keeps what it has prepared for a length, so that one of them serves for many
/// records.
#[derive(Default)]
pub struct Fourier {
    planner: RealFftPlanner<f64>,
}

impl Fourier {
    /// The coefficients of `values`, which are used as working memory.
    pub fn forward(&mut self, values: &mut [f64]) -> Vec<Complex<f64>> {
        let plan = self.planner.plan_fft_forward(values.len());
        let mut output = plan.make_output_vec();
        // Both lengths come from the plan, so that it has nothing to refuse.
        if plan.process(values, &mut output).is_err() {
            output.clear();
        }
        output
    }

    /// The `length` values of `coefficients`, which are used as working memory; those of frequency
    /// zero and of half the sampling frequency must be real (unit).
    pub fn inverse(&mut self, coefficients: &mut [Complex<f64>], length: usize) -> Vec<f64> {
        let plan = self.planner.plan_fft_inverse(length);
        let mut output = plan.make_output_vec();
        if plan.process(coefficients, &mut output).is_err() {
            output.clear();
        }
        let scale = 1.0 / length as f64;
        for value in &mut output {
            *value *= scale;
        }
        output
    }
}
