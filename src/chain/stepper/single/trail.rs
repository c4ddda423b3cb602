//! What places of a chain have felt in its last steps: eight steps are noted and then looked into side by side.

use super::{ChainStepper, Course};
use crate::chain::ForceProbe;
use crate::chain::stepper::around::{Around, BODIES, Bodies, Moves, OnEnd, Seen};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::{Due, Place, ROOM_BEHIND, Sample};
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::wanted::Asked;
use crate::integrate::Integrator;

/// The last steps of a chain at its watched places, up to eight of them.
#[derive(Debug, Clone)]
pub struct Trail {
    count: usize,
    /// The first step, if it has not been read yet, as a bit: it is looked into whatever is asked, for a place may start with a rate of change
    /// that is nothing but rounding.
    first: u8,
    starts: Row,
    lengths: Row,
    ends: Row,
    places: Vec<Watched>,
}

/// Where there is no body: nothing moves there.
const NOWHERE: (usize, usize) = (usize::MAX, 0);

/// A place that is watched.
#[derive(Debug, Clone)]
struct Watched {
    place: Place,
    around: Around,
    /// Row and lane of each of the bodies around it.
    bodies: [(usize, usize); BODIES],
    /// How they stood and moved at the end of each step.
    noted: Box<Bodies>,
    /// How its contacts stood before the first step, in the last lane.
    before: Moves,
    seen: Box<Seen>,
    /// Force (N) and its rate of change (N/s) before the first step, in the last lane.
    felt: [Row; 2],
    /// What is asked of the steps, and which of those read last may hold it, a bit each.
    asked: Asked,
    wanted: u8,
}

impl Trail {
    /// Most steps that are noted.
    pub const STEPS: usize = WIDTH;

    /// Steps noted so far.
    #[must_use]
    pub fn steps(&self) -> usize {
        self.count
    }

    /// Start, length and end of step `step` (s).
    #[must_use]
    pub fn times(&self, step: usize) -> [f64; 3] {
        [&self.starts, &self.lengths, &self.ends].map(|row| row.0[step])
    }

    /// What was felt at place `place` in the steps read last, one in each lane.
    #[must_use]
    pub fn seen(&self, place: usize) -> &Seen {
        &self.places[place].seen
    }

    /// Asks the steps to be read at place `place` for maxima above the first and any forces above the second (N).
    pub fn ask(&mut self, place: usize, asked: [f64; 2]) {
        for lane in 0..WIDTH {
            self.places[place].asked.ask(lane, asked);
        }
    }

    /// Which of the steps read last may hold what was asked for at place `place`, a bit each: where nothing was asked none but
    /// the first of all.
    #[must_use]
    pub fn wanted(&self, place: usize) -> u8 {
        self.places[place].wanted
    }

    /// Goes on with the next steps.
    pub fn clear(&mut self) {
        self.count = 0;
    }
}

impl ChainStepper {
    /// A trail of the places of `probes` that begins here.
    #[must_use]
    pub fn trail(&self, probes: &[ForceProbe]) -> Trail {
        let watched = |probe: &ForceProbe| {
            let mut around = Around::nothing(self.course.plan.form);
            for lane in 0..WIDTH {
                around.put(lane, probe);
            }
            let body = |index| around.body(0, index).filter(|body| *body < self.bodies);
            let place = |index| body(index).map_or(NOWHERE, |body| self.course.place(body));
            let bodies = std::array::from_fn(place);
            Watched {
                place: Place::new(probe),
                around,
                bodies,
                noted: Box::default(),
                before: Moves::default(),
                seen: Box::new(Seen::nothing()),
                felt: Default::default(),
                asked: Asked::nothing(),
                wanted: 0,
            }
        };
        let places = probes.iter().map(watched).collect();
        let one = Row([1.0; WIDTH]);
        let mut trail = Trail { count: 0, first: 1, starts: one, lengths: one, ends: one, places };
        // A step that ends here: its end is where the first one starts.
        self.note_in(&mut trail, WIDTH - 1);
        self.look(&mut trail);
        trail
    }

    /// Notes the last step, for which there must be room.
    pub fn note(&self, trail: &mut Trail) {
        let step = trail.count;
        let (start, length) = self.last_step;
        (trail.starts.0[step], trail.lengths.0[step]) = (start, length);
        trail.ends.0[step] = self.time();
        self.note_in(trail, step);
        trail.count = step + 1;
    }

    fn note_in(&self, trail: &mut Trail, step: usize) {
        let state = self.course.work.now.moving();
        for Watched { bodies, noted, .. } in &mut trail.places {
            for (rows, noted) in state.iter().zip(noted.iter_mut()) {
                for ((row, lane), noted) in bodies.iter().zip(noted) {
                    noted.0[step % WIDTH] = rows.get(*row).map_or(0.0, |row| row.0[lane % WIDTH]);
                }
            }
        }
    }

    /// Looks into the steps that are noted, at least one.
    pub fn read(&self, trail: &mut Trail) {
        self.look(trail);
        let last = trail.count - 1;
        for watched in &mut trail.places {
            for row in watched.before.as_flattened_mut().iter_mut().chain(&mut watched.felt) {
                row.0[WIDTH - 1] = row.0[last];
            }
            watched.wanted = (watched.wanted | trail.first) & (u8::MAX >> (WIDTH - 1 - last));
        }
        trail.first = 0;
    }

    fn look(&self, trail: &mut Trail) {
        let Trail { starts, lengths, places, .. } = trail;
        for watched in places {
            let Watched { around, before: moves, noted: bodies, seen, felt, asked, .. } = watched;
            let times = (*starts, &*lengths);
            let on_end = OnEnd { around, moves, bodies, times, seen, felt, asked };
            watched.wanted = dispatch(self.course.set, on_end);
        }
    }

    /// Adds the forces at place `place` at the times that are `due` in the steps read last to `samples` (N).
    pub fn sample(&self, trail: &Trail, place: usize, due: &Due, samples: &mut Vec<f64>) {
        let before = samples.len();
        let count: usize = due.counts.iter().sum();
        samples.resize(before + count + ROOM_BEHIND, 0.0);
        let Watched { place, seen, .. } = &trail.places[place];
        let (Course { set, plan, .. }, out) = (&self.course, &mut samples[before..]);
        dispatch(*set, Sample { place, seen, form: plan.form, due, out });
        samples.truncate(before + count);
    }
}
