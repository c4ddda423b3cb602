//! The pulse at a probe: first peak, arrivals, and largest force, from the force over each step and
//! not from the ends of steps.
//!
//! The first peak is the first local maximum of the dynamic force above a quarter of its largest
//! value. A step is scanned at [`SAMPLE_TIMES`]; maxima between two of them are bracketed, and a
//! level's first arrival is found in the steps in which the force exceeded all before.

use serde::Serialize;

use crate::chain::ForceProbe;
use crate::motion::ForceSegment;
use crate::motion::probe_step::{
    ContactPair, ForceSamples, ProbeTracker, SAMPLE_TIMES, StepOverlaps,
};
use crate::numeric::roots::root;

/// A force that rises from zero has no maximum between two samples that exceeds the larger of them
/// by more than this factor: samples are a fifteenth of the fastest oscillation apart, or the step
/// would not have been accepted (1).
const MAX_BETWEEN_SAMPLES: f64 = 1.25;
/// Where a force rises at two samples and their cubic's least rate in between is below this share
/// of both rates, it may fall there (1).
const MIN_RATE_SHARE: f64 = 0.3;
/// A peak counts when it exceeds this share of the record's largest dynamic force (1).
pub const PEAK_SHARE: f64 = 0.25;
/// Lowest level whose arrival is kept for certain, as a share of the first peak (1).
pub const MIN_LEVEL_SHARE: f64 = 1e-3;
/// Forces up to this share of the static force, or of the impact's, are rounding and not a pulse
/// (1).
const ROUNDING_SHARE: f64 = 1e-13;
/// Least jump between the interpolants of two steps, as a share of the largest force (1).
const MIN_JUMP_SHARE: f64 = 1e-6;
/// Initial capacity for steps up to the first peak.
const RISES_CAPACITY: usize = 8;
/// Share of the first peak at the half-rise (1).
pub const HALF_RISE_SHARE: f64 = 0.5;
/// Share of the first peak at the foot (1).
pub const FOOT_SHARE: f64 = 0.1;
/// A secant that moves a maximum by less than this share of the way between two samples is
/// within its square of the maximum, where the force is the highest to the last bits (1).
const SECANT_TOLERANCE: f64 = 1e-4;
/// Secants that are tried: each about doubles the digits, or none will.
const MAX_SECANTS: usize = 4;

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

/// Records the force at one probe through a run.
#[derive(Debug, Clone)]
pub struct PulseRecorder {
    history: ForceHistory,
    /// Whether a loss lets the force jump.
    is_lossy: bool,
    /// Whether it has recorded a step of a general method.
    has_begun: bool,
    /// At static equilibrium (N).
    static_force: f64,
    /// Force that a pulse exceeds (N).
    rounding: f64,
    /// Maxima that may turn out to be the first above the threshold.
    peaks: Vec<Bracket>,
    /// Steps during which the force exceeded all before: where any level was first reached.
    rises: Vec<Rise>,
    /// Levels up to this one are no longer known (N).
    forgotten_level: f64,
    largest: f64,
    /// Lower bound of the highest maximum (N).
    highest: f64,
    /// The highest of those that were the first and are dropped: a force that has exceeded a
    /// maximum before it has been at another.
    passed_over: Option<Bracket>,
    rate_before: f64,
    /// Force at the end of the last step (N).
    last: f64,
}

