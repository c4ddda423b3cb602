//! One contact that changes sides in a step of one chain, by itself: the pair's nodes stand side by side instead of contacts, and all else is
//! done in single numbers, which are there sooner. Mostly it is one, or a few that do not wait for each other.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::{BY_UNIT, Cut};
use super::known::{Known, Position, PositionError, Velocity, VelocityError, Weights};
use super::lanes::{Lanes, Row, WIDTH};
use super::quintics::{ROOT_NODES, ROOT_RESIDUE, SEARCH_STEPS, power};
use super::workspace::Motion;

/// Where a contact and the body below it stand, and the body above; none at the top.
#[derive(Clone, Copy)]
pub struct Place {
    at: (usize, usize),
    above: Option<(usize, usize)>,
}

impl Place {
    /// Of the contact in lane `lane` of row `row`.
    #[inline(always)]
    pub fn new(row: usize, lane: usize) -> Self {
        let above = match lane.checked_sub(1) {
            Some(lane) => Some((row, lane)),
            None => row.checked_sub(1).map(|row| (row, WIDTH - 1)),
        };
        Self { at: (row, lane), above }
    }

    /// What `rows` have here.
    #[inline(always)]
    fn here(self, rows: &[Row]) -> f64 {
        rows[self.at.0].0[self.at.1 % WIDTH]
    }

    /// What `rows` have above.
    #[inline(always)]
    fn above(self, rows: &[Row]) -> f64 {
        self.above.map_or(0.0, |(row, lane)| rows[row].0[lane % WIDTH])
    }

    /// What a push of the contact moves below and above it: inverse masses, with a minus above (1/kg).
    #[inline(always)]
    pub fn mobility(self, plan: Cut) -> [f64; 2] {
        [self.here(plan.inverse_mass), -self.above(plan.inverse_mass)]
    }

    /// How much more the body above has than the one below.
    #[inline(always)]
    fn difference(self, rows: &[Row]) -> f64 {
        self.above(rows) - self.here(rows)
    }

    /// Overlap, closing speed and relative acceleration at one end of a step of `h` (s), as [`Ends`] has them.
    #[inline(always)]
    fn end(self, plan: Cut, motion: &Motion, h: f64) -> [f64; 3] {
        [
            self.here(plan.static_overlap) + self.difference(motion.position()),
            h * self.difference(motion.velocity()),
            h * h * self.difference(motion.acceleration()),
        ]
    }

    /// Adds to `rows` here and above.
    #[inline(always)]
    pub fn add<L: Lanes>(self, rows: &mut [Row], [here, above]: [f64; 2]) {
        let none = L::splat(0.0);
        let (row, lane) = self.at;
        let mut sum = L::select(1 << (lane % WIDTH), L::splat(here), none);
        match self.above {
            Some((row_above, lane)) if row_above == row => {
                sum = L::select(1 << (lane % WIDTH), L::splat(above), sum);
            }
            Some((row, lane)) => {
                let sum = L::select(1 << (lane % WIDTH), L::splat(above), none);
                L::store(L::add(L::load(&rows[row]), sum), &mut rows[row]);
            }
            None => {}
        }
        L::store(L::add(L::load(&rows[row]), sum), &mut rows[row]);
    }
}

/// Overlap, closing speed and relative acceleration of a contact, times 1, `h` and `h^2` (m), at both ends of a step.
type Ends = [[f64; 3]; 2];

/// Of the contact at `place` in a step of `h` (s).
#[inline(always)]
fn ends(plan: Cut, place: Place, [from, to]: [&Motion; 2], h: f64) -> Ends {
    [place.end(plan, from, h), place.end(plan, to, h)]
}

/// A quintic in the fraction of the step.
struct Quintic {
    coefficients: [f64; 6],
}

impl Quintic {
    /// Through `ends`.
    #[inline(always)]
    fn new([[p0, w0, g0], [p1, w1, g1]]: Ends) -> Self {
        let square = 0.5 * g0;
        let p = p1 - p0 - (w0 + square);
        let q = (w1 - w0) - g0;
        let r = 0.5 * (g1 - g0);
        let coefficients = [
            p0,
            w0,
            square,
            (10.0 * p - 4.0 * q) + r,
            (7.0 * q - 15.0 * p) - (r + r),
            (6.0 * p - 3.0 * q) + r,
        ];
        Self { coefficients }
    }

