//! Outputs of an uncertain scene: intervals of peaks, arrivals and speeds, and bands of traces.

use serde::Serialize;

use super::regression::{InputShare, Regression, regression};
use crate::experiment::outcome::{Reading, Speed};
use crate::experiment::prediction::Prediction;
use crate::numeric::statistics::{Moments, quantile};
use crate::quantity::Uncertain;
use crate::scene::Scene;
use crate::scene::random_inputs::RandomInput;
use crate::trace::Trace;

/// An output with its interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutputInterval {
    /// What it is: `p14 first peak`, `p14 half-rise`, `p14 -> p27 delay`, `p14 -> p27 peak`.
    pub name: String,
    /// Its unit.
    pub unit: &'static str,
    /// Its value with the scene's own numbers (unit).
    pub value: f64,
    /// The same with the errors of gain and zero that a run draws from the seed (unit).
    #[serde(skip)]
    pub as_run: f64,
    /// Standard deviation of the samples (unit).
    pub u: f64,
    /// Half of the interval's width (unit).
    #[serde(rename = "U95")]
    pub expanded: f64,
    /// 95 % of the samples lie between (unit).
    pub interval_95: [f64; 2],
    /// Share of the variance that the regression on the inputs explains (1).
    pub explained: f64,
    /// Each input's share, the largest first.
    pub inputs: Vec<InputShare>,
    /// The value of each drawn bench, none where it has no such output (unit).
    #[serde(skip)]
    pub drawn: Vec<Option<f64>>,
}

/// Where 95 % of a channel's traces lie, sample by sample, without noise and rounding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TraceBand {
    /// `CH1`.
    pub channel: String,
    /// Time of the first sample after the trigger (s).
    pub start_s: f64,
    /// From one sample to the next (s).
    pub interval_s: f64,
    /// The trace with the scene's own numbers (V).
    pub nominal_v: Vec<f64>,
    /// Lower edge (V).
    pub low_v: Vec<f64>,
    /// Upper edge (V).
    pub high_v: Vec<f64>,
    /// Share of the traces that leave the converter's range somewhere; recordings are clipped
    /// there, as the band is (1).
    pub clipped_share: f64,
}

/// An output of which the regression explains this share is told by it at many more scores than
/// were run (1).
const LINEAR_SHARE: f64 = 0.95;

/// All outputs that the nominal run has, in the samples that have them; `many` scores are those
/// that no run is made for.
pub(super) fn intervals(
    [nominal, as_run]: [&Prediction; 2],
    samples: &[(&[f64], &Prediction)],
    (inputs, many): (&[RandomInput], &[Vec<f64>]),
) -> Vec<OutputInterval> {
    let (all, as_run) = (listed(nominal), listed(as_run));
    let found: Vec<Vec<(String, &str, f64)>> =
        samples.iter().map(|(_, prediction)| listed(prediction)).collect();
    let interval = |(name, unit, value): &(String, &'static str, f64)| {
        let of = |outputs: &Vec<(String, &str, f64)>| {
            outputs.iter().find(|output| output.0 == *name).map(|output| output.2)
        };
        let drawn: Vec<Option<f64>> = found.iter().map(of).collect();
        let pairs = samples.iter().zip(&drawn);
        let pairs: Vec<(&[f64], f64)> =
            pairs.filter_map(|((scores, _), value)| Some((*scores, (*value)?))).collect();
        let found = regression(&pairs, inputs)?;
        let mut values = if found.explained >= LINEAR_SHARE {
            many_values(&found, &pairs, many)
        } else {
            pairs.iter().map(|(_, value)| *value).collect()
        };
        values.sort_unstable_by(f64::total_cmp);
        let interval_95 = [quantile(&values, 0.025), quantile(&values, 0.975)];
        let u = Moments::of(&values).deviation;
        let Regression { explained, shares: inputs, .. } = found;
        Some(OutputInterval {
            name: name.clone(),
            unit,
            value: *value,
            as_run: of(&as_run).unwrap_or(*value),
            u,
            expanded: 0.5 * (interval_95[1] - interval_95[0]),
            interval_95,
            explained,
            inputs,
            drawn,
        })
    };
    all.iter().filter_map(interval).collect()
}

/// `prediction` with nothing but its speeds, over the distances that `nominal` has.
pub(super) fn over_nominal_distances(prediction: &Prediction, nominal: &Prediction) -> Prediction {
    let over_nominal = |speed: &Speed| {
        let is_same = |other: &&Speed| {
            let key = |s: &Speed| (s.from, s.to, s.estimator);
            key(other) == key(speed)
                && (&other.from_sensor, &other.to_sensor) == (&speed.from_sensor, &speed.to_sensor)
        };
        let distance_m = nominal.speeds.iter().find(is_same)?.distance_m;
        let m_per_s = speed.m_per_s * distance_m / speed.distance_m;
        Some(Speed { distance_m, m_per_s, ..speed.clone() })
    };
    Prediction {
        readings: Vec::new(),
        wall: None,
        speeds: prediction.speeds.iter().filter_map(over_nominal).collect(),
        heights: Vec::new(),
        traces: Vec::new(),
    }
}