impl PulseRecorder {
    /// Starts without any force in a chain that is let go with these velocities (m/s); `impact` is
    /// the force that the impact raises (N).
    pub fn new(probe: &ForceProbe, impact: f64, velocities: &[f64]) -> Self {
        let static_force = probe.static_force();
        Self {
            history: ForceHistory::new(ContactPair::new(probe)),
            is_lossy: probe.is_lossy(),
            has_begun: false,
            static_force,
            rounding: ROUNDING_SHARE * static_force.max(impact),
            rate_before: probe.starting_rate(velocities),
            peaks: Vec::new(),
            rises: Vec::with_capacity(RISES_CAPACITY),
            forgotten_level: 0.0,
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

    /// Records the force over the last step of a general method.
    pub fn process_step(&mut self, segment: ForceSegment) {
        let found = SAMPLE_TIMES.map(|theta| segment.force_and_rate(theta));
        let samples = ForceSamples {
            forces: found.map(|[force, _]| force),
            rates: found.map(|[_, rate]| rate),
        };
        // Elsewhere a step starts where the last one ended.
        let anew = self.is_lossy && (segment.anew || !self.has_begun);
        self.has_begun = true;
        let (length, start) = (segment.length, anew.then(|| segment.force_and_rate(0.0)));
        let step = self.history.keep(segment);
        if let Some(start) = start {
            self.jump(step, start);
        }
        self.scan_samples(&samples, length, &|| step);
        let last = [self.peaks.last().map(|p| p.segment), self.rises.last().map(|r| r.segment)];
        if !last.contains(&Some(step)) {
            self.history.release();
        }
    }

    /// Records the last step of the kernel for chains without losses.
    pub fn take_step(&mut self, tracker: &ProbeTracker) {
        if tracker.may_exceed(self.thresholds()) {
            let step = tracker.overlaps();
            let samples = tracker.pair().samples(&step);
            self.scan_samples(&samples, step.length, &|| Segment::Lossless(step));
        }
        [self.last, self.rate_before] = tracker.end();
    }

    /// A maximum up to the first counts for nothing, nor does any other force up to the second (N).
    pub fn thresholds(&self) -> [f64; 2] {
        // Levels are shares of a peak above rounding.
        [self.first_exceeds().max(FOOT_SHARE * self.rounding), self.largest]
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
        self.forgotten_level =
            self.rises[..low].last().map_or(self.forgotten_level, |rise| rise.reached);
        self.rises.drain(..low);
    }

    fn scan_samples(&mut self, samples: &ForceSamples, length: f64, segment: &dyn Fn() -> Segment) {
        let (mut reached, mut top, mut low) = (self.largest, 1.0, 0.0);
        for (index, high) in SAMPLE_TIMES.into_iter().enumerate() {
            let (rate, force) = (samples.rates[index], samples.forces[index]);
            if let Some(mut maximum) = self.between((low, high), (force, rate), length, segment) {
                let mut least = force.max(self.last);
                if maximum.most > reached {
                    let is_bracketed = self.rate_before > 0.0 && rate <= 0.0;
                    let ends = is_bracketed.then_some([self.last, force]);
                    let (at, height) = self.history.height(&maximum, ends);
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

    /// A maximum that may become the first peak, between the last sample and one with this
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
        let counts = most > self.thresholds()[0];
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
            let rate = |theta| self.history.rate(&segment, theta);
            // What changes the force by less than its rounding over all of this is no turn.
            let turned = |rate: f64| sign * rate + FOOT_SHARE * self.rounding / span;
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

    /// A copy that takes up no more memory than its readings need.
    pub fn readings(&mut self) -> Self {
        self.clear_history();
        self.clone()
    }

    /// Largest dynamic force so far (N).
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// Whether that is rounding and not a pulse.
    pub fn is_quiet(&self) -> bool {
        self.largest <= self.rounding
    }

    /// The first local maximum of the dynamic force above a quarter of its largest value so far,
    /// and above the rounding of the static force and of the impact's.
    pub fn first_peak(&self) -> Option<Peak> {
        let threshold = (PEAK_SHARE * self.largest).max(self.rounding);
        let high = self.peaks.iter().filter(|peak| peak.most > threshold);
        let mut tops = high.map(|peak| (peak, self.history.top(peak)));
        let (peak, (theta, dynamic_n)) = tops.find(|(_, top)| top.1 > threshold)?;
        let time_s = self.history.time(&peak.segment, theta);
        Some(Peak { total_n: dynamic_n + self.static_force, dynamic_n, time_s })
    }

    /// The highest maximum that was the first peak until larger forces raised the threshold above
    /// it.
    pub fn passed_over(&self) -> Option<PassedOver> {
        let threshold = (PEAK_SHARE * self.largest).max(self.rounding);
        let tops = self.passed_over.iter().chain(&self.peaks).map(|peak| self.history.top(peak).1);
        let dynamic_n = tops.take_while(|top| *top <= threshold).fold(0.0, f64::max);
        if dynamic_n <= self.rounding {
            return None;
        }
        Some(PassedOver { dynamic_n, until_s: self.first_reach(dynamic_n / PEAK_SHARE)? })
    }

    /// The time when the dynamic force first reached `level` (N), which is positive; none where it
    /// did not, or where the level is lower than [`MIN_LEVEL_SHARE`] of a
    /// first peak and no longer known (s).
    pub fn first_reach(&self, level: f64) -> Option<f64> {
        let is_it = |rise: &&Rise| rise.reached >= level && level > self.forgotten_level;
        let Rise { segment, top, .. } = self.rises.iter().find(is_it)?;
        let excess = |theta: f64| self.history.force(segment, theta) - level;
        let (mut before, mut lacks) = (0.0, excess(0.0));
        if lacks >= 0.0 {
            return Some(self.history.time(segment, 0.0));
        }
        // Samples up to the largest force, which may lie between two of them.
        let samples = SAMPLE_TIMES.into_iter().take_while(|time| time < top);
        for theta in samples.chain([*top]) {
            let exceeds = excess(theta);
            if exceeds >= 0.0 {
                let reached = root(&excess, [before, theta], [lacks, exceeds]);
                return Some(self.history.time(segment, reached));
            }
            (before, lacks) = (theta, exceeds);
        }
        Some(self.history.time(segment, *top))
    }
}

/// A force over one step. Steps resolve the stiffest contact, or they would not be accepted, so a
/// force turns at most twice between two of the places in
/// [`SAMPLE_TIMES`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Segment {
    /// Of any method: which of `ForceHistory::general`.
    General(usize),
    /// Of the vector path.
    Lossless(StepOverlaps),
}

/// The contacts of a probe, and the steps of general methods that are kept.
#[derive(Debug, Clone)]
pub struct ForceHistory {
    place: ContactPair,
    general: Vec<ForceSegment>,
}

/// A maximum, between two samples of a step's force or at a known time.
#[derive(Debug, Clone, Copy)]
pub struct Bracket {
    /// The step.
    pub segment: Segment,
    /// Where it begins and ends, in fractions of the step (1).
    pub between: [f64; 2],
    /// Rates of change there: it rises, and falls or turns (N/s).
    pub rates: [f64; 2],
    /// Upper bound of its value (N).
    pub most: f64,
    /// Whether no force before was as large: others are not the first peak, for the force that
    /// exceeded them came down from a maximum.
    pub exceeds_all: bool,
}

/// A step in which a force exceeded all before.
#[derive(Debug, Clone, Copy)]
pub struct Rise {
    /// The step.
    pub segment: Segment,
    /// The largest force (N).
    pub reached: f64,
    /// At which fraction of the step it was (1).
    pub top: f64,
}

impl ForceHistory {
    /// Without steps.
    pub fn new(place: ContactPair) -> Self {
        Self { place, general: Vec::new() }
    }

    /// Keeps a step of a general method.
    pub fn keep(&mut self, segment: ForceSegment) -> Segment {
        self.general.push(segment);
        Segment::General(self.general.len() - 1)
    }

    /// Drops the step that was kept last.
    pub fn release(&mut self) {
        self.general.pop();
    }

    /// Dynamic force at the fraction `theta` of `segment` (N).
    pub fn force(&self, segment: &Segment, theta: f64) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].force(theta),
            Segment::Lossless(span) => self.place.force_and_rate(span, theta)[0],
        }
    }

    /// Its rate of change there (N/s).
    pub fn rate(&self, segment: &Segment, theta: f64) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].rate(theta),
            Segment::Lossless(span) => self.place.force_and_rate(span, theta)[1],
        }
    }

    /// Time of that (s).
    pub fn time(&self, segment: &Segment, theta: f64) -> f64 {
        let start = match segment {
            Segment::General(index) => self.general[*index].start,
            Segment::Lossless(span) => span.start,
        };
        start + theta * self.length(segment)
    }

    /// Length of the step (s).
    fn length(&self, segment: &Segment) -> f64 {
        match segment {
            Segment::General(index) => self.general[*index].length,
            Segment::Lossless(span) => span.length,
        }
    }

    /// Fraction of the step and force of a maximum (1, N).
    pub fn top(&self, maximum: &Bracket) -> (f64, f64) {
        let Bracket { segment, between, rates, .. } = maximum;
        let theta = if between[1] > between[0] {
            root(&|theta| self.rate(segment, theta), *between, *rates)
        } else {
            between[0]
        };
        (theta, self.force(segment, theta))
    }

    /// The same at less cost, the force to its last bits but not the place, for a maximum between
    /// samples with the forces `ends` (N).
    pub fn height(&self, maximum: &Bracket, ends: Option<[f64; 2]>) -> (f64, f64) {
        let Bracket { segment, between, rates, .. } = maximum;
        let width = (between[1] - between[0]) * self.length(segment);
        let rate = |theta| self.rate(segment, theta);
        let found = ends
            .and_then(|ends| refine_maximum(&rate, *between, *rates, (ends[1] - ends[0]) / width));
        found.map_or_else(|| self.top(maximum), |theta| (theta, self.force(segment, theta)))
    }
}

