//! Explicit Runge-Kutta methods for `x' = v`, `v' = a(x, v)`: forces may depend on velocity.
//!
//! A method is its stages; the last one is at the new state and opens the next step. With an error
//! estimate steps are chosen, without one they are fixed. Interpolation is quintic Hermite, or of
//! order 7 by further stages where a method has them. Where a contact opens or closes within a step
//! (the force is only C^1 there) the two estimates of a pair of orders 8(5,3) are of the same low
//! order, and the larger one counts: the control shortens the step until the kink is harmless.
//! Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I"
//! (Springer, 1993), II.5, II.6.

use super::control::{Clock, StepControl, add_compensated, first_step_of, largest, relative_error};
use super::hermite::{COEFFICIENTS, Interpolant, between};
use super::integrator::{IntegrateError, Integrator, Restart, Work, first_not_finite};
use super::system::{Scales, System};
use crate::chain::State;

/// Across a kink both embedded solutions are of the same low order, and either's error may vanish
/// for some place of the kink within the step, but not both at once: with this share of the third
/// order's, errors of first peaks stayed below 9 times the error tolerated in a step, where the
/// blend made for smooth steps let 1 run in 100 pass that erred by more than 32 times as much, up
/// to 540 (150 tolerances up to 6e-5 of 20 scenes with losses that are not stiff) (1).
const THIRD_ORDER_SHARE_AT_KINKS: f64 = 0.1;

/// Terms of a weighted sum: stage and weight (1).
pub type Row = &'static [(usize, f64)];

/// Terms that are added in one pass.
const AT_ONCE: usize = 4;

/// `out = sum of weight * of(stage)`, added up in the order of the terms.
pub fn add_up<'a>(weights: Row, of: impl Fn(usize) -> &'a [f64], out: &mut [f64]) {
    out.fill(0.0);
    let (passes, rest) = weights.as_chunks::<AT_ONCE>();
    for pass in passes {
        let [a, b, c, d] = pass.map(|(stage, _)| of(stage));
        let [wa, wb, wc, wd] = pass.map(|(_, weight)| weight);
        for ((sum, (a, b)), (c, d)) in out.iter_mut().zip(a.iter().zip(b)).zip(c.iter().zip(d)) {
            *sum = *sum + wa * a + wb * b + wc * c + wd * d;
        }
    }
    for (stage, weight) in rest {
        for (sum, value) in out.iter_mut().zip(of(*stage)) {
            *sum += weight * value;
        }
    }
}

/// How a method estimates the error of a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StepError {
    /// Not at all: its steps are fixed.
    None,
    /// By weights of the stages, and the order of the embedded solution.
    Embedded(Row, u8),
    /// By two embedded solutions of orders 5 and 3, the estimate being of order 7.
    Blended([Row; 2]),
}

/// Interpolation of order 7.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dense {
    /// Weights of the further stages' arguments.
    pub stages: &'static [Row],
    /// Weights of the last four coefficients in the nested form.
    pub weights: &'static [Row; 4],
}

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
    /// How it estimates its error.
    pub error: StepError,
    /// How steps are interpolated; none for quintic Hermite.
    pub dense: Option<Dense>,
    /// Longest stable step times the highest angular frequency (1).
    pub oscillation_reach: f64,
    /// Longest stable step times the fastest decay (1).
    pub decay_reach: f64,
}

/// How steps are chosen.
enum Steps {
    Fixed(Clock),
    /// By the error, and the tolerated error of a step (1).
    Controlled(StepControl, f64),
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
    steps: Steps,
    work: Work,
}

