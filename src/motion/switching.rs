//! Systems whose law changes by switches: contacts whose forces jump where they open or close, or
//! have a kink where they would pull.
//!
//! ```text
//! method's step   |----------------------------------|  smooth law: all switches keep their state
//! a margin        + + + + + + + + + + 0 - - - - - - -   has a root: the switch should have changed
//! accepted step   |-------------------|                 cut at the root
//! next step                           |-----------      the switch flipped, the method restarted
//! ```
//!
//! Within a step the method sees a smooth law and keeps its order. A step over a jump would be of
//! order 1, one over a kink of order 2. Changes that are lost in the tolerance change at the end of
//! a step without a search, or a rattling chain would stop at tens of thousands of them. Source: E.
//! Hairer, S. P. Norsett, G. Wanner, Solving Ordinary Differential Equations I (1993), II.6, "Event
//! location".

use super::hermite::Interpolant;
use super::integrator::{IntegrateError, Integrator, Restart, Work};
use super::system::{Motion, Sides, Turning};
use crate::chain::State;

/// Samples of a margin within a step.
const SAMPLES: u8 = 2;
/// Halvings of the part in which a margin has its root: to the last bit.
const HALVINGS: usize = 60;
/// A step is not cut to less than this share (1).
const MIN_CUT_SHARE: f64 = 1e-9;
/// A margin further from zero than this share of its travel within the step, by the step's cubic,
/// has no root there (1).
const CLEAR_SHARE: f64 = 0.5;
/// Jumps below this share of what the error control tolerates are not searched for (1).
const NEGLIGIBLE_SHARE: f64 = 0.1;

/// A method at work on a system with switches.
pub struct Switched<I> {
    inner: I,
    state: State,
    /// Where the method's last step ended, before any cut.
    reached: State,
    sides: Vec<Sides>,
    /// Distance and speed of the two bodies of each switch at both ends of the step.
    ends: Vec<[Motion; 2]>,
    /// Switches that may have to change within the step.
    unclear: Vec<usize>,
    /// Number of the switch at each place, if there is one.
    at: Vec<Option<usize>>,
    /// Whether each switch was on over the last step.
    on: Vec<bool>,
    /// Whether each switch is on now.
    now: Vec<bool>,
    start: f64,
    /// Whether a switch changed just before the last step, so that the method started again.
    restarts: bool,
    /// Whether one changed at the end of the last step.
    flips_at_end: bool,
    /// Share of the method's last step up to the cut; 1 without one (1).
    cut: f64,
    prepared: bool,
}

impl<I: Restart> Switched<I> {
    /// Watches over `inner`.
    pub fn new(mut inner: I) -> Self {
        let sides = inner.system().switching().map_or_else(Vec::new, |system| {
            (0..system.switches()).map(|switch| system.sides(switch)).collect()
        });
        let state = inner.state();
        let on = vec![true; sides.len()];
        let places = sides.iter().map(|sides| sides.place + 1).max().unwrap_or(0);
        let mut at = vec![None; places];
        for (switch, sides) in sides.iter().enumerate() {
            at[sides.place] = Some(switch);
        }
        Self {
            start: state.time,
            inner,
            reached: state.clone(),
            state,
            ends: Vec::with_capacity(sides.len()),
            unclear: Vec::with_capacity(sides.len()),
            sides,
            at,
            now: on.clone(),
            on,
            restarts: true,
            flips_at_end: false,
            cut: 1.0,
            prepared: false,
        }
    }

    /// A motion over the method's last step, as one over its part up to the cut.
    fn up_to_cut(&self, mut motion: Interpolant) -> Interpolant {
        if self.cut < 1.0 {
            for coefficients in [&mut motion.position, &mut motion.velocity] {
                let mut power = 1.0;
                for coefficient in coefficients {
                    *coefficient *= power;
                    power *= self.cut;
                }
            }
        }
        motion
    }

