//! A polynomial through a few neighbouring samples: what lies between them, and how well it is
//! known.
//!
//! `y(x) = sum over k of c[k] x^k`, `x = (t - centre)/scale` from -1 to 1 over the samples taken;
//! the `c` that make the sum of squared differences smallest. If every sample carries independent
//! noise of variance `s^2`, the coefficients have the covariance `s^2 (V^T V)^-1`,
//! `V[i][k] = x[i]^k`. Source: W. H. Press et al., Numerical Recipes (2007), section 15.4. Valid
//! where the signal is close to a polynomial over the samples taken: the caller's choice of how
//! many.

use std::ops::Range;

use crate::numeric::linear::inverse;
use crate::numeric::roots::root;
use crate::trace::Trace;

/// How far beyond the samples a place may lie that they tell of, in their half-width (1).
const MAX_EXTRAPOLATION: f64 = 1.2;
/// A polynomial changes its sign at most once in each of this many parts of the samples.
const SIGN_SEARCH_PARTS: u8 = 48;

/// Polynomial with the covariance that noise of unit variance gives its coefficients.
#[derive(Debug, Clone)]
pub(super) struct LocalFit {
    centre: f64,
    scale: f64,
    pub(super) coefficients: Vec<f64>,
    covariance: Vec<Vec<f64>>,
    samples: usize,
}

impl LocalFit {
    /// A polynomial of degree `highest`, or less where samples are few, through the samples `range`
    /// of `trace`.
    pub(super) fn of(trace: &Trace, range: Range<usize>, highest: usize) -> Option<Self> {
        let values = trace.values.get(range.clone())?;
        if values.len() < 3 {
            return None;
        }
        let degree = highest.min(values.len() - 2);
        let (first, last) = (trace.time(range.start), trace.time(range.end - 1));
        let (centre, scale) = (0.5 * (first + last), 0.5 * (last - first));
        let size = degree + 1;
        let mut normal = vec![vec![0.0; size]; size];
        let mut right = vec![0.0; size];
        for (index, y) in range.zip(values) {
            let basis = powers((trace.time(index) - centre) / scale, size);
            for ((row, total), b) in normal.iter_mut().zip(&mut right).zip(&basis) {
                *total += b * y;
                for (entry, c) in row.iter_mut().zip(&basis) {
                    *entry += b * c;
                }
            }
        }
        let covariance = inverse(&normal).ok()?;
        let coefficients = covariance.iter().map(|row| dot(row, &right)).collect();
        Some(Self { centre, scale, coefficients, covariance, samples: values.len() })
    }

    /// Time at `x`.
    pub(super) fn time(&self, x: f64) -> f64 {
        self.centre + self.scale * x
    }

    /// Seconds in a unit of `x`.
    pub(super) fn scale(&self) -> f64 {
        self.scale
    }

    pub(super) fn value(&self, x: f64) -> f64 {
        self.derivative(0, x)
    }

    /// `dy/dx`.
    pub(super) fn slope(&self, x: f64) -> f64 {
        self.derivative(1, x)
    }

    /// `d2y/dx2`.
    pub(super) fn curvature(&self, x: f64) -> f64 {
        self.derivative(2, x)
    }

    /// `d3y/dx3`.
    pub(super) fn bend(&self, x: f64) -> f64 {
        self.derivative(3, x)
    }

    /// The derivative of order `order` with respect to `x`.
    fn derivative(&self, order: usize, x: f64) -> f64 {
        dot(&self.gradient(order, x), &self.coefficients)
    }

    /// The coefficients' weights in the derivative of order `order` at `x`.
    pub(super) fn gradient(&self, order: usize, x: f64) -> Vec<f64> {
        derivatives(x, self.coefficients.len(), order)
    }

