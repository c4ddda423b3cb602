//! Medians, quantiles, and straight lines by weighted least squares.
//!
//! The line `y = <y> + b (x - <x>)` has `b = sum w (x - <x>)(y - <y>) / sum w (x - <x>)^2`, means
//! weighted with `w`. Source: W. H. Press et al., Numerical Recipes (2007), section 15.2.

/// The median; zero of no values (unit).
pub fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.get(middle.wrapping_sub(1)), values.get(middle)) {
        (Some(below), Some(above)) if values.len().is_multiple_of(2) => 0.5 * (below + above),
        (_, Some(value)) => *value,
        _ => 0.0,
    }
}

/// The quantile of sorted values, on a straight line between two (unit).
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let place = share * sorted.len().saturating_sub(1) as f64;
    let index = place.floor() as usize;
    let at = |index: usize| sorted.get(index).copied();
    let (low, high) = (at(index), at(index + 1));
    match (low, high) {
        (Some(low), Some(high)) => low + (place - place.floor()) * (high - low),
        (Some(low), None) => low,
        _ => f64::NAN,
    }
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
    /// The line through `points`: abscissa, ordinate, weight.
    pub fn through(points: &[(f64, f64, f64)]) -> Self {
        let sum = |of: &dyn Fn(&(f64, f64, f64)) -> f64| points.iter().map(of).sum::<f64>();
        let weight = sum(&|p| p.2);
        let (x, y) = (sum(&|p| p.2 * p.0) / weight, sum(&|p| p.2 * p.1) / weight);
        let spread = sum(&|p| p.2 * (p.0 - x).powi(2));
        let slope = sum(&|p| p.2 * (p.0 - x) * (p.1 - y)) / spread;
        let residual = sum(&|p| p.2 * (p.1 - y - slope * (p.0 - x)).powi(2));
        Self { mean: (x, y), slope, spread, residual }
    }

    /// The slope's standard uncertainty from the scatter of `count` points of weight one about the
    /// line (unit).
    pub fn slope_u(&self, count: usize) -> f64 {
        (self.residual / (count as f64 - 2.0) / self.spread).sqrt()
    }
}
