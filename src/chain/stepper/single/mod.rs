//! One chain, stepped with error control.

mod look;

use std::marker::PhantomData;

use super::dispatch::{InstructionSet, dispatch};
use super::frame::Ends;
use super::kinks;
use super::lanes::{Row, WIDTH};
use super::plan::{Along, Form, Plan};
use super::quadrature::Quadrature;
use super::steps::{UNMOVED, control, worth};
use super::tasks::{Attempt, Evaluate, Settle};
use super::workspace::Workspace;
use crate::chain::Chain;
use crate::integrate::control::StepControl;
use crate::integrate::hermite::{End, septic};
use crate::integrate::nystrom::NystromPair;
use crate::integrate::{IntegrateError, Integrator, Interpolant, State, Work};

/// Rows at rest behind the last that moves: within a step news travel a contact a stage, of which there are fewer than in these.
const MARGIN: usize = 2;

/// What the stepper does on its own account; to be left out for comparison only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Refinement {
    /// Steps in which contacts open or close are put right, and taken again where they may have missed one.
    KinkCorrection,
    /// Contacts ahead of the wave, where nothing has moved yet, are left alone.
    QuietPart,
    /// The form that forces are computed in: leaving it out takes the other one.
    ForceForm,
}

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
    /// Smallest mass (kg).
    lightest: f64,
    bodies: usize,
    time: f64,
    last_step: (f64, f64),
    counts: Work,
    /// Steps tried in which contacts changed sides.
    events: u64,
    /// Whether kinks are corrected.
    corrects: bool,
    /// Rates of the accelerations at the start and the end of the last step (m/s³), and which step that was; empty until they are
    /// asked for.
    jerks: [Vec<Row>; 2],
    jerks_of: u64,
    /// Room for a frame, once one is asked for: positions (m) and force changes (N).
    frame: [Vec<Row>; 2],
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
        Self::from_state(chain, &state, (pair, tolerance), set)
    }

    /// Starts at `state` with a pair and the tolerated error of its steps, as [`ChainStepper::new`] does at rest.
    #[must_use]
    pub fn from_state(
        chain: &Chain,
        state: &State,
        (pair, tolerance): (&'static NystromPair, f64),
        set: InstructionSet,
    ) -> Self {
        let form = Form::needed(chain, &state.velocity, tolerance);
        Self::with_form(chain, state, (pair, tolerance), (set, form))
    }

    fn with_form(
        chain: &Chain,
        state: &State,
        (pair, tolerance): (&'static NystromPair, f64),
        (set, form): (InstructionSet, Form),
    ) -> Self {
        let velocities = &state.velocity;
        let mut plan = Plan::along(chain, form);
        dispatch(set, Settle::<Along>(&mut plan, PhantomData));
        let mut work = Workspace::new(plan.all_rows(), pair.nodes.len());
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
        work.next.closed.clone_from(&work.now.closed);
        let moves = |row: usize| {
            let all = [&work.now.velocity[row], &work.now.position[row], &work.stages[0][row]];
            all.iter().any(|row| **row != Row::default())
        };
        let last = (0..plan.all_rows()).rev().find(|row| moves(*row)).unwrap_or(0);
        plan.live = (last + 1 + MARGIN).min(plan.all_rows());
        let bodies = chain.bodies().len();
        let speed = velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let scales = (chain.impact_overlap(velocities).max(overlap.0[0]), speed);
        Self {
            set,
            pair,
            quadrature: Quadrature::of(pair),
            work,
            control: control(scales, pair),
            tolerance,
            scales,
            lightest: chain.lightest(),
            bodies,
            time: state.time,
            last_step: (state.time, 0.0),
            counts: Work { force_evaluations: 1, ..Work::default() },
            events: 0,
            corrects: true,
            jerks: [Vec::new(), Vec::new()],
            jerks_of: u64::MAX,
            frame: [Vec::new(), Vec::new()],
            plan,
        }
    }

    /// The stepper, not yet started on `chain`, without one of its refinements.
    #[must_use]
    pub fn without(mut self, refinement: Refinement, chain: &Chain) -> Self {
        match refinement {
            Refinement::KinkCorrection => self.corrects = false,
            Refinement::QuietPart => self.plan.live = self.plan.all_rows(),
            Refinement::ForceForm => {
                let form = match self.plan.form {
                    Form::Plain => Form::Exact,
                    Form::Exact => Form::Plain,
                    Form::Linear => Form::Linear,
                };
                let setting = (self.pair, self.tolerance);
                return Self::with_form(chain, &self.state(), setting, (self.set, form));
            }
        }
        self
    }

    /// Steps tried in which contacts opened or closed.
    #[must_use]
    pub fn events(&self) -> u64 {
        self.events
    }

    /// Goes on with the rows that the motion has come near to.
    fn follow_front(&mut self) {
        let (live, all) = (self.plan.live, self.plan.all_rows());
        let ahead = live.saturating_sub(MARGIN)..live;
        if live < all && self.work.now.velocity[ahead].iter().any(|row| *row != Row::default()) {
            self.plan.live = (live + MARGIN).min(all);
        }
    }

    /// Tries a step of `h` (s) and returns its error as a multiple of the tolerance (1).
    fn attempt(&mut self, h: f64) -> f64 {
        let Self { set, plan, pair, quadrature, work, .. } = self;
        let step = Row([h; WIDTH]);
        // Without corrections no impulse is worth one.
        let tolerance = if self.corrects { self.tolerance } else { f64::INFINITY };
        let slack = kinks::slack(tolerance, self.scales, self.lightest).map(|s| Row([s; WIDTH]));
        let worth = worth(self.tolerance, self.scales).map(|worth| Row([worth; WIDTH]));
        let layout = PhantomData;
        let task = Attempt::<Along> { plan, pair, quadrature, work, step, worth, slack, layout };
        let guard = dispatch(*set, task);
        self.counts.force_evaluations += self.pair.nodes.len() as u64 - 1;
        let error = self.work.error(0);
        if let Some(guard) = guard.filter(|_| error <= 1.0) {
            self.events += 1;
            let moved = guard.moved.0.into_iter().fold(0.0, f64::max);
            if moved > UNMOVED * self.tolerance * self.scales.0 {
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
            let culprit = || first_lost(&work.next.position, &work.next.velocity);
            if !self.control.accepts(trial, error, culprit) {
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
            self.follow_front();
            return Ok(());
        }
    }

    fn prepare_interpolation(&mut self) {
        self.find_jerks();
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let Ends { from, to, span: (_, length) } = self.ends();
        let at = |rows: [&[Row]; 4]| rows.map(|rows| rows[body / WIDTH].0[body % WIDTH]);
        let ([x0, v0, a0, j0], [x1, v1, a1, j1]) = (at(from), at(to));
        let from = End { position: x0, velocity: v0, acceleration: a0 };
        let to = End { position: x1, velocity: v1, acceleration: a1 };
        septic(from, to, (j0, j1), length)
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
