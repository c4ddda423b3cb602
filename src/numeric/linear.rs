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

/// The lower triangle, with pivots no smaller than `least`.
fn factor(matrix: &[Vec<f64>], least: f64) -> Result<Vec<Vec<f64>>, Undetermined> {
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
    Ok(lower)
}

/// Forward, then backward substitution.
fn substitute(lower: &[Vec<f64>], right: &[f64]) -> Vec<f64> {
    let mut x: Vec<f64> = Vec::with_capacity(right.len());
    for (row, b) in lower.iter().zip(right) {
        let known: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
        x.push((b - known) / row[x.len()]);
    }
    for i in (0..x.len()).rev() {
        let known: f64 = (i + 1..x.len()).map(|k| lower[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / lower[i][i];
    }
    x
}

/// `x` with `matrix x = right`.
///
/// # Errors
/// [`Undetermined`] for a matrix that is not positive.
pub fn solve(matrix: &[Vec<f64>], right: &[f64]) -> Result<Vec<f64>, Undetermined> {
    Ok(substitute(&factor(matrix, 0.0)?, right))
}

/// Inverse of `matrix`.
///
/// # Errors
/// [`Undetermined`] for a matrix that is not positive.
pub fn inverse(matrix: &[Vec<f64>]) -> Result<Vec<Vec<f64>>, Undetermined> {
    Ok(inverted(&factor(matrix, 0.0)?))
}

fn inverted(lower: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let unit = |i: usize| (0..lower.len()).map(move |j| if i == j { 1.0 } else { 0.0 });
    (0..lower.len()).map(|i| substitute(lower, &unit(i).collect::<Vec<f64>>())).collect()
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
    let mut inverse = inverted(&factor(&gram, SMALLEST_PIVOT)?);
    for (row, of_i) in inverse.iter_mut().zip(&length) {
        row.iter_mut().zip(&length).for_each(|(x, of_j)| *x /= of_i * of_j);
    }
    Ok(inverse)
}