/// Whether a force that rises at two samples, on average at `mean`, may fall in between (N/s): its
/// cubic's rate is `first + 2 (3 mean - 2 first - second) t + 3 (first + second - 2 mean) t^2`, and
/// where its least value is below the share `doubtful` (1) of both rates, the force's own may be
/// below zero.
pub fn may_decrease((first, second): (f64, f64), mean: f64, doubtful: f64) -> bool {
    let square = 3.0 * (first + second - 2.0 * mean);
    let linear = 2.0 * first + second - 3.0 * mean;
    let least = first - linear * linear / square;
    square > 0.0 && linear > 0.0 && linear < square && least < doubtful * first.min(second)
}

/// Upper bound of a force between two samples where it bends the other way at most once in between,
/// from its values and what its rates of change would come to from one sample to the next: where it
/// is concave it is below its tangent at the end that is concave, and where it is convex below the
/// larger of that part's ends (N).
pub fn highest([first, last]: [f64; 2], [rise, slope]: [f64; 2]) -> f64 {
    (first + rise.max(0.0)).max(last - slope.min(0.0))
}

/// A place between `low` and `high` where `rate`, which is `at_low` and `at_high` there, is below
/// zero, if there is one: its least value, found by golden sections (J. Kiefer, Proc. Am. Math.
/// Soc. 4, 502, 1953), until both ends are below twice the least so far: of parabolas and corners,
/// of which one side may be ten times as steep as the other, it is then not less than two fifths of
/// that (1).
pub fn find_negative(
    rate: &dyn Fn(f64) -> f64,
    [mut low, mut high]: [f64; 2],
    [mut at_low, mut at_high]: [f64; 2],
) -> Option<f64> {
    let section = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut left, mut right) = (high - section * (high - low), low + section * (high - low));
    let (mut at_left, mut at_right) = (rate(left), rate(right));
    for _ in 0..40 {
        let least = at_left.min(at_right);
        if least < 0.0 {
            return Some(if at_left < at_right { left } else { right });
        }
        if at_low.max(at_high) < 2.0 * least {
            return None;
        }
        if at_left < at_right {
            (high, at_high) = (right, at_right);
            (right, at_right) = (left, at_left);
            left = high - section * (high - low);
            at_left = rate(left);
        } else {
            (low, at_low) = (left, at_left);
            (left, at_left) = (right, at_right);
            right = low + section * (high - low);
            at_right = rate(right);
        }
    }
    None
}

