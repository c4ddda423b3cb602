//! One chain, stepped with error control along the rows, or in fixed steps in tiles, or striped where it is short.

/// `$body` for the layout of a chain that is `$laid` so.
macro_rules! laid {
    ($laid:expr, $layout:ident => $body:expr) => {
        match $laid {
            Laid::Along => {
                type $layout = Along;
                $body
            }
            Laid::Tiled => {
                type $layout = Tiled;
                $body
            }
            Laid::Striped => {
                type $layout = Striped;
                $body
            }
        }
    };
}

mod burst;
mod course;
mod drive;
mod look;
mod paced;
mod paired;
mod split;
mod trail;

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::frame::Ends;
use super::lanes::Row;
use super::layout::{Along, Layout, Striped, Tiled};
use super::notes::Notes;
use super::plan::{Form, Plan, are_few, rows_of};
use super::steps::{AT_ONCE, find_gradients, finest_asked};
use super::tasks::{Evaluate, Settle};
use super::workspace::Workspace;
use crate::chain::Chain;
use crate::integrate::hermite::{End, septic};
use crate::integrate::{IntegrateError, Integrator, Interpolant, Scheme, State, Work};
use burst::Burst;
use course::{Course, Laid, UNDER_WAY, margin};
use drive::Drive;
use paced::InSteps;
use paired::Paired;
use split::Split;
pub use trail::Trail;

/// What the stepper does on its own account; to be left out for comparison only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refinement {
    /// Steps in which contacts open or close are put right, and taken again where they may have missed one.
    KinkCorrection,
    /// Steps that would end too far beyond the closing of a stiff contact are made shorter before they are tried.
    Foresight,
    /// Contacts ahead of the wave, where nothing has moved yet that could be seen, are left alone.
    QuietPart,
    /// The form that forces are computed in: leaving it out takes the other one.
    ForceForm,
}

/// Where a chain starts: time (s), positions (m) and velocities (m/s); bodies behind the last that is told of are at rest.
type Start<'a> = (f64, [&'a [f64]; 2]);

fn start_of(state: &State) -> Start<'_> {
    (state.time, [&state.position, &state.velocity])
}

/// A lossless chain under a method for forces that depend on positions alone.
pub struct ChainStepper {
    course: Course,
    drive: Drive,
    scheme: Scheme,
    bodies: usize,
    last_step: (f64, f64),
    /// Rates of the accelerations at the start and the end of the last step (m/s³), and which step that was; empty until they are asked for.
    jerks: [Vec<Row>; 2],
    jerks_of: u64,
    /// Room for a frame, once one is asked for: positions (m) and force changes (N).
    frame: [Vec<Row>; 2],
}

impl ChainStepper {
    /// Starts `scheme` on `chain` with `velocities` (m/s). Errors that a pair tolerates are relative to the largest overlap change and
    /// speed so far.
    #[must_use]
    pub fn new(chain: &Chain, velocities: &[f64], scheme: Scheme, set: InstructionSet) -> Self {
        let form = Form::needed(chain, velocities, finest_asked(scheme));
        Self::with_form(chain, (0.0, [&[], velocities]), scheme, (set, form))
    }

    /// Starts at `state`, as [`ChainStepper::new`] does at rest.
    #[must_use]
    pub fn from_state(chain: &Chain, state: &State, scheme: Scheme, set: InstructionSet) -> Self {
        let form = Form::needed(chain, &state.velocity, finest_asked(scheme));
        Self::with_form(chain, start_of(state), scheme, (set, form))
    }

    fn with_form(
        chain: &Chain,
        from: Start,
        scheme: Scheme,
        (set, form): (InstructionSet, Form),
    ) -> Self {
        let laid = match scheme {
            // Pairs go from overlap to overlap, which gains nothing by stripes.
            Scheme::Pair(..) => Laid::Along,
            _ if are_few(rows_of(chain), form) => Laid::Striped,
            _ => Laid::Tiled,
        };
        laid!(laid, Y => Self::laid::<Y>(laid, (chain, from), scheme, (set, form)))
    }

