//! Symplectic methods with a fixed step: kicks and drifts in turn.
//!
//! A method is the list of its kick fractions `b` and drift fractions `a`: `v += b h a(x)`,
//! `x += a h v`, and so on, kick first and last. Kicks may also go by how the forces change where
//! they point, `v += g h^3 (da/dx) a`. The last kick of a step and the first of the next share one
//! force evaluation. All are explicit, time-reversible, and keep the energy error bounded as long
//! as every contact stays closed; where a contact opens or closes the force has no second
//! derivative and all of them fall to about order 2.5.

use super::hermite::{Between, find_jerks};
use super::two_step::{ContactMotion, NO_CONTACT, StiffContact, TwoStep};
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
    /// What accelerations' gradients along themselves weigh in each kick, in units of the step
    /// cubed; empty without them (1).
    pub gradients: &'static [f64],
    /// Where the parts of a run's first step end, in steps, the last at 1; empty where it is taken
    /// whole (1).
    pub first_step: &'static [f64],
    /// Longest stable step times the highest angular frequency of a linear chain (1).
    pub stability: f64,
}

/// Times at which fixed steps end: `origin + count * step`, never a running sum; an interval's end
/// starts a new count.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clock {
    step: f64,
    origin: f64,
    count: u64,
    /// Ends of the first step's parts that are still to come (1).
    cuts: &'static [f64],
}

impl Clock {
    /// Steps of `step` (s) by `method` from `origin` (s) on.
    pub fn new(method: &Splitting, step: f64, origin: f64) -> Self {
        Self { step, origin, count: 0, cuts: method.first_step }
    }

    /// Length of a whole step (s).
    pub fn step(&self) -> f64 {
        self.step
    }

    /// Length of the next step from `time` on, and where it ends, not beyond `end` (s).
    pub fn next(&mut self, time: f64, end: f64) -> (f64, f64) {
        if let Some((cut, rest)) = self.cuts.split_first() {
            let next = self.origin + cut * self.step;
            if self.is_before(next, end) {
                (self.cuts, self.count) = (rest, u64::from(rest.is_empty()));
                return (next - time, next);
            }
        } else if self.room(1, end) > 0 {
            return (self.step, self.go(1));
        }
        (self.origin, self.count, self.cuts) = (end, 0, &[]);
        (end - time, end)
    }

    /// How many whole steps end before `end` (s), up to `most`.
    pub fn room(&self, most: u64, end: f64) -> u64 {
        if !self.cuts.is_empty() {
            return 0;
        }
        // The quotient may be off by its rounding; the steps' own ends decide.
        let fit = ((end - self.after(0)) / self.step) as u64;
        let mut count = most.min(fit.saturating_add(1));
        while count > 0 && !self.is_before(self.after(count), end) {
            count -= 1;
        }
        count
    }

    /// Takes `count` whole steps; returns where the last ends (s).
    pub fn go(&mut self, count: u64) -> f64 {
        self.count += count;
        self.after(0)
    }

    /// Where the step ended that was `count` before the last, all of them whole (s).
    pub fn before(&self, count: u64) -> f64 {
        self.end(self.count - count)
    }

    /// Where `count` more whole steps end (s).
    fn after(&self, count: u64) -> f64 {
        self.end(self.count + count)
    }

    /// Where step `number` ends (s).
    fn end(&self, number: u64) -> f64 {
        self.origin + number as f64 * self.step
    }

    /// Whether a step that ends at `time` (s) leaves some of the interval; what is nothing but the
    /// rounding of the times is taken along, not stepped over on its own.
    fn is_before(&self, time: f64, end: f64) -> bool {
        time + REMAINDER * self.step < end
    }
}

/// A splitting at work on a system; one with gradients needs a system that knows its jerks.
pub struct SplittingIntegrator<'a> {
    method: &'static Splitting,
    system: Box<dyn System + 'a>,
    state: State,
    previous: State,
    acceleration: Vec<f64>,
    previous_acceleration: Vec<f64>,
    /// Rates of the accelerations at both ends, where the system knows them and the order deserves
    /// them.
    jerks: Option<[Vec<f64>; 2]>,
    /// Gradients of the accelerations along themselves (m/s⁴), for methods that have a use for
    /// them, and the state they are asked for with: accelerations in the velocities' place.
    gradient: Option<(Vec<f64>, State)>,
    timing: Timing,
    work: Work,
}

/// When steps end.
enum Timing {
    Fixed(Clock),
    TwoStep(TwoStep, Option<StiffContact>),
}

impl<'a> SplittingIntegrator<'a> {
    /// Starts `method` at `state` with steps of `step` (s).
    pub fn new(
        method: &'static Splitting,
        system: Box<dyn System + 'a>,
        state: State,
        step: f64,
    ) -> Self {
        let timing = Timing::Fixed(Clock::new(method, step, state.time));
        Self::timed(method, system, state, timing)
    }

    /// Starts `method` at `state` with the steps that `tolerance` (1) asks for.
    pub fn two_step(
        method: &'static Splitting,
        system: Box<dyn System + 'a>,
        state: State,
        tolerance: f64,
    ) -> Self {
        let pacing = system.pacing(&state);
        // The first step is chosen once accelerations are known.
        let timing = Timing::TwoStep(TwoStep::new(&pacing, tolerance, NO_CONTACT), pacing.stiff);
        let mut start = Self::timed(method, system, state, timing);
        let contact_motion = start.contact_motion(pacing.stiff.as_ref());
        start.timing =
            Timing::TwoStep(TwoStep::new(&pacing, tolerance, contact_motion), pacing.stiff);
        start
    }

