//! The force at a probe over one step of the vector path: force and rate of change at both ends,
//! and the two overlaps as polynomials.
//!
//! Each overlap is the septic through its value and its first three derivatives at both ends of the
//! step; the error goes as the step to the power 8 with the constant `1/(8! 2^8)`. Source: C.
//! Hermite, J. reine angew. Math. 84, 70 (1878).

use super::hermite::{COEFFICIENTS, End, septic_coefficients};
use super::integrator::Integrator;
use super::kernel::{ContactStep, InstructionSet, SampleForces, VectorStepper};
use crate::chain::hertz::force_and_tangent;
use crate::chain::{Contact, ForceProbe, Pull};

/// Times in a step at which a force is evaluated, as fractions of the step; its end is the last
/// (1).
pub const SAMPLE_TIMES: [f64; 4] = [0.25, 0.5, 0.75, 1.0];
/// Where a force rises or falls at both ends of a step, and the least rate of their cubic is below
/// this share of both, it may turn in between (1).
const DOUBTFUL_RATE_SHARE: f64 = 0.6;

/// The two contacts that a probe measures, without losses.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactPair([Elastic; 2]);

/// A contact's force law, and its weight in the probe.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Elastic {
    /// `A` (N/m^1.5).
    stiffness: f64,
    /// Square root of the static overlap (m^0.5).
    static_root: f64,
    weight: f64,
}

impl Elastic {
    fn new(contact: &Contact, weight: f64) -> Self {
        let (stiffness, _, static_root) = contact.as_hertz();
        Self { stiffness, static_root, weight }
    }

    /// Force change (N) and tangent stiffness (N/m) where the overlap has grown by `change` (m).
    #[inline]
    fn force_and_tangent(&self, change: f64) -> (f64, f64) {
        force_and_tangent(self.stiffness, self.static_root, change)
    }
}

/// The overlaps of a probe's contacts over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StepOverlaps {
    /// Start of the step (s).
    pub start: f64,
    /// Length of the step (s).
    pub length: f64,
    /// Overlap changes as polynomials in the fraction of the step: coefficients of its powers (m).
    overlaps: [[f64; COEFFICIENTS]; 2],
}

/// Dynamic forces (N) and rates of change (N/s) at [`SAMPLE_TIMES`] within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForceSamples {
    /// (N)
    pub forces: [f64; SAMPLE_TIMES.len()],
    /// (N/s)
    pub rates: [f64; SAMPLE_TIMES.len()],
}

impl ContactPair {
    /// Those of `probe`.
    pub fn new(probe: &ForceProbe) -> Self {
        let [above, below] = probe.contacts();
        let [weight_above, weight_below] = *probe.weights();
        Self([Elastic::new(above, weight_above), Elastic::new(below, weight_below)])
    }

    /// Dynamic force and its rate of change at the fraction `theta` of a step (N, N/s).
    pub fn force_and_rate(&self, step: &StepOverlaps, theta: f64) -> [f64; 2] {
        let (mut force, mut rate) = (0.0, 0.0);
        for (contact, overlap) in self.0.iter().zip(&step.overlaps) {
            let (value, slope) = value_and_slope(overlap, theta);
            let (change, tangent) = contact.force_and_tangent(value);
            force += contact.weight * change;
            rate += contact.weight * tangent * slope;
        }
        [force, rate / step.length]
    }

    /// Adds the dynamic forces at `count` even times to `out` (N): the first and the distance from
    /// one to the next are fractions of the step.
    pub fn sample(
        &self,
        set: InstructionSet,
        step: &StepOverlaps,
        (first, interval, count): (f64, f64, usize),
        out: &mut Vec<f64>,
    ) {
        let taken = out.len();
        out.resize(taken + count, 0.0);
        let contact = |which: usize| {
            let Elastic { stiffness, static_root, weight } = self.0[which];
            ContactStep { overlap: &step.overlaps[which], stiffness, static_root, weight }
        };
        let contacts = [contact(0), contact(1)];
        set.run(SampleForces { contacts, first, interval, out: &mut out[taken..] });
    }

    /// Forces and rates at [`SAMPLE_TIMES`].
    pub fn samples(&self, step: &StepOverlaps) -> ForceSamples {
        let mut samples = ForceSamples { forces: [0.0; 4], rates: [0.0; 4] };
        for (index, theta) in SAMPLE_TIMES.into_iter().enumerate() {
            [samples.forces[index], samples.rates[index]] = self.force_and_rate(step, theta);
        }
        samples
    }
}

/// A polynomial (m) and its slope (m) at `theta`.
#[inline]
fn value_and_slope(coefficients: &[f64; COEFFICIENTS], theta: f64) -> (f64, f64) {
    let (mut value, mut slope) = (0.0, 0.0);
    for coefficient in coefficients.iter().rev() {
        slope = slope * theta + value;
        value = value * theta + coefficient;
    }
    (value, slope)
}