    fn laid<Y: Layout>(
        laid: Laid,
        (chain, (time, moving)): (&Chain, Start),
        scheme: Scheme,
        (set, form): (InstructionSet, Form),
    ) -> Self {
        let [positions, velocities] = moving;
        let mut plan = Plan::one::<Y>(chain, scheme, (set, form));
        dispatch(set, Settle::<Y>(&mut plan, PhantomData));
        let mut work = Workspace::new(plan.all_rows(), scheme);
        let now = work.now.parts();
        let rows = plan.all_rows();
        // Most bodies are at rest, and nearly all others where they were.
        for (values, out) in [(positions, now.position), (velocities, now.velocity)] {
            for (i, value) in values.iter().enumerate().filter(|(_, value)| **value != 0.0) {
                let (row, lane) = Y::place(rows, i, 0);
                out[row].0[lane] = *value;
            }
        }
        let overlap = dispatch(set, Evaluate::<Y>::at(&plan, &mut work.now));
        work.next.closed.clone_from(&work.now.closed);
        work.next.parts().force.copy_from_slice(work.now.force());
        let moves = |row: usize| {
            let now = &work.now;
            let all = [&now.velocity()[row], &now.position()[row], &now.acceleration()[row]];
            all.iter().any(|row| **row != Row::default())
        };
        let last = (0..plan.all_rows()).rev().find(|row| moves(*row)).unwrap_or(0);
        if Y::TILE != 0 {
            let live = (last + 1 + margin::<Y>()).next_multiple_of(Y::TILE.max(1));
            plan.live = live.min(plan.all_rows());
        }
        let counts = Work { force_evaluations: 1, ..Work::default() };
        let speed = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let quiet = UNDER_WAY * speed;
        let mut course = Course { set, laid, plan, quiet, work, time, counts };
        let drive = match scheme {
            Scheme::Pair(pair, tolerance) => {
                let scales = (chain.impact_overlap(velocities).max(overlap.0[0]), speed);
                let (pair, watched) = ((pair, tolerance), !course.plan.watched.is_empty());
                Drive::Paired(Box::new(Paired::new(pair, scales, chain.lightest(), watched)))
            }
            Scheme::Splitting(method, step) => {
                find_gradients::<Y>(set, method, (&course.plan, &mut course.work));
                Drive::Split(Split::new(method, step, time))
            }
            Scheme::Paced(method, tolerance) => {
                find_gradients::<Y>(set, method, (&course.plan, &mut course.work));
                Drive::Paced(Box::new(InSteps::new(
                    method,
                    tolerance,
                    (chain, velocities),
                    &course,
                )))
            }
        };
        Self {
            course,
            drive,
            scheme,
            bodies: chain.bodies().len(),
            last_step: (time, 0.0),
            jerks: [Vec::new(), Vec::new()],
            jerks_of: u64::MAX,
            frame: [Vec::new(), Vec::new()],
        }
    }

    /// The stepper, not yet started on `chain`, without one of its refinements.
    #[must_use]
    pub fn without(mut self, refinement: Refinement, chain: &Chain) -> Self {
        match refinement {
            Refinement::KinkCorrection => {
                if let Drive::Paired(paired) = &mut self.drive {
                    paired.corrects = false;
                }
            }
            Refinement::Foresight => self.course.plan.watched.clear(),
            Refinement::QuietPart => self.course.plan.live = self.course.plan.all_rows(),
            Refinement::ForceForm => {
                let form = match self.course.plan.form {
                    Form::Plain => Form::Exact,
                    Form::Exact => Form::Plain,
                    Form::Linear => Form::Linear,
                };
                let set = self.course.set;
                return Self::with_form(chain, start_of(&self.state()), self.scheme, (set, form));
            }
        }
        self
    }

    /// Takes steps at once, or one where that cannot be; tells how many.
    fn several(&mut self, burst: &mut Burst) -> Result<u64, IntegrateError> {
        let Self { drive, course, last_step, .. } = self;
        let taken = if course.is_all_under_way() { drive.several(course, burst)? } else { None };
        if let Some(taken) = taken {
            *last_step = taken.last;
            return Ok(taken.count);
        }
        self.step(burst.end)?;
        Ok(1)
    }

    /// Start, length and end of the step that was `before` the last, and taken at once with it (s).
    fn times(&self, before: usize) -> [f64; 3] {
        match before {
            0 => [self.last_step.0, self.last_step.1, self.course.time],
            1.. => self.drive.times(before),
        }
    }

    /// Whether forces are computed without cancellation.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.course.plan.form == Form::Exact
    }

    /// Steps tried in which contacts opened or closed; methods with a fixed step do not ask.
    #[must_use]
    pub fn events(&self) -> Option<u64> {
        self.drive.events()
    }
}

impl Integrator for ChainStepper {
    fn time(&self) -> f64 {
        self.course.time
    }

    fn state(&self) -> State {
        let course = &self.course;
        let flat = |rows| course.flat(rows, self.bodies).collect();
        let (position, velocity) = course.work.now.seen();
        State { time: course.time, position: flat(position), velocity: flat(velocity) }
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        let Self { drive, course, last_step, .. } = self;
        *last_step = drive.step(course, end)?;
        course.follow_front();
        Ok(())
    }

    fn advance(&mut self, end: f64) -> Result<(), IntegrateError> {
        let notes = &mut Notes::default();
        while self.course.time < end {
            let most = u64::from(AT_ONCE);
            self.several(&mut Burst { end, pause: end, most, notes: &mut *notes })?;
        }
        Ok(())
    }

    fn prepare_interpolation(&mut self) {
        self.find_jerks();
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let Ends { from, to, span: (_, length) } = self.ends();
        let (row, lane) = self.course.place(body);
        let at = |rows: [&[Row]; 4]| rows.map(|rows| rows[row].0[lane]);
        let ([x0, v0, a0, j0], [x1, v1, a1, j1]) = (at(from), at(to));
        let from = End { position: x0, velocity: v0, acceleration: a0 };
        let to = End { position: x1, velocity: v1, acceleration: a1 };
        septic(from, to, (j0, j1), length)
    }

    fn last_step(&self) -> (f64, f64) {
        self.last_step
    }

    fn work(&self) -> Work {
        self.course.counts
    }
}
