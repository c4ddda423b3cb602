//! Symplectic methods with a fixed step: kicks and drifts in turn.
//!
//! A method is the list of its kick fractions `b` and drift fractions `a`: `v += b h a(x)`, `x += a h v`, and so on, kick first and
//! last. The last kick of a step and the first of the next share one force evaluation. All are explicit, time-reversible,
//! and keep the energy error bounded as long as every contact stays closed; where a contact opens or closes the force
//! has no second derivative and all of them fall to about order 2.5.

use super::hermite::{Between, find_jerks};
use super::{IntegrateError, Integrator, Interpolant, State, System, Work, first_not_finite};

/// A rest of an interval shorter than this share of a step belongs to the step (1).
pub const REMAINDER: f64 = 1e-6;

/// Fractions of a symmetric kick-drift-...-drift-kick method.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Splitting {
    /// Name as written in scenes, options and recordings.
    pub name: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order of convergence on smooth problems.
    pub order: u8,
    /// Kick fractions, one more than drifts (1).
    pub kicks: &'static [f64],
    /// Drift fractions (1).
    pub drifts: &'static [f64],
    /// Longest stable step times the highest angular frequency of a linear chain (1).
    pub stability: f64,
}

/// A splitting at work on a system.
pub struct SplittingIntegrator<'a> {
    method: &'static Splitting,
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    acceleration: Vec<f64>,
    previous_acceleration: Vec<f64>,
    /// Rates of the accelerations at both ends, where the system knows them and the order deserves them.
    jerks: Option<[Vec<f64>; 2]>,
    step: f64,
    /// Time is `origin + count * step`, never a running sum; an interval's end starts a new count.
    origin: f64,
    count: u64,
    work: Work,
}

impl<'a> SplittingIntegrator<'a> {
    /// Starts `method` at `state` with steps of `step` (s).
    #[must_use]
    pub fn new(
        method: &'static Splitting,
        mut system: Box<dyn System + 'a>,
        state: State,
        step: f64,
    ) -> Self {
        let n = system.len();
        let mut acceleration = vec![0.0; n];
        system.accelerations(&state.position, &state.velocity, &mut acceleration);
        // A quintic's error of order 6 is below that of a method of order 4.
        let jerks = (method.order > 4).then(|| [vec![0.0; n], vec![0.0; n]]);
        Self {
            method,
            previous: state.clone(),
            previous_acceleration: acceleration.clone(),
            origin: state.time,
            count: 0,
            work: Work { force_evaluations: 1, ..Work::default() },
            system,
            state,
            acceleration,
            jerks,
            step,
        }
    }
}

impl Integrator for SplittingIntegrator<'_> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    #[allow(clippy::cast_precision_loss, reason = "runs take far fewer than 2^53 steps")]
    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        self.previous.clone_from(&self.state);
        self.previous_acceleration.copy_from_slice(&self.acceleration);
        let regular = self.origin + (self.count + 1) as f64 * self.step;
        // A remainder that is nothing but the rounding of the times is taken along, not stepped over on its own.
        let next = if regular + REMAINDER * self.step < end {
            self.count += 1;
            regular
        } else {
            self.origin = end;
            self.count = 0;
            end
        };
        let h = next - self.state.time;
        let State { position, velocity, .. } = &mut self.state;
        let (first, kicks) = self.method.kicks.split_first().unwrap_or((&0.0, &[]));
        add_scaled(velocity, &self.acceleration, first * h);
        for (drift, kick) in self.method.drifts.iter().zip(kicks) {
            add_scaled(position, velocity, drift * h);
            self.system.accelerations(position, velocity, &mut self.acceleration);
            add_scaled(velocity, &self.acceleration, kick * h);
            self.work.force_evaluations += 1;
        }
        if let Some(body) = first_not_finite(position, velocity) {
            return Err(IntegrateError::NotFinite { body, time: self.previous.time });
        }
        self.state.time = next;
        self.work.steps += 1;
        Ok(())
    }

    fn prepare_interpolation(&mut self) {
        let ends = [&self.previous, &self.state];
        find_jerks(self.system.as_mut(), ends, &mut self.jerks);
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        let from = (&self.previous, self.previous_acceleration.as_slice());
        let to = (&self.state, self.acceleration.as_slice());
        Between { from, to, jerks: self.jerks.as_ref() }.interpolant(body)
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.state.time - self.previous.time)
    }

    fn work(&self) -> Work {
        self.work
    }
}

/// `values += factor * rates`.
fn add_scaled(values: &mut [f64], rates: &[f64], factor: f64) {
    for (value, rate) in values.iter_mut().zip(rates) {
        *value += factor * rate;
    }
}
