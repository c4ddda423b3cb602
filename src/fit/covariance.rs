//! Covariance of fitted parameters where errors of samples go together.
//!
//! The fit weighs samples as if their errors were white; they are not on quiet scopes, and where
//! drift, hum or 1/f noise were predicted from the samples before the pulse. With
//! residuals' derivatives `J`, `G = (J^T J)^-1` and the errors' own covariance `W`:
//! `C = G J^T W J G`. `W` is white, scaled by the residual variance, but for the harmonics of
//! [`crate::analysis::rounding`] and the modes of [`crate::analysis::disturbance`]. Source: the
//! sandwich formula, e.g. W. H. Greene, "Econometric Analysis", 8th ed. (2018), Eq. 9-8.

use super::records::{ChannelRecord, Records};
use crate::analysis::least_squares::Minimum;
use crate::numeric::linear::Undetermined;

/// The covariance at `minimum`, where the records show `shown` (V) (1).
///
/// # Errors
/// [`Undetermined`] with the parameter that the data do not determine beside the others.
pub fn of(
    minimum: &Minimum,
    records: &Records,
    shown: &[Vec<f64>],
) -> Result<Vec<Vec<f64>>, Undetermined> {
    let inverse = minimum.inverse()?;
    let parameters = minimum.x.len();
    let mut middle = vec![vec![0.0; parameters]; parameters];
    let mut add = |vector: &[f64], variance: f64| {
        for (row, a) in middle.iter_mut().zip(vector) {
            row.iter_mut().zip(vector).for_each(|(sum, b)| *sum += variance * a * b);
        }
    };
    let count = records.axis.count;
    let row = |index: usize| -> Vec<f64> {
        minimum.columns.iter().map(|column| column.get(index).copied().unwrap_or(0.0)).collect()
    };
    for (channel, (record, shown)) in records.list.iter().zip(shown).enumerate() {
        let first = channel * count;
        let together = record.rounding.common() / (record.sigma * record.sigma);
        let white = minimum.variance() * (1.0 - together).max(0.0);
        (first..first + count).for_each(|index| add(&row(index), white));
        for mode in &record.modes {
            let of = |column: &Vec<f64>| -> f64 {
                column.iter().skip(first).zip(mode).map(|(derivative, m)| derivative * m).sum()
            };
            let part: Vec<f64> = minimum.columns.iter().map(of).collect();
            add(&part, 1.0 / (record.sigma * record.sigma));
        }
        for (harmonic, variance) in record.rounding.harmonics() {
            for part in along(minimum, record, (first, shown), harmonic) {
                add(&part, variance / (record.sigma * record.sigma));
            }
        }
    }
    // What is known of the gains is known apart from the samples.
    let priors = records.list.len() * count;
    (priors..minimum.residuals.len()).for_each(|index| add(&row(index), 1.0));
    let times = |a: &[Vec<f64>], b: &[Vec<f64>]| -> Vec<Vec<f64>> {
        let cell = |row: &Vec<f64>, j: usize| row.iter().zip(b).map(|(x, of)| x * of[j]).sum();
        a.iter().map(|row| (0..parameters).map(|j| cell(row, j)).collect()).collect()
    };
    Ok(times(&times(&inverse, &middle), &inverse))
}

/// `J^T` times the cosine and the sine of a harmonic of the rounding error along one channel.
fn along(
    minimum: &Minimum,
    record: &ChannelRecord,
    (first, shown): (usize, &[f64]),
    harmonic: f64,
) -> [Vec<f64>; 2] {
    let waves: Vec<(f64, f64)> = shown
        .iter()
        .map(|volts| (std::f64::consts::TAU * harmonic * volts / record.level).sin_cos())
        .collect();
    let sum = |column: &Vec<f64>, of: fn(&(f64, f64)) -> f64| -> f64 {
        column.iter().skip(first).zip(&waves).map(|(derivative, wave)| derivative * of(wave)).sum()
    };
    [|wave: &(f64, f64)| wave.1, |wave: &(f64, f64)| wave.0]
        .map(|of: fn(&(f64, f64)) -> f64| minimum.columns.iter().map(|c| sum(c, of)).collect())
}
