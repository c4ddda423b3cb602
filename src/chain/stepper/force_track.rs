//! The force at one place over one step: the overlaps of two neighbouring contacts as polynomials in time.
//!
//! Each overlap is the septic through its value and its first three derivatives at both ends of the step; the error goes as the
//! step to the power 8 with the constant `1/(8! 2^8)`. Source: C. Hermite, J. reine angew. Math. 84, 70 (1878).
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::lanes::Lanes;
use super::plan::Form;
use crate::chain::hertz::force_and_tangent;
use crate::chain::{ForceProbe, Law};

/// Coefficients of a septic.
pub const COEFFICIENTS: usize = 8;
/// Contacts that a place feels.
pub const CONTACTS: usize = 2;
/// Places within a step at which a force is looked at.
pub const LOOKS: usize = 4;
/// The fractions of a step where they are, its end the last (1).
pub const LOOKED_AT: [f64; LOOKS] = [0.25, 0.5, 0.75, 1.0];

/// A place between two contacts, which feels both.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    contacts: [FeltContact; CONTACTS],
}

/// A contact, as a place beside it feels it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct FeltContact {
    law: Law,
    /// `A` by Hertz (N/m^1.5), linearised the tangent stiffness (N/m).
    stiffness: f64,
    /// At rest (m).
    static_overlap: f64,
    /// Its square root (m^0.5).
    static_root: f64,
    /// What of its force is felt (1).
    weight: f64,
}

/// How a place's contacts move over one step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// Start of the step (s).
    pub start: f64,
    /// Length of the step (s).
    pub length: f64,
    /// Overlap changes as polynomials in the fraction of the step (m).
    pub(super) overlaps: [[f64; COEFFICIENTS]; CONTACTS],
}

/// A force at [`LOOKED_AT`] within a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Looks {
    /// Dynamic force (N).
    pub forces: [f64; LOOKS],
    /// Its rate of change (N/s).
    pub rates: [f64; LOOKS],
}

impl Place {
    /// The place of `probe`.
    #[must_use]
    pub fn new(probe: &ForceProbe) -> Self {
        let felt = |which: usize| {
            let (contact, weight) = (&probe.contacts()[which], probe.weights()[which]);
            let static_overlap = contact.static_overlap;
            let (stiffness, static_root) = match contact.law {
                Law::Hertz => (contact.stiffness, static_overlap.sqrt()),
                Law::Linearised => (contact.static_stiffness(), 0.0),
            };
            FeltContact { law: contact.law, stiffness, static_overlap, static_root, weight }
        };
        Self { contacts: std::array::from_fn(felt) }
    }

    /// Dynamic force (N) and its rate of change for changes of the overlaps (m) and their rates: over a time or over a step (N/s, N).
    #[inline]
    fn feel(&self, overlaps: [[f64; 2]; CONTACTS]) -> (f64, f64) {
        let (mut force, mut rate) = (0.0, 0.0);
        for (contact, [change, closing]) in self.contacts.iter().zip(overlaps) {
            let FeltContact { law, stiffness, static_root, weight, .. } = *contact;
            let (felt, tangent) = match law {
                Law::Hertz => force_and_tangent(stiffness, static_root, change),
                Law::Linearised => (stiffness * change, stiffness),
            };
            force += weight * felt;
            rate += weight * tangent * closing;
        }
        (force, rate)
    }

    /// Dynamic force at the fraction `theta` of a step (N).
    #[must_use]
    pub fn force(&self, span: &Span, theta: f64) -> f64 {
        let [above, below] = &span.overlaps;
        self.feel([[value(above, theta), 0.0], [value(below, theta), 0.0]]).0
    }

    /// Its rate of change there (N/s).
    #[must_use]
    pub fn rate(&self, span: &Span, theta: f64) -> f64 {
        let [above, below] = &span.overlaps;
        let moves = |overlap| [value(overlap, theta), slope(overlap, theta)];
        self.feel([moves(above), moves(below)]).1 / span.length
    }