    /// Flips the switches whose margin has the wrong sign and moves further away from zero.
    fn flip_wrong_switches(&mut self) -> bool {
        let state = &mut self.state;
        let mut any = false;
        let Some(system) = self.inner.system().switching() else { return false };
        for switch in 0..self.sides.len() {
            let motion = system.motion(switch, state);
            if system.is_wrong(switch, motion) {
                system.flip(switch, state);
                any = true;
            }
        }
        for (switch, now) in self.now.iter_mut().enumerate() {
            *now = system.is_on(switch);
        }
        self.on.clone_from(&self.now);
        any
    }

    /// Finds the switches that may have to change within the method's last step.
    fn find_unclear(&mut self) {
        let (_, length) = self.inner.last_step();
        self.reached.clone_from(self.inner.reached());
        self.ends.clear();
        self.unclear.clear();
        let Some(system) = self.inner.system().switching() else { return };
        let motions =
            |switch| [&self.state, &self.reached].map(|state| system.motion(switch, state));
        self.ends.extend((0..self.sides.len()).map(motions));
        for (switch, (ends, on)) in self.ends.iter().zip(&self.on).enumerate() {
            let turns = ends[0].rate > 0.0 && ends[1].rate < 0.0;
            let may_change = turns && system.turning(switch) != Turning::Irrelevant;
            if may_change
                || !stays_clear(*ends, length, |motion| system.margin(switch, motion), *on)
            {
                self.unclear.push(switch);
            }
        }
    }

    /// The first place in the method's last step where a switch should have changed: share of the
    /// step, and the switch.
    fn event(&mut self) -> Option<(f64, usize)> {
        self.find_unclear();
        let (_, length) = self.inner.last_step();
        let tolerated = NEGLIGIBLE_SHARE * self.inner.tolerated();
        let mut first: Option<(f64, usize)> = None;
        for &switch in &self.unclear {
            let (sides, on) = (self.sides[switch], self.on[switch]);
            let body = |index: Option<usize>, end: usize| {
                index.map_or_else(|| self.inner.wall(end), |index| self.inner.interpolant(index))
            };
            let (above, below) = (body(sides.above, 0), body(sides.below, 1));
            let motion = |theta: f64| Motion {
                difference: above.position(theta) - below.position(theta),
                rate: above.velocity(theta) - below.velocity(theta),
            };
            let system = self.inner.system().switching()?;
            let [from, to] = self.ends[switch];
            let turning = system.turning(switch);
            let turns = from.rate > 0.0 && to.rate < 0.0 && turning != Turning::Irrelevant;
            let turn = turns.then(|| root(&|theta| motion(theta).rate < 0.0, 0.0, 1.0));
            if let Turning::Changes(level) = turning {
                let turn = turn.filter(|theta| {
                    let difference = motion(*theta).difference;
                    let error = |turn| system.turn_error(switch, turn, to);
                    difference > level && error(difference) * length > tolerated
                });
                let is_first = |theta: &f64| first.is_none_or(|(earliest, _)| *theta < earliest);
                if let Some(theta) = turn.filter(is_first) {
                    first = Some((theta, switch));
                }
                continue;
            }
            let wrong = |theta: f64| (system.margin(switch, motion(theta)) >= 0.0) != on;
            let (mut before, mut at) = (0.0, None);
            // What is negligible when it is seen first need not be so by the end of the step.
            let samples = (1..=SAMPLES).map(|sample| f64::from(sample) / f64::from(SAMPLES));
            for theta in turn.into_iter().chain(samples) {
                if !wrong(theta) {
                    before = theta;
                    continue;
                }
                let began = at.unwrap_or_else(|| {
                    if wrong(before) { theta } else { root(&wrong, before, theta) }
                });
                at = Some(began);
                let error = system.error(switch, motion(began).rate, motion(theta));
                if error * length > tolerated {
                    if first.is_none_or(|(earliest, _)| began < earliest) {
                        first = Some((began, switch));
                    }
                    break;
                }
            }
        }
        first
    }
}

