//! One chain, stepped with error control.

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::kinks::Quadrature;
use super::lanes::{Row, WIDTH};
use super::plan::{Along, Form, Plan};
use super::tasks::{Attempt, Evaluate, Settle};
use super::workspace::Workspace;
use crate::chain::{Chain, ChainSystem};
use crate::integrate::control::StepControl;
use crate::integrate::hermite::{Between, find_jerks};
use crate::integrate::nystrom::NystromPair;
use crate::integrate::{IntegrateError, Integrator, Interpolant, State, Work};

/// The first step, as a fraction of overlap over speed (1).
const FIRST_STEP: f64 = 1e-3;
/// A corrected position that moved by less than this share of the tolerance keeps its acceleration (1).
const UNMOVED: f64 = 0.03;

/// A lossless chain under a Runge-Kutta-Nystrom pair.
pub struct ChainStepper {
    set: InstructionSet,
    plan: Plan,
    pair: &'static NystromPair,
    quadrature: Quadrature,
    work: Workspace,
    control: StepControl,
    tolerance: f64,
    /// Largest overlap change (m) and speed (m/s) so far: what errors are relative to.
    scales: (f64, f64),
    bodies: usize,
    time: f64,
    last_step: (f64, f64),
    counts: Work,
    /// Contacts that changed sides in accepted steps.
    events: u64,
    /// For interpolation.
    system: ChainSystem,
    ends: [State; 2],
    accelerations: [Vec<f64>; 2],
    jerks: Option<[Vec<f64>; 2]>,
}

impl ChainStepper {
    /// Starts `pair` on `chain` with `velocities` (m/s), tolerating errors of `tolerance` a step relative to the largest overlap
    /// change and speed so far (1).
    #[must_use]
    pub fn new(
        chain: &Chain,
        velocities: &[f64],
        pair: &'static NystromPair,
        tolerance: f64,
        set: InstructionSet,
    ) -> Self {
        let position = vec![0.0; velocities.len()];
        let state = State { time: 0.0, position, velocity: velocities.to_vec() };
        Self::from_state(chain, state, (pair, tolerance), set)
    }

    /// Starts at `state` with a pair and the tolerated error of its steps, as [`ChainStepper::new`] does at rest.
    #[must_use]
    pub fn from_state(
        chain: &Chain,
        state: State,
        (pair, tolerance): (&'static NystromPair, f64),
        set: InstructionSet,
    ) -> Self {
        let velocities = &state.velocity;
        let form = Form::needed(chain, velocities, tolerance);
        let mut plan = Plan::along(chain, form);
        dispatch(set, Settle::<Along>(&mut plan, PhantomData));
        let mut work = Workspace::new(plan.rows(), pair.nodes.len());
        for (i, velocity) in velocities.iter().enumerate() {
            work.now.velocity[i / WIDTH].0[i % WIDTH] = *velocity;
        }
        for (i, position) in state.position.iter().enumerate() {
            work.now.position[i / WIDTH].0[i % WIDTH] = *position;
        }
        let (motion, first) = (&mut work.now, &mut work.stages[0]);
        let overlap = dispatch(
            set,
            Evaluate::<Along> { plan: &plan, motion, acceleration: first, layout: PhantomData },
        );
        let bodies = chain.bodies().len();
        let speed = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let scales = (chain.impact_overlap(velocities).max(overlap.0[0]), speed);
        Self {
            set,
            pair,
            quadrature: Quadrature::of(pair),
            work,
            control: StepControl::new(FIRST_STEP * scales.0 / scales.1, pair.error_order),
            tolerance,
            scales,
            bodies,
            time: state.time,
            last_step: (state.time, 0.0),
            counts: Work { force_evaluations: 1, ..Work::default() },
            events: 0,
            system: ChainSystem::new(chain, velocities),
            ends: [state.clone(), state],
            accelerations: [vec![0.0; bodies], vec![0.0; bodies]],
            jerks: Some([vec![0.0; bodies], vec![0.0; bodies]]),
            plan,
        }
    }

    /// Tries a step of `h` (s) and returns its error as a multiple of the tolerance (1).
    fn attempt(&mut self, h: f64) -> f64 {
        let Self { set, plan, pair, quadrature, work, .. } = self;
        let step = Row([h; WIDTH]);
        let task = Attempt::<Along> { plan, pair, quadrature, work, step, layout: PhantomData };
        let guard = dispatch(*set, task);
        self.counts.force_evaluations += self.pair.nodes.len() as u64 - 1;
        let largest = &self.work.largest;
        let [position, velocity, total] =
            [largest.error_position, largest.error_velocity, largest.total].map(|row| row.0[0]);
        let error = (position / self.scales.0).max(velocity / self.scales.1) / self.tolerance;
        // `max` hides what is not a number; the sum does not.
        let error = if total.is_finite() && !error.is_nan() { error } else { f64::INFINITY };
        if let Some(guard) = guard.filter(|_| error <= 1.0) {
            self.events += 1;
            if guard.moved > UNMOVED * self.tolerance * self.scales.0 {
                self.evaluate_end();
            }
        }
        error
    }

    /// The accelerations where the step ended, after a correction.
    fn evaluate_end(&mut self) {
        let Self { set, plan, work, .. } = self;
        let Some(acceleration) = work.stages.last_mut() else { return };
        let task =
            Evaluate::<Along> { plan, motion: &mut work.next, acceleration, layout: PhantomData };
        work.largest.overlap = dispatch(*set, task);
        self.counts.force_evaluations += 1;
    }
}

/// The first `count` values of rows.
fn unpack(rows: &[Row], out: &mut [f64]) {
    for (out, row) in out.chunks_mut(WIDTH).zip(rows) {
        out.copy_from_slice(&row.0[..out.len()]);
    }
}

impl Integrator for ChainStepper {
    fn time(&self) -> f64 {
        self.time
    }

