//! The force at one place over one step: the overlaps of two neighbouring contacts as polynomials in time.
//!
//! Each overlap is the septic through its value and its first three derivatives at both ends of the step; the error goes as the
//! step to the power 8 with the constant `1/(8! 2^8)`. Source: C. Hermite, J. reine angew. Math. 84, 70 (1878).
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::forces::begin_plain;
use super::lanes::{Lanes, Row, Task, WIDTH};
use super::plan::Form;
use crate::chain::hertz::force_and_tangent;
use crate::chain::{Contact, ForceProbe, Law};

/// Coefficients of a septic.
pub const COEFFICIENTS: usize = 8;
/// Contacts that a place feels.
pub const CONTACTS: usize = 2;
/// Samples are taken so many at a time.
pub const SAMPLED_AT_ONCE: usize = WIDTH;
/// Places within a step at which a force is looked at.
pub const LOOKS: usize = WIDTH / CONTACTS;

/// A place between two contacts, which feels both.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    contacts: [Contact; CONTACTS],
    /// Square roots of the static overlaps (m^0.5).
    static_roots: [f64; CONTACTS],
    weights: [f64; CONTACTS],
}

/// How a place's contacts move over one step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Span {
    /// Start of the step (s).
    pub start: f64,
    /// Length of the step (s).
    pub length: f64,
    /// Overlap changes as polynomials in the fraction of the step (m).
    overlaps: [[f64; COEFFICIENTS]; CONTACTS],
}

/// A force at evenly spaced places within a step, its end the last.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Looks {
    /// Dynamic force (N).
    pub forces: [f64; LOOKS],
    /// Its rate of change (N/s).
    pub rates: [f64; LOOKS],
}

impl Span {
    /// Takes the overlap change of contact `which` over a step from value and derivatives at its ends (m, m/s, m/s², m/s³).
    #[inline(always)]
    pub fn set(&mut self, which: usize, (start, length): (f64, f64), ends: [[f64; 4]; 2]) {
        (self.start, self.length) = (start, length);
        self.overlaps[which] = septic(ends, length);
    }
}

impl Place {
    /// The place of `probe`.
    #[must_use]
    pub fn new(probe: &ForceProbe) -> Self {
        Self {
            contacts: *probe.contacts(),
            static_roots: probe.contacts().map(|contact| contact.static_overlap.sqrt()),
            weights: *probe.weights(),
        }
    }

    /// Dynamic force (N) and its rate of change (N/s) for changes of the overlaps (m) and their rates (m/s).
    #[must_use]
    #[inline]
    pub fn feel(&self, overlaps: [[f64; 2]; CONTACTS]) -> (f64, f64) {
        let (mut force, mut rate) = (0.0, 0.0);
        for (which, [change, closing]) in overlaps.into_iter().enumerate() {
            let contact = &self.contacts[which];
            let (felt, tangent) = match contact.law {
                Law::Hertz => {
                    force_and_tangent(contact.stiffness, self.static_roots[which], change)
                }
                Law::Linearised => (contact.force_change(change), contact.static_stiffness()),
            };
            force += self.weights[which] * felt;
            rate += self.weights[which] * tangent * closing;
        }
        (force, rate)
    }

    /// Dynamic force at the fraction `theta` of a step (N).
    #[must_use]
    pub fn force(&self, span: &Span, theta: f64) -> f64 {
        let [above, below] = &span.overlaps;
        self.feel([[horner(above, theta), 0.0], [horner(below, theta), 0.0]]).0
    }

    /// Its rate of change there (N/s).
    #[must_use]
    pub fn rate(&self, span: &Span, theta: f64) -> f64 {
        let [above, below] = &span.overlaps;
        let above = [horner(above, theta), slope(above, theta) / span.length];
        let below = [horner(below, theta), slope(below, theta) / span.length];
        self.feel([above, below]).1
    }

    /// Stiffness and static root of a contact as the lanes need them.
    #[inline(always)]
    fn constants(&self, which: usize) -> [f64; 2] {
        let contact = &self.contacts[which];
        match contact.law {
            Law::Hertz => [contact.stiffness, self.static_roots[which]],
            Law::Linearised => [contact.static_stiffness(), 0.0],
        }
    }

    /// Stiffness, static root and weight of contact `which` (unit).
    pub fn lane_constants(&self, which: usize) -> [f64; 3] {
        let [stiffness, static_root] = self.constants(which);
        [stiffness, static_root, self.weights[which]]
    }

    /// The law of both contacts; an open end has none.
    #[inline(always)]
    fn law(&self) -> Law {
        let [above, below] = &self.contacts;
        if above.stiffness > 0.0 { above.law } else { below.law }
    }
}

/// Coefficients of the septic through value and three derivatives at both ends of a step of `h` (s), in the fraction of the step (m).
#[inline(always)]
#[allow(clippy::many_single_char_names, reason = "the letters of the derivatives")]
pub fn septic([from, to]: [[f64; 4]; 2], h: f64) -> [f64; COEFFICIENTS] {
    let (square, cube) = (h * h, h * h * h);
    let [x, v, a, j] = [from[0], h * from[1], 0.5 * square * from[2], cube * from[3] / 6.0];
    // What the cubic Taylor polynomial of the start leaves over at the end, derivative by derivative.
    let p = to[0] - x - v - a - j;
    let q = h * to[1] - v - 2.0 * a - 3.0 * j;
    let r = square * to[2] - 2.0 * a - 6.0 * j;
    let s = cube * to[3] - 6.0 * j;
    [
        x,
        v,
        a,
        j,
        35.0 * p - 15.0 * q + 2.5 * r - s / 6.0,
        -84.0 * p + 39.0 * q - 7.0 * r + 0.5 * s,
        70.0 * p - 34.0 * q + 6.5 * r - 0.5 * s,
        -20.0 * p + 10.0 * q - 2.0 * r + s / 6.0,
    ]
}

