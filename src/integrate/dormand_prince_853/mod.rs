//! Dormand and Prince's explicit Runge-Kutta pair of orders 8(5,3): the accurate end of the range.
//!
//! Twelve new force evaluations a step, an error estimate that blends embedded solutions of orders 5 and 3, and an
//! interpolant of order 7 that costs three more evaluations and only where somebody reads it. Where a contact opens or
//! closes within a step (the force is only C^1 there) both are of the same low order, and the larger of them is the estimate: the
//! controller then shortens the step until the kink is harmless, so no event location is needed.
//! Source: E. Hairer, S. P. Norsett, G. Wanner, "Solving Ordinary Differential Equations I" (Springer, 1993), II.5, II.6.

mod tableau;

use super::control::{StepControl, add_compensated, first_step_of, largest, relative_error};
use super::interpolant::{COEFFICIENTS, Interpolant};
use super::stages::{Row, add_up};
use super::switches::Restart;
use super::{IntegrateError, Integrator, Scales, State, System, Work};
use tableau::{DENSE, DENSE_STAGES, ERROR_3, ERROR_5, STAGE_WEIGHTS, STAGES};

/// Order of the error estimate; it goes as the step to the power one higher.
const ERROR_ORDER: u8 = 7;
/// Across a kink both embedded solutions are of the same low order, and either's error may vanish for some place of the kink within the step, but not both at
/// once: with this share of the third order's, errors of first peaks stayed below 9 times the error tolerated in a step, where the blend made for smooth steps let 1
/// run in 100 pass that erred by more than 32 times as much, up to 540 (150 tolerances up to 6e-5 of 20 scenes with losses that are not stiff) (1).
const THIRD_AT_KINKS: f64 = 0.1;

/// The pair at work on a system.
pub struct DormandPrince853<'a> {
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    scratch: State,
    /// Stage derivatives: velocities (m/s) and accelerations (m/s²).
    rates: Vec<Rates>,
    scales: Scales,
    tolerance: f64,
    control: StepControl,
    last_length: f64,
    /// What rounding took from the last sums, per coordinate: positions, then velocities.
    lost: Rates,
    work: Work,
}

/// Time derivatives of position and velocity, or corrections to them.
#[derive(Debug, Clone)]
struct Rates {
    position: Vec<f64>,
    velocity: Vec<f64>,
}

impl<'a> DormandPrince853<'a> {
    /// Name as written in scenes, options and recordings.
    pub const NAME: &'static str = "dormand-prince-853";
    /// Publication that defines the method.
    pub const SOURCE: &'static str =
        "Hairer, Norsett, Wanner, Solving ODEs I, 2nd ed. (1993), II.5-II.6";

    /// Longest stable step times the fastest decay (1).
    pub const DECAY_REACH: f64 = 6.39;

    /// Starts at `state`, tolerating errors of `tolerance` a step relative to the system's scales (1).
    pub fn new(mut system: Box<dyn System + 'a>, state: State, tolerance: f64) -> Self {
        let n = system.len();
        let zero = Rates { position: vec![0.0; n], velocity: vec![0.0; n] };
        let mut rates = vec![zero.clone(); DENSE_STAGES];
        if let Some(first) = rates.first_mut() {
            first.position.copy_from_slice(&state.velocity);
            system.accelerations(&state.position, &state.velocity, &mut first.velocity);
        }
        let scales = system.scales(&state.position, &state.velocity);
        let first_step = first_step_of(system.as_ref(), &state);
        Self {
            previous: state.clone(),
            scratch: state.clone(),
            lost: zero,
            work: Work { force_evaluations: 1, ..Work::default() },
            last_length: 0.0,
            system,
            state,
            rates,
            scales,
            tolerance,
            control: StepControl::new(first_step, ERROR_ORDER),
        }
    }

    /// Evaluates stage `stage` of a step of length `h` from `previous`.
    fn evaluate_stage(&mut self, stage: usize, h: f64) {
        let (before, rest) = self.rates.split_at_mut(stage);
        let Some(rates) = rest.first_mut() else {
            return;
        };
        let weights = STAGE_WEIGHTS.get(stage).copied().unwrap_or_default();
        combine(weights, before, |r| &r.position, &mut self.scratch.position);
        combine(weights, before, |r| &r.velocity, &mut self.scratch.velocity);
        shift(&mut self.scratch.position, &self.previous.position, h);
        shift(&mut self.scratch.velocity, &self.previous.velocity, h);
        rates.position.copy_from_slice(&self.scratch.velocity);
        self.system.accelerations(
            &self.scratch.position,
            &self.scratch.velocity,
            &mut rates.velocity,
        );
        self.work.force_evaluations += 1;
    }

    /// Error of the step just tried as a multiple of the tolerance (1); not finite if the state is not.
    fn error(&mut self, h: f64) -> f64 {
        // The last stage stands at the new state.
        let kink = self.system.has_kink_between(&self.previous, &self.scratch);
        let mut of_order = [0.0_f64; 2];
        for (error, weights) in of_order.iter_mut().zip([ERROR_5, ERROR_3]) {
            combine(weights, &self.rates, |r| &r.position, &mut self.scratch.position);
            let position = largest(&self.scratch.position);
            combine(weights, &self.rates, |r| &r.velocity, &mut self.scratch.velocity);
            *error = relative_error([position, largest(&self.scratch.velocity)], self.scales);
        }
        let [fifth, third] = of_order;
        if !(fifth.is_finite() && third.is_finite()) {
            return f64::INFINITY;
        }
        let error = if kink {
            fifth.max(THIRD_AT_KINKS * third)
        } else if fifth == 0.0 {
            0.0
        } else {
            fifth * fifth / fifth.hypot(0.1 * third)
        };
        h * error / self.tolerance
    }

