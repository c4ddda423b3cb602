//! Embedded Runge-Kutta-Nystrom pairs with error control: `x'' = a(x)` integrated as what it is, at
//! two thirds of the evaluations of a first-order method of the same order.
//!
//! Stages stand at `x + c h v + h^2 sum a f`; the step ends at `x + h v + h^2 sum b f`,
//! `v + h sum b' f`. The error estimate is the difference to the embedded solution, in position and
//! in velocity. Contacts that open or close within a step break the estimate's smoothness, and the
//! controller shortens the step. Interpolation is septic Hermite.

use super::control::{StepControl, add_compensated, first_step_of, largest, relative_error};
use super::hermite::{Between, find_jerks};
use super::stages::{Row, add_up};
use super::{IntegrateError, Integrator, Interpolant, Scales, State, System, Work};

/// Coefficients of a pair whose last stage opens the next step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NystromPair {
    /// Name as written in scenes, options and recordings.
    pub name: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order of the solution that is continued.
    pub order: u8,
    /// Order of the embedded solution.
    pub error_order: u8,
    /// Times of the stages, fractions of a step (1).
    pub nodes: &'static [f64],
    /// Position weights of each stage's argument.
    pub stages: &'static [Row],
    /// Position weights of the solution.
    pub position: Row,
    /// Velocity weights of the solution.
    pub velocity: Row,
    /// Position weights of the error.
    pub position_error: Row,
    /// Velocity weights of the error.
    pub velocity_error: Row,
}

/// A pair at work on a system.
pub struct NystromIntegrator<'a> {
    pair: &'static NystromPair,
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    scratch: Vec<f64>,
    /// Accelerations at the stages (m/s²).
    stages: Vec<Vec<f64>>,
    /// Rates of the accelerations at both ends; none where the system does not know them.
    jerks: Option<[Vec<f64>; 2]>,
    scales: Scales,
    tolerance: f64,
    control: StepControl,
    last_length: f64,
    /// What rounding took from the last sums of position and velocity.
    lost: [Vec<f64>; 2],
    work: Work,
}

impl<'a> NystromIntegrator<'a> {
    /// Starts `pair` at `state`, tolerating errors of `tolerance` a step relative to the system's
    /// scales (1).
    pub fn new(
        pair: &'static NystromPair,
        mut system: Box<dyn System + 'a>,
        state: State,
        tolerance: f64,
    ) -> Self {
        let n = system.len();
        let mut stages = vec![vec![0.0; n]; pair.nodes.len()];
        if let Some(first) = stages.first_mut() {
            system.accelerations(&state.position, &state.velocity, first);
        }
        let scales = system.scales(&state.position, &state.velocity);
        Self {
            pair,
            previous: state.clone(),
            scratch: vec![0.0; n],
            jerks: Some([vec![0.0; n], vec![0.0; n]]),
            control: StepControl::new(first_step_of(system.as_ref(), &state), pair.error_order),
            lost: [vec![0.0; n], vec![0.0; n]],
            work: Work { force_evaluations: 1, ..Work::default() },
            last_length: 0.0,
            system,
            state,
            stages,
            scales,
            tolerance,
        }
    }

    fn evaluate_stage(&mut self, stage: usize, h: f64) {
        let (before, rest) = self.stages.split_at_mut(stage);
        let Some(acceleration) = rest.first_mut() else { return };
        let weights = self.pair.stages.get(stage).copied().unwrap_or_default();
        let node = self.pair.nodes.get(stage).copied().unwrap_or(0.0);
        add_up(weights, |stage| &before[stage], &mut self.scratch);
        let start = self.previous.position.iter().zip(&self.previous.velocity);
        for (value, (x, v)) in self.scratch.iter_mut().zip(start) {
            *value = x + h * (node * v + h * *value);
        }
        // These pairs are for forces of position alone; the velocity they are given is the step's
        // first.
        self.system.accelerations(&self.scratch, &self.previous.velocity, acceleration);
        self.work.force_evaluations += 1;
    }

    /// Error of the step just tried as a multiple of the tolerance (1).
    fn error(&mut self, h: f64) -> f64 {
        add_up(self.pair.position_error, |stage| &self.stages[stage], &mut self.scratch);
        let position = h * h * largest(&self.scratch);
        add_up(self.pair.velocity_error, |stage| &self.stages[stage], &mut self.scratch);
        let velocity = h * largest(&self.scratch);
        relative_error([position, velocity], self.scales) / self.tolerance
    }

    fn accept(&mut self, h: f64, next: f64) {
        add_up(self.pair.position, |stage| &self.stages[stage], &mut self.scratch);
        let [lost_x, lost_v] = &mut self.lost;
        for ((x, lost), (v, sum)) in self
            .state
            .position
            .iter_mut()
            .zip(lost_x)
            .zip(self.previous.velocity.iter().zip(&self.scratch))
        {
            add_compensated(x, lost, h * (v + h * sum));
        }
        add_up(self.pair.velocity, |stage| &self.stages[stage], &mut self.scratch);
        for ((v, lost), sum) in self.state.velocity.iter_mut().zip(lost_v).zip(&self.scratch) {
            add_compensated(v, lost, h * sum);
        }
        self.state.time = next;
        self.last_length = h;
        self.work.steps += 1;
        self.scales.widen(self.system.scales(&self.state.position, &self.state.velocity));
    }
}

impl Integrator for NystromIntegrator<'_> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        let last = self.stages.len() - 1;
        if self.work.steps > 0 {
            self.stages.swap(0, last);
        }
        self.previous.clone_from(&self.state);
        loop {
            let trial = self.control.trial(self.state.time, end)?;
            for stage in 1..=last {
                self.evaluate_stage(stage, trial.length);
            }
            let error = self.error(trial.length);
            let stages = &self.stages;
            if self.control.accepts(trial, error, || first_lost(stages)) {
                self.accept(trial.length, trial.next);
                return Ok(());
            }
            self.work.rejected += 1;
        }
    }

    fn prepare_interpolation(&mut self) {
        let ends = [&self.previous, &self.state];
        find_jerks(self.system.as_mut(), ends, &mut self.jerks);
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let from = (&self.previous, self.stages.first().map_or(&[][..], Vec::as_slice));
        let to = (&self.state, self.stages.last().map_or(&[][..], Vec::as_slice));
        Between { from, to, jerks: self.jerks.as_ref() }.interpolant(body)
    }

    fn body(&self, body: usize) -> [f64; 2] {
        [self.state.position[body], self.state.velocity[body]]
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.last_length)
    }

    fn work(&self) -> Work {
        self.work
    }
}

/// First body with a stage that is not a number.
fn first_lost(stages: &[Vec<f64>]) -> usize {
    stages.iter().find_map(|s| s.iter().position(|a| !a.is_finite())).unwrap_or(0)
}
