//! The force at one place at evenly spaced times, in eight steps on end.
//!
//! Each sample takes the powers of two overlaps, which are septics in time. Where a step holds many samples, the force itself is made such a
//! polynomial first, through its values at the eight Chebyshev points of the step. That is done where it adds about as little as what the
//! septics are off already: where of the largest overlap at least half is left at the smallest, so that no contact is near its opening, and
//! where the two highest Chebyshev polynomials of the force are no larger than four times what those of the overlaps make, each times the
//! contact's tangent stiffness. In waves of any amplitude that adds at most ten times the septics' own error, which a test
//! holds. Source: L. N. Trefethen, Approximation Theory and Approximation Practice, SIAM (2013),
//! chapters 3, 4 and 8.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::chebyshev::{FROM_POINTS, POINTS, cosine};
use super::force_track::{COEFFICIENTS, CONTACTS, Place, lane_forces};
use super::forces::begin_plain;
use super::lanes::{Lanes, Row, Task, WIDTH};
use super::plan::Form;
use super::seen::Seen;

/// Room behind samples: they are written in rows.
pub const ROOM_BEHIND: usize = WIDTH;
/// Samples in a step from which on it takes less to make the force a polynomial.
const MANY: usize = 2 * WIDTH + 1;
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
    /// Dynamic forces, one a sample, with room for a row behind them (N).
    pub out: &'a mut [f64],
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
        let power = begin_plain::<L>(which, overlap).power(which);
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
        let rest = begin_plain::<L>(which, still).power(which);
        Constants { stiffness: L::splat(stiffness * weight), still, rest }
    }

    /// The samples in all steps, in plain form or not.
    #[inline(always)]
    fn rows<L: Lanes, const IS_PLAIN: bool>(mut self) {
        let contacts = [self.constants::<L>(0), self.constants::<L>(1)];
        let polynomials = if IS_PLAIN { self.polynomials::<L>(&contacts) } else { None };
        let count = L::load(&Row([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
        let mut out = std::mem::take(&mut self.out);
        for lane in 0..WIDTH {
            let (first, interval) = (self.due.first[lane], self.due.interval[lane]);
            let mut left = self.due.counts[lane];
            let polynomial = match &polynomials {
                Some(of) if of.steps & (1 << lane) != 0 => Some(&of.coefficients),
                _ => None,
            };
            let mut start = 0.0;
            while left > 0 {
                let index = L::add(L::splat(start), count);
                let theta = L::mul_add(index, L::splat(interval), L::splat(first));
                let force = match polynomial {
                    Some(coefficients) => in_lane::<L>(coefficients, lane, from_middle::<L>(theta)),
                    None => self.force::<L, IS_PLAIN>(&contacts, lane, theta),
                };
                let mut row = Row::default();
                L::store(force, &mut row);
                // Whole rows are written; what is too much is written over by the next.
                out[..WIDTH].copy_from_slice(&row.0);
                let taken = left.min(WIDTH);
                out = &mut out[taken..];
                left -= taken;
                start += 8.0;
            }
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
        let (mut near, mut far) = ([L::splat(0.0); POINTS], [L::splat(0.0); POINTS]);
        let (mut least, mut most) =
            ([L::splat(f64::INFINITY); CONTACTS], [L::splat(0.0); CONTACTS]);
        for k in 0..POINTS {
            for (side, forces) in [(1.0, &mut far), (-1.0, &mut near)] {
                let theta = L::splat(0.5 + 0.5 * side * cosine(2 * k + 1));
                for which in 0..CONTACTS {
                    let rows = &self.seen.overlaps[which];
                    let mut change = L::load(&rows[COEFFICIENTS - 1]);
                    for power in (0..COEFFICIENTS - 1).rev() {
                        change = L::mul_add(change, theta, L::load(&rows[power]));
                    }
                    let overlap = L::add(contacts[which].still, change);
                    (least[which], most[which]) =
                        (L::min(least[which], overlap), L::max(most[which], overlap));
                    forces[k] = contacts[which].plain_force(which, overlap, forces[k]);
                }
            }
        }
        let mut coefficients = <[Row; COEFFICIENTS]>::default();
        for power in 0..COEFFICIENTS {
            let mut sum = L::splat(0.0);
            for k in 0..POINTS {
                let both =
                    if power % 2 == 0 { L::add(far[k], near[k]) } else { L::sub(far[k], near[k]) };
                sum = L::mul_add(L::splat(FROM_POINTS[power][k]), both, sum);
            }
            L::store(sum, &mut coefficients[power]);
        }
        let steps = self.smooth::<L>(contacts, &coefficients, [least, most]);
        Some(Polynomials { coefficients, steps })
    }

    /// The steps in which the forces with these coefficients are about as smooth as the overlaps, a bit each; those are from `least` to `most` at
    /// the Chebyshev points.
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

/// Fractions of a step as places in it, from -1 at its start to 1 at its end (1).
#[inline(always)]
fn from_middle<L: Lanes>(theta: L::V) -> L::V {
    L::mul_add(L::splat(2.0), theta, L::splat(-1.0))
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
    fn wave(still: f64, amplitude: f64, turn: f64) -> Seen {
        let mut seen = Seen::nothing();
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
            let mut out = vec![0.0; WIDTH * at_once + ROOM_BEHIND];
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
        let still = probe.contacts()[0].static_overlap;
        for set in InstructionSet::available() {
            let (mut taken, mut steps) = (0, 0);
            for amplitude in [0.05, 0.2, 0.5, 0.7, 0.9, 1.5] {
                for turn in [0.25, 0.5, 1.0, 1.5, 2.0] {
                    let seen = wave(still, amplitude, turn);
                    let many = sampled(set, &place, &seen, MANY_SAMPLES);
                    let few = sampled(set, &place, &seen, WIDTH);
                    for (lane, (many, few)) in (0_u8..).zip(many.iter().zip(&few)) {
                        let (mut added, mut own, mut largest) = (0.0_f64, 0.0_f64, 0.0_f64);
                        let mut opens = false;
                        for (sample, (a, b)) in (0_u8..).zip(many.iter().zip(few)) {
                            let since = turn * f64::from(sample) / 64.0;
                            let mut exact = 0.0;
                            for (which, contact) in probe.contacts().iter().enumerate() {
                                let overlap = 1.0 + amplitude * phase(lane, which, since).sin();
                                opens |= overlap <= 0.0;
                                let force = overlap.max(0.0).powf(1.5) - 1.0;
                                exact += probe.weights()[which] * contact.static_force * force;
                            }
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
