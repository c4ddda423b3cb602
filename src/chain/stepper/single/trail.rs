//! What places of a chain have felt in its last steps: eight steps are noted and then looked into side by side.

use super::{Burst, ChainStepper, Course};
use crate::chain::ForceProbe;
use crate::chain::stepper::around::{Around, BODIES, Bodies, Moves, row_of};
use crate::chain::stepper::dispatch::dispatch;
use crate::chain::stepper::force_track::Place;
use crate::chain::stepper::lanes::{Row, WIDTH};
use crate::chain::stepper::look_in::OnEnd;
use crate::chain::stepper::notes::{Note, Notes};
use crate::chain::stepper::samples::{Due, Sample};
use crate::chain::stepper::seen::{Depth, Seen};
use crate::chain::stepper::wanted::Asked;
use crate::integrate::IntegrateError;

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
    /// What is noted of steps that are taken at once.
    notes: Notes,
    places: Vec<Box<Watched>>,
}

/// Where a body lies.
#[derive(Debug, Clone, Copy)]
struct Lying {
    row: usize,
    lane: usize,
    /// Which of a step's notes is its row's.
    note: usize,
}

/// Where there is no body: nothing moves there.
const NOWHERE: Lying = Lying { row: usize::MAX, lane: 0, note: usize::MAX };

/// A place that is watched.
#[derive(Debug, Clone)]
struct Watched {
    place: Place,
    around: Around,
    /// The bodies around it.
    bodies: [Lying; BODIES],
    /// How they stood and moved at the end of each step.
    noted: Bodies,
    /// How its contacts stood before the first step, in the last lane.
    before: Moves,
    seen: Seen,
    /// Force (N) and its rate of change (N/s) before the first step, in the last lane.
    felt: [Row; 2],
    /// What is asked of the steps, and which of those read last may hold it, a bit each.
    asked: Asked,
    wanted: u8,
}

impl Watched {
    /// Notes how the bodies around it stand and move at the end of step `step`, `of` their rows; nothing where there is none.
    #[inline(always)]
    #[allow(clippy::inline_always, reason = "for each way to find a row")]
    fn note<'a>(&mut self, step: usize, of: impl Fn(Lying) -> Option<[&'a Row; 3]>) {
        for (index, body) in self.bodies.into_iter().enumerate() {
            let rows = of(body);
            for (part, noted) in self.noted.iter_mut().enumerate() {
                let value = rows.map_or(0.0, |rows| rows[part].0[body.lane % WIDTH]);
                noted[index].0[step % WIDTH] = value;
            }
        }
    }
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
            let lying = |body| {
                let (row, lane) = self.course.place(body);
                Lying { row, lane, ..NOWHERE }
            };
            let bodies = std::array::from_fn(|index| body(index).map_or(NOWHERE, lying));
            Box::new(Watched {
                place: Place::new(probe),
                around,
                bodies,
                noted: Bodies::default(),
                before: Moves::default(),
                seen: Seen::default(),
                felt: Default::default(),
                asked: Asked::default(),
                wanted: 0,
            })
        };
        let mut places: Vec<Box<Watched>> = probes.iter().map(watched).collect();
        let asked = places.iter().flat_map(|watched| watched.bodies).map(|body| body.row);
        let notes =
            Notes::new(Trail::STEPS, asked.filter(|row| *row < self.course.plan.all_rows()));
        for body in places.iter_mut().flat_map(|watched| &mut watched.bodies) {
            body.note = notes.place_of(body.row).unwrap_or(usize::MAX);
        }
        let one = Row([1.0; WIDTH]);
        let (starts, lengths, ends) = (one, one, one);
        let mut trail = Trail { count: 0, first: 1, starts, lengths, ends, notes, places };
        // A step that ends here: its end is where the first one starts.
        let now = self.course.work.now.moving();
        for watched in &mut trail.places {
            watched.note(WIDTH - 1, |body| row_of(now, body.row));
        }
        self.look(&mut trail, Depth::Asked);
        trail
    }

    /// Takes and notes as many steps as can be taken at once and as there is room for, which must be one: up to `end`, none that begins at `pause`
    /// or later but the first (s).
    ///
    /// # Errors
    /// [`IntegrateError`] where the method cannot go on.
    pub fn follow(
        &mut self,
        trail: &mut Trail,
        [end, pause]: [f64; 2],
    ) -> Result<(), IntegrateError> {
        let Trail { count, starts, lengths, ends, notes, places, .. } = trail;
        notes.clear();
        let most = (Trail::STEPS - *count) as u64;
        let taken = self.several(&mut Burst { end, pause, most, notes })?;
        let work = &self.course.work;
        let (last, first) = (work.now.moving(), work.next.moving());
        let taken = usize::try_from(taken).unwrap_or(Trail::STEPS);
        for (step, before) in (0..taken).rev().enumerate() {
            let [start, length, end] = self.times(before);
            (starts.0[*count], lengths.0[*count], ends.0[*count]) = (start, length, end);
            let of_step = notes.of_step(step);
            for watched in &mut *places {
                match before {
                    0 => watched.note(*count, |body| row_of(last, body.row)),
                    1 => watched.note(*count, |body| row_of(first, body.row)),
                    _ => watched.note(*count, |body| of_step.get(body.note).map(Note::each_ref)),
                }
            }
            *count += 1;
        }
        Ok(())
    }

    /// Looks into the steps that are noted, at least one, as far as `depth` says.
    pub fn read(&self, trail: &mut Trail, depth: Depth) {
        self.look(trail, depth);
        let last = trail.count - 1;
        for watched in &mut trail.places {
            for row in watched.before.as_flattened_mut().iter_mut().chain(&mut watched.felt) {
                row.0[WIDTH - 1] = row.0[last];
            }
            watched.wanted &= u8::MAX >> (WIDTH - 1 - last);
        }
        trail.first = 0;
    }

    fn look(&self, trail: &mut Trail, depth: Depth) {
        let Trail { first, starts, lengths, places, .. } = trail;
        for watched in places {
            let Watched { around, before: moves, noted: bodies, seen, felt, asked, .. } =
                &mut **watched;
            let (times, always) = ((*starts, &*lengths), *first);
            let on_end = OnEnd { around, moves, bodies, times, seen, felt, asked, always, depth };
            watched.wanted = dispatch(self.course.set, on_end);
        }
    }

    /// Adds the forces at place `place` at the times that are `due` in the steps read last to `samples` (N).
    pub fn sample(&self, trail: &Trail, place: usize, due: &Due, samples: &mut Vec<f64>) {
        let Watched { place, seen, .. } = &*trail.places[place];
        let Course { set, plan, .. } = &self.course;
        dispatch(*set, Sample { place, seen, form: plan.form, due, out: samples });
    }
}