    /// Adds the step's increment, keeping what rounding would lose (Kahan's compensated sum).
    fn accept(&mut self, h: f64, next: f64) {
        let solution = STAGES - 1;
        let (before, _) = self.rates.split_at(solution);
        let weights = STAGE_WEIGHTS.get(solution).copied().unwrap_or_default();
        combine(weights, before, |r| &r.position, &mut self.scratch.position);
        combine(weights, before, |r| &r.velocity, &mut self.scratch.velocity);
        add(&mut self.state.position, &mut self.lost.position, &self.scratch.position, h);
        add(&mut self.state.velocity, &mut self.lost.velocity, &self.scratch.velocity, h);
        self.state.time = next;
        self.last_length = h;
        self.work.steps += 1;
        self.scales.widen(self.system.scales(&self.state.position, &self.state.velocity));
    }
}

impl Integrator for DormandPrince853<'_> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        if self.work.steps > 0 {
            // First same as last: the previous step's final derivative opens this one.
            self.rates.swap(0, STAGES - 1);
        }
        self.previous.clone_from(&self.state);
        loop {
            let trial = self.control.trial(self.state.time, end)?;
            for stage in 1..STAGES {
                self.evaluate_stage(stage, trial.length);
            }
            let error = self.error(trial.length);
            let rates = &self.rates;
            if self.control.accepts(trial, error, || first_lost(rates)) {
                self.accept(trial.length, trial.next);
                return Ok(());
            }
            self.work.rejected += 1;
        }
    }

    fn prepare_interpolation(&mut self) {
        for stage in STAGES..DENSE_STAGES {
            self.evaluate_stage(stage, self.last_length);
        }
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let h = self.last_length;
        let at = |values: &[f64]| values.get(body).copied().unwrap_or(0.0);
        let coefficients = |[from, to]: [f64; 2], rises: [f64; DENSE_STAGES]| {
            let rise = to - from;
            let (first, last) = (rises[0], rises[STAGES - 1]);
            let mut nested = [rise, first - rise, 2.0 * rise - last - first, 0.0, 0.0, 0.0, 0.0];
            for (value, row) in nested[3..].iter_mut().zip(DENSE) {
                *value = row.iter().map(|(stage, weight)| weight * rises[*stage]).sum();
            }
            to_powers(from, nested)
        };
        let rises = |part: fn(&Rates) -> &Vec<f64>| {
            std::array::from_fn(|stage| {
                h * self.rates.get(stage).map_or(0.0, |rates| at(part(rates)))
            })
        };
        let ends =
            |part: fn(&State) -> &Vec<f64>| [at(part(&self.previous)), at(part(&self.state))];
        Interpolant {
            position: coefficients(ends(|state| &state.position), rises(|rates| &rates.position)),
            velocity: coefficients(ends(|state| &state.velocity), rises(|rates| &rates.velocity)),
        }
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.last_length)
    }

    fn work(&self) -> Work {
        self.work
    }
}

impl Restart for DormandPrince853<'_> {
    fn system(&mut self) -> &mut dyn System {
        self.system.as_mut()
    }

    fn reached(&self) -> &State {
        &self.state
    }

    fn restart(&mut self, state: &State) {
        self.state.clone_from(state);
        self.lost.position.fill(0.0);
        self.lost.velocity.fill(0.0);
        // Where the step will look for it.
        let opening = if self.work.steps > 0 { STAGES - 1 } else { 0 };
        if let Some(rates) = self.rates.get_mut(opening) {
            rates.position.copy_from_slice(&state.velocity);
            self.system.accelerations(&state.position, &state.velocity, &mut rates.velocity);
            self.work.force_evaluations += 1;
        }
    }

    fn tolerated(&self) -> f64 {
        self.tolerance * self.scales.velocity
    }
}

/// First body with a stage that is not a number.
fn first_lost(rates: &[Rates]) -> usize {
    let lost = |r: &Rates| super::first_not_finite(&r.position, &r.velocity);
    rates.iter().find_map(lost).unwrap_or(0)
}

/// `out = sum of weight * rates[stage]`.
fn combine(weights: Row, rates: &[Rates], part: impl Fn(&Rates) -> &[f64], out: &mut [f64]) {
    add_up(weights, |stage| part(&rates[stage]), out);
}

/// `values = from + h * values`.
fn shift(values: &mut [f64], from: &[f64], h: f64) {
    for (value, start) in values.iter_mut().zip(from) {
        *value = start + h * *value;
    }
}

/// `values += h * rates`, with the rounding of earlier sums made good.
fn add(values: &mut [f64], lost: &mut [f64], rates: &[f64], h: f64) {
    for ((value, lost), rate) in values.iter_mut().zip(lost).zip(rates) {
        add_compensated(value, lost, h * rate);
    }
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
    use super::tableau::{ABSCISSAE, DENSE_STAGES, STAGE_WEIGHTS};
    use super::*;

    /// Row sums are the abscissae, and the solution integrates polynomials up to degree 7 exactly: the quadrature
    /// conditions `sum b c^k = 1/(k+1)`.
    #[test]
    fn coefficients_meet_their_conditions() {
        for stage in 1..DENSE_STAGES {
            let sum: f64 = STAGE_WEIGHTS[stage].iter().map(|(_, weight)| weight).sum();
            assert!((sum - ABSCISSAE[stage]).abs() < 1e-13, "stage {stage}: {sum}");
        }
        for power in 0..8 {
            let sum: f64 =
                STAGE_WEIGHTS[12].iter().map(|(s, b)| b * ABSCISSAE[*s].powi(power)).sum();
            assert!((sum - 1.0 / f64::from(power + 1)).abs() < 1e-14, "degree {power}: {sum}");
        }
    }

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
