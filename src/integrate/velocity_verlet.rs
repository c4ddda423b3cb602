//! Velocity Verlet with a fixed step: the honest, cheap end of the accuracy range.
//!
//! `v' = v + h/2 a(x)`, `x = x + h v'`, `v = v' + h/2 a(x)`. Order 2, symplectic and time-reversible as long as
//! forces depend on positions alone; stable below `2/omega` of the stiffest contact. Energy oscillates within a
//! bound while every contact stays closed and wanders once contacts open.
//! Source: W. C. Swope, H. C. Andersen, P. H. Berens, K. R. Wilson, J. Chem. Phys. 76, 637 (1982).

use super::interpolant::{COEFFICIENTS, Interpolant};
use super::{IntegrateError, Integrator, State, System, Work, first_not_finite};

/// Velocity Verlet at work on a system.
pub struct VelocityVerlet<'a> {
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    acceleration: Vec<f64>,
    previous_acceleration: Vec<f64>,
    step: f64,
    /// Time is `start + steps * step`, never a running sum.
    start: f64,
    work: Work,
}

impl<'a> VelocityVerlet<'a> {
    /// Name as written in scenes, options and recordings.
    pub const NAME: &'static str = "velocity-verlet";
    /// Publication that defines the method.
    pub const SOURCE: &'static str = "Swope et al., J. Chem. Phys. 76, 637 (1982)";

    /// Starts at `state` with steps of `step` (s).
    #[must_use]
    pub fn new(mut system: Box<dyn System + 'a>, state: State, step: f64) -> Self {
        let mut acceleration = vec![0.0; system.len()];
        system.accelerations(&state.position, &state.velocity, &mut acceleration);
        Self {
            previous: state.clone(),
            previous_acceleration: acceleration.clone(),
            start: state.time,
            work: Work { force_evaluations: 1, ..Work::default() },
            system,
            state,
            acceleration,
            step,
        }
    }
}

impl Integrator for VelocityVerlet<'_> {
    fn state(&self) -> &State {
        &self.state
    }

    #[allow(clippy::cast_precision_loss, reason = "runs take far fewer than 2^53 steps")]
    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        self.previous.clone_from(&self.state);
        self.previous_acceleration.copy_from_slice(&self.acceleration);
        let regular = self.start + (self.work.steps + 1) as f64 * self.step;
        let next = regular.min(end);
        let h = next - self.state.time;
        let half = 0.5 * h;
        let State { position, velocity, .. } = &mut self.state;
        for ((x, v), a) in position.iter_mut().zip(velocity.iter_mut()).zip(&self.acceleration) {
            *v += half * a;
            *x += h * *v;
        }
        self.system.accelerations(position, velocity, &mut self.acceleration);
        for (v, a) in velocity.iter_mut().zip(&self.acceleration) {
            *v += half * a;
        }
        if let Some(body) = first_not_finite(position, velocity) {
            return Err(IntegrateError::NotFinite { body, time: self.previous.time });
        }
        self.state.time = next;
        self.work.steps += 1;
        self.work.force_evaluations += 1;
        Ok(())
    }

    fn prepare_interpolation(&mut self) {}

    /// The quintic that meets position, velocity and acceleration at both ends, and its derivative. Its error is
    /// of order 6, far below the method's own.
    fn interpolant(&self, body: usize) -> Interpolant {
        let at = |values: &[f64]| values.get(body).copied().unwrap_or(0.0);
        let h = self.state.time - self.previous.time;
        let x0 = at(&self.previous.position);
        let (v0, v1) = (h * at(&self.previous.velocity), h * at(&self.state.velocity));
        let (a0, a1) = (h * h * at(&self.previous_acceleration), h * h * at(&self.acceleration));
        let rise = at(&self.state.position) - x0;
        let p = rise - v0 - 0.5 * a0;
        let q = v1 - v0 - a0;
        let r = a1 - a0;
        let position = [
            x0,
            v0,
            0.5 * a0,
            10.0 * p - 4.0 * q + 0.5 * r,
            -15.0 * p + 7.0 * q - r,
            6.0 * p - 3.0 * q + 0.5 * r,
            0.0,
            0.0,
        ];
        let mut velocity = [0.0; COEFFICIENTS];
        if h > 0.0 {
            for (power, (v, x)) in (1_u8..).zip(velocity.iter_mut().zip(&position[1..])) {
                *v = f64::from(power) * x / h;
            }
        }
        Interpolant { position, velocity }
    }

    fn last_step(&self) -> (f64, f64) {
        (self.previous.time, self.state.time - self.previous.time)
    }

    fn work(&self) -> Work {
        self.work
    }
}
