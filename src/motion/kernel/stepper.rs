//! A chain without losses at work under a method for forces that depend on positions alone.

use super::frame::Frame;
use super::opening::correct;
use super::rkn86::{EVALUATIONS, Evaluate, Trial, TrialStep};
use super::rows::{ChainRows, Motion, place};
use super::splitting::Step;
use super::vector::{InstructionSet, Row, WIDTH};
use crate::chain::{Chain, State};
use crate::motion::control::{Clock, StepControl, first_step, relative_error};
use crate::motion::hermite::{End, septic};
use crate::motion::splitting::{FORCE_GRADIENT, Splitting};
use crate::motion::two_step::{self, ContactMotion, NO_CONTACT, StiffContact, TwoStep};
use crate::motion::{IntegrateError, Integrator, Interpolant, LosslessScheme, Scales, Work};

/// Rows at rest that are kept in the sweep behind the last one that moves: within a step motion
/// spreads by a contact a stage, of which there are fewer than in these.
const MARGIN_ROWS: usize = 2;
/// Speed from which a row counts as moving, as a share of the largest at the start: forces without
/// cancellation send something ahead however far, far below 1e-13 of the impact, under which
/// nothing is a pulse (1).
const MOVING_SHARE: f64 = 1e-30;
/// A step grows at most by this factor: the error estimate does not see how sharply a force sets in
/// that begins at zero overlap. With 5 instead of 3, first peaks of a chain under gravity were five
/// to ten times as far off at 1e-6 to 1e-9 (1).
const MAX_GROWTH: f64 = 3.0;
/// A correction that moves positions by less than this share of the tolerance leaves the
/// accelerations as they are (1).
const UNMOVED_SHARE: f64 = 0.03;

/// Longest step that error control accepts, in terms of the fastest oscillation (rad).
const CONTROLLED_PHASE: f64 = 8.0 * std::f64::consts::PI / 15.0;

/// How steps are chosen.
enum Drive {
    Nystrom(Box<Nystrom>),
    Fixed(Clock),
    TwoStep(TwoStep, Option<StiffContact>),
}

/// The error-controlled pair.
struct Nystrom {
    control: StepControl,
    tolerance: f64,
    /// Largest overlap change and speed so far: errors are relative to them.
    scales: Scales,
    trial: Trial,
}

/// An integrator of a chain without losses.
pub struct VectorStepper {
    set: InstructionSet,
    chain: ChainRows,
    bodies: usize,
    lightest: f64,
    drive: Drive,
    method: &'static Splitting,
    now: Motion,
    previous: Motion,
    gradient: Vec<Row>,
    /// Length of the longest steps in terms of the fastest oscillation (rad).
    max_phase: f64,
    /// Rows in the sweep.
    live: usize,
    /// Rows in which nothing is faster are ahead of the wave (m/s).
    quiet: f64,
    time: f64,
    last_step: (f64, f64),
    work: Work,
    /// Steps in which contacts opened or closed.
    changes: u64,
    /// Room for frames: jerks, and displacements with forces; empty until one is asked for.
    frame: [[Vec<Row>; 2]; 2],
}

impl VectorStepper {
    /// Starts `scheme` on `chain` at `state`. Errors that the pair tolerates are relative to the
    /// largest overlap change and speed so far.
    pub fn new(chain: &Chain, state: &State, scheme: LosslessScheme, set: InstructionSet) -> Self {
        let rows = ChainRows::new(chain);
        let mut now = Motion::at_rest(rows.len());
        let bodies = chain.bodies().len();
        for (values, out) in
            [(&state.position, &mut now.position), (&state.velocity, &mut now.velocity)]
        {
            for (body, value) in values.iter().take(bodies).enumerate() {
                let (row, lane) = place(body);
                out[row].0[lane] = *value;
            }
        }
        let live = rows.len();
        let overlap = set.run(Evaluate { chain: &rows, live, motion: &mut now });
        let is_moving = |row: usize| {
            let all = [&now.position[row], &now.velocity[row], &now.acceleration[row]];
            all.into_iter().any(|row| *row != Row::default())
        };
        let last = (0..live).rev().find(|row| is_moving(*row)).unwrap_or(0);
        let speed = state.velocity.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let pacing = two_step::pacing(chain, &state.velocity);
        let fastest = pacing.stiff.map_or(0.0, |stiff| stiff.frequency).max(pacing.frequency);
        let max_phase = match scheme {
            LosslessScheme::Nystrom(_) => CONTROLLED_PHASE,
            LosslessScheme::Splitting(_, step) => step * fastest,
            LosslessScheme::TwoStep(..) => two_step::LONG_PHASE,
        };
        let (drive, method) = match scheme {
            LosslessScheme::Nystrom(tolerance) => {
                let position = chain.impact_overlap(&state.velocity).max(overlap);
                let scales = Scales { position, velocity: speed };
                let first = first_step(scales, pacing.frequency);
                let control = StepControl::new(first, 6).growing(MAX_GROWTH);
                let trial = Trial::new(live);
                let nystrom = Nystrom { control, tolerance, scales, trial };
                (Drive::Nystrom(Box::new(nystrom)), &FORCE_GRADIENT)
            }
            LosslessScheme::Splitting(method, step) => {
                (Drive::Fixed(Clock::new(step, state.time, method.first_step)), method)
            }
            LosslessScheme::TwoStep(method, tolerance) => {
                let motion = contact_motion(pacing.stiff.as_ref(), &now);
                let steps = TwoStep::new(&pacing, tolerance, motion);
                (Drive::TwoStep(steps, pacing.stiff), method)
            }
        };
        Self {
            set,
            bodies,
            lightest: chain.lightest(),
            drive,
            method,
            max_phase,
            previous: now.clone(),
            now,
            gradient: vec![Row::default(); live],
            live: (last + 1 + MARGIN_ROWS).min(live),
            chain: rows,
            quiet: MOVING_SHARE * speed,
            time: state.time,
            last_step: (state.time, 0.0),
            work: Work { force_evaluations: 1, ..Work::default() },
            changes: 0,
            frame: Default::default(),
        }
    }