    /// Stiffness, static root and weight of contact `which` as the lanes need them (unit).
    #[inline(always)]
    pub fn lane_constants(&self, which: usize) -> [f64; 3] {
        let FeltContact { stiffness, static_root, weight, .. } = self.contacts[which];
        [stiffness, static_root, weight]
    }

    /// Static overlap of contact `which` (m).
    #[inline(always)]
    pub fn static_overlap(&self, which: usize) -> f64 {
        self.contacts[which].static_overlap
    }
}

/// Coefficients of the septics through value and three derivatives at both ends of steps of `h` (s), in the fraction of the step (m).
#[inline(always)]
#[allow(clippy::many_single_char_names, reason = "the letters of the derivatives")]
pub fn septic<L: Lanes>([from, to]: [[L::V; 4]; 2], h: L::V) -> [L::V; COEFFICIENTS] {
    let square = L::mul(h, h);
    let cube = L::mul(h, square);
    let (x, v) = (from[0], L::mul(h, from[1]));
    let a = L::mul(L::mul(L::splat(0.5), square), from[2]);
    let j = L::mul(L::mul(L::splat(1.0 / 6.0), cube), from[3]);
    // What the cubic Taylor polynomial of the start leaves over at the end, derivative by derivative.
    let start = [x, v, a, j];
    let p = L::sub(L::sub(L::sub(L::sub(to[0], x), v), a), j);
    let q = L::sub(L::mul(h, to[1]), sum::<L>(start, [0.0, 1.0, 2.0, 3.0]));
    let r = L::sub(L::mul(square, to[2]), sum::<L>(start, [0.0, 0.0, 2.0, 6.0]));
    let s = L::sub(L::mul(cube, to[3]), L::mul(L::splat(6.0), j));
    let left = [p, q, r, s];
    [
        x,
        v,
        a,
        j,
        sum::<L>(left, [35.0, -15.0, 2.5, -1.0 / 6.0]),
        sum::<L>(left, [-84.0, 39.0, -7.0, 0.5]),
        sum::<L>(left, [70.0, -34.0, 6.5, -0.5]),
        sum::<L>(left, [-20.0, 10.0, -2.0, 1.0 / 6.0]),
    ]
}

/// The weighted sum of four values.
#[inline(always)]
pub fn sum<L: Lanes>(values: [L::V; 4], weights: [f64; 4]) -> L::V {
    let mut sum = L::mul(L::splat(weights[0]), values[0]);
    for i in 1..4 {
        sum = L::mul_add(L::splat(weights[i]), values[i], sum);
    }
    sum
}

/// The polynomials `c` at `t` (m), and their slopes there (m).
#[inline(always)]
pub fn horner_and_slope<L: Lanes>(c: &[L::V; COEFFICIENTS], t: L::V) -> (L::V, L::V) {
    let (mut value, mut slope) = (c[COEFFICIENTS - 1], L::splat(0.0));
    for power in (0..COEFFICIENTS - 1).rev() {
        slope = L::mul_add(slope, t, value);
        value = L::mul_add(value, t, c[power]);
    }
    (value, slope)
}

/// The polynomial `c` at `t` (m): even and odd powers apart, so that neither waits for the other.
#[inline(always)]
fn value(c: &[f64; COEFFICIENTS], t: f64) -> f64 {
    let square = t * t;
    let cubic = |a: f64, b: f64, c: f64, d: f64| a + square * (b + square * (c + square * d));
    cubic(c[0], c[2], c[4], c[6]) + t * cubic(c[1], c[3], c[5], c[7])
}

/// Its slope there (m).
#[inline(always)]
fn slope(c: &[f64; COEFFICIENTS], t: f64) -> f64 {
    let square = t * t;
    let odd = 2.0 * c[2] + square * (4.0 * c[4] + square * (6.0 * c[6]));
    c[1] + square * (3.0 * c[3] + square * (5.0 * c[5] + square * (7.0 * c[7]))) + t * odd
}

/// `hertz::force_change` and the tangent stiffness in eight places; linear where `form` says so.
#[inline(always)]
pub fn lane_forces<L: Lanes>(contact: [L::V; 2], change: L::V, form: Form) -> (L::V, L::V) {
    let [stiffness, static_root] = contact;
    if form == Form::Linear {
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
