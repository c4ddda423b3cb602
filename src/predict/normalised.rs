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
//!
//! Beside these, one test of all peaks and delays together at a level of 5 %:
//! `chi^2 = r^T C^-1 r` of the differences `r`. Their covariance `C` is that of the drawn benches
//! and of both sides' noise, where delays that share an arrival go together. The level is exact
//! where the benches' outputs are normal. Sources: ISO 13528:2022, 9.6; ASME V&V 20-2009; R. A.
//! Johnson, D. W. Wichern, "Applied Multivariate Statistical Analysis", 6th ed. (2007), section
//! 4.2, for chi squared.

use serde::Serialize;

use super::UncertainPrediction;
use super::outputs::{OutputInterval, TraceBand};
use crate::analysis::comparison::Pair;
use crate::measurement::compare::{ChannelScore, Compared, SpeedScore, clipped_failures};
use crate::numeric::intervals::{chi_squared_beyond, expanded_95};
use crate::numeric::linear::Cholesky;
use crate::quantity::Uncertain;

/// The joint test rejects benches that are as stated in this share of cases (1).
const LEVEL: f64 = 0.05;
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
    /// What the joint test needs of it; none for speeds and traces.
    #[serde(skip)]
    joint: Option<JointPart>,
}

/// A quantity in the joint test.
#[derive(Debug, Clone, PartialEq)]
struct JointPart {
    /// Independent errors of both records, by name: change of the difference with one standard
    /// uncertainty each (unit).
    own: Vec<(String, f64)>,
    /// The prediction, and what takes its values to those that are compared (1).
    output: OutputInterval,
    scale: f64,
}

impl JointPart {
    fn covariance(&self, other: &Self) -> f64 {
        let shared = |(name, change): &(String, f64)| {
            let same = other.own.iter().find(|(own, _)| own == name);
            same.map_or(0.0, |(_, other)| change * other)
        };
        let own: f64 = self.own.iter().map(shared).sum();
        own + self.scale * other.scale * self.output.covariance(&other.output)
    }
}

/// One statement on all peaks and delays together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointTest {
    /// Chi squared (1).
    pub chi_squared: f64,
    /// Number of quantities.
    pub quantities: usize,
    /// Share of benches that are as stated whose chi squared is larger (1).
    pub probability: f64,
}

impl JointTest {
    /// Whether both sides agree within what they know.
    pub fn agrees(&self) -> bool {
        self.probability >= LEVEL
    }

    /// Of the peaks and delays among `errors`; none without any.
    pub fn of(errors: &[NormalisedError]) -> Option<Self> {
        let parts: Vec<(&JointPart, f64)> = errors
            .iter()
            .filter_map(|e| Some((e.joint.as_ref()?, e.measured?.value - e.simulated?.value)))
            .collect();
        // In units of each difference's own uncertainty: volts and seconds differ by 1e6.
        let scaled: Vec<(&JointPart, f64, f64)> = parts
            .into_iter()
            .map(|(part, difference)| (part, part.covariance(part).sqrt(), difference))
            .filter(|(_, u, _)| *u > 0.0)
            .collect();
        let row = |(a, of_a, _): &(&JointPart, f64, f64)| -> Vec<f64> {
            scaled.iter().map(|(b, of_b, _)| a.covariance(b) / (of_a * of_b)).collect()
        };
        let matrix: Vec<Vec<f64>> = scaled.iter().map(row).collect();
        let off: Vec<f64> = scaled.iter().map(|(_, u, difference)| difference / u).collect();
        let white = Cholesky::of(&matrix).ok().filter(|_| !off.is_empty())?.whiten(&off);
        let chi_squared: f64 = white.iter().map(|w| w * w).sum();
        let probability = chi_squared_beyond(chi_squared, off.len() as f64);
        Some(Self { chi_squared, quantities: off.len(), probability })
    }

    /// The test in words.
    pub fn words(&self) -> String {
        format!(
            "{} peaks and delays together: chi squared {:.1}, more in {:.2} % of benches as stated",
            self.quantities,
            self.chi_squared,
            100.0 * self.probability
        )
    }
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