/// Change, rate, second and third derivative of an overlap (m, m/s, m/s², m/s³).
type Derivatives = [f64; 4];

/// Follows one probe from step to step.
#[derive(Debug, Clone)]
pub struct ProbeTracker {
    pair: ContactPair,
    /// The contacts of the neighbourhood: the two of the probe, and the next above and below.
    neighbourhood: [Elastic; 4],
    inverse_masses: [f64; 3],
    /// A magnet that follows one of the three bodies, by its place among them.
    pull: Option<(usize, Pull)>,
    /// The five bodies around, from above; none beyond the ends.
    bodies: [Option<usize>; 5],
    /// Overlaps of the probe's contacts at both ends of the last step.
    ends: [[Derivatives; 2]; 2],
    /// Force (N) and its rate of change (N/s) there.
    forces: [[f64; 2]; 2],
    /// Start and length of the last step (s).
    step: (f64, f64),
    /// A maximum within a step is no more than this factor above the larger force at its ends (1).
    max_ratio: f64,
}

/// Largest ratio of a force's maximum within a step of `phase` (rad) of its fastest oscillation to
/// the larger force at the ends: the overlap is `cos(phase/2)` of its maximum there, the force goes
/// as its power 1.5; unlimited from half an oscillation on (1).
fn max_ratio_within_step(phase: f64) -> f64 {
    if phase < std::f64::consts::PI { (0.5 * phase).cos().powf(-1.5) } else { f64::INFINITY }
}

impl ProbeTracker {
    /// Starts at the present state of `stepper`, whose chain has so many bodies.
    pub fn new(probe: &ForceProbe, stepper: &VectorStepper, bodies: usize) -> Self {
        let body = |offset: usize| (probe.body() + offset).checked_sub(2).filter(|b| *b < bodies);
        let mut tracker = Self {
            pair: ContactPair::new(probe),
            neighbourhood: probe
                .neighbourhood()
                .each_ref()
                .map(|contact| Elastic::new(contact, 1.0)),
            inverse_masses: probe.inverse_masses(),
            pull: probe.pull().cloned(),
            bodies: std::array::from_fn(body),
            ends: Default::default(),
            forces: Default::default(),
            step: (stepper.time(), 0.0),
            max_ratio: max_ratio_within_step(stepper.max_phase()),
        };
        tracker.advance(stepper);
        tracker
    }

    /// Takes in the last step of `stepper`.
    // Loops and not `map`, which the compiler does not inline here: half of a sweep's time.
    pub fn advance(&mut self, stepper: &VectorStepper) {
        let mut moving = [[0.0; 3]; 5];
        for (moving, body) in moving.iter_mut().zip(self.bodies) {
            *moving = stepper.motion(body);
        }
        // Change of each overlap and its first two derivatives; change of its force, and its rate.
        let (mut between, mut forces, mut rates) = ([[0.0; 3]; 4], [0.0; 4], [0.0; 4]);
        for j in 0..4 {
            for order in 0..3 {
                between[j][order] = moving[j][order] - moving[j + 1][order];
            }
            let (force, tangent) = self.neighbourhood[j].force_and_tangent(between[j][0]);
            (forces[j], rates[j]) = (force, tangent * between[j][1]);
        }
        let mut jerk = [0.0; 3];
        for i in 0..3 {
            jerk[i] = (rates[i] - rates[i + 1]) * self.inverse_masses[i];
        }
        if let Some((place, pull)) = &self.pull {
            let [position, velocity, _] = moving[place + 1];
            jerk[*place] += pull.slope(position) * velocity * self.inverse_masses[*place];
        }
        let mut end = [[0.0; 4]; 2];
        let mut force = [0.0; 2];
        for which in 0..2 {
            let ([x, v, a], weight) = (between[which + 1], self.pair.0[which].weight);
            end[which] = [x, v, a, jerk[which] - jerk[which + 1]];
            force[0] += weight * forces[which + 1];
            force[1] += weight * rates[which + 1];
        }
        self.ends = [self.ends[1], end];
        self.forces = [self.forces[1], force];
        self.step = stepper.last_step();
    }

    /// Dynamic force and its rate of change at the end of the last step (N, N/s).
    pub fn end(&self) -> [f64; 2] {
        self.forces[1]
    }

    /// The contacts that it measures.
    pub fn pair(&self) -> &ContactPair {
        &self.pair
    }

