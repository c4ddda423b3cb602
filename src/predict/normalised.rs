//! A comparison by what both sides know: the normalised error of each quantity, and which inputs
//! would have to move.
//!
//! `E_n = |m - s|/sqrt(U_m^2 + U_s^2)`, expanded uncertainties for 95 %: up to 1 both agree; `s` is
//! the middle of the prediction's interval. Peaks, delays between sensors (half-rise), and speeds
//! have one each; a trace's is the root mean square over its samples, zeros taken out, with the
//! noise of both scopes, the gain and the prediction's band. The inputs' moves are the least, in
//! their own standard uncertainties, that take the prediction to the measurement:
//! `d_i = (m - s) b_i / sum of b_j^2`, `b` the changes with one uncertainty each. Speeds on both
//! sides are delays over the scene's own distance, which is exact here: plates that are elsewhere,
//! or beads of another size, change the delay. The verdict is one test of all peaks, delays and
//! speeds ([`JointTest`]), and an `E_n` up to 1 of each trace, which benches as stated hardly ever
//! exceed: the mean over its samples hardly scatters. Sources: ISO 13528:2022, 9.6; ASME V&V
//! 20-2009.

use serde::Serialize;

use super::UncertainPrediction;
use super::joint::{JointQuantity, JointTest, OwnError};
use super::outputs::{OutputInterval, TraceBand};
use crate::analysis::comparison::Pair;
use crate::measurement::compare::{
    ChannelScore, Compared, Comparison, SpeedScore, clipped_failures,
};
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

/// Normalised errors, and the test of those of peaks, delays and speeds together.
pub type JudgedErrors = (Vec<NormalisedError>, Option<JointTest>);

/// Normalised errors of first peaks, delays, speeds and traces of `compared`, whose simulated side
/// `predicted` tells with its uncertainty, and the test of peaks, delays and speeds together.
pub fn normalised_errors(compared: &Compared, predicted: &UncertainPrediction) -> JudgedErrors {
    let comparison = &compared.comparison;
    let mut found = first_peaks(comparison, predicted);
    for speed in comparison.speeds.iter().filter(|speed| speed.estimator == "half_rise") {
        found.extend(delay(comparison, predicted, speed));
    }
    for speed in &comparison.speeds {
        found.extend(pulse_speed(comparison, predicted, speed));
    }
    let (mut errors, joint): (Vec<_>, Vec<_>) = found.into_iter().unzip();
    let traces = comparison.channels.iter().zip(&compared.pairs).zip(&compared.quiet);
    errors.extend(traces.filter_map(|((score, pair), quiet)| {
        let is_volts = score.unit == "V";
        let band = predicted.bands.iter().find(|band| is_volts && band.channel == score.against)?;
        trace_error((score, gain_u(score, predicted)), pair, (*quiet)?, band)
    }));
    (errors, JointTest::of(&joint, predicted.seed))
}

/// The same, and by them the verdict of `compared`, where there are any.
pub fn judge(compared: &mut Compared, predicted: &UncertainPrediction) -> JudgedErrors {
    let (errors, joint) = normalised_errors(compared, predicted);
    let comparison = &mut compared.comparison;
    if !errors.is_empty() {
        let limit = |error: &NormalisedError| match joint {
            Some(joint) if error.measured.is_some() => joint.limit,
            _ => 1.0,
        };
        let beyond = errors.iter().filter(|error| error.e_n > limit(error));
        let failure = |error: &NormalisedError| {
            format!("{}: E_n {}, limit {:.2}", error.quantity, error.figure(), limit(error))
        };
        comparison.failures = beyond.map(failure).collect();
        comparison.failures.extend(clipped_failures(&comparison.channels));
        comparison.tolerance = joint.iter().map(JointTest::tolerance).collect();
        comparison.notes.extend(joint.iter().map(JointTest::words));
        comparison.tolerance.push("E_n of traces up to 1".to_owned());
        comparison.verdict = if comparison.failures.is_empty() { "pass" } else { "fail" };
    }
    (errors, joint)
}

/// Relative standard uncertainty of the measuring channel's gain: where the prediction counts its
/// scope's gain, the measured reading is what it is (1).
fn gain_u(score: &ChannelScore, predicted: &UncertainPrediction) -> f64 {
    let gain = format!("gain of {}", score.against);
    if predicted.inputs.iter().any(|input| input.name == gain) { 0.0 } else { score.gain_u }
}

fn first_peaks(
    comparison: &Comparison,
    predicted: &UncertainPrediction,
) -> Vec<(NormalisedError, JointQuantity)> {
    let peak = |score: &ChannelScore| {
        let pair = score.peak_measured.zip(score.peak_simulated);
        let (measured, simulated) = pair.filter(|_| score.unit == "V")?;
        let name = format!("{} first peak, droop undone", score.against);
        let output = predicted.outputs.iter().find(|output| output.name == name)?;
        let gain = gain_u(score, predicted) * measured.value.abs();
        let half_width = 3f64.sqrt() * gain;
        let own = |side: &str, normal, half_width| OwnError {
            name: format!("{} first peak, {side}", score.name),
            normal,
            half_width,
        };
        let own = vec![own("measured", measured.u, half_width), own("simulated", simulated.u, 0.0)];
        let measured = Uncertain { u: measured.u.hypot(gain), half_width, ..measured };
        Some(error(format!("{} first peak", score.name), [measured, simulated], output, own))
    };
    comparison.channels.iter().filter_map(peak).collect()
}

