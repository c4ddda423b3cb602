//! What an implicit method needs to know about a chain: its tangent, which couples neighbours only.

use super::State;

/// A symmetric tridiagonal matrix.
#[derive(Debug, Clone, Default)]
pub struct Tridiagonal {
    /// Entries on the diagonal (unit).
    pub diagonal: Vec<f64>,
    /// Entries beside it (unit).
    pub off_diagonal: Vec<f64>,
}

impl Tridiagonal {
    /// A matrix of `n` rows, all zero.
    pub fn new(n: usize) -> Self {
        Self { diagonal: vec![0.0; n], off_diagonal: vec![0.0; n.saturating_sub(1)] }
    }

    /// Replaces the matrix by its factors `L D L^T`. Stable without pivoting: chains that repel
    /// make it positive definite.
    pub fn factorise(&mut self) {
        for i in 1..self.diagonal.len() {
            let beside = self.off_diagonal[i - 1];
            let factor = beside / self.diagonal[i - 1];
            self.diagonal[i] -= factor * beside;
            self.off_diagonal[i - 1] = factor;
        }
    }

    /// Replaces `values` by the solution for them as right-hand side. Source: L. H. Thomas, Watson
    /// Sci. Comput. Lab. report (1949).
    pub fn solve(&self, values: &mut [f64]) {
        let n = self.diagonal.len();
        for i in 1..n {
            values[i] -= self.off_diagonal[i - 1] * values[i - 1];
        }
        for (value, pivot) in values.iter_mut().zip(&self.diagonal) {
            *value /= pivot;
        }
        for i in (1..n).rev() {
            values[i - 1] -= self.off_diagonal[i - 1] * values[i];
        }
    }
}

/// A system whose tangent is a chain's: `M a = F(x, v)`, and behind the bodies accounts whose rates
/// follow from the bodies' motion alone.
pub trait Linearised {
    /// Number of bodies; accounts stand behind them.
    fn bodies(&self) -> usize;

    /// Takes the tangent at `state`.
    fn linearise(&mut self, state: &State);

    /// Writes `shift^2 M + shift C + K`, `-C` and `-K` the tangents of the forces against
    /// velocities and positions.
    fn assemble(&mut self, shift: f64, matrix: &mut Tridiagonal);

    /// Masses of the bodies (kg).
    fn masses(&self) -> &[f64];

    /// Writes the forces `-K x` of small displacements `position` (m) (N).
    fn forces_of(&mut self, position: &[f64], out: &mut [f64]);

    /// Writes the changes of the accounts' rates under small changes of positions (m) and
    /// velocities (m/s).
    fn account_rates(&mut self, position: &[f64], velocity: &[f64], out: &mut [f64]);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_solve_what_was_multiplied() {
        let mut matrix =
            Tridiagonal { diagonal: vec![4.0, 5.0, 6.0, 3.0], off_diagonal: vec![-1.0, 2.0, -2.5] };
        let x = [1.0, -2.0, 0.5, 3.0];
        let row = |i: usize| {
            let beside = |j: usize, k: usize| matrix.off_diagonal[j] * x[k];
            let left = if i > 0 { beside(i - 1, i - 1) } else { 0.0 };
            let right = if i < 3 { beside(i, i + 1) } else { 0.0 };
            left + matrix.diagonal[i] * x[i] + right
        };
        let mut values: Vec<f64> = (0..4).map(row).collect();
        matrix.factorise();
        matrix.solve(&mut values);
        for (found, exact) in values.iter().zip(x) {
            assert!((found - exact).abs() < 1e-14);
        }
    }
}