/// Whether a switch surely keeps its state `on` over a step of `length` (s) between two `ends`, by
/// the cubic through them, so that its costly interpolants are not needed: most contacts of a long
/// chain are far from opening, or from closing.
fn stays_clear(ends: [Motion; 2], length: f64, margin: impl Fn(Motion) -> f64, on: bool) -> bool {
    let [from, to] = ends;
    let rise = to.difference - from.difference;
    let middle = Motion {
        difference: from.difference + 0.5 * rise + 0.125 * length * (from.rate - to.rate),
        rate: 1.5 * rise / length - 0.25 * (from.rate + to.rate),
    };
    let margins = [from, middle, to].map(margin);
    let [least, most] = [f64::min, f64::max].map(|pick| margins.into_iter().fold(margins[0], pick));
    let nearest = if on { least } else { -most };
    nearest >= 0.0 && nearest >= CLEAR_SHARE * (most - least) && (on || nearest > 0.0)
}

/// Where `wrong` begins between `low` and `high`.
fn root(wrong: &dyn Fn(f64) -> bool, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if wrong(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

impl<I: Restart> Integrator for Switched<I> {
    fn time(&self) -> f64 {
        self.state.time
    }

    fn state(&self) -> State {
        self.state.clone()
    }

    fn step(&mut self, end: f64) -> Result<(), IntegrateError> {
        self.restarts = self.flip_wrong_switches() || self.flips_at_end;
        self.flips_at_end = false;
        if self.restarts {
            self.inner.restart(&self.state);
        }
        // Each switch may change once without time passing; more would be no motion.
        for _ in 0..=self.sides.len() {
            self.start = self.state.time;
            self.cut = 1.0;
            self.prepared = true;
            self.inner.step(end)?;
            self.inner.prepare_interpolation();
            let Some((theta, switch)) = self.event() else {
                self.state.clone_from(self.inner.reached());
                return Ok(());
            };
            let (start, length) = self.inner.last_step();
            if theta >= MIN_CUT_SHARE {
                self.cut = theta;
                for body in 0..self.state.position.len() {
                    let motion = self.inner.interpolant(body);
                    self.state.position[body] = motion.position(theta);
                    self.state.velocity[body] = motion.velocity(theta);
                }
                self.state.time = start + theta * length;
            }
            let Some(system) = self.inner.system().switching() else { break };
            system.flip(switch, &mut self.state);
            for (switch, now) in self.now.iter_mut().enumerate() {
                *now = system.is_on(switch);
            }
            if theta >= MIN_CUT_SHARE {
                self.flips_at_end = true;
                return Ok(());
            }
            self.on.clone_from(&self.now);
            self.restarts = true;
            self.inner.restart(&self.state);
        }
        Ok(())
    }

    fn prepare_interpolation(&mut self) {
        if !self.prepared {
            self.inner.prepare_interpolation();
            self.prepared = true;
        }
    }

    fn interpolant(&self, body: usize) -> Interpolant {
        self.up_to_cut(self.inner.interpolant(body))
    }

    fn wall(&self, end: usize) -> Interpolant {
        self.up_to_cut(self.inner.wall(end))
    }

    fn body(&self, body: usize) -> [f64; 2] {
        [self.state.position[body], self.state.velocity[body]]
    }

    fn last_step(&self) -> (f64, f64) {
        (self.start, self.state.time - self.start)
    }

    fn work(&self) -> Work {
        self.inner.work()
    }

    fn starts_anew(&self) -> bool {
        self.restarts
    }

    fn was_on(&self, place: usize) -> bool {
        self.at.get(place).copied().flatten().is_none_or(|switch| self.on[switch])
    }

    fn is_on(&self, place: usize) -> bool {
        self.at.get(place).copied().flatten().is_none_or(|switch| self.now[switch])
    }
}

#[cfg(test)]
mod tests {
    use super::Switched;
    use crate::chain::State;
    use crate::motion::{
        IntegrateError, Integrator, Interpolant, Motion, Restart, Scales, Sides, Switching, System,
        Work,
    };

    /// A body that moves at 1 m/s; its switch should be on up to `at` (m), and beyond it is off by
    /// as many m/s² as the body is by m.
    struct Coasting {
        at: f64,
        is_on: bool,
    }

    impl System for Coasting {
        fn len(&self) -> usize {
            1
        }

        fn accelerations(&mut self, _: &[f64], _: &[f64], acceleration: &mut [f64]) {
            acceleration.fill(0.0);
        }

        fn scales(&self, _: &[f64], _: &[f64]) -> Scales {
            Scales { position: 1.0, velocity: 1.0 }
        }

        fn switching(&mut self) -> Option<&mut dyn Switching> {
            Some(self)
        }
    }

    impl Switching for Coasting {
        fn switches(&self) -> usize {
            1
        }

        fn is_on(&self, _: usize) -> bool {
            self.is_on
        }

        fn flip(&mut self, _: usize, _: &mut State) {
            self.is_on = !self.is_on;
        }

        fn sides(&self, _: usize) -> Sides {
            Sides { above: Some(0), below: None, place: 0 }
        }

        fn margin(&self, _: usize, motion: Motion) -> f64 {
            self.at - motion.difference
        }

        fn is_wrong(&self, _: usize, motion: Motion) -> bool {
            (motion.difference <= self.at) != self.is_on
        }

        fn error(&self, _: usize, _: f64, beyond: Motion) -> f64 {
            beyond.difference - self.at
        }
    }

    /// Steps of 1 s, exact.
    struct Exact {
        system: Coasting,
        state: State,
        start: f64,
        tolerated: f64,
        restarts: usize,
    }

    impl Exact {
        fn up_to(at: f64, tolerated: f64) -> Switched<Self> {
            let state = State { time: 0.0, position: vec![0.0], velocity: vec![1.0] };
            let system = Coasting { at, is_on: true };
            Switched::new(Self { system, state, start: 0.0, tolerated, restarts: 0 })
        }
    }

    impl Integrator for Exact {
        fn time(&self) -> f64 {
            self.state.time
        }

        fn state(&self) -> State {
            self.state.clone()
        }

        fn step(&mut self, _: f64) -> Result<(), IntegrateError> {
            self.start = self.state.time;
            self.state.time += 1.0;
            self.state.position[0] += 1.0;
            Ok(())
        }

        fn prepare_interpolation(&mut self) {}

        fn interpolant(&self, _: usize) -> Interpolant {
            let mut motion = Interpolant::REST;
            (motion.position[0], motion.position[1]) = (self.state.position[0] - 1.0, 1.0);
            motion.velocity[0] = 1.0;
            motion
        }

        fn body(&self, body: usize) -> [f64; 2] {
            [self.state.position[body], self.state.velocity[body]]
        }

        fn last_step(&self) -> (f64, f64) {
            (self.start, 1.0)
        }

        fn work(&self) -> Work {
            Work::default()
        }
    }

    impl Restart for Exact {
        fn system(&mut self) -> &mut dyn System {
            &mut self.system
        }

        fn reached(&self) -> &State {
            &self.state
        }

        fn restart(&mut self, state: &State) {
            self.state.clone_from(state);
            self.restarts += 1;
        }

        fn tolerated(&self) -> f64 {
            self.tolerated
        }
    }

    /// Whatever is negligible where it is first seen, at mid-step, counts for what it has become at
    /// the end.
    #[test]
    fn a_switch_just_before_mid_step_cuts_the_step() {
        for (at, tolerated, length) in [
            (0.499, 0.1, 0.499),
            (0.3, 0.1, 0.3),
            (0.8, 0.1, 0.8),
            (0.499, 6.0, 1.0),
            (0.995, 0.1, 1.0),
        ] {
            let mut body = Exact::up_to(at, tolerated);
            body.step(9.0).expect("a step");
            let (_, taken) = body.last_step();
            assert!((taken - length).abs() < 1e-12, "{at} m, {tolerated} m/s: {taken} s");
            assert_eq!(body.is_on(0), length >= 1.0);
        }
    }

    /// Where a switch changes at the last bit of a step the next one starts anew, as after any
    /// other.
    #[test]
    fn a_switch_at_the_very_end_begins_anew() {
        let last = 1.0 - 0.5 * f64::EPSILON;
        let mut body = Exact::up_to(last, 0.0);
        body.step(9.0).expect("a step");
        assert_eq!((body.time(), body.is_on(0)), (1.0, false));
        let before = body.inner.restarts;
        body.step(9.0).expect("a step");
        assert!(body.starts_anew());
        assert_eq!(body.inner.restarts, before + 1);
    }
}