    fn timed(
        method: &'static Splitting,
        mut system: Box<dyn System + 'a>,
        state: State,
        timing: Timing,
    ) -> Self {
        let n = system.len();
        let mut acceleration = vec![0.0; n];
        system.accelerations(&state.position, &state.velocity, &mut acceleration);
        // A quintic's error of order 6 is below that of a method of order 4.
        let jerks = (method.order > 4).then(|| [vec![0.0; n], vec![0.0; n]]);
        let gradient = (!method.gradients.is_empty()).then(|| (vec![0.0; n], state.clone()));
        let mut start = Self {
            method,
            previous: state.clone(),
            previous_acceleration: acceleration.clone(),
            timing,
            work: Work { force_evaluations: 1, ..Work::default() },
            system,
            state,
            acceleration,
            jerks,
            gradient,
        };
        start.find_gradient();
        start
    }

    /// How the stiff contact moves.
    fn contact_motion(&self, stiff: Option<&StiffContact>) -> ContactMotion {
        let State { position, velocity, .. } = &self.state;
        stiff.map_or(NO_CONTACT, |stiff| stiff.motion([position, velocity, &self.acceleration]))
    }

    fn find_gradient(&mut self) {
        if let Some((gradient, at)) = &mut self.gradient {
            at.position.copy_from_slice(&self.state.position);
            at.velocity.copy_from_slice(&self.acceleration);
            self.system.jerks(at, gradient);
        }
    }

    /// Kick `index` of a step of `h` (s).
    fn kick(&mut self, index: usize, h: f64) {
        let velocity = &mut self.state.velocity;
        add_scaled(velocity, &self.acceleration, self.method.kicks[index] * h);
        if let Some((gradient, _)) = &self.gradient {
            add_scaled(velocity, gradient, self.method.gradients[index] * h * h * h);
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

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        self.previous.clone_from(&self.state);
        self.previous_acceleration.copy_from_slice(&self.acceleration);
        let (h, next) = match &mut self.timing {
            Timing::Fixed(clock) => clock.next(self.state.time, end),
            Timing::TwoStep(steps, _) => steps.next(self.state.time, end),
        };
        self.kick(0, h);
        for (index, drift) in self.method.drifts.iter().enumerate() {
            let State { position, velocity, .. } = &mut self.state;
            add_scaled(position, velocity, drift * h);
            self.system.accelerations(position, velocity, &mut self.acceleration);
            self.find_gradient();
            self.kick(index + 1, h);
            self.work.force_evaluations += 1;
        }
        let State { position, velocity, .. } = &self.state;
        if let Some(body) = first_not_finite(position, velocity) {
            return Err(IntegrateError::NotFinite { body, time: self.previous.time });
        }
        if let Timing::TwoStep(_, stiff) = self.timing {
            let contact_motion = self.contact_motion(stiff.as_ref());
            if let Timing::TwoStep(steps, _) = &mut self.timing {
                steps.advance(contact_motion);
            }
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

/// `values += factor * rates`.
fn add_scaled(values: &mut [f64], rates: &[f64], factor: f64) {
    for (value, rate) in values.iter_mut().zip(rates) {
        *value += factor * rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::force_gradient::FORCE_GRADIENT;
    use crate::integrate::velocity_verlet::VELOCITY_VERLET;

    /// Half the trace of a step of `angle` (rad) of a linear oscillator: motions stay bounded where
    /// it is between -1 and 1.
    fn half_trace(method: &Splitting, angle: f64) -> f64 {
        let square = angle * angle;
        let through = |[mut x, mut v]: [f64; 2]| {
            for (index, kick) in method.kicks.iter().enumerate() {
                let gradient = method.gradients.get(index).unwrap_or(&0.0);
                v += (gradient * square - kick) * square * x;
                x += method.drifts.get(index).unwrap_or(&0.0) * v;
            }
            [x, v]
        };
        0.5 * (through([1.0, 0.0])[0] + through([0.0, 1.0])[1])
    }

    /// Up to the step that each method says, also where one turns the oscillator round, and not
    /// right beyond.
    #[test]
    fn steps_are_stable_as_far_as_is_said() {
        for method in [&VELOCITY_VERLET, &FORCE_GRADIENT] {
            // In shares of a hundred thousandth.
            let most = |shares: std::ops::Range<u32>| {
                let angles = shares.map(|share| 1e-5 * f64::from(share) * method.stability);
                angles.map(|angle| half_trace(method, angle).abs() - 1.0).reduce(f64::max)
            };
            let [below, beyond] = [most(1..100_000), most(100_000..103_000)];
            println!("{}: {below:?} up to {}, {beyond:?}", method.name, method.stability);
            assert!(below.is_some_and(|most| most < 1e-13), "{}: {below:?}", method.name);
            assert!(beyond.is_some_and(|most| most > 1e-9), "{}: {beyond:?}", method.name);
        }
    }

    /// As many as there are one by one, also where the interval is a whole number of steps, or all
    /// but one.
    #[test]
    fn steps_that_fit_are_those_that_end_before() {
        let step = 0.1;
        for origin in [0.0, -3.7, 1e3] {
            let mut clock = Clock::new(&VELOCITY_VERLET, step, origin);
            for taken in [0, 3, 1_000] {
                let start = clock.go(taken);
                let ends = (0..400_u32).map(|i| f64::from(i) / 8.0).chain([f64::INFINITY, -1.0]);
                for end in ends.map(|steps| start + steps * step) {
                    for most in [0, 1, 7, 64] {
                        let fit = (1..=most).take_while(|i| clock.is_before(clock.after(*i), end));
                        let (fit, found) = (fit.count() as u64, clock.room(most, end));
                        assert_eq!(found, fit, "{origin}, {taken}, {end}, {most}");
                    }
                }
            }
        }
    }
}
