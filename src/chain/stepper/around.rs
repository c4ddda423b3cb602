//! What places in chains feel within steps, eight at a time: one place in eight steps on end, or places of eight chains in a step of each.
//!
//! Two contacts press on a place, and what they do in a step follows from both ends of it: overlap, closing speed, relative acceleration and
//! its rate, for which the contacts beyond them count as well. With `k = 3/2 A sqrt(overlap)` the force of contact `j` changes at
//! `k_j (v_(j-1) - v_j)`, and the acceleration of body `j` between contacts `j` and `j+1` at the difference of two such rates over its mass.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]
#![allow(
    clippy::needless_range_loop,
    reason = "closures would be compiled without the instruction set"
)]

use super::force_track::{COEFFICIENTS, CONTACTS, LOOKED_AT, LOOKS, Place};
use super::force_track::{horner_and_slope, lane_forces};
use super::lanes::{Lanes, Row, WIDTH};
use super::plan::Form;
use super::seen::Seen;
use crate::chain::{Contact, ForceProbe};

/// Bodies that count: the two contacts press three, and two more contacts press those.
pub const BODIES: usize = 5;

/// Positions (m), velocities (m/s) and accelerations (m/s²) of all bodies in rows.
pub type Rows<'a> = [&'a [Row]; 3];

/// How row `row` stands and moves, if there is one.
pub fn row_of(rows: Rows<'_>, row: usize) -> Option<[&Row; 3]> {
    let [position, velocity, acceleration] = rows;
    Some([position.get(row)?, velocity.get(row)?, acceleration.get(row)?])
}

/// Positions (m), velocities (m/s) and accelerations (m/s²) of the bodies around eight places.
pub type Bodies = [[Row; BODIES]; 3];

/// Overlap changes of two contacts in eight places and their first three derivatives (m, m/s, m/s², m/s³).
pub type Moves = [[Row; 4]; CONTACTS];

/// The same in registers.
pub type Held<L> = [[<L as Lanes>::V; 4]; CONTACTS];

/// Overlaps of the two contacts as far as they are closed, and their roots (m, m^0.5): of the plain form, others know their own.
pub type Pressed<L> = [[<L as Lanes>::V; 2]; CONTACTS];

/// The contacts and bodies around a place in each lane.
#[derive(Debug, Clone, Default)]
pub struct Around {
    /// Index of the body in the middle.
    bodies: [usize; WIDTH],
    /// Static overlaps of the contacts between the bodies (m).
    static_overlap: [Row; BODIES - 1],
    /// `3/2 A` of those contacts, or their tangent stiffness where they are linearised (unit).
    stiffness: [Row; BODIES - 1],
    /// Inverse masses of the three bodies in the middle (1/kg).
    inverse_mass: [Row; CONTACTS + 1],
    /// Stiffness (unit), square root of the static overlap (m^0.5) and weight of the contacts above and below the place (1).
    pub contacts: [[Row; 3]; CONTACTS],
    /// What those two bear at rest, as the plain form computes it (N).
    at_rest: [Row; CONTACTS],
    /// The form that the chains compute forces in, and what is seen of them.
    pub form: Form,
}

impl Around {
    /// Places where nothing is.
    pub fn nothing(form: Form) -> Self {
        Self { form, ..Self::default() }
    }

    /// Puts the place of `probe` into lane `lane`.
    pub fn put(&mut self, lane: usize, probe: &ForceProbe) {
        let contacts = probe.neighbourhood();
        let stiffness = |contact: Contact| match self.form {
            Form::Linear => contact.static_stiffness(),
            Form::Plain | Form::Exact => 1.5 * contact.stiffness,
        };
        set(&mut self.stiffness, lane, contacts.map(stiffness));
        set(&mut self.static_overlap, lane, contacts.map(|contact| contact.static_overlap));
        set(&mut self.inverse_mass, lane, probe.inverse_masses());
        let place = Place::new(probe);
        for (which, rows) in self.contacts.iter_mut().enumerate() {
            let [stiffness, static_root, weight] = place.lane_constants(which);
            set(rows, lane, [stiffness, static_root, weight]);
            // Step by step as the lanes do it: exactly nothing is felt where nothing has moved.
            let overlap = place.static_overlap(which).max(0.0);
            self.at_rest[which].0[lane] = overlap * (stiffness * overlap.sqrt());
        }
        self.bodies[lane] = probe.body();
    }

    /// Index of body `index` around the place in lane `lane`, counted from two above its own; none above the chain.
    pub fn body(&self, lane: usize, index: usize) -> Option<usize> {
        (self.bodies[lane] + index).checked_sub(BODIES / 2)
    }

