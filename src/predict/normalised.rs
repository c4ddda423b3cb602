//! A comparison by what both sides know: the normalised error of each quantity, and which inputs
//! would have to move.
//!
//! `E_n = |m - s|/sqrt(U_m^2 + U_s^2)`, expanded uncertainties for 95 %: up to 1 both agree; `s` is
//! the middle of the prediction's interval. Peaks, delays between sensors (half-rise), and speeds
//! have one each; a trace's is the root mean square over its samples, zeros taken out, with the
//! noise of both scopes, the gain and the prediction's band. The inputs' moves are the least, in
//! their own standard uncertainties, that take the prediction to the measurement:
//! `d_i = (m - s) b_i / sum of b_j^2`, `b` the changes with one uncertainty each. Speeds on both
//! sides are delays over the scene's own distance: plates that are elsewhere change the delay.
//! Sources: ISO 13528:2022, 9.6; ASME V&V 20-2009.

use serde::Serialize;

use super::UncertainPrediction;
use super::outputs::{OutputInterval, TraceBand};
use crate::analysis::comparison::Pair;
use crate::measurement::compare::{ChannelScore, Compared, SpeedScore, clipped_failures};
use crate::numeric::intervals::expanded_95;
use crate::quantity::Uncertain;

/// Moves smaller than this share of the largest are not listed (1).
const LISTED_SHARE: f64 = 0.1;

/// How far an input would have to move.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct InputMove {
    /// The input.
    pub input: String,
    /// By how many of its own standard uncertainties, with the others (1).
    pub by_u: f64,
    /// The same if it moved alone (1).
    pub alone_by_u: f64,
}

/// The normalised error of one quantity.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NormalisedError {
    /// What is compared: `CH2 first peak`, `CH2 -> CH3 delay`, `CH2 -> CH3 half-rise`, `CH2 trace`.
    pub quantity: String,
    /// Its unit.
    pub unit: &'static str,
    /// The measured value; none for a trace.
    pub measured: Option<Uncertain>,
    /// The middle of the simulated value's interval, with the scene's uncertainty and the simulated
    /// scope's noise; none for a trace.
    pub simulated: Option<Uncertain>,
    /// `|m - s|/sqrt(U_m^2 + U_s^2)` (1).
    #[serde(rename = "E_n")]
    pub e_n: f64,
    /// Which inputs would have to move for both to be equal, the largest moves first.
    pub moves: Vec<InputMove>,
}

impl NormalisedError {
    /// `E_n` to two decimals, or as many as show that it is above 1.
    pub fn figure(&self) -> String {
        let text = format!("{:.2}", self.e_n);
        if self.agrees() || text != "1.00" { text } else { format!("{:.4}", self.e_n) }
    }

    /// Whether both sides agree within what they know.
    pub fn agrees(&self) -> bool {
        self.e_n <= 1.0
    }
}

/// Normalised errors of first peaks, delays, speeds and traces of `compared`, whose simulated side
/// `predicted` tells with its uncertainty.
pub fn normalised_errors(
    compared: &Compared,
    predicted: &UncertainPrediction,
) -> Vec<NormalisedError> {
    let comparison = &compared.comparison;
    let output = |name: String| predicted.outputs.iter().find(|output| output.name == name);
    // Both sides tell readings: where the prediction counts its scope's gain, the measured reading
    // is what it is.
    let gain_u = |score: &ChannelScore| {
        let gain = format!("gain of {}", score.against);
        if predicted.inputs.iter().any(|input| input.name == gain) { 0.0 } else { score.gain_u }
    };
    let mut errors = Vec::new();
    for score in &comparison.channels {
        let pair = score.peak_measured.zip(score.peak_simulated).filter(|_| score.unit == "V");
        if let (Some((measured, simulated)), Some(output)) =
            (pair, output(format!("{} first peak, droop undone", score.against)))
        {
            let gain = gain_u(score) * measured.value.abs();
            let (u, half_width) = (measured.u.hypot(gain), 3f64.sqrt() * gain);
            let measured = Uncertain { u, half_width, ..measured };
            errors.push(error(format!("{} first peak", score.name), measured, simulated, output));
        }
    }
    let score = |name: &str| comparison.channels.iter().find(|score| score.name == name);
    let between = |outputs: &[OutputInterval], speed: &SpeedScore, what: &str| {
        let (from, to) = (score(&speed.from)?.sensor.as_ref()?, score(&speed.to)?.sensor.as_ref()?);
        let name = format!("{} -> {} {what}", speed.from, speed.to);
        let simulated = format!("{from} -> {to} {what}");
        Some((name, outputs.iter().find(|output| output.name == simulated)?.clone()))
    };
    for speed in comparison.speeds.iter().filter(|speed| speed.estimator == "half_rise") {
        let delay = |arrival: fn(&ChannelScore) -> Option<Uncertain>| {
            let (from, to) = (arrival(score(&speed.from)?)?, arrival(score(&speed.to)?)?);
            Some(Uncertain::normal(to.value - from.value, from.u.hypot(to.u)))
        };
        let sides = delay(|score| score.arrival_measured_s)
            .zip(delay(|score| score.arrival_simulated_s))
            .zip(between(&predicted.outputs, speed, "delay"));
        errors.extend(sides.map(|((m, s), (name, output))| error(name, m, s, &output)));
    }
    for speed in &comparison.speeds {
        let outputs = &predicted.speeds_as_measured;
        if let Some((name, output)) = between(outputs, speed, &speed.estimator.replace('_', "-")) {
            errors.push(error(name, speed.measured_m_per_s, speed.simulated_m_per_s, &output));
        }
    }
    let traces = comparison.channels.iter().zip(&compared.pairs).zip(&compared.quiet);
    errors.extend(traces.filter_map(|((score, pair), quiet)| {
        let is_volts = score.unit == "V";
        let band = predicted.bands.iter().find(|band| is_volts && band.channel == score.against)?;
        trace_error((score, gain_u(score)), pair, (*quiet)?, band)
    }));
    errors
}

