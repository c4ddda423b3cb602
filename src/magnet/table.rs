//! A measured force over distance, interpolated by a monotone piecewise cubic (no overshoot).
//!
//! Between two points `y = h00 y0 + h10 w m0 + h01 y1 + h11 w m1`, Hermite's cubic over the width
//! `w`, with slopes `m` that are zero at local extremes of the data, otherwise the weighted
//! harmonic mean of the adjacent secant slopes: the curve is monotone between points. Source: F. N.
//! Fritsch, J. Butland, SIAM J. Sci. Stat. Comput. 5, 300 (1984); ends: one-sided parabola,
//! limited. Valid between the outermost points: `force` and `slope` return none outside,
//! `held_force` and `integral` continue with the end value. Forces keep the sign of the data; the
//! magnet's tables count attraction as positive.

/// Errors of a force table.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Too few points.
    #[error("found {points} points, expected at least 2")]
    TooFew {
        /// How many there are.
        points: usize,
    },
    /// Distances that are not strictly increasing.
    #[error("distances must increase: {next:e} m follows {before:e} m")]
    Order {
        /// One distance (m).
        before: f64,
        /// The next (m).
        next: f64,
    },
}

/// Measured forces by distance.
#[derive(Debug, Clone, PartialEq)]
pub struct ForceTable {
    distances: Vec<f64>,
    forces: Vec<f64>,
    slopes: Vec<f64>,
}

impl ForceTable {
    /// A table of points (distance in m, force in N).
    ///
    /// # Errors
    /// [`TableError`] for fewer than two points and distances that do not rise.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, TableError> {
        if points.len() < 2 {
            return Err(TableError::TooFew { points: points.len() });
        }
        for pair in points.windows(2) {
            let (before, next) = (pair[0].0, pair[1].0);
            if next.partial_cmp(&before) != Some(std::cmp::Ordering::Greater) {
                return Err(TableError::Order { before, next });
            }
        }
        let (distances, forces) = points.iter().copied().unzip();
        Ok(Self { distances, forces, slopes: slopes(points) })
    }

    /// First and last distance (m).
    pub fn span(&self) -> [f64; 2] {
        let of = |value: Option<&f64>| value.copied().unwrap_or(0.0);
        [of(self.distances.first()), of(self.distances.last())]
    }

    /// The force at `distance` (m), none beyond the table (N).
    pub fn force(&self, distance: f64) -> Option<f64> {
        let [first, last] = self.span();
        (first..=last).contains(&distance).then(|| self.held_force(distance))
    }

    /// The force at `distance` (m), beyond the table that of its end (N).
    pub fn held_force(&self, distance: f64) -> f64 {
        let Piece { x, width, ends: [y0, y1], slopes: [m0, m1] } = self.piece(distance);
        let t = ((distance - x) / width).clamp(0.0, 1.0);
        let (s, t2) = (1.0 - t, t * t);
        let s2 = s * s;
        y0 * (1.0 + 2.0 * t) * s2
            + width * m0 * t * s2
            + y1 * t2 * (3.0 - 2.0 * t)
            + width * m1 * t2 * (t - 1.0)
    }

    /// Derivative of the force with respect to distance, none outside the table (N/m).
    pub fn slope(&self, distance: f64) -> Option<f64> {
        let [first, last] = self.span();
        if !(first..=last).contains(&distance) {
            return None;
        }
        let Piece { x, width, ends: [y0, y1], slopes: [m0, m1] } = self.piece(distance);
        let t = (distance - x) / width;
        let s = 1.0 - t;
        Some(6.0 * t * s * (y1 - y0) / width + s * (1.0 - 3.0 * t) * m0 - t * (2.0 - 3.0 * t) * m1)
    }

    /// Integral of the force from the table's first distance to `distance` (m), beyond the table
    /// with the force of its end (J).
    pub fn integral(&self, distance: f64) -> f64 {
        let whole = |i: usize| {
            let place = self.distances.get(i).copied().unwrap_or(0.0);
            self.piece(place).integral(1.0)
        };
        let [first, last] = self.span();
        let inside = distance.clamp(first, last);
        let upper = self.upper(inside);
        let before: f64 = (0..upper - 1).map(whole).sum();
        let piece = self.piece(inside);
        let beyond = distance - inside;
        before
            + piece.integral((inside - piece.x) / piece.width)
            + beyond * self.held_force(distance)
    }

    /// Index of the point at the upper end of the piece around `distance`.
    fn upper(&self, distance: f64) -> usize {
        let after = self.distances.partition_point(|d| *d <= distance);
        after.clamp(1, self.distances.len().max(2) - 1)
    }

    fn piece(&self, distance: f64) -> Piece {
        let upper = self.upper(distance);
        let at = |values: &[f64], i: usize| values.get(i).copied().unwrap_or(0.0);
        let both = |values: &[f64]| [at(values, upper - 1), at(values, upper)];
        let [x, end] = both(&self.distances);
        Piece { x, width: end - x, ends: both(&self.forces), slopes: both(&self.slopes) }
    }
}

/// Hermite's cubic between two points.
struct Piece {
    x: f64,
    width: f64,
    ends: [f64; 2],
    slopes: [f64; 2],
}

impl Piece {
    /// Integral over the first part `t` of it.
    fn integral(&self, t: f64) -> f64 {
        let Self { width, ends: [y0, y1], slopes: [m0, m1], .. } = self;
        let (t2, t3) = (t * t, t * t * t);
        let of_ends = y0 * (t - t3 + 0.5 * t2 * t2) + y1 * (t3 - 0.5 * t2 * t2);
        let first = t2 * (0.5 - t * (2.0 / 3.0 - 0.25 * t));
        let second = t3 * (0.25 * t - 1.0 / 3.0);
        width * (of_ends + width * (m0 * first + m1 * second))
    }
}

/// Slopes at the points that keep the curve between them.
fn slopes(points: &[(f64, f64)]) -> Vec<f64> {
    let secants: Vec<(f64, f64)> = points
        .windows(2)
        .map(|pair| (pair[1].0 - pair[0].0, (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0)))
        .collect();
    let inner = secants.windows(2).map(|pair| {
        let ((w0, s0), (w1, s1)) = (pair[0], pair[1]);
        if s0 * s1 <= 0.0 {
            return 0.0;
        }
        let (a, b) = (2.0 * w1 + w0, w1 + 2.0 * w0);
        (a + b) / (a / s0 + b / s1)
    });
    let reversed: Vec<(f64, f64)> = secants.iter().rev().copied().collect();
    std::iter::once(end_slope(&secants)).chain(inner).chain([end_slope(&reversed)]).collect()
}

/// Slope at the first point of `secants`: derivative of the parabola through three points, limited
/// to the sign of the first secant and, where the secants change sign, to three times its value.
fn end_slope(secants: &[(f64, f64)]) -> f64 {
    let Some((w0, s0)) = secants.first() else { return 0.0 };
    let Some((w1, s1)) = secants.get(1) else { return *s0 };
    let slope = ((2.0 * w0 + w1) * s0 - w0 * s1) / (w0 + w1);
    if slope * s0 <= 0.0 {
        0.0
    } else if s0 * s1 <= 0.0 && slope.abs() > 3.0 * s0.abs() {
        3.0 * s0
    } else {
        slope
    }
}