/// The polynomial `c` at `t` (m).
#[inline(always)]
pub fn horner(c: &[f64; COEFFICIENTS], t: f64) -> f64 {
    c.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

#[inline(always)]
fn slope(c: &[f64; COEFFICIENTS], t: f64) -> f64 {
    let mut sum = 0.0;
    for (power, c) in (1_u8..8).zip(&c[1..]).rev() {
        sum = sum * t + f64::from(power) * c;
    }
    sum
}

/// `hertz::force_change` and the tangent stiffness in eight places; linear where `law` says so.
#[inline(always)]
pub fn lane_forces<L: Lanes>(contact: [L::V; 2], change: L::V, law: Law) -> (L::V, L::V) {
    let [stiffness, static_root] = contact;
    if law == Law::Linearised {
        return (L::mul(stiffness, change), stiffness);
    }
    let static_overlap = L::mul(static_root, static_root);
    let change = L::max(change, L::sub(L::splat(0.0), static_overlap));
    let root = L::sqrt(L::max(L::add(static_overlap, change), L::splat(0.0)));
    let sum = L::add(root, static_root);
    let divisor = L::max(sum, L::splat(f64::MIN_POSITIVE));
    let rest = L::sub(sum, L::div(L::mul(root, static_root), divisor));
    let force = L::mul(L::mul(stiffness, change), rest);
    (force, L::mul(L::mul(L::splat(1.5), stiffness), root))
}

impl Place {
    /// The force in [`LOOKS`] places: both contacts side by side.
    #[inline(always)]
    pub fn looks<L: Lanes>(&self, span: &Span) -> Looks {
        let both = |pair: [f64; CONTACTS]| {
            let mut row = Row::default();
            for (i, value) in row.0.iter_mut().enumerate() {
                *value = pair[i / LOOKS];
            }
            L::load(&row)
        };
        let theta = Row([0.25, 0.5, 0.75, 1.0, 0.25, 0.5, 0.75, 1.0]);
        let theta = L::load(&theta);
        let (mut change, mut rate) = (both([0.0; 2]), both([0.0; 2]));
        for power in (0..COEFFICIENTS).rev() {
            rate = L::mul_add(rate, theta, change);
            change = L::mul_add(change, theta, both(span.overlaps.map(|c| c[power])));
        }
        let [first, second] = [self.constants(0), self.constants(1)];
        let constants = [both([first[0], second[0]]), both([first[1], second[1]])];
        let (force, tangent) = lane_forces::<L>(constants, change, self.law());
        let weights = both(self.weights);
        let (mut forces, mut rates) = (Row::default(), Row::default());
        L::store(L::mul(weights, force), &mut forces);
        L::store(L::mul(L::mul(weights, tangent), rate), &mut rates);
        Looks {
            forces: std::array::from_fn(|i| forces.0[i] + forces.0[i + LOOKS]),
            rates: std::array::from_fn(|i| (rates.0[i] + rates.0[i + LOOKS]) / span.length),
        }
    }
}

/// The force at evenly spaced times.
pub struct Sample<'a> {
    /// Where it is felt, and over which step.
    pub place: &'a Place,
    pub span: &'a Span,
    /// The form that the chain computes forces in: what is sampled is rounded no less.
    pub form: Form,
    /// Fraction of the step at the first sample (1).
    pub first: f64,
    /// From one sample to the next, in fractions of the step (1).
    pub interval: f64,
    /// Dynamic forces, one a sample (N).
    pub out: &'a mut [[f64; SAMPLED_AT_ONCE]],
}

impl Sample<'_> {
    /// Force changes of contact `which` for changes of its overlap (N).
    #[inline(always)]
    fn force<L: Lanes>(&self, which: usize, change: L::V) -> L::V {
        let contact = &self.place.contacts[which];
        if self.form != Form::Plain {
            let constants = self.place.constants(which).map(|c| L::splat(c));
            return lane_forces::<L>(constants, change, contact.law).0;
        }
        let still = L::splat(contact.static_overlap);
        let power = begin_plain::<L>(which, L::add(still, change)).power(which);
        // The static part by the same loops: exactly nothing is felt where nothing has moved.
        let felt = L::sub(power, begin_plain::<L>(which, still).power(which));
        L::mul(L::splat(contact.stiffness), felt)
    }
}

impl Task for Sample<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(mut self) {
        let (first, interval) = (L::splat(self.first), L::splat(self.interval));
        let count = L::load(&Row([0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]));
        let mut start = 0.0;
        for out in std::mem::take(&mut self.out) {
            let theta = L::mul_add(L::add(L::splat(start), count), interval, first);
            let mut total = L::splat(0.0);
            for which in 0..CONTACTS {
                let mut change = L::splat(0.0);
                for coefficient in self.span.overlaps[which].iter().rev() {
                    change = L::mul_add(change, theta, L::splat(*coefficient));
                }
                let weight = L::splat(self.place.weights[which]);
                total = L::mul_add(weight, self.force::<L>(which, change), total);
            }
            let mut row = Row::default();
            L::store(total, &mut row);
            *out = row.0;
            start += 8.0;
        }
    }
}