/// The same, and by them the verdict of `compared`, where there are any.
pub fn judge(compared: &mut Compared, predicted: &UncertainPrediction) -> Vec<NormalisedError> {
    let errors = normalised_errors(compared, predicted);
    let comparison = &mut compared.comparison;
    if !errors.is_empty() {
        let beyond = errors.iter().filter(|error| !error.agrees());
        let failures = beyond.map(|error| format!("{}: E_n {}", error.quantity, error.figure()));
        comparison.failures = failures.collect();
        comparison.failures.extend(clipped_failures(&comparison.channels));
        comparison.tolerance = vec!["E_n of peaks, delays, speeds and traces up to 1".to_owned()];
        comparison.verdict = if comparison.failures.is_empty() { "pass" } else { "fail" };
    }
    errors
}

/// Root mean square over the samples of their normalised errors; none for a band without width
/// of them.
fn trace_error(
    (score, gain_u): (&ChannelScore, f64),
    pair: &Pair,
    [measured, simulated]: [Uncertain; 2],
    band: &TraceBand,
) -> Option<NormalisedError> {
    let half_width = |time: f64| {
        let place = (time - score.shift_s - band.start_s) / band.interval_s;
        let index = place.round().max(0.0) as usize;
        Some(0.5 * (band.high_v.get(index)? - band.low_v.get(index)?))
    };
    let noise = measured.expanded().hypot(simulated.expanded());
    let (mut squares, mut count) = (0.0, 0.0);
    for (index, (m, s)) in pair.measured.values.iter().zip(&pair.simulated.values).enumerate() {
        let Some(model) = half_width(pair.measured.time(index)) else { continue };
        let volts = m - measured.value;
        let gain = expanded_95(gain_u * volts.abs(), 3f64.sqrt() * gain_u * volts.abs());
        let expanded = noise.hypot(gain).hypot(model);
        squares += ((volts - (s - simulated.value)) / expanded).powi(2);
        count += 1.0;
    }
    let e_n = (squares / count).sqrt();
    let quantity = format!("{} trace", score.name);
    let (measured, simulated, moves) = (None, None, Vec::new());
    e_n.is_finite().then_some(NormalisedError {
        quantity,
        unit: "V",
        measured,
        simulated,
        e_n,
        moves,
    })
}

fn error(
    quantity: String,
    measured: Uncertain,
    simulated: Uncertain,
    output: &OutputInterval,
) -> NormalisedError {
    // The scene's part is relative to its own value: the simulated one has noise on it.
    let scale = simulated.value / output.as_run;
    let u = simulated.u.hypot(output.u * scale);
    let simulated = Uncertain { value: output.middle() * scale, u, ..simulated };
    let difference = measured.value - simulated.value;
    let e_n = difference.abs() / measured.expanded().hypot(simulated.expanded());
    let squares: f64 = output.inputs.iter().map(|input| input.change * input.change).sum();
    let mut moves: Vec<InputMove> = output
        .inputs
        .iter()
        .map(|part| InputMove {
            input: part.input.clone(),
            by_u: difference * part.change / squares,
            alone_by_u: difference / part.change,
        })
        .collect();
    moves.sort_by(|a, b| b.by_u.abs().total_cmp(&a.by_u.abs()));
    let least = LISTED_SHARE * moves.first().map_or(0.0, |first| first.by_u.abs());
    moves.retain(|one| one.by_u.abs() >= least && one.by_u != 0.0);
    let (measured, simulated) = (Some(measured), Some(simulated));
    NormalisedError { quantity, unit: output.unit, measured, simulated, e_n, moves }
}