fn score<'a>(comparison: &'a Comparison, name: &str) -> Option<&'a ChannelScore> {
    comparison.channels.iter().find(|score| score.name == name)
}

/// The prediction of `what` between the two channels' sensors, and what it is called here.
fn between<'a>(
    comparison: &Comparison,
    outputs: &'a [OutputInterval],
    speed: &SpeedScore,
    what: &str,
) -> Option<(String, &'a OutputInterval)> {
    let sensor = |channel: &str| score(comparison, channel)?.sensor.as_ref();
    let predicted = format!("{} -> {} {what}", sensor(&speed.from)?, sensor(&speed.to)?);
    let output = outputs.iter().find(|output| output.name == predicted)?;
    Some((format!("{} -> {} {what}", speed.from, speed.to), output))
}

/// Errors of the arrivals (half-rise) at both ends on both sides, times `scale` (unit/s).
fn arrival_errors(
    comparison: &Comparison,
    speed: &SpeedScore,
    scale: [f64; 2],
) -> Option<Vec<OwnError>> {
    let mut own = Vec::new();
    for (channel, sign) in [(&speed.from, -1.0), (&speed.to, 1.0)] {
        let score = score(comparison, channel)?;
        let us = [score.arrival_measured_s?.u, score.arrival_simulated_s?.u];
        for ((side, u), scale) in ["measured", "simulated"].iter().zip(us).zip(scale) {
            let name = format!("{channel} arrival, {side}");
            own.push(OwnError { name, normal: sign * scale * u, half_width: 0.0 });
        }
    }
    Some(own)
}

fn delay(
    comparison: &Comparison,
    predicted: &UncertainPrediction,
    speed: &SpeedScore,
) -> Option<(NormalisedError, JointQuantity)> {
    let (from, to) = (score(comparison, &speed.from)?, score(comparison, &speed.to)?);
    let delay = |arrival: fn(&ChannelScore) -> Option<Uncertain>| {
        let (from, to) = (arrival(from)?, arrival(to)?);
        Some(Uncertain::normal(to.value - from.value, from.u.hypot(to.u)))
    };
    let sides =
        [delay(|score| score.arrival_measured_s)?, delay(|score| score.arrival_simulated_s)?];
    let (name, output) = between(comparison, &predicted.outputs, speed, "delay")?;
    Some(error(name, sides, output, arrival_errors(comparison, speed, [1.0; 2])?))
}

fn pulse_speed(
    comparison: &Comparison,
    predicted: &UncertainPrediction,
    speed: &SpeedScore,
) -> Option<(NormalisedError, JointQuantity)> {
    let sides = [speed.measured_over_exact_distance, speed.simulated_m_per_s];
    let what = speed.estimator.replace('_', "-");
    let (name, output) = between(comparison, &predicted.speeds_as_measured, speed, &what)?;
    let own = if speed.estimator == "half_rise" {
        // v = d/t: a later arrival at the lower sensor makes it smaller by v/t.
        let scale = sides.map(|side| -side.value * side.value / speed.distance_m);
        arrival_errors(comparison, speed, scale)?
    } else {
        let own = ["measured", "simulated"].iter().zip(sides).map(|(side, speed)| OwnError {
            name: format!("{name}, {side}"),
            normal: speed.u,
            half_width: 0.0,
        });
        own.collect()
    };
    Some(error(name, sides, output, own))
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

/// The normalised error of a quantity between both `sides`, the measured one first, and its part in
/// the joint test.
fn error(
    quantity: String,
    [measured, simulated]: [Uncertain; 2],
    output: &OutputInterval,
    own: Vec<OwnError>,
) -> (NormalisedError, JointQuantity) {
    // The scene's part is relative to its own value: the simulated one has noise on it.
    let scale = simulated.value / output.as_run;
    let u = simulated.u.hypot(output.u * scale);
    let simulated = Uncertain { value: output.middle() * scale, u, ..simulated };
    let difference = measured.value - simulated.value;
    let expanded = measured.expanded().hypot(simulated.expanded());
    let e_n = difference.abs() / expanded;
    let less = |value: &f64| (value - output.middle()) * scale;
    let drawn = output.drawn.iter().map(|value| value.as_ref().map(less)).collect();
    let (measured, simulated) = (Some(measured), Some(simulated));
    let moves = moves(difference, output);
    (
        NormalisedError { quantity, unit: output.unit, measured, simulated, e_n, moves },
        JointQuantity { e_n, expanded, drawn, own },
    )
}

/// The least moves of the inputs that make up for `difference`.
fn moves(difference: f64, output: &OutputInterval) -> Vec<InputMove> {
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
    moves
}