    /// In pairs of terms: none waits for more than three others.
    #[inline(always)]
    fn at<L: Lanes>(&self, t: f64) -> f64 {
        let (c, square) = (&self.coefficients, t * t);
        let pair = |n: usize| L::fused(c[n + 1], t, c[n]);
        L::fused(L::fused(pair(4), square, pair(2)), square, pair(0))
    }

    /// The same at eight times.
    #[inline(always)]
    fn at_all<L: Lanes>(&self, t: L::V) -> L::V {
        let (c, square) = (self.coefficients.map(L::splat), L::mul(t, t));
        let (low, middle) = (L::mul_add(c[1], t, c[0]), L::mul_add(c[3], t, c[2]));
        let high = L::mul_add(c[5], t, c[4]);
        L::mul_add(L::mul_add(high, square, middle), square, low)
    }

    /// A step of Halley's method from `t`, as [`super::quintics::Quintics`] has it.
    #[inline(always)]
    fn nearer<L: Lanes>(&self, t: f64) -> f64 {
        let (c, square) = (&self.coefficients, t * t);
        let low = L::fused(L::fused(3.0 * c[3], t, 2.0 * c[2]), t, c[1]);
        let slope = L::fused(L::fused(5.0 * c[5], t, 4.0 * c[4]), square * t, low);
        let low = L::fused(3.0 * c[3], t, c[2]);
        let half_bend = L::fused(L::fused(10.0 * c[5], t, 6.0 * c[4]), square, low);
        let value = self.at::<L>(t);
        t - value * slope / (slope * slope - value * half_bend)
    }

    /// Where it changes sign between `ends` (1).
    #[inline(always)]
    fn root<L: Lanes>(&self, [[start, early, _], [end, late, _]]: Ends) -> f64 {
        let rise = end - start;
        let (done, left) = (-start / rise, end / rise);
        let (early, late) = (rise / early - 1.0, 1.0 - rise / late);
        let bend = L::fused(early, left, late * done);
        let guess = L::fused(done * left, bend, done);
        // Where that is not a number, the search begins at the start.
        let nearer = self.nearer::<L>(guess);
        let mut root = if nearer > 0.0 { nearer.min(1.0) } else { 0.0 };
        let allowed = ROOT_RESIDUE * (start.abs() + end.abs());
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..SEARCH_STEPS {
            let value = self.at::<L>(root);
            if value.abs() < allowed {
                break;
            }
            if (value > 0.0) == (end > 0.0) {
                high = root;
            } else {
                low = root;
            }
            let next = self.nearer::<L>(root);
            root = if next > low && next < high { next } else { 0.5 * (low + high) };
        }
        root
    }
}

/// The lane of stage `stage`: stages at the same node share one, for a pair may have nine of which two are.
const fn lane_of<P: Known<N>, const N: usize>(stage: usize) -> usize {
    let (mut lane, mut i) = (0, 1);
    while i <= stage {
        if P::PAIR.nodes[i].to_bits() != P::PAIR.nodes[i - 1].to_bits() {
            lane += 1;
        }
        i += 1;
    }
    lane
}

/// Nodes of a pair, each in its lane; the first in those left over (1).
struct Nodes<P, const N: usize>(P);

impl<P: Known<N>, const N: usize> Nodes<P, N> {
    const AT: Row = {
        let (mut row, mut i) = ([0.0; WIDTH], 0);
        while i < N {
            row[lane_of::<P, N>(i)] = P::PAIR.nodes[i];
            i += 1;
        }
        Row(row)
    };
}

/// What is weighed there; nothing in the lanes left over (1).
struct Beside<W, P, const N: usize>(W, P);

impl<W: Weights, P: Known<N>, const N: usize> Beside<W, P, N> {
    const OF: Row = {
        let (mut row, mut i) = ([0.0; WIDTH], 0);
        while i < N {
            row[lane_of::<P, N>(i)] += W::OF[i];
            i += 1;
        }
        Row(row)
    };
}

