//! The force at one place at evenly spaced times, in eight steps on end.
//!
//! Each sample takes the powers of two overlaps, which are septics in time. Where a step holds many samples, the force itself is made such a
//! polynomial first, through what is felt at both ends and its values at four places between. That is done where it adds about as little as
//! what the septics are off already: where of the largest overlap at least half is left at the smallest, so that no contact is near its opening, and
//! where the two highest Chebyshev polynomials of the force are no larger than four times what those of the overlaps make, each times the
//! contact's tangent stiffness. In waves of any amplitude that adds at most ten times the septics' own error, which a test
//! holds. Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM (2013),
//! chapters 3, 4 and 8.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::force_septic::{BETWEEN, EVEN, ODD, PLACES};
use super::force_track::{COEFFICIENTS, CONTACTS, LOOKS, Place, lane_forces, sum};
use super::forces::{PLAIN, begin_plain};
use super::lanes::{Lanes, Row, Task, WIDTH};
use super::plan::Form;
use super::seen::Seen;

/// Room behind samples: they are written in rows.
pub const ROOM_BEHIND: usize = WIDTH;
/// Samples in a step from which on it takes less to make the force a polynomial.
const MANY: usize = WIDTH + 1;
/// How many times as large as the overlaps alone would make them the two highest Chebyshev polynomials of a force may be (1).
const ROUGHER: f64 = 4.0;

/// Evenly spaced times that fall into eight steps on end.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Due {
    /// How many fall into each step.
    pub counts: [usize; WIDTH],
    /// Fraction of the step at the first of them (1).
    pub first: [f64; WIDTH],
    /// From one to the next, in fractions of the step (1).
    pub interval: [f64; WIDTH],
}

/// The force at evenly spaced times.
pub struct Sample<'a> {
    /// Where it is felt, and how in each step.
    pub place: &'a Place,
    pub seen: &'a Seen,
    /// The form that the chain computes forces in: what is sampled is rounded no less.
    pub form: Form,
    pub due: &'a Due,
    /// Where dynamic forces are added, one a sample (N).
    pub out: &'a mut Vec<f64>,
}

/// What forces at a contact are computed from, in all lanes.
struct Constants<L: Lanes> {
    /// In plain form `A` times the contact's weight, else as in [`Place::lane_constants`] (unit).
    stiffness: L::V,
    /// In plain form the static overlap (m), else its square root (m^0.5).
    still: L::V,
    /// In plain form `overlap^1.5` at rest (m^1.5), else the weight (1).
    rest: L::V,
}

impl<L: Lanes> Constants<L> {
    /// In plain form the force of contact `which` at this overlap, on top of `total` (N).
    #[inline(always)]
    fn plain_force(&self, which: usize, overlap: L::V, total: L::V) -> L::V {
        let power = begin_plain::<L, PLAIN>(which, overlap).power(which);
        L::mul_add(self.stiffness, L::sub(power, self.rest), total)
    }
}

/// The forces in eight steps as polynomials in where in the step they are felt, from -1 at its start to 1 at its end (N).
struct Polynomials {
    coefficients: [Row; COEFFICIENTS],
    /// The steps that have one, a bit each.
    steps: u8,
}

