//! Moments, quantiles, coverage of intervals, and straight lines by weighted least squares.
//!
//! Of `n` values: mean, standard deviation `s = sqrt(sum (x_i - mean)^2/(n - 1))`, standard
//! uncertainty of the mean `s/sqrt(n)` (JCGM 100:2008, 4.2). The quantile of sorted values lies on
//! a straight line between two of them, at `(n - 1) share` (R. J. Hyndman, Y. Fan, Am. Stat. 50,
//! 361 (1996), definition 7). The line `y = <y> + b (x - <x>)` has `b = sum w (x - <x>)(y - <y>) /
//! sum w (x - <x>)^2`, means weighted with `w`. Source: W. H. Press et al., Numerical Recipes
//! (2007), section 15.2.

use super::intervals::NORMAL_95;

/// Number, mean and standard deviation of values.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moments {
    /// How many values.
    pub count: usize,
    /// Mean; not a number for none (unit).
    pub mean: f64,
    /// Standard deviation of a single value; not a number for fewer than two (unit).
    pub deviation: f64,
}

impl Moments {
    /// Those of `values`.
    pub fn of(values: &[f64]) -> Self {
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        let deviation = if values.len() < 2 { f64::NAN } else { (squares / (n - 1.0)).sqrt() };
        Self { count: values.len(), mean, deviation }
    }

    /// Standard uncertainty of the mean (unit).
    pub fn mean_u(&self) -> f64 {
        self.deviation / (self.count as f64).sqrt()
    }
}

/// The median; zero of no values (unit).
pub fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    values.sort_by(f64::total_cmp);
    quantile(&values, 0.5)
}

/// The quantile of sorted values, on a straight line between two; not a number for none (unit).
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let index = place.floor() as usize;
    let at = |index: usize| sorted.get(index).copied();
    match (at(index), at(index + 1)) {
        (Some(low), Some(high)) => low + (place - place.floor()) * (high - low),
        (Some(low), None) => low,
        _ => f64::NAN,
    }
}

/// Values found again and again, each with its stated 95 % interval, against the truth.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Coverage {
    errors: Vec<f64>,
    inside: usize,
}

impl Coverage {
    /// Adds a value with its expanded uncertainty for 95 % (unit); errors are counted over `scale`
    /// (unit).
    pub fn add(&mut self, found: f64, expanded: f64, truth: f64, scale: f64) {
        self.inside += usize::from((found - truth).abs() <= expanded);
        self.errors.push((found - truth) / scale);
    }

    /// Share of the intervals that contain the truth; not a number for none (1).
    pub fn share(&self) -> f64 {
        self.inside as f64 / self.errors.len() as f64
    }

    /// Mean and standard deviation of the errors.
    pub fn errors(&self) -> Moments {
        Moments::of(&self.errors)
    }
}

/// Shares of `trials` right 95 % intervals that hold the truth in 95 % of all repetitions: the
/// binomial scatter (1).
pub fn expected_coverage(trials: u32) -> [f64; 2] {
    let scatter = NORMAL_95 * (0.95 * 0.05 / f64::from(trials.max(1))).sqrt();
    [0.95 - scatter, (0.95 + scatter).min(1.0)]
}

/// A straight line through points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StraightLine {
    /// Mean abscissa and ordinate, weighted (unit).
    pub mean: (f64, f64),
    /// Slope (unit).
    pub slope: f64,
    /// Weighted sum of the squared distances of abscissae from their mean (unit).
    pub spread: f64,
    /// Weighted sum of the squared residuals (unit).
    pub residual: f64,
}

impl StraightLine {
    /// The line through `points`: abscissa, ordinate, weight. None for points of one abscissa, or
    /// of numbers that are not finite.
    pub fn through(points: &[(f64, f64, f64)]) -> Option<Self> {
        let sum = |of: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
        let weight = sum(&|p| p.2);
        let (x, y) = (sum(&|p| p.2 * p.0) / weight, sum(&|p| p.2 * p.1) / weight);
        let spread = sum(&|p| p.2 * (p.0 - x).powi(2));
        let slope = sum(&|p| p.2 * (p.0 - x) * (p.1 - y)) / spread;
        let residual = sum(&|p| p.2 * (p.1 - y - slope * (p.0 - x)).powi(2));
        let is_line = spread > 0.0 && slope.is_finite() && residual.is_finite();
        is_line.then_some(Self { mean: (x, y), slope, spread, residual })
    }

    /// The slope's standard uncertainty from the scatter of `count` points of weight one about the
    /// line (unit).
    pub fn slope_u(&self, count: usize) -> f64 {
        (self.residual / (count as f64 - 2.0) / self.spread).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand, and the quantiles of R's default on 1, 2, 3, 4.
    #[test]
    fn moments_quantiles_and_lines_by_hand() {
        let found = Moments::of(&[2.0, 4.0, 6.0, 5.0]);
        assert_eq!((found.count, found.mean), (4, 4.25));
        assert!((found.deviation - (8.75f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((found.mean_u() - 0.5 * found.deviation).abs() < 1e-15);
        assert!(Moments::of(&[1.0]).deviation.is_nan());
        let four = [1.0, 2.0, 3.0, 4.0];
        for (share, value) in [(0.0, 1.0), (0.025, 1.075), (0.5, 2.5), (0.9, 3.7), (1.0, 4.0)] {
            assert!((quantile(&four, share) - value).abs() < 1e-12, "{share}");
        }
        assert_eq!((median(vec![3.0, 1.0, 2.0]), median(vec![4.0, 1.0])), (2.0, 2.5));
        let line = StraightLine::through(&[(1.0, 2.0, 1.0), (2.0, 4.0, 1.0), (3.0, 6.0, 1.0)]);
        assert!((line.expect("a line").slope - 2.0).abs() < 1e-15);
        for no_line in [&[][..], &[(1.0, 2.0, 1.0)], &[(1.0, 2.0, 1.0), (1.0, 3.0, 1.0)]] {
            assert_eq!(StraightLine::through(no_line), None);
        }
        let unweighted = [(1.0, 2.0, 0.0), (2.0, 3.0, 0.0)];
        assert_eq!(StraightLine::through(&unweighted), None);
    }
}
