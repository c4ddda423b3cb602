//! What a place in each lane's chain feels at the end of a step, and whether anybody has to look into the step itself: all lanes at once.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use crate::chain::ForceProbe;
use crate::chain::stepper::around::{Around, BODIES, Bodies, Rows, Seen};
use crate::chain::stepper::force_track::lane_forces;
use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};
use crate::chain::stepper::plan::Form;
use crate::chain::stepper::wanted::Asked;

/// Which of the bodies around a place is its own.
const MIDDLE: usize = BODIES / 2;

/// A watched place in each lane, or none.
#[derive(Debug, Clone)]
pub struct Glances {
    /// Lanes that have one, a bit each.
    lanes: u8,
    /// Lanes that have not taken a step yet: their first is looked into whatever is asked, for a place may start with a rate of change that is
    /// nothing but rounding.
    first: u8,
    pub(super) around: Around,
    /// Whether it is around the same body in all lanes.
    alike: bool,
    /// Dynamic forces (N) and their rates of change (N/s) at the start of the last step and at its end.
    felt: [[Row; 2]; 2],
    /// What is asked of each lane.
    asked: Asked,
    /// The steps looked into last.
    pub(super) seen: Box<Seen>,
}

impl Glances {
    /// At the places of each lane's probe in chains that compute forces in `form`, at rest; nothing is asked yet.
    pub(super) fn new<'a>(
        form: Form,
        probes: impl Iterator<Item = Option<&'a ForceProbe>>,
    ) -> Self {
        let mut glances = Self {
            lanes: 0,
            first: u8::MAX,
            around: Around::nothing(form),
            alike: false,
            felt: Default::default(),
            asked: Asked::nothing(),
            seen: Box::new(Seen::nothing()),
        };
        for (lane, probe) in probes.enumerate().take(WIDTH) {
            let Some(probe) = probe else { continue };
            if glances.lanes == 0 {
                // Lanes that have none are taken along.
                (0..WIDTH).for_each(|lane| glances.around.put(lane, probe));
            }
            glances.lanes |= 1 << lane;
            glances.around.put(lane, probe);
        }
        let above = |lane| glances.around.body(lane, MIDDLE);
        glances.alike = (1..WIDTH).all(|lane| above(lane) == above(0));
        glances
    }

    /// How the bodies around the places stand and move.
    pub(super) fn bodies(&self, state: Rows<'_>) -> Bodies {
        let mut bodies = Bodies::default();
        for (rows, bodies) in state.into_iter().zip(&mut bodies) {
            for (index, row) in bodies.iter_mut().enumerate() {
                *row = self.body(rows, index);
            }
        }
        bodies
    }

    /// Body `index` around the place in each lane; nothing where there is none.
    #[inline(always)]
    fn body(&self, rows: &[Row], index: usize) -> Row {
        let of = |lane| self.around.body(lane, index).and_then(|body| rows.get(body));
        if self.alike {
            return of(0).copied().unwrap_or_default();
        }
        Row(std::array::from_fn(|lane| of(lane).map_or(0.0, |row| row.0[lane])))
    }

    /// How much more the bodies above contacts `which` of the places have than those below.
    #[inline(always)]
    fn difference<L: Lanes>(&self, rows: &[Row], which: usize) -> L::V {
        let [above, below] = [MIDDLE - 1, MIDDLE].map(|first| self.body(rows, first + which));
        L::sub(L::load(&above), L::load(&below))
    }

    /// The steps that were looked into last.
    #[must_use]
    pub fn seen(&self) -> &Seen {
        &self.seen
    }

    /// Asks lane `lane` for maxima above the first and any forces above the second (N).
    pub fn ask(&mut self, lane: usize, asked: [f64; 2]) {
        self.asked.ask(lane, asked);
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
}

impl Task for Glance<'_> {
    /// Lanes whose step holds what is asked for, or may, a bit each.
    type Output = u8;

    #[inline(always)]
    fn run<L: Lanes>(self) -> u8 {
        let Self { glances, to, length, taken } = self;
        let taken = taken & glances.lanes;
        let (mut force, mut rate) = (L::splat(0.0), L::splat(0.0));
        for (which, contact) in glances.around.contacts.iter().enumerate() {
            let [stiffness, static_root, weight] = contact;
            let change = glances.difference::<L>(to[0], which);
            let closing = glances.difference::<L>(to[1], which);
            let constants = [L::load(stiffness), L::load(static_root)];
            let (felt, tangent) = lane_forces::<L>(constants, change, glances.around.form);
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
        let before = [L::load(&from[0]), L::load(&from[1])];
        let wanted = glances.asked.wanted::<L>(before, [force, rate], L::load(&length));
        let first = glances.first;
        glances.first &= !taken;
        taken & (wanted | first)
    }
}
