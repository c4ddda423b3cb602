//! Explicit Runge-Kutta methods for `x' = v`, `v' = a(x, v)`: forces may depend on velocity.
//!
//! A method is its stages; the last one stands at the new state and opens the next step. With an embedded error estimate steps are
//! chosen, without one they are fixed. Interpolation is quintic Hermite, of an order above the methods'.

use super::control::{StepControl, add_compensated, first_step_of, largest, relative_error};
use super::hermite::Between;
use super::splitting::REMAINDER;
use super::stages::{Row, add_up};
use super::switches::Restart;
use super::{
    IntegrateError, Integrator, Interpolant, Scales, State, System, Work, first_not_finite,
};

/// Coefficients of a method whose last stage opens the next step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RungeKutta {
    /// Name as written in scenes, options and recordings.
    pub name: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order of the solution that is continued.
    pub order: u8,
    /// Weights of each stage's argument; those of the last are the solution's.
    pub stages: &'static [Row],
    /// Weights of the error, and the order of the embedded solution.
    pub error: Option<(Row, u8)>,
    /// Longest stable step times the highest angular frequency (1).
    pub oscillation_reach: f64,
    /// Longest stable step times the fastest decay (1).
    pub decay_reach: f64,
}

/// How steps are chosen.
enum Pace {
    /// Time is `origin + count * step`, never a running sum; an interval's end starts a new count.
    Fixed {
        step: f64,
        origin: f64,
        count: u64,
    },
    Controlled {
        control: StepControl,
        tolerance: f64,
    },
}

/// Rates of positions (m/s) and velocities (m/s²) at a stage.
type Rates = [Vec<f64>; 2];

/// A method at work on a system.
pub struct RungeKuttaIntegrator<'a> {
    method: &'static RungeKutta,
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    scratch: State,
    stages: Vec<Rates>,
    lost: Rates,
    scales: Scales,
    pace: Pace,
    work: Work,
}

impl<'a> RungeKuttaIntegrator<'a> {
    /// Starts `method` at `state`; `setting` is its step (s), or the tolerated error of a step relative to the system's
    /// scales (1) if the method estimates its error.
    pub fn new(
        method: &'static RungeKutta,
        system: Box<dyn System + 'a>,
        state: State,
        setting: f64,
    ) -> Self {
        let n = system.len();
        let zero = [vec![0.0; n], vec![0.0; n]];
        let scales = system.scales(&state.position, &state.velocity);
        let pace = match method.error {
            None => Pace::Fixed { step: setting, origin: state.time, count: 0 },
            Some((_, order)) => {
                let first = first_step_of(system.as_ref(), &state);
                Pace::Controlled { control: StepControl::new(first, order), tolerance: setting }
            }
        };
        let mut started = Self {
            method,
            previous: state.clone(),
            scratch: state.clone(),
            stages: vec![zero.clone(); method.stages.len()],
            lost: zero,
            work: Work::default(),
            scales,
            pace,
            system,
            state,
        };
        started.open();
        started
    }

    /// Evaluates the rates at the present state, where the last stage would have left them.
    fn open(&mut self) {
        if let Some([velocity, acceleration]) = self.stages.last_mut() {
            velocity.copy_from_slice(&self.state.velocity);
            let State { position, velocity, .. } = &self.state;
            self.system.accelerations(position, velocity, acceleration);
            self.work.force_evaluations += 1;
        }
    }

    fn evaluate_stage(&mut self, stage: usize, h: f64) {
        let (before, rest) = self.stages.split_at_mut(stage);
        let Some([rate, acceleration]) = rest.first_mut() else { return };
        let weights = self.method.stages.get(stage).copied().unwrap_or_default();
        let State { position, velocity, .. } = &mut self.scratch;
        for (part, (out, start)) in
            [(position, &self.previous.position), (velocity, &self.previous.velocity)]
                .into_iter()
                .enumerate()
        {
            combine(weights, before, part, out);
            for (value, start) in out.iter_mut().zip(start) {
                *value = start + h * *value;
            }
        }
        rate.copy_from_slice(&self.scratch.velocity);
        self.system.accelerations(&self.scratch.position, &self.scratch.velocity, acceleration);
        self.work.force_evaluations += 1;
    }