    /// How the two contacts stand where the bodies stand and move as told, and how they are pressed.
    #[inline(always)]
    pub fn moves<L: Lanes>(&self, bodies: &Bodies) -> (Held<L>, Pressed<L>) {
        let [position, velocity, acceleration] = bodies;
        let none = L::splat(0.0);
        let (mut change, mut closing) = ([none; BODIES - 1], [none; BODIES - 1]);
        let (mut rate, mut pressed) = ([none; BODIES - 1], [[none; 2]; BODIES - 1]);
        for j in 0..BODIES - 1 {
            change[j] = L::sub(L::load(&position[j]), L::load(&position[j + 1]));
            closing[j] = L::sub(L::load(&velocity[j]), L::load(&velocity[j + 1]));
            rate[j] = L::mul(L::load(&self.stiffness[j]), closing[j]);
            if self.form != Form::Linear {
                let closed = self.closed::<L>(j, change[j]);
                pressed[j] = [closed, L::sqrt(closed)];
                rate[j] = L::mul(rate[j], pressed[j][1]);
            }
        }
        let mut jerk = [none; CONTACTS + 1];
        for i in 0..=CONTACTS {
            jerk[i] = L::mul(L::load(&self.inverse_mass[i]), L::sub(rate[i], rate[i + 1]));
        }
        let mut moves = [[none; 4]; CONTACTS];
        for w in 0..CONTACTS {
            let bend = L::sub(L::load(&acceleration[w + 1]), L::load(&acceleration[w + 2]));
            moves[w] = [change[w + 1], closing[w + 1], bend, L::sub(jerk[w], jerk[w + 1])];
        }
        (moves, [pressed[1], pressed[2]])
    }

    /// Overlaps, as far as they are closed, of contact `j` between the bodies where they have changed by `change` (m).
    #[inline(always)]
    fn closed<L: Lanes>(&self, j: usize, change: L::V) -> L::V {
        L::max(L::add(L::load(&self.static_overlap[j]), change), L::splat(0.0))
    }

    /// Dynamic forces (N) of contact `which` beside the places and its tangent stiffnesses (N/m), for changes of its overlaps (m).
    #[inline(always)]
    pub fn press<L: Lanes>(&self, which: usize, change: L::V) -> (L::V, L::V) {
        if self.form != Form::Plain {
            let [stiffness, static_root, _] = &self.contacts[which];
            return lane_forces::<L>([L::load(stiffness), L::load(static_root)], change, self.form);
        }
        let closed = self.closed::<L>(which + 1, change);
        self.press_plain::<L>(which, [closed, L::sqrt(closed)])
    }

    /// The same in plain form, for overlaps as far as they are closed (m) and their roots (m^0.5).
    #[inline(always)]
    fn press_plain<L: Lanes>(&self, which: usize, [closed, root]: [L::V; 2]) -> (L::V, L::V) {
        let slope = L::mul(L::load(&self.contacts[which][0]), root);
        let whole = L::mul(closed, slope);
        (L::sub(whole, L::load(&self.at_rest[which])), L::mul(L::splat(1.5), slope))
    }

    /// Force (N) and its rate of change where the contacts' overlaps have changed and change as told (N/s).
    #[inline(always)]
    pub fn feel<L: Lanes>(&self, moves: [[L::V; 2]; CONTACTS]) -> [L::V; 2] {
        let mut felt = [L::splat(0.0); 2];
        for which in 0..CONTACTS {
            let [change, closing] = moves[which];
            felt = self.weigh::<L>(which, self.press::<L>(which, change), closing, felt);
        }
        felt
    }

    /// The same where it is known how they are pressed.
    #[inline(always)]
    pub fn feel_pressed<L: Lanes>(&self, moves: &Held<L>, pressed: &Pressed<L>) -> [L::V; 2] {
        if self.form != Form::Plain {
            return self.feel::<L>([[moves[0][0], moves[0][1]], [moves[1][0], moves[1][1]]]);
        }
        let mut felt = [L::splat(0.0); 2];
        for which in 0..CONTACTS {
            let press = self.press_plain::<L>(which, pressed[which]);
            felt = self.weigh::<L>(which, press, moves[which][1], felt);
        }
        felt
    }

    /// Adds what is felt of contact `which` to force (N) and rate of change (N/s), where it has this force (N) and tangent stiffness (N/m).
    #[inline(always)]
    fn weigh<L: Lanes>(
        &self,
        which: usize,
        (pressed, tangent): (L::V, L::V),
        closing: L::V,
        [force, rate]: [L::V; 2],
    ) -> [L::V; 2] {
        let weight = L::load(&self.contacts[which][2]);
        [L::mul_add(weight, pressed, force), L::mul_add(L::mul(weight, tangent), closing, rate)]
    }

    /// What is felt within steps that are joined.
    #[inline(always)]
    pub fn look<L: Lanes>(&self, length: &Row, seen: &mut Seen) {
        const WITHIN: usize = LOOKS - 1;
        let h = L::load(length);
        let (mut forces, mut rates) = ([L::splat(0.0); WITHIN], [L::splat(0.0); WITHIN]);
        for which in 0..CONTACTS {
            let mut overlap = [h; COEFFICIENTS];
            for power in 0..COEFFICIENTS {
                overlap[power] = L::load(&seen.overlaps[which][power]);
            }
            let weight = L::load(&self.contacts[which][2]);
            for look in 0..WITHIN {
                let at = L::splat(LOOKED_AT[look]);
                let (change, slope) = horner_and_slope::<L>(&overlap, at);
                let (force, tangent) = self.press::<L>(which, change);
                forces[look] = L::mul_add(weight, force, forces[look]);
                rates[look] = L::mul_add(L::mul(weight, tangent), slope, rates[look]);
            }
        }
        for look in 0..WITHIN {
            L::store(forces[look], &mut seen.forces[look]);
            L::store(L::div(rates[look], h), &mut seen.rates[look]);
        }
    }
}

/// Writes `values` into lane `lane`.
fn set<const N: usize>(rows: &mut [Row; N], lane: usize, values: [f64; N]) {
    for (row, value) in rows.iter_mut().zip(values) {
        row.0[lane] = value;
    }
}
