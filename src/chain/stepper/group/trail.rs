//! What places in each lane's chain have felt in the last steps, and into which of those somebody has to look: a few steps are noted, their ends
//! felt side by side, and few of them looked into.
#![allow(clippy::inline_always, reason = "each instruction set needs its own copy of the loops")]

use super::{ChainGroup, bits};
use crate::chain::ForceProbe;
use crate::chain::stepper::around::{Around, BODIES, Bodies, Rows, Seen, SideBySide};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::lane_forces;
use crate::chain::stepper::lanes::{Lanes, Row, Task, WIDTH};
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::plan::Form;
use crate::chain::stepper::wanted::Asked;

/// Which of the bodies around a place is its own.
const MIDDLE: usize = BODIES / 2;

/// The last steps of a group's chains at their watched places.
#[derive(Debug, Clone)]
pub struct GroupTrail {
    count: usize,
    /// Lanes that have taken each step, a bit each.
    taken: [u8; GroupTrail::STEPS],
    /// Starts and lengths of the steps (s).
    times: [(Row, Row); GroupTrail::STEPS],
    places: Vec<Watched>,
    /// Of steps that are taken at once.
    notes: Notes,
}

/// A watched place in each lane, or none.
#[derive(Debug, Clone)]
struct Watched {
    /// Lanes that have one, a bit each.
    lanes: u8,
    /// Lanes that have not taken a step yet: their first is looked into whatever is asked, for a place may start with a rate of change that is
    /// nothing but rounding.
    first: u8,
    around: Around,
    /// Whether it is around the same body in all lanes.
    alike: bool,
    /// How the bodies around it stood and moved before the first step and at the end of each.
    noted: Box<[Bodies; GroupTrail::STEPS + 1]>,
    /// Dynamic forces (N) and their rates of change (N/s) at the end of each step.
    ends: [[Row; 2]; GroupTrail::STEPS],
    /// The same at the end of the last step that was glanced at, as somebody felt it who has looked closer.
    felt: [Row; 2],
    /// What is asked of each lane.
    asked: Asked,
    seen: Box<Seen>,
}

/// What somebody has felt in a step of place `.0` in lane `.1`, which began with the force and its rate of change `.2` (N, N/s): what they are at its
/// end, and the force above which a maximum counts from now on, and any other does (N).
pub type Look<'a> = dyn FnMut((usize, usize), [f64; 2], &Seen) -> [[f64; 2]; 2] + 'a;

impl GroupTrail {
    /// Most steps that are noted.
    pub const STEPS: usize = 8;

    /// Whether there is no room for another step.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.count == Self::STEPS
    }

    /// Begins with this force (N) and rate of change (N/s) at place `place` in lane `lane`; asks it for maxima above the first and any forces
    /// above the second (N).
    pub fn begin(&mut self, (place, lane): (usize, usize), felt: [f64; 2], asked: [f64; 2]) {
        let watched = &mut self.places[place];
        watched.correct(lane, felt);
        watched.asked.ask(lane, asked);
    }
}

impl ChainGroup {
    /// A trail that begins here, of the places of each lane's probes.
    #[must_use]
    pub fn trail(&self, probes: &[&[ForceProbe]]) -> GroupTrail {
        let count = probes.iter().map(|probes| probes.len()).max().unwrap_or(0);
        let rows = self.work.now.moving();
        let place = |place| {
            let mut watched =
                Watched::new(self.plan.form, probes.iter().map(move |probes| probes.get(place)));
            watched.note(0, |body| of(rows, body));
            watched
        };
        let places: Vec<Watched> = (0..count).map(place).collect();
        let asked = places.iter().flat_map(Watched::bodies).filter(|body| *body < rows[0].len());
        GroupTrail {
            count: 0,
            taken: Default::default(),
            times: Default::default(),
            notes: Notes::new(GroupTrail::STEPS - 2, asked),
            places,
        }
    }

    /// Tries a step in every lane that is still moving, or takes as many of one length as the trail has room for, which must be one, and notes them.
    pub fn follow(&mut self, trail: &mut GroupTrail) {
        let room = GroupTrail::STEPS - trail.count;
        trail.notes.clear();
        let (count, taken) = self.step(room as u64, &mut trail.notes);
        let (started, rows) = (self.work.next.moving(), self.work.now.moving());
        for (step, before) in (0..count).rev().enumerate() {
            trail.taken[trail.count] = bits(taken);
            trail.times[trail.count] = self.drive.last_steps(before);
            trail.count += 1;
            let GroupTrail { places, notes, .. } = trail;
            for watched in places {
                match before {
                    0 => watched.note(trail.count, |body| of(rows, body)),
                    1 => watched.note(trail.count, |body| of(started, body)),
                    _ => watched.note(trail.count, |body| notes.at(step, body)),
                }
            }
        }
    }

    /// Reads the steps that are noted, and has `look` look into those that hold what is asked for, or may.
    pub fn read(&self, trail: &mut GroupTrail, look: &mut Look<'_>) {
        let GroupTrail { count, taken, times, places, .. } = trail;
        for (place, watched) in places.iter_mut().enumerate() {
            dispatch(self.set, Feel { watched, count: *count });
            for step in 0..*count {
                let (starts, lengths) = &times[step];
                let taken = taken[step];
                let wanted = dispatch(self.set, Glance { watched, step, lengths, taken });
                if wanted.lanes == 0 {
                    continue;
                }
                let Watched { around, noted, seen, .. } = watched;
                let ends = [&noted[step], &noted[step + 1]];
                dispatch(self.set, SideBySide { around, ends, times: (*starts, lengths), seen });
                for lane in (0..WIDTH).filter(|lane| wanted.lanes & (1 << lane) != 0) {
                    let before = wanted.before.each_ref().map(|row| row.0[lane]);
                    let [felt, asked] = look((place, lane), before, &watched.seen);
                    watched.correct(lane, felt);
                    watched.asked.ask(lane, asked);
                }
            }
            watched.noted[0] = watched.noted[*count];
        }
        *count = 0;
    }
}