/// Nodes of the quadrature from the root on, their inverses and weights; none in the lanes left over (1).
const ROOTS: [Row; 3] = {
    let mut rows = [Row([1.0; WIDTH]), Row([1.0; WIDTH]), Row([0.0; WIDTH])];
    let mut i = 0;
    while i < ROOT_NODES.len() {
        let (node, weight) = ROOT_NODES[i];
        rows[0].0[i] = node;
        rows[1].0[i] = 1.0 / node;
        rows[2].0[i] = weight;
        i += 1;
    }
    rows
};

/// What is missing, as [`super::quintics::missing`] has it: impulse and moment, their errors, and the impulse's uncertainty (m^1.5).
#[inline(always)]
fn missing<L: Lanes, P: Known<N>, const N: usize>(ends: Ends) -> [f64; 5] {
    let (quintic, [start, end]) = (Quintic::new(ends), ends);
    // The quadrature first: it does not wait for the root.
    let one = L::splat(1.0);
    let found = power::<L>(BY_UNIT, quintic.at_all::<L>(L::load(&Nodes::<P, N>::AT)));
    let weighed = |row: Row| L::mul(found, L::load(&row));
    let errors = [
        L::sum(weighed(Beside::<VelocityError<P, N>, P, N>::OF)),
        L::sum(weighed(Beside::<PositionError<P, N>, P, N>::OF)),
    ];
    let (impulse, moment) =
        (weighed(Beside::<Velocity<P, N>, P, N>::OF), weighed(Beside::<Position<P, N>, P, N>::OF));
    let root = quintic.root::<L>(ends);
    // The closed part, which reaches from the root to the end of the step where the contact is closed there, or to its start.
    let length = if end[0] > 0.0 { 1.0 - root } else { -root };
    let [node, inverse, weight] = &ROOTS;
    let t = L::mul_add(L::load(node), L::splat(length), L::splat(root));
    // The root is taken out, what remains is smooth.
    let whole = power::<L>(BY_UNIT, L::mul(L::load(inverse), quintic.at_all::<L>(t)));
    let whole = L::mul(whole, L::mul(L::load(weight), L::splat(length.abs())));
    let impulse = L::sum(L::sub(whole, impulse));
    let moment = L::sum(L::sub(L::mul(whole, L::sub(one, t)), moment));
    let depth = start[0].max(end[0]).max(0.0).sqrt();
    [impulse, moment, errors[0], errors[1], 1.5 * depth * doubt(ends)]
}

/// As [`super::quintics`] has it.
#[inline(always)]
fn doubt([[p0, w0, g0], [p1, w1, g1]]: Ends) -> f64 {
    let rise = p1 - p0;
    let square = 3.0 * rise - 2.0 * w0 - w1;
    let cube = w0 + w1 - 2.0 * rise;
    let early = g0 - 2.0 * square;
    let late = g1 - 2.0 * square - 6.0 * cube;
    (early + late).abs() / 64.0
}

/// What the quadrature has missed at one contact.
#[derive(Clone, Copy)]
pub struct Lone {
    /// Moment of the impulse (N s²), the impulse (N s), and with a minus what they have put into the error estimates of positions and velocities (unit).
    pub pushes: [f64; 4],
    /// How uncertain the impulse is (N s).
    pub uncertainty: f64,
}