impl<'a> RungeKuttaIntegrator<'a> {
    /// Starts `method` at `state`; `setting` is its step (s), or the tolerated error of a step
    /// relative to the system's scales (1) if the method estimates its error.
    pub fn new(
        method: &'static RungeKutta,
        system: Box<dyn System + 'a>,
        state: State,
        setting: f64,
    ) -> Self {
        let n = system.len();
        let zero = [vec![0.0; n], vec![0.0; n]];
        let scales = system.scales(&state.position, &state.velocity);
        let first = || first_step_of(system.as_ref(), &state);
        let longest = system.longest_step();
        let controlled =
            |order: u8| Steps::Controlled(StepControl::new(first(), order).up_to(longest), setting);
        let steps = match method.error {
            StepError::None => Steps::Fixed(Clock::new(setting, state.time, &[])),
            StepError::Embedded(_, order) => controlled(order),
            StepError::Blended(_) => controlled(7),
        };
        let further = method.dense.map_or(0, |dense| dense.stages.len());
        let mut started = Self {
            method,
            previous: state.clone(),
            scratch: state.clone(),
            stages: vec![zero.clone(); method.stages.len() + further],
            lost: zero,
            work: Work::default(),
            scales,
            steps,
            system,
            state,
        };
        started.open();
        started
    }

    /// Evaluates the rates at the present state, where the last stage would have left them.
    fn open(&mut self) {
        let solution = self.solution();
        let [rate, acceleration] = &mut self.stages[solution];
        let State { position, velocity, .. } = &self.state;
        rate.copy_from_slice(velocity);
        self.system.accelerations(position, velocity, acceleration);
        self.work.force_evaluations += 1;
    }

    /// The stage at the new state.
    fn solution(&self) -> usize {
        self.method.stages.len() - 1
    }

