//! The residuals of a fit and their derivatives.
//!
//! Parameters, in this order: each freed number of the scene over its starting value; the time of
//! the trigger after the striker's first contact, in sample intervals; where times are not exact,
//! by how many of its standard uncertainties the time base is off; a factor for each channel whose
//! gain is not exact, with a residual `(g - 1)/u` where `u` is known; with `offsets`, a zero for
//! each channel, in levels, unless what disturbs it contains the zero; in the end the scores of the
//! scene's other uncertain inputs. Time base and scores are residuals, too: what is known of them,
//! as normal distributions. The scene's numbers are differentiated by central differences with
//! steps of about one standard deviation, the rest in closed form.

use super::forward::{TimeAxis, forces_at};
use super::records::{ChannelRecord, Records};
use crate::analysis::correlation::correlate;
use crate::analysis::least_squares::{LeastSquaresProblem, squares};
use crate::scene::adjust::{Adjustable, AdjustableNumber};
use crate::scene::random_inputs::RandomInputs;

/// First step of the differences, relative (1).
const FIRST_STEP: f64 = 1e-3;
/// Shortest and longest step, relative: shorter ones drown in the integration's error, longer ones
/// see the curvature (1).
const DIFFERENCE_STEPS: (f64, f64) = (1e-5, 1e-2);
/// The same for scores, in standard uncertainties, which are about a hundredth of a number (1).
const FIRST_SCORE_STEP: f64 = 0.1;
const SCORE_STEPS: (f64, f64) = (1e-3, 1.0);
/// A number that is off by a larger factor from where it starts describes another bench, and could
/// take any time to run (1).
const MAX_PARAMETER_FACTOR: f64 = 20.0;
/// Accuracy at which the trigger is looked for (1).
const TRIGGER_ACCURACY: f64 = 1e-4;

/// The traces as a function of the parameters.
pub struct TraceModel<'a> {
    /// The scene.
    pub scene: &'a Adjustable,
    /// The freed parameters.
    pub knobs: &'a [AdjustableNumber],
    /// The measured records.
    pub records: &'a Records,
    /// The scene's other uncertain inputs; none on the way to the minimum.
    pub inputs: RandomInputs,
    /// Whether each channel has an offset of its own.
    pub offsets: bool,
    /// Whether these stay where they are for now.
    pub holds_offsets: bool,
    /// Accuracy of the integration (1).
    pub accuracy: f64,
    /// Samples of each record that count, from its start: late motion of a rattling chain has too
    /// many valleys to begin with.
    pub horizon: usize,
    /// Called after every run.
    pub progress: &'a mut dyn FnMut(),
    /// Runs so far.
    pub runs: u64,
    /// Steps of the differences, by the parameter's place.
    steps: Vec<f64>,
    /// Traces at the last point that residuals were asked for.
    last: Option<(Vec<f64>, Vec<Vec<f64>>)>,
}

impl<'a> TraceModel<'a> {
    /// The model of `records` by `scene`.
    pub fn new(
        scene: &'a Adjustable,
        knobs: &'a [AdjustableNumber],
        records: &'a Records,
        (offsets, accuracy): (bool, f64),
        progress: &'a mut dyn FnMut(),
    ) -> Self {
        let steps = vec![FIRST_STEP; knobs.len()];
        let horizon = records.axis.count;
        Self {
            scene,
            knobs,
            records,
            inputs: RandomInputs::default(),
            offsets,
            holds_offsets: false,
            accuracy,
            horizon,
            progress,
            runs: 0,
            steps,
            last: None,
        }
    }

