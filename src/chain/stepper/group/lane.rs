//! One chain of a group under a pair: how far it is, and how it goes on.

use super::Member;
use super::progress::Progress;
use crate::chain::stepper::foresight::Watch;
use crate::chain::stepper::steps::control;
use crate::chain::stepper::workspace::{Motion, Workspace};
use crate::integrate::Pair;
use crate::integrate::control::{StepControl, Trial};

/// One chain of a group.
#[derive(Debug, Clone)]
pub struct Lane {
    control: StepControl,
    /// The step that is being tried, if one is.
    trial: Option<Trial>,
    /// Largest overlap change (m) and speed (m/s) so far: what errors are relative to.
    pub scales: (f64, f64),
    /// Smallest mass (kg).
    pub lightest: f64,
    pub progress: Progress,
    /// Whether what contacts will do is foreseen.
    watch: Watch,
}

impl Lane {
    pub fn new(member: &Member<'_>, pair: Pair, watched: bool) -> Self {
        let speed = member.velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let scales = (member.chain.impact_overlap(member.velocities), speed);
        Self {
            control: control(scales, pair, watched),
            trial: None,
            scales,
            lightest: member.chain.lightest(),
            progress: Progress::new(member),
            watch: Watch::new(),
        }
    }

    /// Whether what its contacts will do is foreseen.
    pub fn is_watched(&self) -> bool {
        self.watch.is_on()
    }

    /// Whether a step of it is being tried.
    pub fn tries(&self) -> bool {
        self.trial.is_some()
    }

    /// The next step; 0 for a lane that stands (s).
    pub fn choose(&mut self) -> f64 {
        self.trial = None;
        let progress = &mut self.progress;
        if progress.is_moving() {
            match self.control.trial(progress.time, progress.end) {
                Ok(trial) => self.trial = Some(trial),
                Err(error) => progress.failed = Some(error),
            }
        }
        self.trial.map_or(0.0, |trial| trial.length)
    }

    /// Tries only the first `share` of its step (1); the length of that (s).
    pub fn shorten(&mut self, share: f64) -> f64 {
        let Some(trial) = &mut self.trial else { return 0.0 };
        *trial = trial.shortened(self.progress.time, share);
        self.watch.renew();
        trial.length
    }

    /// Whether the step just tried is taken.
    pub fn judge(&mut self, work: &Workspace, index: usize) -> bool {
        let Self { control, trial: Some(trial), .. } = self else { return false };
        let largest = &work.largest;
        let error = work.error(index);
        if !control.accepts(*trial, error, || first_lost(&work.next, index)) {
            self.progress.counts.rejected += 1;
            self.watch.renew();
            return false;
        }
        self.progress.pass(trial.length, trial.next);
        self.watch.pass();
        self.scales.0 = self.scales.0.max(largest.overlap.0[index]);
        self.scales.1 = self.scales.1.max(largest.speed.0[index]);
        true
    }
}

/// First body of the chain in lane `index` whose state is not finite.
pub fn first_lost(motion: &Motion, index: usize) -> usize {
    let mut states = motion.position().iter().zip(motion.velocity());
    let lost = states.position(|(x, v)| !(x.0[index].is_finite() && v.0[index].is_finite()));
    lost.unwrap_or(0)
}