impl Lone {
    /// Of the contact at `place`, in a step of `h` (s) from one of `motions` to the other.
    #[inline(always)]
    pub fn new<L: Lanes, P: Known<N>, const N: usize>(
        (plan, place): (Cut, Place),
        motions: [&Motion; 2],
        h: f64,
    ) -> Self {
        let [impulse, moment, velocity, position, uncertainty] =
            missing::<L, P, N>(ends(plan, place, motions, h));
        let whole = h * place.here(plan.stiffness);
        let square = h * whole;
        let pushes = [square * moment, whole * impulse, -square * position, -whole * velocity];
        Self { pushes, uncertainty: whole * uncertainty }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chain::stepper::dispatch::{InstructionSet, dispatch};
    use crate::chain::stepper::known::{Pair64, Pair86};
    use crate::chain::stepper::lanes::Task;
    use crate::chain::stepper::quintics;

    /// Contacts that close and open, early and late, bent this way and that.
    fn all() -> [Ends; WIDTH] {
        let path = |root: f64, speed: f64, bend: f64| -> Ends {
            let at = |t: f64| {
                let s = t - root;
                [
                    s * (speed + s * (bend + 0.1 * s * s)),
                    speed + s * (2.0 * bend + 0.4 * s * s),
                    2.0 * bend + 1.2 * s * s,
                ]
            };
            [at(0.0), at(1.0)]
        };
        [
            path(0.2, 1.0, 0.1),
            path(0.5, -1.0, 0.3),
            path(0.8, 2.0, -1.0),
            path(0.01, -3.0, 1.0),
            path(0.99, 1.0, 0.0),
            path(0.4, -0.3, -0.05),
            path(0.3, 1e-6, 1e-7),
            path(0.6, -20.0, 5.0),
        ]
    }

    struct Both;

    impl Task for Both {
        type Output = [[[Row; 5]; 2]; 2];

        fn run<L: Lanes>(self) -> Self::Output {
            [of::<L, Pair64, 6>(), of::<L, Pair86, 9>()]
        }
    }

    /// What is missing at each contact by itself, and at all of them side by side.
    fn of<L: Lanes, P: Known<N>, const N: usize>() -> [[Row; 5]; 2] {
        let mut found = [[Row::default(); 5]; 2];
        let mut rows = [[Row::default(); 3]; 2];
        for (lane, ends) in all().into_iter().enumerate() {
            for (row, value) in found[0].iter_mut().zip(missing::<L, P, N>(ends)) {
                row.0[lane] = value;
            }
            for (row, value) in rows.as_flattened_mut().iter_mut().zip(ends.as_flattened()) {
                row.0[lane] = *value;
            }
        }
        let ends = rows.map(|rows| rows.map(|row| L::load(&row)));
        let together = quintics::missing::<L, P, N>(ends, u8::MAX);
        let [velocity, position] = together.errors;
        let values = [together.impulse, together.moment, velocity, position, together.uncertainty];
        for (row, value) in found[1].iter_mut().zip(values) {
            L::store(value, row);
        }
        found
    }

    /// As far as [`ROOT_RESIDUE`] lets the roots be off.
    #[test]
    fn a_contact_by_itself_is_as_among_others() {
        for set in InstructionSet::available() {
            for (pair, [alone, together]) in dispatch(set, Both).into_iter().enumerate() {
                for lane in 0..WIDTH {
                    let [[start, ..], [end, ..]] = all()[lane];
                    let whole = start.max(end).powf(1.5);
                    for which in 0..5 {
                        let [alone, together] = [&alone, &together].map(|of| of[which].0[lane]);
                        let off = (alone - together).abs() / whole;
                        let what =
                            format!("{}, pair {pair}, contact {lane}, value {which}", set.name());
                        assert!(off < 2.0 * ROOT_RESIDUE, "{what}: {alone} and {together}");
                        assert!(together != 0.0, "{what}");
                    }
                }
            }
        }
    }

    /// Changes go to the bodies on both sides of a contact, also where they stand in two rows, or where there is one only.
    #[test]
    fn bodies_on_both_sides_are_changed() {
        struct Added(usize, usize);
        impl Task for Added {
            type Output = [Row; 2];

            fn run<L: Lanes>(self) -> [Row; 2] {
                let mut rows = [Row([1.0; WIDTH]); 2];
                Place::new(self.0, self.1).add::<L>(&mut rows, [10.0, 20.0]);
                rows
            }
        }
        for set in InstructionSet::available() {
            for index in 0..2 * WIDTH {
                let rows = dispatch(set, Added(index / WIDTH, index % WIDTH));
                for (body, found) in rows.iter().flat_map(|row| row.0).enumerate() {
                    let change = if body == index {
                        10.0
                    } else if body + 1 == index {
                        20.0
                    } else {
                        0.0
                    };
                    assert_eq!(found.to_bits(), f64::to_bits(1.0 + change), "{index}, {body}");
                }
            }
        }
    }
}