    /// Names of the parameters.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = self.knobs.iter().map(|knob| knob.path.clone()).collect();
        names.push("trigger time".to_owned());
        if self.has_time_base() {
            names.push("time base".to_owned());
        }
        names.extend(self.with_gain().map(|record| format!("gain of {}", record.name)));
        if self.offsets {
            let offset = |record: &ChannelRecord| format!("offset of {}", record.name);
            names.extend(self.with_offset().map(offset));
        }
        names.extend(self.inputs.list().iter().map(|input| input.name.clone()));
        names
    }

    /// Starting point: the scene's numbers by these factors, and the trigger where traces fit best;
    /// none where the scene cannot run (1).
    pub fn start(&mut self, factors: &[f64]) -> Option<Vec<f64>> {
        let trigger = self.find_trigger(factors)?;
        let mut x = factors.to_vec();
        x.push(trigger / self.records.axis.interval);
        x.extend(self.has_time_base().then_some(0.0));
        x.extend(self.with_gain().map(|_| 1.0));
        if self.offsets {
            x.extend(self.with_offset().map(|record| record.baseline / record.level));
        }
        Some(x)
    }

    /// The scene's part of the traces, one sample longer at both ends (V).
    fn traces(
        &mut self,
        (factors, scores): (&[f64], &[f64]),
        axis: TimeAxis,
        trigger: f64,
        accuracy: f64,
    ) -> Option<Vec<Vec<f64>>> {
        let values: Vec<(&AdjustableNumber, f64)> = self
            .knobs
            .iter()
            .zip(factors)
            .map(|(knob, factor)| (knob, knob.value * factor))
            .collect();
        let sane =
            |factor: &f64| (1.0 / MAX_PARAMETER_FACTOR..=MAX_PARAMETER_FACTOR).contains(factor);
        if !factors.iter().all(sane) {
            return None;
        }
        let mut scene = self.inputs.scene(self.scene, &values, scores).ok()?;
        // The fit knows the plates by their data only.
        scene.sensor_tolerance = None;
        self.runs += 1;
        (self.progress)();
        forces_at(&scene, &self.records.wanted(), axis, trigger, accuracy).ok()?
    }

    /// Time of the trigger for which the sum of squared residuals is least, to a sample: all of
    /// them at once by correlation (s).
    fn find_trigger(&mut self, factors: &[f64]) -> Option<f64> {
        let axis = self.records.axis;
        let scene = self.scene.scene().ok()?;
        let length = axis.count as f64 * axis.interval;
        let after = scene.duration + length;
        let count = axis.count + (after / axis.interval).ceil() as usize;
        let long = TimeAxis { start: -length, interval: axis.interval, count };
        let traces = self.traces((factors, &[]), long, 0.0, TRIGGER_ACCURACY)?;
        let mut cost = vec![0.0; count + 1 - axis.count];
        for (record, trace) in self.records.list.iter().zip(&traces) {
            let measured: Vec<f64> =
                record.undisturbed().map(|volts| volts - record.baseline).collect();
            let trace = &trace[1..trace.len() - 1];
            let products = correlate(&measured, trace);
            let mut inside = squares(&trace[..axis.count]);
            for (lag, cost) in cost.iter_mut().enumerate() {
                *cost += (inside - 2.0 * products[lag]) / (record.sigma * record.sigma);
                if let (Some(new), Some(old)) = (trace.get(lag + axis.count), trace.get(lag)) {
                    inside += new * new - old * old;
                }
            }
        }
        let best = (0..cost.len()).min_by(|a, b| cost[*a].total_cmp(&cost[*b]))?;
        Some(long.start + best as f64 * axis.interval - axis.start)
    }

    fn at(&mut self, x: &[f64]) -> Option<Vec<Vec<f64>>> {
        let (factors, rest) = x.split_at(self.knobs.len());
        let (_, scores) = x.split_at(x.len() - self.inputs.count());
        let TimeAxis { start, interval, count } = self.records.axis;
        let trigger = rest.first()? * interval;
        let longer = 1.0 + self.time_base(x) * self.records.time_base_u;
        let axis = TimeAxis { start: start * longer, interval: interval * longer, count };
        self.traces((factors, scores), axis, trigger, self.accuracy)
    }

    /// Whether the time base is a parameter.
    fn has_time_base(&self) -> bool {
        self.records.time_base_u > 0.0
    }

    /// By how many of its standard uncertainties the time base is off (1).
    fn time_base(&self, x: &[f64]) -> f64 {
        if self.has_time_base() { x[self.knobs.len() + 1] } else { 0.0 }
    }

    /// Gain and offset (V) of each channel.
    fn nuisances(&self, x: &[f64]) -> Vec<(f64, f64)> {
        let first = self.knobs.len() + 1 + usize::from(self.has_time_base());
        let mut rest = x[first..].iter().copied();
        let mut next = |free: bool, fixed: f64| {
            if free { rest.next().unwrap_or(fixed) } else { fixed }
        };
        let records = &self.records.list;
        let gains: Vec<f64> = records.iter().map(|r| next(r.gain_u > 0.0, 1.0)).collect();
        let offsets = records.iter().map(|record| {
            let known = if self.offsets { record.baseline / record.level } else { 0.0 };
            next(self.offsets && record.has_offset(), known) * record.level
        });
        gains.into_iter().zip(offsets).collect()
    }

    /// The channels whose gain is a parameter.
    fn with_gain(&self) -> impl Iterator<Item = &ChannelRecord> {
        self.records.list.iter().filter(|record| record.gain_u > 0.0)
    }

    /// The channels whose offset is a parameter, where offsets are.
    fn with_offset(&self) -> impl Iterator<Item = &ChannelRecord> {
        self.records.list.iter().filter(|record| record.has_offset())
    }

    /// What time base, gains and inputs are off by what is known of them, in its standard
    /// deviations: residuals behind those of the samples (1).
    fn priors(&self, x: &[f64]) -> Vec<f64> {
        let nuisances = self.nuisances(x);
        let gains = self.records.list.iter().zip(&nuisances);
        let known = gains.filter(|(record, _)| record.has_prior());
        let gains = known.map(|(record, (gain, _))| (gain - 1.0) / record.gain_u);
        let time_base = self.has_time_base().then(|| self.time_base(x));
        let scores = &x[x.len() - self.inputs.count()..];
        time_base.into_iter().chain(gains).chain(scores.iter().copied()).collect()
    }

    /// Number of them.
    fn prior_count(&self) -> usize {
        let gains = self.records.list.iter().filter(|record| record.has_prior()).count();
        usize::from(self.has_time_base()) + gains + self.inputs.count()
    }

    /// The modelled traces with what disturbs them, one a channel (V).
    pub fn shown(&mut self, x: &[f64]) -> Option<Vec<Vec<f64>>> {
        let traces = self.at(x)?;
        let residuals = self.weigh(x, &traces);
        let nuisances = self.nuisances(x);
        let channels = self.records.list.iter().zip(&traces).zip(nuisances);
        let mut shown = Vec::with_capacity(traces.len());
        for (((record, trace), (gain, offset)), residuals) in
            channels.zip(residuals.chunks(self.records.axis.count.max(1)))
        {
            let added = record.fitted_disturbance(residuals);
            let samples = trace[1..trace.len() - 1].iter().zip(added);
            shown.push(samples.map(|(v, added)| gain * v + offset + added).collect());
        }
        Some(shown)
    }

    fn weigh(&self, x: &[f64], traces: &[Vec<f64>]) -> Vec<f64> {
        let mut residuals = Vec::with_capacity(self.records.list.len() * self.records.axis.count);
        let channels = self.records.list.iter().zip(traces).zip(self.nuisances(x));
        for ((record, trace), (gain, offset)) in channels {
            let samples = record.undisturbed().zip(&trace[1..]).enumerate();
            residuals.extend(samples.map(|(index, (volts, v))| {
                let weighs = index < self.horizon && record.weighs(index);
                if weighs { (volts - gain * v - offset) / record.sigma } else { 0.0 }
            }));
        }
        self.whiten(&mut residuals);
        residuals.extend(self.priors(x));
        residuals
    }

    /// Makes residuals, or their derivatives, white; on the way over parts of the records they are
    /// white enough.
    fn whiten(&self, residuals: &mut [f64]) {
        let count = self.records.axis.count;
        if self.horizon >= count {
            let channels = residuals.chunks_mut(count.max(1)).zip(&self.records.list);
            channels.for_each(|(residuals, record)| record.whiten(residuals));
        }
    }

    /// A column that has, for channel `only` or all of them, `value` of the trace at each sample.
    fn column(
        &self,
        traces: &[Vec<f64>],
        only: Option<usize>,
        value: &dyn Fn(usize, &[f64]) -> f64,
    ) -> Vec<f64> {
        let mut column = Vec::with_capacity(self.records.list.len() * self.records.axis.count);
        for (channel, (record, trace)) in self.records.list.iter().zip(traces).enumerate() {
            let meant = only.is_none_or(|only| only == channel);
            let around = trace.windows(3).enumerate();
            column.extend(around.map(|(index, around)| {
                let weighs = meant && index < self.horizon && record.weighs(index);
                if weighs { -value(channel, around) / record.sigma } else { 0.0 }
            }));
        }
        column.resize(column.len() + self.prior_count(), 0.0);
        column
    }

    /// Derivative by the time base, from those `slope` by a sample interval of the trigger: each
    /// sample is later by the same share of its time.
    fn by_time_base(&self, traces: &[Vec<f64>], slope: &dyn Fn(usize, &[f64]) -> f64) -> Vec<f64> {
        let mut column = self.column(traces, None, slope);
        let axis = self.records.axis;
        let samples = self.records.list.len() * axis.count;
        for (index, value) in column[..samples].iter_mut().enumerate() {
            let time = axis.start / axis.interval + (index % axis.count) as f64;
            *value *= time * self.records.time_base_u;
        }
        column[samples] = 1.0;
        column
    }

    /// Derivative by parameter `place`, a freed number or a score, by central differences.
    fn by_difference(&mut self, x: &[f64], at: &[f64], place: usize) -> Option<Vec<f64>> {
        let step = self.steps.get(place).copied().unwrap_or(FIRST_SCORE_STEP);
        let mut side = |by: f64| {
            let mut there = x.to_vec();
            there[place] += by;
            let traces = self.at(&there)?;
            Some(self.weigh(&there, &traces))
        };
        // At the edge of what a number may be, one side has to do.
        let (high, low, apart) = match (side(step), side(-step)) {
            (Some(high), Some(low)) => (high, low, 2.0 * step),
            (Some(high), None) => (high, at.to_vec(), step),
            (None, Some(low)) => (at.to_vec(), low, step),
            (None, None) => return None,
        };
        let column: Vec<f64> = high.iter().zip(&low).map(|(h, l)| (h - l) / apart).collect();
        let deviation = 1.0 / squares(&column).sqrt();
        let (least, most) = if place < self.knobs.len() { DIFFERENCE_STEPS } else { SCORE_STEPS };
        self.steps.resize(self.steps.len().max(place + 1), FIRST_SCORE_STEP);
        self.steps[place] = deviation.clamp(least, most);
        Some(column)
    }
}

