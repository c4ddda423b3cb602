//! What places in each lane's chain have felt in the last steps, and into which of those somebody has to look: a few steps are noted, their ends
//! felt side by side, and few of them looked into.

use super::watched::{Feel, Glance, Wanted, Watched};
use super::{ChainGroup, bits};
use crate::chain::ForceProbe;
use crate::chain::stepper::around::row_of;
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::look_in::SideBySide;
use crate::chain::stepper::notes::Notes;
use crate::chain::stepper::seen::Seen;

/// The last steps of a group's chains at their watched places.
#[derive(Debug, Clone, Default)]
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
    /// Has `trail` begin here, whatever it was of, with the places of each lane's probes.
    pub fn begin_trail(&self, trail: &mut GroupTrail, probes: &[&[ForceProbe]]) {
        let count = probes.iter().map(|probes| probes.len()).max().unwrap_or(0);
        let rows = self.work.now.moving();
        trail.count = 0;
        trail.places.resize_with(count, Watched::default);
        for (place, watched) in trail.places.iter_mut().enumerate() {
            watched.begin(self.plan.form, probes.iter().map(|probes| probes.get(place)));
            watched.note(self.set, 0, |body| row_of(rows, body));
        }
        let bodies = trail.places.iter().flat_map(Watched::bodies).chain(self.drive.asks());
        trail.notes.ask(GroupTrail::STEPS - 1, bodies.filter(|body| *body < rows[0].len()));
    }

    /// Tries a step in every lane that is still moving, or takes as many of one length as the trail has room for, which must be one, and notes them.
    pub fn follow(&mut self, trail: &mut GroupTrail) {
        let room = GroupTrail::STEPS - trail.count;
        trail.notes.clear();
        let (count, taken) = self.step(room, &mut trail.notes);
        let rows = self.work.now.moving();
        for (step, before) in (0..count).rev().enumerate() {
            trail.taken[trail.count] = bits(taken);
            trail.times[trail.count] = self.drive.last_steps(before);
            trail.count += 1;
            let GroupTrail { places, notes, .. } = trail;
            for watched in places {
                match before {
                    0 => watched.note(self.set, trail.count, |body| row_of(rows, body)),
                    _ => watched.note(self.set, trail.count, |body| notes.at(step, body)),
                }
            }
        }
    }

    /// Reads the steps that are noted, and has `look` look into those that hold what is asked for, or may.
    pub fn read(&self, trail: &mut GroupTrail, look: &mut Look<'_>) {
        let GroupTrail { count, taken, times, places, .. } = trail;
        for (place, watched) in places.iter_mut().enumerate() {
            dispatch(self.set, Feel { watched, count: *count });
            let mut from = 0;
            while let Some(Wanted { step, lanes, before }) =
                dispatch(self.set, Glance { watched, steps: [from, *count], times, taken })
            {
                from = step + 1;
                let Watched { around, noted, seen, .. } = watched;
                let (ends, (starts, lengths)) = ([&noted[step], &noted[from]], &times[step]);
                dispatch(self.set, SideBySide { around, ends, times: (*starts, lengths), seen });
                for lane in (0..WIDTH).filter(|lane| lanes & (1 << lane) != 0) {
                    let before = before.each_ref().map(|row| row.0[lane]);
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
