//! Hairer and Wanner's Rosenbrock method RODAS of orders 4(3) for losses that are stiff: L-stable,
//! so fast decays do not limit its steps.
//!
//! Six stages, each one force evaluation and one tridiagonal solution with the step's one
//! factorisation; no iteration. A stage solves
//! `(1/(h gamma) - J) u = f(y + sum a u) + sum c u / h`, `J` the exact tangent; for `x' = v` the
//! positions drop out and what is left has one row a body. Source: E. Hairer, G. Wanner, Solving
//! Ordinary Differential Equations II (1996), IV.7 and IV.10. Interpolation is quintic Hermite.

#![allow(clippy::unreadable_literal, reason = "digits as published")]

use super::control::{StepControl, add_compensated, first_step_of, largest, relative_error};
use super::hermite::{Interpolant, between};
use super::integrator::{IntegrateError, Integrator, Restart, Work, first_not_finite};
use super::system::{Scales, System, Tridiagonal};
use crate::chain::State;

/// Stages of a step.
pub const STAGES: usize = 6;
const GAMMA: f64 = 0.25;
/// Weights of earlier stages in a stage's argument. The last two arguments stand at the embedded
/// solutions.
const ARGUMENTS: [&[f64]; STAGES] = [
    &[],
    &[1.544],
    &[0.9466785280815826, 0.2557011698983284],
    &[3.314825187068521, 2.896124015972201, 0.9986419139977817],
    &[1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895],
    &[1.221224509226641, 6.019134481288629, 12.53708332932087, -0.687886036105895, 1.0],
];
/// Weights of earlier stages in a stage's right-hand side, to be divided by the step.
const COUPLINGS: [&[f64]; STAGES] = [
    &[],
    &[-5.6688],
    &[-2.430093356833875, -0.2063599157091915],
    &[-0.1073529058151375, -9.594562251023355, -20.47028614809616],
    &[7.496443313967647, -10.24680431464352, -33.99990352819905, 11.7089089320616],
    &[
        8.083246795921522,
        -7.981132988064893,
        -31.52159432874371,
        16.31930543123136,
        -6.058818238834054,
    ],
];
/// Order of the error estimate.
const ERROR_ORDER: u8 = 3;
/// First step as a share of the usual one, which is 1e-3 of overlap over speed: Kuwabara and Kono's
/// force begins as the square root of time, what a step misses of that goes as its length to the
/// power 1.5, and `(1e-8)^1.5 = 1e-12` is below any accuracy; beside a dashpot the first peak may
/// be that early (1).
const FIRST_STEP_SHARE: f64 = 1e-5;

/// The method at work on a system.
pub struct Rodas<'a> {
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    scratch: State,
    /// Increments of positions and velocities by each stage.
    stages: Vec<[Vec<f64>; 2]>,
    matrix: Tridiagonal,
    /// Accelerations at both ends of the last step (m/s²).
    accelerations: [Vec<f64>; 2],
    scales: Scales,
    tolerance: f64,
    control: StepControl,
    lost: [Vec<f64>; 2],
    work: Work,
}

impl<'a> Rodas<'a> {
    /// Name as written in scenes, options and recordings.
    pub const NAME: &'static str = "rodas";
    /// Publication that defines the method.
    pub const SOURCE: &'static str =
        "Hairer, Wanner, Solving ODEs II, 2nd ed. (1996), IV.10, RODAS";
    /// Order of convergence on smooth problems.
    pub const ORDER: u8 = 4;

    /// Starts at `state`, tolerating errors of `tolerance` a step relative to the system's scales
    /// (1).
    pub fn new(mut system: Box<dyn System + 'a>, state: State, tolerance: f64) -> Self {
        let n = system.len();
        let bodies = system.linearised().map_or(0, |system| system.bodies());
        let zero = [vec![0.0; n], vec![0.0; n]];
        let scales = system.scales(&state.position, &state.velocity);
        let first = FIRST_STEP_SHARE * first_step_of(system.as_ref(), &state);
        let mut started = Self {
            previous: state.clone(),
            scratch: state.clone(),
            stages: vec![zero.clone(); STAGES],
            matrix: Tridiagonal::new(bodies),
            accelerations: zero.clone(),
            scales,
            tolerance,
            control: StepControl::new(first, ERROR_ORDER),
            lost: zero,
            work: Work::default(),
            system,
            state,
        };
        started.open();
        started
    }

    /// Evaluates the accelerations at the present state.
    fn open(&mut self) {
        let State { position, velocity, .. } = &self.state;
        self.system.accelerations(position, velocity, &mut self.accelerations[1]);
        self.work.force_evaluations += 1;
    }

    /// Solves for the increments of all stages of a step of length `h` (s).
    fn attempt(&mut self, h: f64) {
        let shift = 1.0 / (h * GAMMA);
        if let Some(system) = self.system.linearised() {
            system.assemble(shift, &mut self.matrix);
        }
        self.matrix.factorise();
        for stage in 0..STAGES {
            self.argument(stage);
            let mut acceleration = std::mem::take(&mut self.stages[stage][1]);
            if stage == 0 {
                acceleration.copy_from_slice(&self.accelerations[0]);
            } else {
                let State { position, velocity, .. } = &self.scratch;
                self.system.accelerations(position, velocity, &mut acceleration);
                self.work.force_evaluations += 1;
            }
            self.stages[stage][1] = acceleration;
            self.solve(stage, h, shift);
        }
    }