    fn state(&self) -> State {
        let mut state = State {
            time: self.time,
            position: vec![0.0; self.bodies],
            velocity: vec![0.0; self.bodies],
        };
        unpack(&self.work.now.position, &mut state.position);
        unpack(&self.work.now.velocity, &mut state.velocity);
        state
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        let last = self.pair.nodes.len() - 1;
        loop {
            let trial = self.control.trial(self.time, end)?;
            let error = self.attempt(trial.length);
            let work = &self.work;
            let lost = || first_lost(&work.next.position, &work.next.velocity);
            if !self.control.accepts(trial, error, lost) {
                self.counts.rejected += 1;
                continue;
            }
            // What was the start stays where interpolation finds it.
            std::mem::swap(&mut self.work.now, &mut self.work.next);
            self.work.stages.swap(0, last);
            self.last_step = (self.time, trial.length);
            self.time = trial.next;
            self.counts.steps += 1;
            let largest = &self.work.largest;
            self.scales.0 = self.scales.0.max(largest.overlap.0[0]);
            self.scales.1 = self.scales.1.max(largest.speed.0[0]);
            return Ok(());
        }
    }

    fn prepare_interpolation(&mut self) {
        let [before, after] = &mut self.ends;
        let last = self.pair.nodes.len() - 1;
        before.time = self.last_step.0;
        after.time = self.time;
        unpack(&self.work.next.position, &mut before.position);
        unpack(&self.work.next.velocity, &mut before.velocity);
        unpack(&self.work.now.position, &mut after.position);
        unpack(&self.work.now.velocity, &mut after.velocity);
        unpack(&self.work.stages[last], &mut self.accelerations[0]);
        unpack(&self.work.stages[0], &mut self.accelerations[1]);
        find_jerks(&mut self.system, [&self.ends[0], &self.ends[1]], &mut self.jerks);
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let from = (&self.ends[0], self.accelerations[0].as_slice());
        let to = (&self.ends[1], self.accelerations[1].as_slice());
        Between { from, to, jerks: self.jerks.as_ref() }.interpolant(body)
    }

    fn last_step(&self) -> (f64, f64) {
        self.last_step
    }

    fn work(&self) -> Work {
        self.counts
    }
}

/// First body whose state is not finite.
fn first_lost(position: &[Row], velocity: &[Row]) -> usize {
    let flat = |rows: &[Row]| rows.iter().flat_map(|row| row.0).collect::<Vec<f64>>();
    flat(position)
        .iter()
        .zip(&flat(velocity))
        .position(|(x, v)| !(x.is_finite() && v.is_finite()))
        .unwrap_or(0)
}
