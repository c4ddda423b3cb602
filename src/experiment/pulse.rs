//! What a force probe has felt: samples, local maxima, and the first time a level was reached, all from the
//! interpolant and none from the integrator's grid.

use serde::Serialize;

use crate::chain::{ForceProbe, ForceSegment};
use crate::integrate::Integrator;

/// A step is looked at in this many places for a change of slope. Steps resolve the stiffest contact, or they would not
/// be accepted, so a force turns at most once between two looks.
const LOOKS_PER_STEP: u8 = 4;
/// A peak counts when it exceeds this share of the record's largest dynamic force (1).
const PEAK_SHARE: f64 = 0.25;
/// What two steps' interpolants may differ by where they meet is no jump, as a share of the largest force (1).
const SMALLEST_JUMP: f64 = 1e-6;
/// Share of the first peak at which a pulse is said to arrive by its half-rise (1).
pub const HALF_RISE: f64 = 0.5;
/// Share of the first peak at which a pulse is said to arrive by its foot (1).
pub const FOOT: f64 = 0.1;

/// A local maximum of the dynamic force.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    /// Force with its static part (N).
    pub total_n: f64,
    /// Force above its static part (N).
    pub dynamic_n: f64,
    /// Time since the striker's first contact (s).
    pub time_s: f64,
}

/// Follows one probe through a run.
#[derive(Debug, Clone)]
pub struct PulseRecorder {
    probe: ForceProbe,
    peaks: Vec<(f64, f64)>,
    /// Segments during which the force exceeded all before: where any level was first reached.
    rises: Vec<Rise>,
    largest: f64,
    rate_before: f64,
    /// Force at the end of the last step where it may jump (N).
    last: f64,
}

#[derive(Debug, Clone)]
struct Rise {
    segment: ForceSegment,
    reached: f64,
}

impl PulseRecorder {
    /// Starts with nothing felt.
    #[must_use]
    pub fn new(probe: ForceProbe) -> Self {
        Self {
            probe,
            peaks: Vec::new(),
            rises: Vec::new(),
            largest: 0.0,
            rate_before: 0.0,
            last: 0.0,
        }
    }

    /// The probe that is followed.
    #[must_use]
    pub fn probe(&self) -> &ForceProbe {
        &self.probe
    }

    /// Takes in the integrator's last step and returns the force over it.
    pub fn take(&mut self, integrator: &dyn Integrator, bodies: usize) -> ForceSegment {
        let segment = self.probe.over_step(integrator, bodies);
        let mut reached = self.largest;
        let mut theta_before = 0.0;
        if self.probe.is_lossy() {
            reached = reached.max(self.jump(&segment));
        }
        for look in 1..=LOOKS_PER_STEP {
            let theta = f64::from(look) / f64::from(LOOKS_PER_STEP);
            let rate = segment.rate(theta);
            if self.rate_before > 0.0 && rate <= 0.0 {
                let top = root(&|t| segment.rate(t), theta_before, theta);
                let force = segment.force(top);
                self.peaks.push((segment.start + top * segment.length, force));
                reached = reached.max(force);
            }
            self.rate_before = rate;
            theta_before = theta;
        }
        // Between its peaks a force is largest at an end of the step.
        reached = reached.max(segment.force(1.0));
        if reached > self.largest {
            self.largest = reached;
            self.rises.push(Rise { segment: segment.clone(), reached });
        }
        segment
    }

    /// A force that jumps up as a contact closes and then falls has its peak at the jump. Returns the force there (N).
    fn jump(&mut self, segment: &ForceSegment) -> f64 {
        let (force, rate) = (segment.force(0.0), segment.rate(0.0));
        if force - self.last > SMALLEST_JUMP * self.largest && rate <= 0.0 {
            self.peaks.push((segment.start, force));
        }
        self.rate_before = rate;
        self.last = segment.force(1.0);
        force
    }

    /// Largest dynamic force so far (N).
    #[must_use]
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// The first local maximum of the dynamic force above a quarter of its largest value so far.
    #[must_use]
    pub fn first_peak(&self) -> Option<Peak> {
        let threshold = PEAK_SHARE * self.largest;
        let (time_s, dynamic_n) = *self.peaks.iter().find(|(_, force)| *force > threshold)?;
        Some(Peak { total_n: dynamic_n + self.probe.static_force(), dynamic_n, time_s })
    }

    /// The time when the dynamic force first reached `level` (N), which is positive (s).
    #[must_use]
    pub fn first_reach(&self, level: f64) -> Option<f64> {
        let rise = self.rises.iter().find(|rise| rise.reached >= level)?;
        let excess = |theta: f64| rise.segment.force(theta) - level;
        let mut theta_before = 0.0;
        for look in 1..=LOOKS_PER_STEP {
            let theta = f64::from(look) / f64::from(LOOKS_PER_STEP);
            if excess(theta) >= 0.0 {
                let at = root(&excess, theta_before, theta);
                return Some(rise.segment.start + at * rise.segment.length);
            }
            theta_before = theta;
        }
        // The level lies between the last looks' forces and a peak between them.
        let top = root(&|t| rise.segment.rate(t), 0.0, 1.0);
        let at = root(&excess, 0.0, top);
        Some(rise.segment.start + at * rise.segment.length)
    }
}

/// Root of `f`, which changes sign between `low` and `high`, by bisection to the last bit: 60 cheap evaluations, and no
/// shape of `f` can defeat it.
fn root(f: &dyn Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    let low_is_positive = f(low) > 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (f(middle) > 0.0) == low_is_positive {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}
