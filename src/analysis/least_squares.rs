//! Nonlinear least squares by Levenberg and Marquardt, and what the minimum says about its
//! parameters.
//!
//! Minimises `chi^2(x) = sum r[i](x)^2`, residuals in units of their standard deviations. A step
//! `h` solves `(J^T J + mu D) h = -J^T r`, `D` the largest diagonal of `J^T J` so far; `mu` follows
//! the gain ratio by Nielsen's rule, and a step to where the problem has no value is refused like
//! one that climbs. Covariance of white residuals: `s^2 (J^T J)^-1` with the residual variance
//! `s^2 = chi^2/(N - P)`. Sources: J. J. Moré, Lecture Notes in Mathematics 630, 105 (1978), for
//! the scaling; K. Madsen, H. B. Nielsen, O. Tingleff, "Methods for Non-Linear Least Squares
//! Problems", DTU (2004), Algorithm 3.16, for the damping. Valid for residuals that are smooth in
//! the parameters; finds the minimum of the valley it starts in.

use crate::numeric::linear::{Undetermined, inverse_of_gram, solve};

/// First damping, relative to the diagonal (1).
const FIRST_DAMPING: f64 = 1e-3;
/// Damping beyond which no step is left that could help (1).
const LAST_DAMPING: f64 = 1e12;

/// A least-squares problem.
pub trait LeastSquaresProblem {
    /// Residuals at `x` in their standard deviations; none where there is no value (1).
    fn residuals(&mut self, x: &[f64]) -> Option<Vec<f64>>;

    /// Derivatives of the residuals at `x` by each parameter, a column each, where the residuals
    /// are `at`; none where there is no value (1).
    fn columns(&mut self, x: &[f64], at: &[f64]) -> Option<Vec<Vec<f64>>>;

