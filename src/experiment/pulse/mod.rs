//! Records a probe's force: samples, local maxima, and the first time a level was reached, all from
//! the interpolant and none from the integrator's grid.

mod read;

use serde::Serialize;

use super::roots::{find_negative, highest, may_decrease};
use super::segment::{Bracket, ForceHistory, Rise, Segment};
use crate::chain::ForceProbe;
use crate::motion::ForceSegment;
use crate::motion::probe_step::{ContactPair, ForceSamples, ProbeTracker, SAMPLE_TIMES};

/// A force that rises from zero has no maximum between two looks that exceeds the larger of them by
/// more than this factor: looks are a fifteenth of the fastest oscillation apart, or the step would
/// not have been accepted (1).
const MAX_BETWEEN_SAMPLES: f64 = 1.25;
/// Where a force rises at two looks and their cubic's least rate in between is below this share of
/// both rates, it may fall there (1).
const MIN_RATE_SHARE: f64 = 0.3;
/// A peak counts when it exceeds this share of the record's largest dynamic force (1).
pub const PEAK_SHARE: f64 = 0.25;
/// Lowest level that is remembered for certain, as a share of the first peak (1).
pub const MIN_LEVEL_SHARE: f64 = 1e-3;
/// Forces up to this share of the static force, or of the impact's, are rounding and not a pulse
/// (1).
const ROUNDING_SHARE: f64 = 1e-13;
/// Least jump between the interpolants of two steps, as a share of the largest force (1).
const MIN_JUMP_SHARE: f64 = 1e-6;
/// Steps to the first peak that there is room for from the start: mostly there are no more.
const RISES_CAPACITY: usize = 8;
/// Share of the first peak at which a pulse is said to arrive by its half-rise (1).
pub const HALF_RISE_SHARE: f64 = 0.5;
/// Share of the first peak at which a pulse is said to arrive by its foot (1).
pub const FOOT_SHARE: f64 = 0.1;

/// A local maximum of the dynamic force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// Force with its static part (N).
    pub total_n: f64,
    /// Force above its static part (N).
    pub dynamic_n: f64,
    /// Time since the striker's first contact (s).
    pub time_s: f64,
}

/// A maximum that was the first peak for a while.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PassedOver {
    /// Its dynamic force (N).
    pub dynamic_n: f64,
    /// When a larger force raised the threshold above that; time since the striker's first contact
    /// (s).
    pub until_s: f64,
}

/// Follows one probe through a run.
#[derive(Debug, Clone)]
pub struct PulseRecorder {
    felt: ForceHistory,
    /// Whether a loss lets the force jump.
    is_lossy: bool,
    /// Whether it has taken in a step of any method.
    has_begun: bool,
    /// At static equilibrium (N).
    static_force: f64,
    /// Force that a pulse exceeds (N).
    quietest: f64,
    /// Maxima that may turn out to be the first above the threshold.
    peaks: Vec<Bracket>,
    /// Steps during which the force exceeded all before: where any level was first reached.
    rises: Vec<Rise>,
    /// Levels up to here are no longer remembered (N).
    forgotten: f64,
    largest: f64,
    /// Lower bound of the highest maximum (N).
    highest: f64,
    /// The highest of those that were the first and are forgotten: a force that has exceeded a
    /// maximum before it has been at another.
    passed_over: Option<Bracket>,
    rate_before: f64,
    /// Force at the end of the last step (N).
    last: f64,
}

impl PulseRecorder {
    /// Starts with nothing felt in a chain that is let go with these velocities (m/s); `impact` is
    /// the force that the impact raises (N).
    pub fn new(probe: &ForceProbe, impact: f64, velocities: &[f64]) -> Self {
        let static_force = probe.static_force();
        Self {
            felt: ForceHistory::nothing(ContactPair::new(probe)),
            is_lossy: probe.is_lossy(),
            has_begun: false,
            static_force,
            quietest: ROUNDING_SHARE * static_force.max(impact),
            rate_before: probe.starting_rate(velocities),
            peaks: Vec::new(),
            rises: Vec::with_capacity(RISES_CAPACITY),
            forgotten: 0.0,
            largest: 0.0,
            highest: 0.0,
            passed_over: None,
            last: 0.0,
        }
    }

    /// Force at static equilibrium (N).
    pub fn static_force(&self) -> f64 {
        self.static_force
    }

    /// Takes in the force over the integrator's last step.
    pub fn process_step(&mut self, segment: ForceSegment) {
        let looked = SAMPLE_TIMES.map(|theta| segment.look(theta));
        let looks = ForceSamples {
            forces: looked.map(|[force, _]| force),
            rates: looked.map(|[_, rate]| rate),
        };
        // Elsewhere a step starts where the last one ended.
        let anew = self.is_lossy && (segment.anew || !self.has_begun);
        self.has_begun = true;
        let (length, start) = (segment.length, anew.then(|| segment.look(0.0)));
        let step = self.felt.keep(segment);
        if let Some(start) = start {
            self.jump(step, start);
        }
        self.scan_samples(&looks, length, &|| step);
        let last = [self.peaks.last().map(|p| p.segment), self.rises.last().map(|r| r.segment)];
        if !last.contains(&Some(step)) {
            self.felt.release();
        }
    }

    /// Takes in the last step of a chain on the vector path.
    pub fn take_step(&mut self, tracker: &ProbeTracker) {
        if tracker.may_exceed(self.asks()) {
            let step = tracker.overlaps();
            let samples = tracker.pair().samples(&step);
            self.scan_samples(&samples, step.length, &|| Segment::Lossless(step));
        }
        [self.last, self.rate_before] = tracker.end();
    }