    /// The instructions that it runs with.
    pub fn instructions(&self) -> InstructionSet {
        self.set
    }

    /// Length of the longest steps in terms of the chain's fastest oscillation (rad).
    pub fn max_phase(&self) -> f64 {
        self.max_phase
    }

    /// Steps in which contacts opened or closed.
    pub fn contact_changes(&self) -> u64 {
        self.changes
    }

    /// Position, velocity and acceleration of `body` at the end of the last step; zero for a body
    /// that is not there (m, m/s, m/s²).
    #[inline]
    pub fn motion(&self, body: Option<usize>) -> [f64; 3] {
        match body {
            Some(body) => self.now.of(body),
            None => [0.0; 3],
        }
    }

    /// Displacement of each body (m) and force change of each contact (N) at the fraction `theta`
    /// of the last step.
    pub fn frame(&mut self, theta: f64) -> (impl Iterator<Item = f64>, impl Iterator<Item = f64>) {
        let rows = self.chain.len();
        let [jerks, out] = &mut self.frame;
        for rows_of in jerks.iter_mut().chain(out.iter_mut()) {
            rows_of.resize(rows, Row::default());
        }
        let Self { chain, live, previous, now, last_step, .. } = self;
        let h = last_step.1;
        self.set.run(Frame { chain, live: *live, ends: [previous, now], theta, h, jerks, out });
        let flat = |rows: &'_ [Row], count: usize| {
            rows.iter().flat_map(|row| row.0).take(count).collect::<Vec<f64>>().into_iter()
        };
        (flat(&out[0], self.bodies), flat(&out[1], self.bodies + 1))
    }

    /// Takes one trial step of the pair; whether it is accepted.
    fn attempt(&mut self, end: f64) -> Result<bool, IntegrateError> {
        let Drive::Nystrom(nystrom) = &mut self.drive else { return Ok(true) };
        let Nystrom { control, tolerance, scales, trial } = &mut **nystrom;
        let step = control.trial(self.time, end)?;
        let (h, live, chain) = (step.length, self.live, &self.chain);
        let (now, next) = (&self.now, &mut self.previous);
        let attempt = TrialStep { chain, live, now, next: &mut *next, trial: &mut *trial, h };
        let mut judged = self.set.run(attempt);
        self.work.force_evaluations += EVALUATIONS;
        let tolerated = [*tolerance * scales.position, *tolerance * scales.velocity];
        let mut error = relative_error(judged.errors, *scales) / *tolerance;
        let mut is_changed = false;
        if judged.is_changed && error.is_finite() {
            let guard =
                correct(chain, (now, &mut *next), &mut *trial, h, (tolerated, self.lightest));
            if guard.is_changed {
                let [x, v] = trial.errors.each_ref().map(|rows| largest(&rows[..live]));
                let errors = [x.max(guard.position), v.max(guard.velocity)];
                error = relative_error(errors, *scales) / *tolerance;
                if error <= 1.0 && guard.moved > UNMOVED_SHARE * tolerated[0] {
                    judged.overlap = self.set.run(Evaluate { chain, live, motion: next });
                    self.work.force_evaluations += 1;
                }
                is_changed = true;
            }
        }
        let lost = || next.first_not_finite().unwrap_or(0);
        if !control.accepts(step, error, lost) {
            self.work.rejected += 1;
            return Ok(false);
        }
        scales.widen(Scales { position: judged.overlap, velocity: judged.speed });
        self.changes += u64::from(is_changed);
        self.finish(step.next, h);
        Ok(true)
    }

    /// Makes the end of a step of `h` (s) the present.
    fn finish(&mut self, time: f64, h: f64) {
        std::mem::swap(&mut self.now, &mut self.previous);
        self.last_step = (self.time, h);
        self.time = time;
        self.work.steps += 1;
        let rows = self.chain.len();
        if self.live < rows {
            let front = self.live.saturating_sub(MARGIN_ROWS)..self.live;
            let is_moving = |row: &Row| row.0.iter().any(|v| v.abs() > self.quiet);
            if self.now.velocity[front].iter().any(is_moving) {
                self.live = (self.live + MARGIN_ROWS).min(rows);
            }
        }
    }

    /// Takes a step of the splitting.
    fn split(&mut self, end: f64) -> Result<(), IntegrateError> {
        let (h, next_time) = match &mut self.drive {
            Drive::Fixed(clock) => clock.next(self.time, end),
            Drive::TwoStep(steps, _) => steps.next(self.time, end),
            Drive::Nystrom(_) => return Ok(()),
        };
        let Self { set, chain, live, method, now, previous, gradient, .. } = self;
        let (live, next) = (*live, &mut *previous);
        if !set.run(Step { chain, live, method, now, next, gradient, h }) {
            let body = self.previous.first_not_finite().unwrap_or(0);
            return Err(IntegrateError::NotFinite { body, time: self.time });
        }
        self.work.force_evaluations += self.method.drifts.len() as u64;
        self.changes += u64::from(self.now.closed[..live] != self.previous.closed[..live]);
        self.finish(next_time, h);
        if let Drive::TwoStep(steps, stiff) = &mut self.drive {
            steps.advance(contact_motion(stiff.as_ref(), &self.now));
        }
        Ok(())
    }
}