impl Sample<'_> {
    #[inline(always)]
    fn constants<L: Lanes>(&self, which: usize) -> Constants<L> {
        let [stiffness, static_root, weight] = self.place.lane_constants(which);
        if self.form != Form::Plain {
            let [still, rest] = [L::splat(static_root), L::splat(weight)];
            return Constants { stiffness: L::splat(stiffness), still, rest };
        }
        let still = L::splat(self.place.static_overlap(which));
        // The static part by the same loops: exactly nothing is felt where nothing has moved.
        let rest = begin_plain::<L, PLAIN>(which, still).power(which);
        Constants { stiffness: L::splat(stiffness * weight), still, rest }
    }

    /// The samples in all steps, in plain form or not.
    #[inline(always)]
    fn rows<L: Lanes, const IS_PLAIN: bool>(self) {
        let contacts = [self.constants::<L>(0), self.constants::<L>(1)];
        let polynomials = if IS_PLAIN { self.polynomials::<L>(&contacts) } else { None };
        let count = L::load(&Row([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
        for lane in 0..WIDTH {
            let (first, interval) = (self.due.first[lane], self.due.interval[lane]);
            let mut left = self.due.counts[lane];
            let after = self.out.len() + left;
            let polynomial = match &polynomials {
                Some(of) if of.steps & (1 << lane) != 0 => Some(&of.coefficients),
                _ => None,
            };
            // Polynomials of the force go from -1 at a step's start to 1 at its end.
            let (scale, offset) = if polynomial.is_some() { (2.0, -1.0) } else { (1.0, 0.0) };
            let (first, interval) = (scale * first + offset, scale * interval);
            let ahead = L::mul(count, L::splat(interval));
            let mut start = 0.0;
            while left > 0 {
                let at = L::add(ahead, L::splat(start * interval + first));
                let force = match polynomial {
                    Some(coefficients) => in_lane::<L>(coefficients, lane, at),
                    None => self.force::<L, IS_PLAIN>(&contacts, lane, at),
                };
                let mut row = Row::default();
                L::store(force, &mut row);
                // Whole rows are written.
                self.out.extend_from_slice(&row.0);
                left = left.saturating_sub(WIDTH);
                start += 8.0;
            }
            self.out.truncate(after);
        }
    }

    /// The force at fractions `theta` of the step in lane `lane`.
    #[inline(always)]
    fn force<L: Lanes, const IS_PLAIN: bool>(
        &self,
        contacts: &[Constants<L>; CONTACTS],
        lane: usize,
        theta: L::V,
    ) -> L::V {
        let mut total = L::splat(0.0);
        for which in 0..CONTACTS {
            let change = in_lane::<L>(&self.seen.overlaps[which], lane, theta);
            let Constants { stiffness, still, rest } = contacts[which];
            total = if IS_PLAIN {
                contacts[which].plain_force(which, L::add(still, change), total)
            } else {
                let (force, _) = lane_forces::<L>([stiffness, still], change, self.form);
                L::mul_add(rest, force, total)
            };
        }
        total
    }

    /// The forces as polynomials, in those steps whose contacts are pressed enough for that; none if no step holds as many samples as that takes.
    #[inline(always)]
    fn polynomials<L: Lanes>(&self, contacts: &[Constants<L>; CONTACTS]) -> Option<Polynomials> {
        if self.due.counts.iter().all(|count| *count < MANY) {
            return None;
        }
        let none = L::splat(0.0);
        let (mut near, mut far) = ([none; BETWEEN], [none; BETWEEN]);
        let (mut least, mut most) = ([none; CONTACTS], [none; CONTACTS]);
        for which in 0..CONTACTS {
            let of = &contacts[which];
            let rows = &self.seen.overlaps[which];
            let start = L::add(of.still, L::load(&rows[0]));
            let end = L::add(of.still, horner_row::<L>(rows, 1.0));
            (least[which], most[which]) = (L::min(start, end), L::max(start, end));
            for k in 0..BETWEEN {
                for (side, forces) in [(1.0, &mut far), (-1.0, &mut near)] {
                    let change = horner_row::<L>(rows, 0.5 + 0.5 * side * PLACES[k]);
                    let overlap = L::add(of.still, change);
                    (least[which], most[which]) =
                        (L::min(least[which], overlap), L::max(most[which], overlap));
                    forces[k] = of.plain_force(which, overlap, forces[k]);
                }
            }
        }
        let [even, odd] = self.known::<L>([near, far]);
        let mut coefficients = <[Row; COEFFICIENTS]>::default();
        for half in 0..COEFFICIENTS / 2 {
            L::store(sum::<L>(even, EVEN[half]), &mut coefficients[2 * half]);
            L::store(sum::<L>(odd, ODD[half]), &mut coefficients[2 * half + 1]);
        }
        let steps = self.smooth::<L>(contacts, &coefficients, [least, most]);
        Some(Polynomials { coefficients, steps })
    }

    /// What is known of the force's even part and of its odd part, given the forces at the places between, before the middle of the steps and after it.
    #[inline(always)]
    fn known<L: Lanes>(&self, [near, far]: [[L::V; BETWEEN]; 2]) -> [[L::V; 4]; 2] {
        let Seen { before, forces, rates, .. } = self.seen;
        let half = L::mul(L::splat(0.5), L::load(self.seen.lengths()));
        let [first, last] = [L::load(&before[0]), L::load(&forces[LOOKS - 1])];
        let climb = L::mul(half, L::load(&before[1]));
        let slope = L::mul(half, L::load(&rates[LOOKS - 1]));
        let sums = [L::add(far[0], near[0]), L::add(far[1], near[1]), L::add(last, first)];
        let differences = [L::sub(far[0], near[0]), L::sub(far[1], near[1]), L::sub(last, first)];
        [
            [sums[0], sums[1], sums[2], L::sub(slope, climb)],
            [differences[0], differences[1], differences[2], L::add(slope, climb)],
        ]
    }

    /// The steps in which the forces with these coefficients are about as smooth as the overlaps, a bit each; those are from `least` to `most` at
    /// both ends and between.
    #[inline(always)]
    fn smooth<L: Lanes>(
        &self,
        contacts: &[Constants<L>; CONTACTS],
        coefficients: &[Row; COEFFICIENTS],
        [least, most]: [[L::V; CONTACTS]; 2],
    ) -> u8 {
        let (mut steps, mut allowed) = (u8::MAX, L::splat(0.0));
        for which in 0..CONTACTS {
            let stiffness = contacts[which].stiffness;
            let tangent = L::mul(L::mul(L::splat(1.5), stiffness), L::sqrt(most[which]));
            let [.., sixth, seventh] = &self.seen.overlaps[which];
            // In the fraction of a step: half as much to either side of its middle.
            let (sixth, seventh) = (L::load(sixth), L::load(seventh));
            let sixth = L::mul_add(L::splat(3.5), seventh, sixth);
            let highest = highest::<L>([0.5_f64.powi(6), 0.5_f64.powi(7)], [sixth, seventh]);
            allowed = L::mul_add(tangent, highest, allowed);
            let [stiffness, _, weight] = self.place.lane_constants(which);
            if stiffness * weight != 0.0 {
                steps &= L::positive(L::sub(L::add(least[which], least[which]), most[which]));
            }
        }
        let [.., sixth, seventh] = coefficients;
        let found = highest::<L>([1.0, 1.0], [L::load(sixth), L::load(seventh)]);
        steps & L::positive(L::sub(L::mul(L::splat(ROUGHER), allowed), found))
    }
}

/// The polynomials with these coefficients at `at`.
#[inline(always)]
fn horner_row<L: Lanes>(coefficients: &[Row; COEFFICIENTS], at: f64) -> L::V {
    let mut value = L::load(&coefficients[COEFFICIENTS - 1]);
    for power in (0..COEFFICIENTS - 1).rev() {
        value = L::mul_add(value, L::splat(at), L::load(&coefficients[power]));
    }
    value
}

/// The polynomial with these coefficients in lane `lane`, at eight places.
#[inline(always)]
fn in_lane<L: Lanes>(coefficients: &[Row; COEFFICIENTS], lane: usize, at: L::V) -> L::V {
    let mut value = L::splat(coefficients[COEFFICIENTS - 1].0[lane]);
    for power in (0..COEFFICIENTS - 1).rev() {
        value = L::mul_add(value, at, L::splat(coefficients[power].0[lane]));
    }
    value
}

/// How large the two highest Chebyshev polynomials are in what has these highest coefficients, over `scales`.
#[inline(always)]
fn highest<L: Lanes>(scales: [f64; 2], [sixth, seventh]: [L::V; 2]) -> L::V {
    let sixth = L::mul(L::splat(scales[0] / 32.0), L::abs(sixth));
    L::mul_add(L::splat(scales[1] / 64.0), L::abs(seventh), sixth)
}

impl Task for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        if self.form == Form::Plain {
            self.rows::<L, true>();
        } else {
            self.rows::<L, false>();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
    use crate::chain::stepper::force_track::septic;
    use crate::chain::stepper::lanes::Baseline;
    use crate::chain::{Body, Chain, ChainSpec, EffectsSpec, Elasticity, End, ForceProbe};

    const MANY_SAMPLES: usize = 64;

    /// A probe in the middle of five spheres that a force presses.
    fn probe() -> ForceProbe {
        let elasticity = Elasticity { youngs_modulus: 1.46e9, poissons_ratio: 0.46 };
        let sphere = Body {
            name: "sphere".into(),
            mass: 0.12e-3,
            length: 4.76e-3,
            curvature: 1.0 / 2.38e-3,
            elasticity,
            yield_strength: None,
        };
        let spec = ChainSpec {
            striker: None,
            particles: vec![sphere; 5],
            top: End::Force(2.4),
            bottom: End::Wall(elasticity),
            wall_preload: 0.0,
            effects: EffectsSpec::default(),
        };
        let chain = Chain::new(&spec).expect("a chain");
        ForceProbe::inside(&chain, 3, 0.0).expect("a particle")
    }

    /// How far ahead in phase the second contact is (1).
    const AHEAD: f64 = 0.4;

    /// Steps of a wave that presses contacts by `1 + amplitude sin(phase)` of what they bear at rest, one each eighth of a turn.
    fn wave(probe: &ForceProbe, amplitude: f64, turn: f64) -> Seen {
        let still = probe.contacts()[0].static_overlap;
        let mut seen = Seen::default();
        let felt = [0.0, turn].map(|since| felt(probe, amplitude, turn, since));
        seen.begin::<Baseline>((Row::default(), &Row([1.0; WIDTH])), felt[1]);
        seen.before = felt[0].map(Row);
        for which in 0..CONTACTS {
            let mut ends = [[[0.0; WIDTH]; 4]; 2];
            for (end, derivatives) in ends.iter_mut().enumerate() {
                for (order, values) in (0_u8..4).zip(derivatives) {
                    for (lane, value) in (0_u8..).zip(values) {
                        let at = phase(lane, which, turn * if end == 0 { 0.0 } else { 1.0 });
                        let quarter = f64::from(order) * std::f64::consts::FRAC_PI_2;
                        let scale = still * amplitude * turn.powi(i32::from(order));
                        *value = scale * (at + quarter).sin();
                    }
                }
            }
            let coefficients = septic::<Baseline>(ends, [1.0; WIDTH]);
            seen.overlaps[which] = coefficients.map(Row);
        }
        seen
    }

    fn phase(lane: u8, which: usize, since: f64) -> f64 {
        let ahead = if which == 0 { 0.0 } else { AHEAD };
        f64::from(lane) * std::f64::consts::FRAC_PI_4 + ahead + since
    }

    /// Force (N) and its rate of change over a step (N) in each of them, where the phase has gone on by `since`.
    fn felt(probe: &ForceProbe, amplitude: f64, turn: f64, since: f64) -> [[f64; WIDTH]; 2] {
        let (mut force, mut rate) = ([0.0; WIDTH], [0.0; WIDTH]);
        for (lane, (force, rate)) in (0_u8..).zip(force.iter_mut().zip(&mut rate)) {
            for (which, contact) in probe.contacts().iter().enumerate() {
                let at = phase(lane, which, since);
                let overlap = (1.0 + amplitude * at.sin()).max(0.0);
                let weight = probe.weights()[which] * contact.static_force;
                *force += weight * (overlap.powf(1.5) - 1.0);
                *rate += weight * 1.5 * overlap.sqrt() * amplitude * turn * at.cos();
            }
        }
        [force, rate]
    }

    /// The forces at so many times in each of eight steps, `at_once` at a time (N).
    fn sampled(set: InstructionSet, place: &Place, seen: &Seen, at_once: usize) -> Vec<Vec<f64>> {
        let mut steps = vec![Vec::new(); WIDTH];
        let fraction = |count: usize| f64::from(u8::try_from(count).expect("few")) / 64.0;
        for before in (0..MANY_SAMPLES).step_by(at_once) {
            let due = Due {
                counts: [at_once; WIDTH],
                first: [fraction(before); WIDTH],
                interval: [fraction(1); WIDTH],
            };
            let mut out = Vec::new();
            dispatch(set, Sample { place, seen, form: Form::Plain, due: &due, out: &mut out });
            for (step, forces) in steps.iter_mut().zip(out.chunks(at_once)) {
                step.extend_from_slice(forces);
            }
        }
        steps
    }

    /// Against the wave itself: what a polynomial adds to the error of the overlaps, which are polynomials, too, is of its size, and where contacts
    /// open it is not taken.
    #[test]
    fn forces_as_polynomials_are_as_good_as_the_overlaps() {
        let probe = probe();
        let place = Place::new(&probe);
        for set in InstructionSet::available() {
            let (mut taken, mut steps) = (0, 0);
            for amplitude in [0.05, 0.2, 0.5, 0.7, 0.9, 1.5] {
                for turn in [0.25, 0.5, 1.0, 1.5, 2.0] {
                    let seen = wave(&probe, amplitude, turn);
                    let many = sampled(set, &place, &seen, MANY_SAMPLES);
                    let few = sampled(set, &place, &seen, WIDTH);
                    for (lane, (many, few)) in (0_u8..).zip(many.iter().zip(&few)) {
                        let (mut added, mut own, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
                        let mut opens = false;
                        for (sample, (a, b)) in (0_u8..).zip(many.iter().zip(few)) {
                            let since = turn * f64::from(sample) / 64.0;
                            let [force, _] = felt(&probe, amplitude, turn, since);
                            let exact = force[usize::from(lane)];
                            let overlap = |which| 1.0 + amplitude * phase(lane, which, since).sin();
                            opens |= (0..CONTACTS).any(|which| overlap(which) <= 0.0);
                            added = added.max((a - b).abs());
                            own = own.max((b - exact).abs());
                            largest = largest.max(exact.abs());
                        }
                        let named = format!("{amplitude} {turn} {lane}: {added:e} and {own:e}");
                        assert!(added <= 10.0 * own + 1e-13 * largest, "{named}");
                        assert!(!opens || added == 0.0, "{named}");
                        taken += u32::from(added > 0.0);
                        steps += 1;
                    }
                }
            }
            // Elsewhere overlaps change too much, or contacts open.
            assert!(3 * taken > steps, "{taken} of {steps}");
        }
    }
}
