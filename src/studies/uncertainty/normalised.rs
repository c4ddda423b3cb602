//! A comparison by what both sides know: the normalised error of each quantity, and which inputs would have to move.
//!
//! `E_n = |m - s|/sqrt(U_m^2 + U_s^2)`, expanded uncertainties for 95 %: up to 1 both agree. The inputs' moves are the least, in their own standard
//! uncertainties, that take the prediction to the measurement: `d_i = (m - s) b_i / sum of b_j^2`, `b` the changes with one uncertainty each.
//! Sources: ISO 13528:2022, 9.6; ASME V&V 20-2009.

use serde::Serialize;

use super::UncertainPrediction;
use super::outputs::OutputInterval;
use crate::measurement::compare::{ChannelScore, Comparison};
use crate::quantity::Uncertain;

/// Moves smaller than this share of the largest are not listed (1).
const LISTED_SHARE: f64 = 0.1;

/// How far an input would have to move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputMove {
    /// The input.
    pub input: String,
    /// By how many of its own standard uncertainties (1).
    pub by_u: f64,
}

/// The normalised error of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NormalisedError {
    /// What is compared: `CH2 first peak`, `CH2 -> CH3 half-rise`.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// The measured value.
    pub measured: Uncertain,
    /// The simulated value, with the scene's uncertainty and the simulated scope's noise.
    pub simulated: Uncertain,
    /// `|m - s|/sqrt(U_m^2 + U_s^2)` (1).
    #[serde(rename = "E_n")]
    pub e_n: f64,
    /// Which inputs would have to move for both to be equal, the largest moves first.
    pub moves: Vec<InputMove>,
}

impl NormalisedError {
    /// Whether both sides agree within what they know.
    pub fn agrees(&self) -> bool {
        self.e_n <= 1.0
    }
}

/// Normalised errors of first peaks and speeds of `comparison`, whose simulated side `predicted` tells with its uncertainty.
pub fn normalised_errors(
    comparison: &Comparison,
    predicted: &UncertainPrediction,
) -> Vec<NormalisedError> {
    let output = |name: String| predicted.outputs.iter().find(|output| output.name == name);
    let mut errors = Vec::new();
    for score in &comparison.channels {
        let pair = score.peak_measured_v.zip(score.peak_simulated_v);
        if let (Some((measured, simulated)), Some(output)) =
            (pair, output(format!("{} first peak", score.against)))
        {
            let u = measured.u.hypot(score.gain_u * measured.value);
            let measured = Uncertain { u, ..measured };
            errors.push(error(format!("{} first peak", score.name), measured, simulated, output));
        }
    }
    let sensor = |name: &str| {
        let is = |score: &&ChannelScore| score.name == name;
        comparison.channels.iter().find(is)?.sensor.clone()
    };
    for speed in &comparison.speeds {
        let Some((from, to)) = sensor(&speed.from).zip(sensor(&speed.to)) else { continue };
        let estimator = speed.estimator.replace('_', "-");
        if let Some(output) = output(format!("{from} -> {to} {estimator}")) {
            let name = format!("{} -> {} {estimator}", speed.from, speed.to);
            errors.push(error(name, speed.measured_m_per_s, speed.simulated_m_per_s, output));
        }
    }
    errors
}

fn error(
    quantity: String,
    measured: Uncertain,
    simulated: Uncertain,
    output: &OutputInterval,
) -> NormalisedError {
    // The scene's part is relative to its own value: the simulated one has noise on it.
    let model = output.u / output.value * simulated.value;
    let simulated = Uncertain { u: simulated.u.hypot(model), ..simulated };
    let difference = measured.value - simulated.value;
    let e_n = difference.abs() / measured.expanded().hypot(simulated.expanded());
    let squares: f64 = output.inputs.iter().map(|input| input.change * input.change).sum();
    let mut moves: Vec<InputMove> = output
        .inputs
        .iter()
        .map(|part| InputMove {
            input: part.input.clone(),
            by_u: difference * part.change / squares,
        })
        .collect();
    moves.sort_by(|a, b| b.by_u.abs().total_cmp(&a.by_u.abs()));
    let least = LISTED_SHARE * moves.first().map_or(0.0, |first| first.by_u.abs());
    moves.retain(|one| one.by_u.abs() >= least && one.by_u != 0.0);
    NormalisedError { quantity, unit: output.unit, measured, simulated, e_n, moves }
}