    /// Writes the stage's argument to the scratch state.
    fn argument(&mut self, stage: usize) {
        self.scratch.position.copy_from_slice(&self.previous.position);
        self.scratch.velocity.copy_from_slice(&self.previous.velocity);
        let weights = ARGUMENTS[stage].iter().zip(&self.stages);
        for (weight, [position, velocity]) in weights {
            add_scaled(&mut self.scratch.position, position, *weight);
            add_scaled(&mut self.scratch.velocity, velocity, *weight);
        }
    }

    /// Turns the accelerations in the stage's place into its increments.
    fn solve(&mut self, stage: usize, h: f64, shift: f64) {
        let (before, rest) = self.stages.split_at_mut(stage);
        let Some([position, velocity]) = rest.first_mut() else { return };
        // Right-hand sides: the rates, and what earlier stages leave.
        position.copy_from_slice(&self.scratch.velocity);
        for (coupling, [x, v]) in COUPLINGS[stage].iter().zip(before) {
            add_scaled(position, x, coupling / h);
            add_scaled(velocity, v, coupling / h);
        }
        let Some(system) = self.system.linearised() else { return };
        let n = system.bodies();
        // (s^2 M + s C + K) u_v = s M r_v - K r_x, then u_x = (u_v + r_x)/s.
        let room = &mut self.scratch.position;
        system.forces_of(position, room);
        for ((v, mass), force) in velocity.iter_mut().zip(system.masses()).zip(room.iter()) {
            *v = shift * mass * *v + force;
        }
        self.matrix.solve(&mut velocity[..n]);
        for (x, v) in position.iter_mut().zip(velocity.iter()).take(n) {
            *x = (*v + *x) / shift;
        }
        let accounts = &mut self.scratch.velocity[n..];
        system.account_rates(position, velocity, accounts);
        for ((v, x), rate) in velocity[n..].iter_mut().zip(&mut position[n..]).zip(accounts) {
            *v = (*v + *rate) / shift;
            *x = (*v + *x) / shift;
        }
    }

    /// Error of the step just tried as a multiple of the tolerance (1): the last stage's
    /// increments.
    fn error(&self) -> f64 {
        let [position, velocity] = &self.stages[STAGES - 1];
        relative_error([largest(position), largest(velocity)], self.scales) / self.tolerance
    }

    fn accept(&mut self, next: f64) {
        let weights = ARGUMENTS[STAGES - 1].iter().chain(&[1.0]);
        let State { position, velocity, .. } = &mut self.state;
        for (part, values) in [position, velocity].into_iter().enumerate() {
            self.scratch.position.fill(0.0);
            for (weight, stage) in weights.clone().zip(&self.stages) {
                add_scaled(&mut self.scratch.position, &stage[part], *weight);
            }
            let sums = self.lost[part].iter_mut().zip(&self.scratch.position);
            for (value, (lost, sum)) in values.iter_mut().zip(sums) {
                add_compensated(value, lost, *sum);
            }
        }
        self.state.time = next;
        self.work.steps += 1;
        self.scales.widen(self.system.scales(&self.state.position, &self.state.velocity));
        self.open();
    }
}

impl Integrator for Rodas<'_> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        self.accelerations.swap(0, 1);
        self.previous.clone_from(&self.state);
        if let Some(system) = self.system.linearised() {
            system.linearise(&self.state);
        }
        loop {
            let trial = self.control.trial(self.state.time, end)?;
            self.attempt(trial.length);
            let error = self.error();
            let [x, v] = &self.stages[STAGES - 1];
            if self.control.accepts(trial, error, || first_not_finite(x, v).unwrap_or(0)) {
                self.accept(trial.next);
                return Ok(());
            }
            self.work.rejected += 1;
        }
    }

    fn prepare_interpolation(&mut self) {}

    fn interpolant(&self, body: usize) -> Interpolant {
        let [before, after] = &self.accelerations;
        let (from, to) = ((&self.previous, &before[..]), (&self.state, &after[..]));
        between(from, to, body)
    }

    fn body(&self, body: usize) -> [f64; 2] {
        [self.state.position[body], self.state.velocity[body]]
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.state.time - self.previous.time)
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl Restart for Rodas<'_> {
    fn system(&mut self) -> &mut dyn System {
        self.system.as_mut()
    }

    fn reached(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, state: &State) {
        self.state.clone_from(state);
        self.lost.iter_mut().for_each(|lost| lost.fill(0.0));
        self.open();
    }

    fn tolerated(&self) -> f64 {
        self.tolerance * self.scales.velocity
    }
}

/// `values += factor * others`.
fn add_scaled(values: &mut [f64], others: &[f64], factor: f64) {
    for (value, other) in values.iter_mut().zip(others) {
        *value += factor * other;
    }
}