/// Values of an output for `many` scores: regression, its curvature along itself, and what both
/// leave of the samples (unit).
fn many_values(found: &Regression, samples: &[(&[f64], f64)], many: &[Vec<f64>]) -> Vec<f64> {
    let count = samples.len() as f64;
    let mean = |of: &dyn Fn(f64, f64) -> f64| {
        samples.iter().map(|(scores, value)| of(found.linear(scores), *value)).sum::<f64>() / count
    };
    let (level, square) = (mean(&|l, y| y - l), mean(&|l, _| l * l));
    let bend =
        mean(&|l, y| (y - level - l) * (l * l - square)) / mean(&|l, _| (l * l - square).powi(2));
    let surface = |l: f64| level + l + bend * (l * l - square);
    let left: Vec<f64> =
        samples.iter().map(|(scores, value)| value - surface(found.linear(scores))).collect();
    let scores = many.iter().zip(left.iter().cycle());
    scores.map(|(scores, left)| surface(found.linear(scores)) + left).collect()
}

impl TraceBand {
    /// Lower and upper edge as traces, named as the channel.
    pub fn edges(self) -> [Trace; 2] {
        let trace = |values| Trace {
            name: self.channel.clone(),
            unit: "V".to_owned(),
            start: self.start_s,
            interval: self.interval_s,
            values,
        };
        [trace(self.low_v), trace(self.high_v)]
    }
}

impl OutputInterval {
    /// The middle of the interval (unit).
    pub fn middle(&self) -> f64 {
        0.5 * (self.interval_95[0] + self.interval_95[1])
    }

    /// Whether an end of the interval is off by more than a tenth of its half-width from where a
    /// `±` around the value would have it.
    pub fn is_one_sided(&self) -> bool {
        /// A tenth (1).
        const SHOWN_SHARE: f64 = 0.1;
        (self.middle() - self.value).abs() > SHOWN_SHARE * self.expanded
    }

    /// The same as a number with its standard uncertainty.
    pub fn uncertain(&self) -> Uncertain {
        Uncertain::normal(self.value, self.u)
    }
}

/// Names, units and values of what a run predicts.
fn listed(prediction: &Prediction) -> Vec<(String, &'static str, f64)> {
    let mut outputs = Vec::new();
    let places = prediction.readings.iter().chain(&prediction.wall);
    let mut add = |name: String, unit, value: Option<f64>| {
        outputs.extend(value.map(|value| (name, unit, value)));
    };
    for reading in places {
        let Reading { name, first_peak, half_rise_s, .. } = reading;
        add(format!("{name} first peak"), "N", first_peak.map(|peak| peak.dynamic_n));
        add(format!("{name} half-rise"), "s", *half_rise_s);
        add(format!("{name} peak time"), "s", first_peak.map(|peak| peak.time_s));
    }
    for (channel, volts) in &prediction.heights {
        // What `arrivals` and `compare` call so; the trace, and its band, show the droop.
        add(format!("{channel} first peak, droop undone"), "V", Some(*volts));
    }
    let time = |sensor: &str| prediction.readings.iter().find(|r| r.name == sensor)?.half_rise_s;
    for speed in prediction.speeds.iter().filter(|speed| speed.estimator == "half_rise") {
        let Speed { from_sensor, to_sensor, .. } = speed;
        let delay = time(from_sensor).zip(time(to_sensor)).map(|(from, to)| to - from);
        add(format!("{from_sensor} -> {to_sensor} delay"), "s", delay);
    }
    for Speed { from_sensor, to_sensor, estimator, m_per_s, .. } in &prediction.speeds {
        let estimator = estimator.replace('_', "-");
        add(format!("{from_sensor} -> {to_sensor} {estimator}"), "m/s", Some(*m_per_s));
    }
    outputs
}

/// Bands of all channels that triggered in the nominal run.
pub(super) fn bands(
    scene: &Scene,
    nominal: &Prediction,
    samples: &[(&[f64], &Prediction)],
) -> Vec<TraceBand> {
    let channels = || {
        (1..)
            .zip(&scene.scope.channels)
            .filter_map(|(number, channel)| Some((number, channel.as_ref()?)))
    };
    let band = |(place, trace): (usize, &Trace)| {
        let others = samples.iter().filter_map(|(_, prediction)| prediction.traces.get(place));
        let others: Vec<&Trace> = others.collect();
        let edges = |index: usize| {
            let values = others.iter().filter_map(|trace| trace.values.get(index).copied());
            let mut values: Vec<f64> = values.collect();
            values.sort_by(f64::total_cmp);
            (quantile(&values, 0.025), quantile(&values, 0.975))
        };
        let (low_v, high_v) = (0..trace.values.len()).map(edges).unzip();
        let own = channels().find(|(number, _): &(u8, _)| trace.name == format!("CH{number}"));
        let [low, high] = own.map_or([f64::NEG_INFINITY, f64::INFINITY], |(_, c)| {
            scene.scope.model.range(&c.vertical)
        });
        let is_clipped = |trace: &&&Trace| trace.values.iter().any(|v| *v <= low || *v >= high);
        let clipped = others.iter().filter(is_clipped).count();
        TraceBand {
            clipped_share: clipped as f64 / others.len() as f64,
            channel: trace.name.clone(),
            start_s: trace.start,
            interval_s: trace.interval,
            nominal_v: trace.values.clone(),
            low_v,
            high_v,
        }
    };
    nominal.traces.iter().enumerate().map(band).collect()
}