/// How the stiff contact moves; as if there were none where there is none.
fn contact_motion(stiff: Option<&StiffContact>, motion: &Motion) -> ContactMotion {
    let Some(stiff) = stiff else { return NO_CONTACT };
    let of = |body: Option<usize>| body.map_or([0.0; 3], |body| motion.of(body));
    let [above, below] = stiff.bodies.map(of);
    let overlap = stiff.static_overlap + above[0] - below[0];
    ContactMotion { overlap, closing: above[1] - below[1], bend: above[2] - below[2] }
}

/// Largest magnitude; not a number if one of them is not (unit).
fn largest(rows: &[Row]) -> f64 {
    let larger = |most: f64, value: f64| if value <= most || most.is_nan() { most } else { value };
    let mut lanes = [0.0_f64; WIDTH];
    for row in rows {
        for (most, value) in lanes.iter_mut().zip(row.0) {
            *most = larger(*most, value.abs());
        }
    }
    lanes.into_iter().fold(0.0, larger)
}

impl Integrator for VectorStepper {
    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        let flat = |rows: &[Row]| rows.iter().flat_map(|row| row.0).take(self.bodies).collect();
        let Motion { position, velocity, .. } = &self.now;
        State { time: self.time, position: flat(position), velocity: flat(velocity) }
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        if let Drive::Nystrom(_) = self.drive {
            while !self.attempt(end)? {}
            return Ok(());
        }
        self.split(end)
    }

    fn prepare_interpolation(&mut self) {}

    fn interpolant(&self, body: usize) -> Interpolant {
        let end = |motion: &Motion| {
            let [position, velocity, acceleration] = motion.of(body);
            (End { position, velocity, acceleration }, motion.jerk(&self.chain, body))
        };
        let ((from, early), (to, late)) = (end(&self.previous), end(&self.now));
        septic(from, to, (early, late), self.last_step.1)
    }

    fn body(&self, body: usize) -> [f64; 2] {
        let [position, velocity, _] = self.now.of(body);
        [position, velocity]
    }

    fn last_step(&self) -> (f64, f64) {
        self.last_step
    }

    fn work(&self) -> Work {
        self.work
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_a_number_is_not_lost_among_larger_ones() {
        for place in 0..3 * WIDTH {
            let mut rows = [Row([1.0; WIDTH]), Row([-7.0; WIDTH]), Row([9.0; WIDTH])];
            assert!((largest(&rows) - 9.0).abs() < f64::EPSILON);
            rows[place / WIDTH].0[place % WIDTH] = f64::NAN;
            assert!(largest(&rows).is_nan(), "{place}");
        }
    }
}