    /// Each sample's weight in the sum of coefficients with the weights `gradient`, and the
    /// polynomial there.
    pub(super) fn weights(&self, gradient: &[f64]) -> impl Iterator<Item = (f64, f64)> {
        let row: Vec<f64> = self.covariance.iter().map(|row| dot(row, gradient)).collect();
        let step = 2.0 / (self.samples - 1) as f64;
        (0..self.samples).map(move |index| {
            let x = step * index as f64 - 1.0;
            (dot(&powers(x, row.len()), &row), self.value(x))
        })
    }

    /// Variance of the sum of coefficients with the weights `gradient`, from noise of unit
    /// variance.
    pub(super) fn variance(&self, gradient: &[f64]) -> f64 {
        self.covariance.iter().zip(gradient).map(|(row, g)| g * dot(row, gradient)).sum()
    }
}

/// The `x` nearest to the middle where `f`, something read off a polynomial, falls through zero.
pub(super) fn nearest_fall(f: &dyn Fn(f64) -> f64) -> Option<f64> {
    let width = 2.0 * MAX_EXTRAPOLATION / f64::from(SIGN_SEARCH_PARTS);
    let edges = (0..SIGN_SEARCH_PARTS).map(|look| width * f64::from(look) - MAX_EXTRAPOLATION);
    let falls = edges.filter_map(|low| {
        let high = low + width;
        let ends = [f(low), f(high)];
        (ends[0] > 0.0 && ends[1] <= 0.0).then(|| root(f, [low, high], ends))
    });
    falls.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

fn powers(x: f64, size: usize) -> Vec<f64> {
    std::iter::successors(Some(1.0), |power| Some(power * x)).take(size).collect()
}

/// Derivatives of the powers of `x`, of order `order`.
fn derivatives(x: f64, size: usize, order: usize) -> Vec<f64> {
    let factor = |power: usize| (power + 1 - order..=power).map(|k| k as f64).product::<f64>();
    let lower = powers(x, size.saturating_sub(order)).into_iter();
    let upper = (order..).zip(lower).map(|(power, lower)| factor(power) * lower);
    std::iter::repeat_n(0.0, order.min(size)).chain(upper).collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cubic is its own fit; noise of unit variance gives the middle of `n` points the variance
    /// of a Savitzky-Golay filter, `3 (3 m^2 + 3 m - 1) / ((2 m - 1)(2 m + 1)(2 m + 3))`,
    /// `n = 2 m + 1`.
    #[test]
    fn a_cubic_is_its_own_fit() {
        let cubic = |t: f64| 1.0 + 2.0 * t - 3.0 * t * t + 0.5 * t * t * t;
        let values = (0..9).map(|i| cubic(0.25 * f64::from(i))).collect();
        let (name, unit) = (String::new(), String::new());
        let trace = Trace { name, unit, start: 0.0, interval: 0.25, values };
        let fit = LocalFit::of(&trace, 0..9, 3).expect("a fit");
        for x in [-1.0, -0.3, 0.0, 0.8] {
            assert!((fit.value(x) - cubic(fit.time(x))).abs() < 1e-12);
        }
        let m = 4.0;
        let gain = 3.0 * (3.0 * m * m + 3.0 * m - 1.0)
            / ((2.0 * m - 1.0) * (2.0 * m + 1.0) * (2.0 * m + 3.0));
        let gradient = fit.gradient(0, 0.0);
        assert!((fit.variance(&gradient) - gain).abs() < 1e-12);
        // The value is the samples' sum with their weights, and has the variance of the squared
        // weights.
        let weighed: Vec<_> = fit.weights(&gradient).collect();
        let sum: f64 = weighed.iter().map(|(weight, value)| weight * value).sum();
        let squares: f64 = weighed.iter().map(|(weight, _)| weight * weight).sum();
        assert!((sum - fit.value(0.0)).abs() < 1e-12 && (squares - gain).abs() < 1e-12);
        let x = nearest_fall(&|x| cubic(0.9) - fit.value(x)).expect("a crossing");
        assert!((cubic(fit.time(x)) - cubic(0.9)).abs() < 1e-12);
        assert!(LocalFit::of(&trace, 0..2, 3).is_none());
    }
}