    /// The overlaps over the last step.
    pub fn overlaps(&self) -> StepOverlaps {
        let (start, length) = self.step;
        let end = |[position, velocity, acceleration, jerk]: Derivatives| {
            (End { position, velocity, acceleration }, jerk)
        };
        let [from, to] = self.ends;
        let overlap = |which: usize| {
            let ((from, early), (to, late)) = (end(from[which]), end(to[which]));
            septic_coefficients(from, to, (early, late), length)
        };
        StepOverlaps { start, length, overlaps: [overlap(0), overlap(1)] }
    }

    /// Whether the last step may hold a maximum above the first of these forces, or any force above
    /// the second (N).
    ///
    /// A force that changes its curvature at most once in a step is below its tangents at both
    /// ends: below the one where it is concave there, and where it is convex below the larger of
    /// that part's ends. A maximum of one that falls at the start and rises at the end is not
    /// looked for: it would have turned three times. In steps of half an oscillation and more
    /// nothing is ruled out: the places in [`SAMPLE_TIMES`] are closer than two turns up to steps
    /// of two oscillations.
    pub fn may_exceed(&self, [maximum, level]: [f64; 2]) -> bool {
        if self.max_ratio.is_infinite() {
            return true;
        }
        let ([[first, first_rate], [last, last_rate]], length) = (self.forces, self.step.1);
        let (climb, slope) = (first_rate * length, last_rate * length);
        let bound = (first + climb.max(0.0)).max(last - slope.min(0.0));
        if bound.max(self.max_ratio * first.max(last)) <= maximum {
            return false;
        }
        let (rose, rises) = (climb > 0.0, slope > 0.0);
        if last > level || rose && !rises {
            return true;
        }
        // Of the cubic through both ends; falling twice is rising twice, upside down.
        let mean = if rises { last - first } else { first - last };
        let (start, end) = (climb.abs(), slope.abs());
        let (bend, turn) = (3.0 * (start + end - 2.0 * mean), 2.0 * start + end - 3.0 * mean);
        let spare = start - DOUBTFUL_RATE_SHARE * start.min(end);
        rose == rises && bend > 0.0 && turn > 0.0 && turn < bend && turn * turn > spare * bend
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A tracker of nothing whose last step, of 1 s, has these forces and rates at its ends.
    fn tracker(forces: [[f64; 2]; 2]) -> ProbeTracker {
        let none = Elastic { stiffness: 0.0, static_root: 0.0, weight: 0.0 };
        ProbeTracker {
            pair: ContactPair([none; 2]),
            neighbourhood: [none; 4],
            inverse_masses: [0.0; 3],
            pull: None,
            bodies: [None; 5],
            ends: Default::default(),
            forces,
            step: (0.0, 1.0),
            max_ratio: max_ratio_within_step(8.0 * std::f64::consts::PI / 15.0),
        }
    }

    /// The highest inner maximum of the cubic through both ends, by its rate's roots.
    fn top([[first, climb], [last, slope]]: [[f64; 2]; 2]) -> Option<f64> {
        let change = last - first;
        let (square, cube) = (3.0 * change - 2.0 * climb - slope, climb + slope - 2.0 * change);
        let force = |t: f64| first + t * (climb + t * (square + t * cube));
        let spread = (square * square - 3.0 * cube * climb).sqrt();
        let place = if square <= 0.0 {
            climb / (spread - square)
        } else {
            -(square + spread) / (3.0 * cube)
        };
        (spread > 0.0 && place > 0.0 && place < 1.0).then(|| force(place))
    }

    /// Whatever the signs of forces and rates, zero among them, a maximum or an end above what is
    /// asked for is never overlooked.
    #[test]
    fn no_maximum_is_overlooked() {
        let mut bits = 0x9E37_79B9_7F4A_7C15_u64;
        let mut random = || {
            bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            f64::from((bits >> 33) as u32) / f64::from(1_u32 << 30) - 1.0
        };
        let mut sized =
            || if random() > 0.8 { 0.0 } else { random() * 10.0_f64.powf(3.0 * random()) };
        let (mut maxima, mut ends, mut spared) = (0, 0, 0);
        for _ in 0..400_000 {
            let [a, b, c, d, maximum, level] = std::array::from_fn(|_| sized());
            let may_exceed = tracker([[a, b], [c, d]]).may_exceed([maximum, level]);
            let rounding = 1e-12 * (a.abs() + b.abs() + c.abs() + d.abs());
            let exceeds = top([[a, b], [c, d]]).is_some_and(|top| top > maximum + rounding);
            let end_exceeds = c > level.max(maximum);
            assert!(may_exceed || !exceeds, "{a} {b} {c} {d} above {maximum}");
            assert!(may_exceed || !end_exceeds, "{c} above {level} and {maximum}");
            maxima += u32::from(exceeds);
            ends += u32::from(end_exceeds);
            spared += u32::from(!may_exceed);
        }
        assert!(maxima > 10_000 && ends > 10_000 && spared > 10_000);
    }
}