    /// How many of the residuals `at` count: all, unless some have no weight.
    fn counted(&self, at: &[f64]) -> usize {
        at.len()
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopCriteria {
    /// Done when a step is to lower chi squared by less than this share of it (1).
    pub reduction: f64,
    /// Most steps that are tried.
    pub steps: u32,
}

/// Why there is no minimum.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LeastSquaresError {
    /// The problem has no value where it starts.
    #[error("found no value at the starting point, expected one")]
    NoStart,
    /// More parameters than data.
    #[error("found {residuals} residuals for {parameters} parameters, expected more")]
    TooFew {
        /// How many residuals there are.
        residuals: usize,
        /// How many parameters.
        parameters: usize,
    },
    /// The steps ran out.
    #[error("found no minimum within {steps} steps, expected one: start closer, or free less")]
    NotConverged {
        /// Steps tried.
        steps: u32,
    },
}

/// A minimum.
#[derive(Debug, Clone, PartialEq)]
pub struct Minimum {
    /// Where it is (unit).
    pub x: Vec<f64>,
    /// Residuals there (1).
    pub residuals: Vec<f64>,
    /// Their derivatives there, a column a parameter (unit).
    pub columns: Vec<Vec<f64>>,
    /// Sum of the squared residuals (1).
    pub chi_squared: f64,
    /// Residuals that count, less parameters.
    pub degrees_of_freedom: usize,
    /// Steps tried.
    pub steps: u32,
}

/// The minimum that is reached from `start`.
///
/// # Errors
/// [`LeastSquaresError`] where the start has no value, where data are too few, and where steps run
/// out.
pub fn minimise(
    problem: &mut dyn LeastSquaresProblem,
    start: &[f64],
    limits: StopCriteria,
) -> Result<Minimum, LeastSquaresError> {
    let mut x = start.to_vec();
    let mut residuals = problem.residuals(&x).ok_or(LeastSquaresError::NoStart)?;
    if problem.counted(&residuals) <= x.len() {
        let (residuals, parameters) = (problem.counted(&residuals), x.len());
        return Err(LeastSquaresError::TooFew { residuals, parameters });
    }
    let mut columns = problem.columns(&x, &residuals).ok_or(LeastSquaresError::NoStart)?;
    let degrees_of_freedom = problem.counted(&residuals).saturating_sub(x.len());
    let mut chi_squared = squares(&residuals);
    let (mut damping, mut growth) = (FIRST_DAMPING, 2.0);
    let mut scale = vec![0.0; x.len()];
    let mut steps = 0;
    while steps < limits.steps {
        steps += 1;
        for (scale, column) in scale.iter_mut().zip(&columns) {
            *scale = squares(column).max(*scale);
        }
        let gradient: Vec<f64> = columns.iter().map(|column| dot(column, &residuals)).collect();
        let step = damped_step(&columns, &gradient, &scale, damping);
        let predicted: f64 = step
            .iter()
            .zip(gradient.iter().zip(&scale))
            .map(|(h, (g, d))| h * (damping * d * h - g))
            .sum();
        if predicted <= limits.reduction * chi_squared && damping <= 1.0 {
            return Ok(Minimum { x, residuals, columns, chi_squared, degrees_of_freedom, steps });
        }
        let moved: Vec<f64> = x.iter().zip(&step).map(|(x, h)| x + h).collect();
        let there = problem.residuals(&moved).map(|r| (squares(&r), r));
        let gain = there.as_ref().map_or(f64::NAN, |(chi, _)| (chi_squared - chi) / predicted);
        let downhill = there.filter(|_| gain > 0.0);
        let taken = downhill.and_then(|(chi, r)| Some((problem.columns(&moved, &r)?, chi, r)));
        if let Some((new_columns, chi, r)) = taken {
            (x, residuals, columns, chi_squared) = (moved, r, new_columns, chi);
            damping *= (1.0 - (2.0 * gain - 1.0).powi(3)).max(1.0 / 3.0);
            growth = 2.0;
        } else {
            damping *= growth;
            growth *= 2.0;
            if damping > LAST_DAMPING {
                // Nothing is lower within what numbers can tell apart.
                return Ok(Minimum {
                    x,
                    residuals,
                    columns,
                    chi_squared,
                    degrees_of_freedom,
                    steps,
                });
            }
        }
    }
    Err(LeastSquaresError::NotConverged { steps })
}

/// Solves for the damped step; no step along a parameter that changes nothing.
fn damped_step(columns: &[Vec<f64>], gradient: &[f64], scale: &[f64], damping: f64) -> Vec<f64> {
    let root: Vec<f64> = scale.iter().map(|d| if *d > 0.0 { d.sqrt() } else { 1.0 }).collect();
    let mut matrix: Vec<Vec<f64>> = Vec::with_capacity(columns.len());
    for (i, a) in columns.iter().enumerate() {
        let row = columns.iter().enumerate().map(|(j, b)| {
            let damped = if i == j { damping } else { 0.0 };
            dot(a, b) / (root[i] * root[j]) + damped
        });
        matrix.push(row.collect());
    }
    let downhill: Vec<f64> = gradient.iter().zip(&root).map(|(g, d)| -g / d).collect();
    let step = solve(&matrix, &downhill).unwrap_or_else(|_| vec![0.0; gradient.len()]);
    step.iter().zip(&root).map(|(h, d)| h / d).collect()
}

impl Minimum {
    /// Residual variance `chi^2/(N - P)`, `N` the residuals that count: 1 where the residuals'
    /// standard deviations are right and the model is (1).
    pub fn variance(&self) -> f64 {
        self.chi_squared / self.degrees_of_freedom.max(1) as f64
    }

    /// `(J^T J)^-1`, the covariance of the parameters for white residuals of variance one, in the
    /// product of their units (1).
    ///
    /// # Errors
    /// [`Undetermined`] with the parameter that the data do not determine beside the others.
    pub fn inverse(&self) -> Result<Vec<Vec<f64>>, Undetermined> {
        inverse_of_gram(&self.columns)
    }
}

/// Sum of squares (unit).
pub fn squares(values: &[f64]) -> f64 {
    values.iter().map(|v| v * v).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    type Curve = fn(&[f64], f64) -> f64;

    /// A curve through points, differentiated by central differences.
    struct Points<'a>(Curve, &'a [(f64, f64)]);