impl LeastSquaresProblem for TraceModel<'_> {
    fn counted(&self, _: &[f64]) -> usize {
        self.records.counted(self.horizon) + self.prior_count()
    }

    fn residuals(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        let traces = self.at(x)?;
        let residuals = self.weigh(x, &traces);
        self.last = Some((x.to_vec(), traces));
        residuals.iter().all(|r| r.is_finite()).then_some(residuals)
    }

    fn columns(&mut self, x: &[f64], at: &[f64]) -> Option<Vec<Vec<f64>>> {
        let known = self.last.take().filter(|(there, _)| there == x);
        let traces = match known {
            Some((_, traces)) => traces,
            None => self.at(x)?,
        };
        let mut columns = Vec::with_capacity(x.len());
        for place in 0..self.knobs.len() {
            columns.push(self.by_difference(x, at, place)?);
        }
        let nuisances = self.nuisances(x);
        // A later trigger shows a later part of the motion.
        let slope =
            |channel: usize, around: &[f64]| nuisances[channel].0 * 0.5 * (around[2] - around[0]);
        let first = columns.len();
        columns.push(self.column(&traces, None, &slope));
        let mut prior = self.records.list.len() * self.records.axis.count;
        if self.has_time_base() {
            columns.push(self.by_time_base(&traces, &slope));
            prior += 1;
        }
        for (channel, record) in self.records.list.iter().enumerate() {
            if record.gain_u <= 0.0 {
                continue;
            }
            let mut column = self.column(&traces, Some(channel), &|_, around| around[1]);
            if record.has_prior() {
                column[prior] = 1.0 / record.gain_u;
                prior += 1;
            }
            columns.push(column);
        }
        for (channel, record) in self.records.list.iter().enumerate() {
            if self.offsets && record.has_offset() {
                let level = if self.holds_offsets { 0.0 } else { record.level };
                columns.push(self.column(&traces, Some(channel), &|_, _| level));
            }
        }
        let samples = self.records.list.len() * self.records.axis.count;
        columns[first..].iter_mut().for_each(|column| self.whiten(&mut column[..samples]));
        for place in x.len() - self.inputs.count()..x.len() {
            columns.push(self.by_difference(x, at, place)?);
        }
        Some(columns)
    }
}