impl Watched {
    /// The places of each lane's probe in chains that compute forces in `form`, at rest; nothing is asked yet.
    fn new<'a>(form: Form, probes: impl Iterator<Item = Option<&'a ForceProbe>>) -> Self {
        let mut watched = Self {
            lanes: 0,
            first: u8::MAX,
            around: Around::nothing(form),
            alike: false,
            noted: Box::default(),
            ends: Default::default(),
            felt: Default::default(),
            asked: Asked::nothing(),
            seen: Box::new(Seen::nothing()),
        };
        for (lane, probe) in probes.enumerate().take(WIDTH) {
            let Some(probe) = probe else { continue };
            if watched.lanes == 0 {
                // Lanes that have none are taken along.
                (0..WIDTH).for_each(|lane| watched.around.put(lane, probe));
            }
            watched.lanes |= 1 << lane;
            watched.around.put(lane, probe);
        }
        let above = |lane| watched.around.body(lane, MIDDLE);
        watched.alike = (1..WIDTH).all(|lane| above(lane) == above(0));
        watched
    }

    /// The bodies around the places.
    fn bodies(&self) -> impl Iterator<Item = usize> {
        let lanes = if self.alike { 1 } else { WIDTH };
        let around = (0..lanes).flat_map(|lane| (0..BODIES).map(move |index| (lane, index)));
        around.filter_map(|(lane, index)| self.around.body(lane, index))
    }

    /// Notes how the bodies around the places stand and move, `of` each body, nothing where there is none.
    fn note<'a>(&mut self, step: usize, of: impl Fn(usize) -> Option<[&'a Row; 3]>) {
        let Self { around, alike, noted, .. } = self;
        for index in 0..BODIES {
            let of = |lane| around.body(lane, index).and_then(&of);
            if *alike {
                let rows = of(0);
                for (part, noted) in noted[step].iter_mut().enumerate() {
                    noted[index] = rows.map_or(Row::default(), |rows| *rows[part]);
                }
                continue;
            }
            for lane in 0..WIDTH {
                let rows = of(lane);
                for (part, noted) in noted[step].iter_mut().enumerate() {
                    noted[index].0[lane] = rows.map_or(0.0, |rows| rows[part].0[lane]);
                }
            }
        }
    }

    /// Takes force (N) and rate of change (N/s) at the end of lane `lane`'s last step from somebody who has looked closer.
    fn correct(&mut self, lane: usize, felt: [f64; 2]) {
        for (row, value) in self.felt.iter_mut().zip(felt) {
            row.0[lane] = value;
        }
    }
}

/// Feels the ends of all steps that are noted.
struct Feel<'a> {
    watched: &'a mut Watched,
    count: usize,
}

impl Task for Feel<'_> {
    type Output = ();

    #[inline(always)]
    fn run<L: Lanes>(self) {
        let Watched { around, noted, ends, .. } = self.watched;
        for (end, [position, velocity, _]) in ends.iter_mut().zip(&noted[1..=self.count]) {
            let (mut force, mut rate) = (L::splat(0.0), L::splat(0.0));
            for (which, contact) in around.contacts.iter().enumerate() {
                let [stiffness, static_root, weight] = contact;
                let change = across::<L>(position, which);
                let closing = across::<L>(velocity, which);
                let constants = [L::load(stiffness), L::load(static_root)];
                let (felt, tangent) = lane_forces::<L>(constants, change, around.form);
                let weight = L::load(weight);
                force = L::mul_add(weight, felt, force);
                rate = L::mul_add(L::mul(weight, tangent), closing, rate);
            }
            L::store(force, &mut end[0]);
            L::store(rate, &mut end[1]);
        }
    }
}

/// How `body` stands and moves by these rows.
fn of(rows: Rows<'_>, body: usize) -> Option<[&Row; 3]> {
    let [position, velocity, acceleration] = rows;
    Some([position.get(body)?, velocity.get(body)?, acceleration.get(body)?])
}

/// How much more the body above contact `which` of the places has than the one below.
#[inline(always)]
fn across<L: Lanes>(rows: &[Row; BODIES], which: usize) -> L::V {
    let above = MIDDLE - 1 + which;
    L::sub(L::load(&rows[above]), L::load(&rows[above + 1]))
}

/// Takes a glance at a step's ends.
struct Glance<'a> {
    watched: &'a mut Watched,
    step: usize,
    lengths: &'a Row,
    taken: u8,
}

/// What a glance tells.
struct Wanted {
    /// Lanes whose step holds what is asked for, or may, a bit each.
    lanes: u8,
    /// Force and its rate of change where the step starts (N, N/s).
    before: [Row; 2],
}

impl Task for Glance<'_> {
    type Output = Wanted;

    #[inline(always)]
    fn run<L: Lanes>(self) -> Wanted {
        let Watched { lanes, first, ends, felt, asked, .. } = self.watched;
        let taken = self.taken & *lanes;
        let before = [L::load(&felt[0]), L::load(&felt[1])];
        let end = [L::load(&ends[self.step][0]), L::load(&ends[self.step][1])];
        let wanted = asked.wanted::<L>(before, end, L::load(self.lengths));
        let mut started = [Row::default(); 2];
        for which in 0..felt.len() {
            L::store(before[which], &mut started[which]);
            L::store(L::select(taken, end[which], before[which]), &mut felt[which]);
        }
        let lanes = taken & (wanted | *first);
        *first &= !taken;
        Wanted { lanes, before: started }
    }
}