    impl LeastSquaresProblem for Points<'_> {
        fn residuals(&mut self, x: &[f64]) -> Option<Vec<f64>> {
            Some(self.1.iter().map(|(at, y)| y - (self.0)(x, *at)).collect())
        }

        fn columns(&mut self, x: &[f64], _: &[f64]) -> Option<Vec<Vec<f64>>> {
            let column = |j: usize| {
                let moved = |by: f64| {
                    let mut there = x.to_vec();
                    there[j] *= 1.0 + by;
                    self.1.iter().map(|(at, _)| -(self.0)(&there, *at)).collect::<Vec<f64>>()
                };
                let step = 2e-5 * x[j];
                moved(1e-5).iter().zip(moved(-1e-5)).map(|(u, l)| (u - l) / step).collect()
            };
            Some((0..x.len()).map(column).collect())
        }
    }

    /// Misra1a of the NIST Statistical Reference Datasets: certified parameters, their standard
    /// deviations and the residual standard deviation, from both starts.
    #[test]
    fn misra1a_of_nist_comes_out() {
        const DATA: [(f64, f64); 14] = [
            (77.6, 10.07),
            (114.9, 14.73),
            (141.1, 17.94),
            (190.8, 23.93),
            (239.9, 29.61),
            (289.0, 35.18),
            (332.8, 40.02),
            (378.4, 44.82),
            (434.8, 50.76),
            (477.3, 55.05),
            (536.8, 61.01),
            (593.1, 66.40),
            (689.1, 75.47),
            (760.0, 81.78),
        ];
        let curve: Curve = |b, x| b[0] * -(-b[1] * x).exp_m1();
        for start in [[500.0, 1e-4], [250.0, 5e-4]] {
            let limits = StopCriteria { reduction: 1e-14, steps: 200 };
            let found = minimise(&mut Points(curve, &DATA), &start, limits).expect("a minimum");
            let inverse = found.inverse().expect("determined parameters");
            for (j, (value, deviation)) in
                [(238.942_129_18, 2.707_007_524_1), (5.501_564_318_1e-4, 7.266_868_843_6e-6)]
                    .into_iter()
                    .enumerate()
            {
                assert!((found.x[j] / value - 1.0).abs() < 1e-6, "{start:?}: {:?}", found.x);
                let off = (found.variance() * inverse[j][j]).sqrt() / deviation - 1.0;
                assert!(off.abs() < 1e-5, "deviation of b{}: {off:e}", j + 1);
            }
            assert!((found.variance().sqrt() / 0.101_878_763_30 - 1.0).abs() < 1e-7);
        }
    }

    /// Two parameters that only count as their sum cannot be determined, and the error says so;
    /// which of all is named is left to rounding, as derivatives are differences here.
    #[test]
    fn parameters_that_cannot_be_told_apart_are_refused() {
        let points: Vec<(f64, f64)> = (1..9).map(|i| (f64::from(i), 3.0 * f64::from(i))).collect();
        let curve: Curve = |b, x| (b[0] + b[1]) * x + b[2];
        let limits = StopCriteria { reduction: 1e-12, steps: 50 };
        let found = minimise(&mut Points(curve, &points), &[1.0, 1.0, 1.0], limits);
        assert!(found.expect("a minimum").inverse().is_err());
    }

    /// A step to where there is no value is refused, and the minimum at the edge of what is allowed
    /// is still found.
    #[test]
    fn where_there_is_no_value_no_step_ends() {
        struct BoundedProblem;
        impl LeastSquaresProblem for BoundedProblem {
            fn residuals(&mut self, x: &[f64]) -> Option<Vec<f64>> {
                (x[0] > 0.0).then(|| vec![x[0].ln(), 0.5 * x[0].ln()])
            }
            fn columns(&mut self, x: &[f64], _: &[f64]) -> Option<Vec<Vec<f64>>> {
                Some(vec![vec![1.0 / x[0], 0.5 / x[0]]])
            }
        }
        let limits = StopCriteria { reduction: 0.0, steps: 100 };
        let found = minimise(&mut BoundedProblem, &[20.0], limits).expect("a minimum");
        assert!((found.x[0] - 1.0).abs() < 1e-8, "{:?}", found.x);
    }
}