    /// Error of the step just tried as a multiple of `tolerance` (1).
    fn error(&mut self, weights: Row, h: f64, tolerance: f64) -> f64 {
        combine(weights, &self.stages, 0, &mut self.scratch.position);
        combine(weights, &self.stages, 1, &mut self.scratch.velocity);
        let position = h * largest(&self.scratch.position);
        let velocity = h * largest(&self.scratch.velocity);
        relative_error([position, velocity], self.scales) / tolerance
    }

    fn accept(&mut self, h: f64, next: f64) {
        let weights = self.method.stages.last().copied().unwrap_or_default();
        let State { position, velocity, .. } = &mut self.state;
        for (part, values) in [position, velocity].into_iter().enumerate() {
            combine(weights, &self.stages, part, &mut self.scratch.position);
            let lost = self.lost[part].iter_mut();
            for ((value, lost), rate) in values.iter_mut().zip(lost).zip(&self.scratch.position) {
                add_compensated(value, lost, h * rate);
            }
        }
        self.state.time = next;
        self.work.steps += 1;
        self.scales.widen(self.system.scales(&self.state.position, &self.state.velocity));
    }

    #[allow(clippy::cast_precision_loss, reason = "runs take far fewer than 2^53 steps")]
    fn fixed(&mut self, end: f64) -> Result<(), IntegrateError> {
        let Pace::Fixed { step, origin, count } = &mut self.pace else { return Ok(()) };
        let regular = *origin + (*count + 1) as f64 * *step;
        let next = if regular + REMAINDER * *step < end {
            *count += 1;
            regular
        } else {
            (*origin, *count) = (end, 0);
            end
        };
        let h = next - self.state.time;
        for stage in 1..self.stages.len() {
            self.evaluate_stage(stage, h);
        }
        self.accept(h, next);
        match first_not_finite(&self.state.position, &self.state.velocity) {
            Some(body) => Err(IntegrateError::NotFinite { body, time: self.previous.time }),
            None => Ok(()),
        }
    }

    fn controlled(&mut self, end: f64, weights: Row) -> Result<(), IntegrateError> {
        loop {
            let Pace::Controlled { control, tolerance } = &self.pace else { return Ok(()) };
            let tolerance = *tolerance;
            let trial = control.trial(self.state.time, end)?;
            for stage in 1..self.stages.len() {
                self.evaluate_stage(stage, trial.length);
            }
            let error = self.error(weights, trial.length, tolerance);
            let lost = first_not_finite(&self.scratch.position, &self.scratch.velocity);
            let Pace::Controlled { control, .. } = &mut self.pace else { return Ok(()) };
            if control.accepts(trial, error, || lost.unwrap_or(0)) {
                self.accept(trial.length, trial.next);
                return Ok(());
            }
            self.work.rejected += 1;
        }
    }
}

impl Integrator for RungeKuttaIntegrator<'_> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        let last = self.stages.len() - 1;
        self.stages.swap(0, last);
        self.previous.clone_from(&self.state);
        match self.method.error {
            None => self.fixed(end),
            Some((weights, _)) => self.controlled(end, weights),
        }
    }

    fn prepare_interpolation(&mut self) {}

    fn interpolant(&self, body: usize) -> Interpolant {
        let from = (&self.previous, self.stages.first().map_or(&[][..], |r| r[1].as_slice()));
        let to = (&self.state, self.stages.last().map_or(&[][..], |r| r[1].as_slice()));
        Between { from, to, jerks: None }.interpolant(body)
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.state.time - self.previous.time)
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl Restart for RungeKuttaIntegrator<'_> {
    fn system(&mut self) -> &mut dyn System {
        self.system.as_mut()
    }

    fn reached(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, state: &State) {
        self.state.clone_from(state);
        self.lost.iter_mut().for_each(|lost| lost.fill(0.0));
        if let Pace::Fixed { origin, count, .. } = &mut self.pace {
            (*origin, *count) = (state.time, 0);
        }
        self.open();
    }

    fn tolerated(&self) -> f64 {
        match self.pace {
            Pace::Fixed { .. } => 0.0,
            Pace::Controlled { tolerance, .. } => tolerance * self.scales.velocity,
        }
    }
}

/// `out = sum of weight * stages[stage][part]`.
fn combine(weights: Row, stages: &[Rates], part: usize, out: &mut [f64]) {
    add_up(weights, |stage| &stages[stage][part], out);
}
