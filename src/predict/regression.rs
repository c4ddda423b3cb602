//! Each input's share of an output's variance, from a linear regression on the inputs' standard
//! scores.

use serde::Serialize;

use crate::numeric::linear::solve;
use crate::scene::random_inputs::RandomInput;

/// One input's part in an output.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputShare {
    /// The input.
    pub input: String,
    /// Change of the output with one standard uncertainty of the input (unit).
    pub change: f64,
    /// Its share of the output's variance (1).
    pub share: f64,
}

/// A linear regression of an output on the inputs' standard scores.
pub(super) struct Regression {
    /// The share of its variance that the regression explains (1).
    pub explained: f64,
    /// Change with each input's score (unit).
    pub slopes: Vec<f64>,
    /// Each input's share, the largest first.
    pub shares: Vec<InputShare>,
}

impl Regression {
    /// What the inputs' `scores` make of the output, less its mean (unit).
    pub(super) fn linear(&self, scores: &[f64]) -> f64 {
        self.slopes.iter().zip(scores).map(|(slope, score)| slope * score).sum()
    }
}

/// The regression; none for fewer samples than inputs, or an output that never changes.
pub(super) fn regression(samples: &[(&[f64], f64)], inputs: &[RandomInput]) -> Option<Regression> {
    let count = samples.len() as f64;
    if samples.len() < inputs.len() + 2 {
        return None;
    }
    let mean_of =
        |values: &dyn Fn(usize) -> f64| (0..samples.len()).map(values).sum::<f64>() / count;
    let middle = mean_of(&|i| samples[i].1);
    let means: Vec<f64> = (0..inputs.len()).map(|j| mean_of(&|i| samples[i].0[j])).collect();
    let variance = samples.iter().map(|(_, y)| (y - middle).powi(2)).sum::<f64>() / (count - 1.0);
    let changes = variance > 0.0;
    if !changes {
        return None;
    }
    let product = |a: &dyn Fn(usize) -> f64, b: &dyn Fn(usize) -> f64| {
        (0..samples.len()).map(|i| a(i) * b(i)).sum::<f64>() / (count - 1.0)
    };
    let centred = |j: usize| {
        let mean = means[j];
        move |i: usize| samples[i].0[j] - mean
    };
    let output = |i: usize| samples[i].1 - middle;
    let all = 0..inputs.len();
    let gram: Vec<Vec<f64>> = all
        .clone()
        .map(|j| all.clone().map(|k| product(&centred(j), &centred(k))).collect())
        .collect();
    let right: Vec<f64> = all.clone().map(|j| product(&centred(j), &output)).collect();
    let slopes = solve(&gram, &right).ok()?;
    let explained: f64 = slopes.iter().zip(&right).map(|(b, r)| b * r).sum::<f64>() / variance;
    let explained = explained.clamp(0.0, 1.0);
    // Scores have variance one but for the samples' chance, which makes them go together a little:
    // shares add up to what is explained all the same.
    let change = |j: usize| slopes[j] * gram[j][j].sqrt();
    let squares: f64 = all.map(|j| change(j).powi(2)).sum();
    let part = |(j, input): (usize, &RandomInput)| {
        let (input, change) = (input.name.clone(), change(j));
        InputShare { input, change, share: explained * change * change / squares }
    };
    let mut parts: Vec<InputShare> = inputs.iter().enumerate().map(part).collect();
    parts.sort_by(|a, b| b.share.total_cmp(&a.share));
    Some(Regression { explained, slopes, shares: parts })
}