    fn evaluate_stage(&mut self, stage: usize, weights: Row, h: f64) {
        let (before, rest) = self.stages.split_at_mut(stage);
        let [rate, acceleration] = &mut rest[0];
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

    fn evaluate_stages(&mut self, h: f64) {
        for (stage, weights) in self.method.stages.iter().enumerate().skip(1) {
            self.evaluate_stage(stage, weights, h);
        }
    }

    /// Error of the step just tried as a multiple of `tolerance` (1).
    fn error(&mut self, h: f64, tolerance: f64) -> f64 {
        // The last stage is at the new state.
        let has_kink = self.system.has_kink_between(&self.previous, &self.scratch);
        let mut error = |weights: Row| {
            combine(weights, &self.stages, 0, &mut self.scratch.position);
            combine(weights, &self.stages, 1, &mut self.scratch.velocity);
            let position = h * largest(&self.scratch.position);
            let velocity = h * largest(&self.scratch.velocity);
            relative_error([position, velocity], self.scales) / tolerance
        };
        let [fifth, third] = match self.method.error {
            StepError::None => return 0.0,
            StepError::Embedded(weights, _) => return error(weights),
            StepError::Blended(weights) => weights.map(&mut error),
        };
        if !(fifth.is_finite() && third.is_finite()) {
            f64::INFINITY
        } else if has_kink {
            fifth.max(THIRD_ORDER_SHARE_AT_KINKS * third)
        } else if fifth == 0.0 {
            0.0
        } else {
            fifth * fifth / fifth.hypot(0.1 * third)
        }
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

    fn fixed(&mut self, end: f64) -> Result<(), IntegrateError> {
        let Steps::Fixed(clock) = &mut self.steps else { return Ok(()) };
        let (_, next) = clock.next(self.state.time, end);
        let h = next - self.state.time;
        self.evaluate_stages(h);
        self.accept(h, next);
        match first_not_finite(&self.state.position, &self.state.velocity) {
            Some(body) => Err(IntegrateError::NotFinite { body, time: self.previous.time }),
            None => Ok(()),
        }
    }

    fn controlled(&mut self, end: f64) -> Result<(), IntegrateError> {
        loop {
            let Steps::Controlled(control, tolerance) = &self.steps else { return Ok(()) };
            let tolerance = *tolerance;
            let trial = control.trial(self.state.time, end)?;
            self.evaluate_stages(trial.length);
            let error = self.error(trial.length, tolerance);
            let stages = &self.stages;
            let lost = || stages.iter().find_map(|[v, a]| first_not_finite(v, a)).unwrap_or(0);
            let Steps::Controlled(control, _) = &mut self.steps else { return Ok(()) };
            if control.accepts(trial, error, lost) {
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
        let solution = self.solution();
        self.stages.swap(0, solution);
        self.previous.clone_from(&self.state);
        match self.steps {
            Steps::Fixed(_) => self.fixed(end),
            Steps::Controlled(..) => self.controlled(end),
        }?;
        if self.system.has_memory() {
            self.prepare_interpolation();
            let walls = [0, 1].map(|end| self.wall(end));
            self.system.remember(self.last_step(), walls);
        }
        Ok(())
    }

    fn prepare_interpolation(&mut self) {
        let h = self.state.time - self.previous.time;
        let further = self.method.dense.map_or(&[][..], |dense| dense.stages);
        for (stage, weights) in (self.method.stages.len()..).zip(further) {
            self.evaluate_stage(stage, weights, h);
        }
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let Some(dense) = self.method.dense else {
            let from = (&self.previous, &self.stages[0][1][..]);
            let to = (&self.state, &self.stages[self.solution()][1][..]);
            return between(from, to, body);
        };
        let h = self.state.time - self.previous.time;
        let coefficients = |part: usize, [from, to]: [f64; 2]| {
            let rate = |stage: usize| h * self.stages[stage][part][body];
            let (rise, first, last) = (to - from, rate(0), rate(self.solution()));
            let mut nested = [rise, first - rise, 2.0 * rise - last - first, 0.0, 0.0, 0.0, 0.0];
            for (value, row) in nested[3..].iter_mut().zip(dense.weights) {
                *value = row.iter().map(|(stage, weight)| weight * rate(*stage)).sum();
            }
            to_powers(from, nested)
        };
        let ends = [&self.previous, &self.state];
        Interpolant {
            position: coefficients(0, ends.map(|state| state.position[body])),
            velocity: coefficients(1, ends.map(|state| state.velocity[body])),
        }
    }

    fn wall(&self, end: usize) -> Interpolant {
        self.system.wall(end, self.last_step(), &|body| self.interpolant(body))
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
        if let Steps::Fixed(clock) = &mut self.steps {
            clock.restart(state.time);
        }
        self.open();
    }

    fn tolerated(&self) -> f64 {
        match self.steps {
            Steps::Fixed(_) => 0.0,
            Steps::Controlled(_, tolerance) => tolerance * self.scales.velocity,
        }
    }
}

/// `out = sum of weight * stages[stage][part]`.
fn combine(weights: Row, stages: &[Rates], part: usize, out: &mut [f64]) {
    add_up(weights, |stage| &stages[stage][part], out);
}

/// From the nested form `y0 + t(f0 + s(f1 + t(f2 + s(...))))`, `s = 1 - t`, to powers of `t`.
fn to_powers(start: f64, nested: [f64; 7]) -> [f64; COEFFICIENTS] {
    let mut powers = [0.0; COEFFICIENTS];
    for (index, value) in nested.iter().enumerate().rev() {
        powers[0] += value;
        // The outermost factor is t, and they alternate inward.
        let mut shifted = [0.0; COEFFICIENTS];
        shifted[1..].copy_from_slice(&powers[..COEFFICIENTS - 1]);
        if index % 2 == 0 {
            powers = shifted;
        } else {
            for (power, shifted) in powers.iter_mut().zip(shifted) {
                *power -= shifted;
            }
        }
    }
    powers[0] += start;
    powers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nested_form_and_powers_agree() {
        let nested = [1.0, -2.0, 3.0, 0.5, -0.25, 4.0, 0.125];
        let powers = to_powers(7.0, nested);
        for theta in [0.0, 0.2, 0.5, 0.9, 1.0_f64] {
            let mut value = 0.0;
            for (index, term) in nested.iter().enumerate().rev() {
                value = (value + term) * if index % 2 == 0 { theta } else { 1.0 - theta };
            }
            let sum: f64 = powers.iter().rev().fold(0.0, |s, c| s * theta + c);
            assert!((sum - 7.0 - value).abs() < 1e-13);
        }
    }
}
