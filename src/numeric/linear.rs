//! Small systems of linear equations with a symmetric, positive matrix: Cholesky's factorisation.
//!
//! `A = L L^T`. Source: G. H. Golub, C. F. Van Loan, "Matrix Computations", 4th ed. (2013), section
//! 4.2.3. Valid for a handful of unknowns.

/// A pivot of a matrix with a diagonal of ones is the share of a column that the columns before it
/// do not explain; below this there is nothing left of it but errors of the differences it was made
/// from (1).
const SMALLEST_PIVOT: f64 = 1e-9;

/// Data do not determine a parameter beside those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("parameter {parameter} (from 0) is linearly dependent on the others: fix it, or add data")]
pub struct Undetermined {
    /// Its place, from 0.
    pub parameter: usize,
}

/// Cholesky's factor `L` of a symmetric, positive matrix `L L^T`.
#[derive(Debug, Clone, PartialEq)]
pub struct Cholesky {
    lower: Vec<Vec<f64>>,
}

impl Cholesky {
    /// Factors `matrix`.
    ///
    /// # Errors
    /// [`Undetermined`] for a matrix that is not positive.
    pub fn of(matrix: &[Vec<f64>]) -> Result<Self, Undetermined> {
        Self::above(matrix, 0.0)
    }

    /// The same with pivots above `least`.
    fn above(matrix: &[Vec<f64>], least: f64) -> Result<Self, Undetermined> {
        let mut lower: Vec<Vec<f64>> = Vec::with_capacity(matrix.len());
        for (i, row) in matrix.iter().enumerate() {
            let mut new = Vec::with_capacity(i + 1);
            for (j, before) in lower.iter().enumerate() {
                let known: f64 = before[..j].iter().zip(&new).map(|(a, b)| a * b).sum();
                new.push((row[j] - known) / before[j]);
            }
            let pivot = row[i] - new.iter().map(|a| a * a).sum::<f64>();
            // A pivot that is not a number is no larger, either.
            if pivot.is_nan() || pivot <= least {
                return Err(Undetermined { parameter: i });
            }
            new.push(pivot.sqrt());
            lower.push(new);
        }
        Ok(Self { lower })
    }

    /// `L^-1 right`: white, of variance one, if `right` has the matrix as its covariance (1).
    pub fn whiten(&self, right: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = Vec::with_capacity(right.len());
        for (row, b) in self.lower.iter().zip(right) {
            let known: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
            x.push((b - known) / row[x.len()]);
        }
        x
    }

    /// `x` with `L L^T x = right`, by forward, then backward substitution (unit).
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.whiten(right);
        for i in (0..x.len()).rev() {
            let known: f64 = (i + 1..x.len()).map(|k| self.lower[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / self.lower[i][i];
        }
        x
    }

    /// Inverse of the matrix (unit).
    pub fn inverse(&self) -> Vec<Vec<f64>> {
        let size = self.lower.len();
        let unit = |i: usize| (0..size).map(move |j| if i == j { 1.0 } else { 0.0 });
        (0..size).map(|i| self.solve(&unit(i).collect::<Vec<f64>>())).collect()
    }

    /// Natural logarithm of the matrix's determinant (1).
    pub fn log_determinant(&self) -> f64 {
        2.0 * self.lower.iter().filter_map(|row| row.last()).map(|pivot| pivot.ln()).sum::<f64>()
    }
}

/// `x` with `matrix x = right`.
///
/// # Errors
/// [`Undetermined`] for a matrix that is not positive.
pub fn solve(matrix: &[Vec<f64>], right: &[f64]) -> Result<Vec<f64>, Undetermined> {
    Ok(Cholesky::of(matrix)?.solve(right))
}

/// Inverse of `matrix`.
///
/// # Errors
/// [`Undetermined`] for a matrix that is not positive.
pub fn inverse(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Undetermined> {
    Ok(Cholesky::of(matrix)?.inverse())
}

/// Inverse of the matrix of all products of `columns`, each brought to length one in between.
///
/// # Errors
/// [`Undetermined`] with the first column that those before it explain, or that is nothing.
pub fn inverse_of_gram(columns: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Undetermined> {
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let length: Vec<f64> = columns.iter().map(|column| product(column, column).sqrt()).collect();
    if let Some(parameter) = length.iter().position(|length| length.is_nan() || *length <= 0.0) {
        return Err(Undetermined { parameter });
    }
    let row = |(a, of_a): (&Vec<f64>, &f64)| {
        columns.iter().zip(&length).map(|(b, of_b)| product(a, b) / (of_a * of_b)).collect()
    };
    let gram: Vec<Vec<f64>> = columns.iter().zip(&length).map(row).collect();
    let mut inverse = Cholesky::above(&gram, SMALLEST_PIVOT)?.inverse();
    for (row, of_i) in inverse.iter_mut().zip(&length) {
        row.iter_mut().zip(&length).for_each(|(x, of_j)| *x /= of_i * of_j);
    }
    Ok(inverse)
}
