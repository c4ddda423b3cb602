//! What a place in a chain feels: at the end of every step, and within the steps that somebody asks for.
//!
//! Two contacts press on a place, and what they do in a step follows from both ends of it: overlap, closing speed, relative acceleration and
//! its rate, for which the contacts beyond them count as well. With `k = 3/2 A sqrt(overlap)` the force of contact `j` changes at
//! `k_j (v_(j-1) - v_j)`, and the acceleration of body `j` between contacts `j` and `j+1` at the difference of two such rates over its mass.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::force_track::{CONTACTS, Looks, Place, Span};
use super::lanes::{Lanes, Row, Task};
use crate::chain::{Contact, ForceProbe, Law};

/// Bodies that count: the two contacts press three, and two more contacts press those.
const BODIES: usize = 5;
/// Where there is no body: nothing moves there.
const NOWHERE: (usize, usize) = (usize::MAX, 0);

/// A place whose force is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// Index of the body between the two contacts.
    pub body: usize,
    /// The two contacts.
    pub place: Place,
    /// The step looked into last, as they moved in it.
    pub span: Span,
    /// The force in a few places of that step.
    pub looks: Looks,
    /// Length of the step glanced at last (s).
    pub length: f64,
    /// Dynamic force at its end (N).
    pub end: f64,
    /// Its rate of change there (N/s).
    pub rate: f64,
    /// Whether the force within the last step is wanted.
    pub wanted: bool,
    near: Near,
    /// How the contacts stood at the end of the step looked into last, and which that was.
    seen: ([Move; CONTACTS], u64),
}

/// A contact's overlap change and its first three derivatives (m, m/s, m/s², m/s³).
type Move = [f64; 4];

/// The bodies and contacts around a place.
#[derive(Debug, Clone, PartialEq)]
struct Near {
    /// Row and lane of each body.
    places: [(usize, usize); BODIES],
    /// Static overlaps of the contacts between them (m).
    static_overlap: [f64; BODIES - 1],
    /// `3/2 A` of those contacts, or their tangent stiffness where they are linearised (unit).
    stiffness: [f64; BODIES - 1],
    law: Law,
    /// Inverse masses of the three bodies in the middle (1/kg).
    inverse_mass: [f64; CONTACTS + 1],
}

/// Positions (m), velocities (m/s) and accelerations (m/s²) of all bodies in rows.
pub type Rows<'a> = [&'a [Row]; 3];

impl View {
    /// The place of `probe`, at rest, in a chain with `bodies` entries that stand at a row and lane of their own.
    pub(super) fn new(
        probe: &ForceProbe,
        bodies: usize,
        place: impl Fn(usize) -> (usize, usize),
    ) -> Self {
        let place = |index: usize| {
            // Counted from two bodies above the place's own.
            let body = (probe.body() + index).checked_sub(BODIES / 2);
            body.filter(|body| *body < bodies).map_or(NOWHERE, &place)
        };
        Self {
            body: probe.body(),
            place: Place::new(probe),
            span: Span::default(),
            looks: Looks::default(),
            length: 0.0,
            end: 0.0,
            rate: 0.0,
            wanted: false,
            near: Near::new(probe, std::array::from_fn(place)),
            seen: ([[0.0; 4]; CONTACTS], u64::MAX),
        }
    }

    /// Brings it up to the end of a step of `length` (s), where bodies stand and move as in `to` (m, m/s).
    pub(super) fn glance(&mut self, (position, velocity): (&[Row], &[Row]), length: f64) {
        let change: [f64; CONTACTS] = self.near.differences(1, position);
        let closing: [f64; CONTACTS] = self.near.differences(1, velocity);
        (self.end, self.rate) = self.place.feel([[change[0], closing[0]], [change[1], closing[1]]]);
        self.length = length;
    }
}

impl Near {
    fn new(probe: &ForceProbe, places: [(usize, usize); BODIES]) -> Self {
        let contacts = probe.neighbourhood();
        let linear = contacts.iter().any(|contact| contact.law == Law::Linearised);
        let stiffness = |contact: Contact| {
            if linear { contact.static_stiffness() } else { 1.5 * contact.stiffness }
        };
        Self {
            places,
            static_overlap: contacts.map(|contact| contact.static_overlap),
            stiffness: contacts.map(stiffness),
            law: if linear { Law::Linearised } else { Law::Hertz },
            inverse_mass: probe.inverse_masses(),
        }
    }

    /// How much more the bodies above contacts `first`, `first + 1`, ... have than those below them.
    #[inline(always)]
    fn differences<const N: usize>(&self, first: usize, rows: &[Row]) -> [f64; N] {
        let mut above = self.value(first, rows);
        let mut found = [0.0; N];
        for contact in 0..N {
            let below = self.value(first + contact + 1, rows);
            found[contact] = above - below;
            above = below;
        }
        found
    }

    /// What a body has.
    #[inline(always)]
    fn value(&self, body: usize, rows: &[Row]) -> f64 {
        let (row, lane) = self.places[body];
        match rows.get(row) {
            Some(row) => row.0[lane],
            None => 0.0,
        }
    }

    /// How the place's two contacts stand where bodies do as in `rows`. Tangents are [`Contact::tangent_stiffness`], in line: calls would leave
    /// the instruction set.
    #[inline(always)]
    fn moves(&self, [position, velocity, acceleration]: Rows) -> [Move; CONTACTS] {
        let change: [f64; BODIES - 1] = self.differences(0, position);
        let closing: [f64; BODIES - 1] = self.differences(0, velocity);
        let bend: [f64; CONTACTS] = self.differences(1, acceleration);
        let mut rate = [0.0; BODIES - 1];
        for contact in 0..BODIES - 1 {
            let overlap = change[contact] + self.static_overlap[contact];
            let root = if self.law == Law::Hertz { overlap.max(0.0).sqrt() } else { 1.0 };
            rate[contact] = self.stiffness[contact] * root * closing[contact];
        }
        let mut jerk = [0.0; CONTACTS + 1];
        for body in 0..=CONTACTS {
            jerk[body] = (rate[body] - rate[body + 1]) * self.inverse_mass[body];
        }
        let mut moves = [[0.0; 4]; CONTACTS];
        for w in 0..CONTACTS {
            moves[w] = [change[w + 1], closing[w + 1], bend[w], jerk[w] - jerk[w + 1]];
        }
        moves
    }
}

/// Looks into a step for the views that want it.
pub struct Look<'a> {
    /// Both ends of the step.
    pub ends: [Rows<'a>; 2],
    /// Start and length of it (s).
    pub span: (f64, f64),
    /// How many steps have been taken with it.
    pub count: u64,
    pub views: &'a mut [View],
}

impl Task for Look<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Self { ends: [from, to], span, count, views } = self;
        for view in views.iter_mut().filter(|view| view.wanted) {
            let (moves, last) = view.seen;
            let from = if last.wrapping_add(1) == count { moves } else { view.near.moves(from) };
            let to = view.near.moves(to);
            view.seen = (to, count);
            for which in 0..CONTACTS {
                view.span.set(which, span, [from[which], to[which]]);
            }
            view.looks = view.place.looks::<L>(&view.span);
        }
    }
}