    /// Counts it in the joint test, with the records' own errors and its prediction.
    fn in_joint_test(mut self, own: Vec<(String, f64)>, output: &OutputInterval) -> Self {
        let scale = self.simulated.map_or(1.0, |simulated| simulated.value / output.middle());
        self.joint = Some(JointPart { own, output: output.clone(), scale });
        self
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
        let pair = score.peak_measured_v.zip(score.peak_simulated_v);
        if let (Some((measured, simulated)), Some(output)) =
            (pair, output(format!("{} first peak, droop undone", score.against)))
        {
            let gain = gain_u(score) * measured.value.abs();
            let (u, half_width) = (measured.u.hypot(gain), 3f64.sqrt() * gain);
            let measured = Uncertain { u, half_width, ..measured };
            let name = format!("{} first peak", score.name);
            let own = vec![("measured".to_owned(), measured.u), ("simulated".to_owned(), simulated.u)];
            let own = own.into_iter().map(|(side, u)| (format!("{name}, {side}"), u)).collect();
            errors.push(error(name, measured, simulated, output).in_joint_test(own, output));
        }
    }
    // Independent errors of a delay: those of its arrivals on both sides.
    let arrivals = |speed: &SpeedScore| -> Option<Vec<(String, f64)>> {
        let end = |channel: &str, sign: f64| {
            let score = comparison.channels.iter().find(|score| score.name == channel)?;
            let u = [score.arrival_measured_s?.u, score.arrival_simulated_s?.u];
            Some(["measured", "simulated"].into_iter().zip(u).map(move |(side, u)| {
                (format!("{} arrival, {side}", score.name), sign * u)
            }))
        };
        Some(end(&speed.from, -1.0)?.chain(end(&speed.to, 1.0)?).collect())
    };
    let score = |name: &str| comparison.channels.iter().find(|score| score.name == name);
    let between = |outputs: &'_ [OutputInterval], speed: &SpeedScore, what: &str| {
        let (from, to) = (score(&speed.from)?.sensor.as_ref()?, score(&speed.to)?.sensor.as_ref()?);
        let name = format!("{} -> {} {what}", speed.from, speed.to);
        let simulated = format!("{from} -> {to} {what}");
        let place = outputs.iter().position(|output| output.name == simulated)?;
        Some((name, place))
    };
    for speed in comparison.speeds.iter().filter(|speed| speed.estimator == "half_rise") {
        let delay = |arrival: fn(&ChannelScore) -> Option<Uncertain>| {
            let (from, to) = (arrival(score(&speed.from)?)?, arrival(score(&speed.to)?)?);
            Some(Uncertain::normal(to.value - from.value, from.u.hypot(to.u)))
        };
        let sides = delay(|score| score.arrival_measured_s)
            .zip(delay(|score| score.arrival_simulated_s))
            .zip(between(&predicted.outputs, speed, "delay"));
        let found = sides.zip(arrivals(speed));
        errors.extend(found.map(|(((m, s), (name, place)), own)| {
            let output = &predicted.outputs[place];
            error(name, m, s, output).in_joint_test(own, output)
        }));
    }
    for speed in &comparison.speeds {
        let outputs = &predicted.speeds_as_measured;
        if let Some((name, place)) = between(outputs, speed, &speed.estimator.replace('_', "-")) {
            let (measured, simulated) = (speed.measured_m_per_s, speed.simulated_m_per_s);
            errors.push(error(name, measured, simulated, &outputs[place]));
        }
    }
    let traces = comparison.channels.iter().zip(&compared.pairs).zip(&compared.quiet);
    errors.extend(traces.filter_map(|((score, pair), quiet)| {
        let band = predicted.bands.iter().find(|band| band.channel == score.against)?;
        trace_error((score, gain_u(score)), pair, (*quiet)?, band)
    }));
    errors
}

/// The same, and by them the verdict of `compared`, where there are any; what the converter cut off
/// never passes. The joint test is noted.
pub fn judge(compared: &mut Compared, predicted: &UncertainPrediction) -> Vec<NormalisedError> {
    let errors = normalised_errors(compared, predicted);
    let comparison = &mut compared.comparison;
    if !errors.is_empty() {
        let beyond = errors.iter().filter(|error| !error.agrees());
        let failures = beyond.map(|error| format!("{}: E_n {}", error.quantity, error.figure()));
        comparison.failures = failures.collect();
        comparison.failures.extend(clipped_failures(&comparison.channels));
        comparison.notes.extend(JointTest::of(&errors).map(|joint| joint.words()));
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
        joint: None,
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
    NormalisedError { quantity, unit: output.unit, measured, simulated, e_n, moves, joint: None }
}
