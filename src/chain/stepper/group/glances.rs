//! What a place in each lane's chain feels at the end of a step, and whether anybody has to look into the step itself: all lanes at once.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use crate::chain::Law;
use crate::chain::stepper::force_track::{CONTACTS, lane_forces};
use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};
use crate::chain::stepper::view::View;

/// A watched place in each lane, or none.
#[derive(Debug, Clone)]
pub struct Glances {
    /// Lanes that have one, a bit each.
    lanes: u8,
    /// Index of the body between the two contacts, and whether it is the same in all lanes.
    bodies: [usize; WIDTH],
    alike: bool,
    /// Stiffness (unit), square root of the static overlap (m^0.5) and weight of the contacts above and below (1).
    contacts: [[Row; 3]; CONTACTS],
    /// Dynamic forces (N) and their rates of change (N/s) at the start of the last step and at its end.
    felt: [[Row; 2]; 2],
    /// What is asked of each lane: forces that do not exceed this are nobody's business, nor is a rise up to that (N).
    asked: [Row; 2],
}

impl Glances {
    /// At the views of each lane, at rest; nothing is asked yet.
    #[must_use]
    pub fn new<'a>(views: impl Iterator<Item = Option<&'a View>>) -> Self {
        let mut glances = Self {
            lanes: 0,
            bodies: [0; WIDTH],
            alike: false,
            contacts: Default::default(),
            felt: Default::default(),
            asked: Default::default(),
        };
        for (lane, view) in views.enumerate().take(WIDTH) {
            let Some(view) = view else { continue };
            if glances.lanes == 0 {
                // Lanes that have none are taken along.
                glances.bodies = [view.body; WIDTH];
            }
            glances.lanes |= 1 << lane;
            glances.bodies[lane] = view.body;
            for (which, contact) in glances.contacts.iter_mut().enumerate() {
                for (row, value) in contact.iter_mut().zip(view.place.lane_constants(which)) {
                    row.0[lane] = value;
                }
            }
        }
        glances.alike = glances.bodies.iter().all(|body| *body == glances.bodies[0]);
        glances
    }

    /// Asks lane `lane` for forces above `least` that turn or rise above `largest` (N).
    pub fn ask(&mut self, lane: usize, [least, largest]: [f64; 2]) {
        self.asked[0].0[lane] = least;
        self.asked[1].0[lane] = largest;
    }

    /// Force and its rate of change at the start of lane `lane`'s last step (N, N/s).
    #[must_use]
    pub fn before(&self, lane: usize) -> [f64; 2] {
        self.felt[0].map(|row| row.0[lane])
    }

    /// Takes force (N) and rate of change (N/s) at the end of lane `lane`'s last step from somebody who has looked closer.
    pub fn correct(&mut self, lane: usize, felt: [f64; 2]) {
        for (row, value) in self.felt[1].iter_mut().zip(felt) {
            row.0[lane] = value;
        }
    }
}

/// Takes a glance at the ends of steps.
pub struct Glance<'a> {
    pub glances: &'a mut Glances,
    /// Positions (m) and velocities (m/s) there.
    pub to: [&'a [Row]; 2],
    /// Lengths of the steps (s).
    pub length: Row,
    /// Lanes that have taken one, a bit each.
    pub taken: u8,
    /// The law of all contacts.
    pub law: Law,
    /// How doubtful a turn within the step may be: see `experiment::turn::may_fall` (1).
    pub doubtful: f64,
}

/// How much more the bodies above contacts `which` of the places have than those below.
#[inline(always)]
fn differences<L: Lanes>(rows: &[Row], glances: &Glances, which: usize) -> L::V {
    let (mut above, mut below) = (Row::default(), Row::default());
    if glances.alike {
        let body = glances.bodies[0] + which;
        let upper = body.checked_sub(1).map_or(above, |body| rows[body]);
        return L::sub(L::load(&upper), L::load(&rows[body]));
    }
    for (lane, body) in glances.bodies.iter().enumerate() {
        let body = body + which;
        above.0[lane] = body.checked_sub(1).map_or(0.0, |body| rows[body].0[lane]);
        below.0[lane] = rows[body].0[lane];
    }
    L::sub(L::load(&above), L::load(&below))
}

impl Task for Glance<'_> {
    /// Lanes whose step holds what is asked for, or may, a bit each.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Self { glances, to, length, taken, law, doubtful } = self;
        let taken = taken & glances.lanes;
        let (none, mut force, mut rate) = (L::splat(0.0), L::splat(0.0), L::splat(0.0));
        for (which, contact) in glances.contacts.iter().enumerate() {
            let [stiffness, static_root, weight] = [&contact[0], &contact[1], &contact[2]];
            let change = differences::<L>(to[0], glances, which);
            let closing = differences::<L>(to[1], glances, which);
            let constants = [L::load(stiffness), L::load(static_root)];
            let (felt, tangent) = lane_forces::<L>(constants, change, law);
            let weight = L::load(weight);
            force = L::mul_add(weight, felt, force);
            rate = L::mul_add(L::mul(weight, tangent), closing, rate);
        }
        let [from, end] = &mut glances.felt;
        for ((from, end), felt) in from.iter_mut().zip(end).zip([force, rate]) {
            let before = L::load(end);
            L::store(L::select(taken, before, L::load(from)), from);
            L::store(L::select(taken, felt, before), end);
        }
        let [last, rate_before] = [L::load(&from[0]), L::load(&from[1])];

        let [floor, record] = [L::load(&glances.asked[0]), L::load(&glances.asked[1])];
        let counts = L::positive(L::sub(L::max(force, last), floor));
        let exceeds = L::positive(L::sub(force, record));
        let (rose, rises) = (L::positive(rate_before), L::positive(rate));
        let mean = L::div(L::sub(force, last), L::load(&length));
        // Falling twice is rising twice, upside down.
        let mean = L::select(rises, mean, L::sub(none, mean));
        let (first, second) = (L::abs(rate_before), L::abs(rate));
        let three = L::splat(3.0);
        let both = L::add(first, second);
        let bend = L::mul(three, L::sub(both, L::add(mean, mean)));
        let turn = L::sub(L::add(first, both), L::mul(three, mean));
        let lowest = L::sub(first, L::div(L::mul(turn, turn), bend));
        let doubt = L::mul(L::splat(doubtful), L::min(first, second));
        let turns = L::positive(bend)
            & L::positive(turn)
            & L::positive(L::sub(bend, turn))
            & L::positive(L::sub(doubt, lowest));
        taken & counts & (exceeds | rose & !rises | !(rose ^ rises) & turns)
    }
}