    /// A maximum up to the first counts for nothing, nor does any other force up to the second (N).
    pub fn asks(&self) -> [f64; 2] {
        // Levels are shares of a peak above rounding.
        [self.first_exceeds().max(FOOT_SHARE * self.quietest), self.largest]
    }

    /// Lower bound of a first peak that is yet to come: a share of the largest force, and all
    /// maxima before it, or one of them were first (N).
    fn first_exceeds(&self) -> f64 {
        self.highest.max(PEAK_SHARE * self.largest)
    }

    /// Keeps a maximum of at least `least` (N).
    fn keep(&mut self, least: f64, peak: Bracket) {
        self.highest = self.highest.max(least);
        if self.peaks.len() == self.peaks.capacity() {
            self.clear_history();
        }
        self.peaks.push(peak);
    }

    /// Keeps a step in which the force is largest.
    fn keep_rise(&mut self, rise: Rise) {
        self.largest = rise.reached;
        if self.rises.len() == self.rises.capacity() {
            self.clear_history();
        }
        self.rises.push(rise);
    }

    /// Frees memory of what is not read: maxima below the threshold of the first peak, which only
    /// rises, and rises to levels far below it.
    fn clear_history(&mut self) {
        let threshold = PEAK_SHARE * self.largest;
        // What exceeds all before is higher than what did so earlier.
        let was_first = |peak: &&Bracket| peak.most <= threshold && peak.exceeds_all;
        self.passed_over = self.peaks.iter().rfind(was_first).copied().or(self.passed_over);
        self.peaks.retain(|peak| peak.most > threshold);
        let low = self.rises.partition_point(|rise| rise.reached < MIN_LEVEL_SHARE * threshold);
        self.forgotten = self.rises[..low].last().map_or(self.forgotten, |rise| rise.reached);
        self.rises.drain(..low);
    }

    fn scan_samples(&mut self, looks: &ForceSamples, length: f64, segment: &dyn Fn() -> Segment) {
        let (mut reached, mut top, mut low) = (self.largest, 1.0, 0.0);
        for (index, high) in SAMPLE_TIMES.into_iter().enumerate() {
            let (rate, force) = (looks.rates[index], looks.forces[index]);
            if let Some(mut maximum) = self.between((low, high), (force, rate), length, segment) {
                let mut least = force.max(self.last);
                if maximum.most > reached {
                    let looked = self.rate_before > 0.0 && rate <= 0.0;
                    let ends = looked.then_some([self.last, force]);
                    let (at, height) = self.felt.height(&maximum, ends);
                    (least, maximum.most) = (height, height);
                    maximum.exceeds_all = height > reached;
                    if maximum.exceeds_all {
                        (reached, top) = (height, at);
                    }
                }
                self.keep(least, maximum);
            }
            (low, self.rate_before, self.last) = (high, rate, force);
        }
        // Between its peaks a force is largest at an end of the step.
        if self.last > reached {
            (reached, top) = (self.last, 1.0);
        }
        if reached > self.largest {
            self.keep_rise(Rise { segment: segment(), reached, top });
        }
    }

    /// A maximum that may become the first peak, between the look that came last and one with this
    /// force (N) and rate of change (N/s), `low` and `high` in a step of `length` (s).
    fn between(
        &self,
        (low, high): (f64, f64),
        (force, rate): (f64, f64),
        length: f64,
        segment: &dyn Fn() -> Segment,
    ) -> Option<Bracket> {
        let (before, after, span) = (self.rate_before, rate, (high - low) * length);
        let rises = [before, after].map(|rate| rate * span);
        let most =
            highest([self.last, force], rises).max(MAX_BETWEEN_SAMPLES * force.max(self.last));
        let counts = most > self.asks()[0];
        if before <= 0.0 && after > 0.0 || !counts {
            return None;
        }
        let mean = (force - self.last) / span;
        let (mut between, mut rates) = ([low, high], [before, after]);
        if before <= 0.0 || after > 0.0 {
            // Up and down again, or down and up again before it falls: one end of the maximum is in
            // between.
            let (sign, inner) = if after > 0.0 { (1.0, 1) } else { (-1.0, 0) };
            if !may_decrease((sign * before, sign * after), sign * mean, MIN_RATE_SHARE) {
                return None;
            }
            let segment = segment();
            let rate = |theta| self.felt.rate(&segment, theta);
            // What changes the force by less than its rounding over all of this is no turn.
            let turned = |rate: f64| sign * rate + FOOT_SHARE * self.quietest / span;
            let ends = [before, after].map(turned);
            let theta = find_negative(&|theta| turned(rate(theta)), [low, high], ends)?;
            (between[inner], rates[inner]) = (theta, rate(theta));
        }
        Some(Bracket { segment: segment(), between, rates, most, exceeds_all: false })
    }

    /// A force that jumps up as a contact closes and then falls has its peak at the jump: force and
    /// its rate of change after it (N, N/s).
    fn jump(&mut self, segment: Segment, [force, rate]: [f64; 2]) {
        if force - self.last > MIN_JUMP_SHARE * self.largest && rate <= 0.0 {
            let exceeds_all = force > self.largest;
            let (between, rates) = ([0.0; 2], [rate; 2]);
            self.keep(force, Bracket { segment, between, rates, most: force, exceeds_all });
            if exceeds_all {
                self.keep_rise(Rise { segment, reached: force, top: 0.0 });
            }
        }
        self.rate_before = rate;
        self.last = force;
    }
}