/// Where a force is highest that rises at `low` and falls at `high`, by its rates of change there,
/// `first` and `second`, and its `mean` one (N/s): the turn of its cubic, and a few secants from
/// there. The force there is the highest to the last bits; none where that is not certain (1).
pub fn refine_maximum(
    rate: &dyn Fn(f64) -> f64,
    [low, high]: [f64; 2],
    [first, second]: [f64; 2],
    mean: f64,
) -> Option<f64> {
    let square = 3.0 * (first + second - 2.0 * mean);
    let linear = 2.0 * (3.0 * mean - 2.0 * first - second);
    let steepness = (linear * linear - 4.0 * square * first).sqrt();
    let place = |share: f64| low + share * (high - low);
    let mut before = 2.0 * first / (steepness - linear);
    let mut at_before = rate(place(before));
    let mut fall = -steepness;
    let mut next = before - at_before / fall;
    for _ in 0..MAX_SECANTS {
        if !(0.0..=1.0).contains(&next) {
            return None;
        }
        let at_next = rate(place(next));
        let step = next - before;
        // The first guess may have been the maximum.
        if step.abs() > 0.0 {
            fall = (at_next - at_before) / step;
        }
        let maximum = next - at_next / fall;
        if fall < 0.0
            && (maximum - next).abs() <= SECANT_TOLERANCE
            && (0.0..=1.0).contains(&maximum)
        {
            return Some(place(maximum));
        }
        (before, at_before, next) = (next, at_next, maximum);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::{find_negative, highest, may_decrease, refine_maximum};
    use std::cell::Cell;

    /// A force that rises at both ends, `f = t - 4.5 t^2 + 5.8 t^3`: its rate is below zero from
    /// 0.162 to 0.356, and at neither end.
    #[test]
    fn a_fall_between_two_rising_ends_is_found() {
        let rate = |t: f64| 1.0 - 9.0 * t + 17.4 * t * t;
        let force = |t: f64| t * (1.0 + t * (-4.5 + t * 5.8));
        assert!(may_decrease((rate(0.0), rate(1.0)), force(1.0) - force(0.0), 0.3));
        let place = find_negative(&rate, [0.0, 1.0], [rate(0.0), rate(1.0)]).expect("a fall");
        assert!(rate(place) < 0.0, "{place}");
    }

    /// A maximum wherever it is between two looks, to the last bits of the force: by two rates
    /// where looks are a fifteenth of an oscillation apart, by two or three more where they are a
    /// quarter.
    #[test]
    fn the_force_at_a_crest_is_the_highest() {
        let (mut worst, mut found) = (0.0_f64, 0);
        for width in [0.01, 0.1, 0.2, 0.4, 0.8, 1.5] {
            for share in [0.001, 0.1, 0.3, 0.5, 0.77, 0.99] {
                let angle = |t: f64| width * (t - share);
                let force = |t: f64| angle(t).cos() + 0.1 * (2.0 * angle(t)).cos();
                let rate = |t: f64| -width * (angle(t).sin() + 0.2 * (2.0 * angle(t)).sin());
                let count = Cell::new(0);
                let counted = |t: f64| {
                    count.set(count.get() + 1);
                    rate(t)
                };
                let mean = force(1.0) - force(0.0);
                let place = refine_maximum(&counted, [0.0, 1.0], [rate(0.0), rate(1.0)], mean);
                assert!(place.is_some(), "{width} {share}");
                let most = if width > 0.4 { 5 } else { 2 };
                assert!(count.get() <= most, "{width} {share}: {} rates", count.get());
                found += u32::from(count.get() == 2);
                worst = place.map_or(worst, |place| worst.max(1.1 - force(place)));
            }
        }
        println!("{found} of 36 by two rates, {worst:e} below the highest");
        assert!(worst <= 4.0 * f64::EPSILON);
    }

    /// Rates with a jump, and rates that the cubic knows nothing of.
    #[test]
    fn a_crest_that_is_not_certain_is_none() {
        let jump = |t: f64| if t < 0.7 { 1e-3 } else { -1.0 };
        assert_eq!(refine_maximum(&jump, [0.0, 1.0], [1e-3, -1.0], -0.2993), None);
        let told_wrong = |t: f64| -1e-3 - t;
        assert_eq!(refine_maximum(&told_wrong, [0.0, 1.0], [1e-6, -1.001], -0.5), None);
        assert_eq!(refine_maximum(&|_| f64::NAN, [0.0, 1.0], [1.0, -1.0], 0.0), None);
    }

    #[test]
    fn a_straight_rise_is_none() {
        assert!(!may_decrease((1.0, 1.0), 1.0, 0.3));
        assert!(!may_decrease((1.0, 1.0), 0.9, 0.3));
        assert_eq!(find_negative(&|t| 0.1 + (t - 0.5).powi(2), [0.0, 1.0], [0.35, 0.35]), None);
    }

    /// Parabolas and corners, some far steeper to one side, their least values above and below
    /// zero, anywhere in between: what is missed is not there. Fewer rates tell than the eighty of
    /// all sections, twice each.
    #[test]
    fn a_rate_falls_where_its_least_value_is_below_zero() {
        let (mut most, mut falls) = (0, 0);
        for place in (1..100).map(|i| 0.01 * f64::from(i)) {
            for least in [-0.2, -0.01, -1e-4, 1e-4, 0.01, 0.2] {
                let off = |t: f64| t - place;
                let shapes: [&dyn Fn(f64) -> f64; 4] = [
                    &|t| least + off(t).powi(2),
                    &|t| least + off(t).abs(),
                    &|t| least + off(t).max(-0.1 * off(t)),
                    &|t| least + (0.1 * off(t)).max(-off(t)),
                ];
                for shape in shapes {
                    let count = Cell::new(0);
                    let rate = |t: f64| {
                        count.set(count.get() + 1);
                        shape(t)
                    };
                    let ends = [shape(0.0), shape(1.0)];
                    let found = find_negative(&rate, [0.0, 1.0], ends);
                    assert_eq!(found.is_some(), least < 0.0, "{place} {least}");
                    assert!(found.is_none_or(|t| shape(t) < 0.0), "{place} {least}");
                    falls += u32::from(found.is_some());
                    most = most.max(count.get());
                }
            }
        }
        println!("{falls} falls, {most} rates at most");
        assert!(most <= 25, "{most}");
    }

    /// Cubics bend the other way at most once: by force and rise at both ends, of all signs.
    #[test]
    fn no_cubic_exceeds_what_it_is_said_to_stay_below() {
        let few = [-3.0, -1.0, -0.1, 0.0, 0.1, 0.95, 3.0];
        let mut closest = f64::INFINITY;
        for (first, last) in few.into_iter().flat_map(|a| few.map(|b| (a, b))) {
            for (rise, slope) in few.into_iter().flat_map(|a| few.map(|b| (a, b))) {
                let change = last - first;
                let (square, cube) =
                    (3.0 * change - 2.0 * rise - slope, rise + slope - 2.0 * change);
                let force = |t: f64| first + t * (rise + t * (square + t * cube));
                let top = (0..=100).map(|i| force(0.01 * f64::from(i))).fold(f64::MIN, f64::max);
                let bound = highest([first, last], [rise, slope]);
                assert!(top <= bound + 1e-12, "{first} {rise} {last} {slope}: {top} and {bound}");
                closest = closest.min(bound - top);
            }
        }
        assert!(closest < 1e-12, "{closest}");
    }
}
