//! One chain of a group: how far it is, and how it goes on.

use super::Member;
use crate::chain::stepper::foresight::Watch;
use crate::chain::stepper::steps::{AT_ONCE, control};
use crate::chain::stepper::workspace::{Motion, Workspace};
use crate::integrate::control::{StepControl, Trial};
use crate::integrate::splitting::Clock;
use crate::integrate::{IntegrateError, Scheme, Work};

/// How its next step is found.
#[derive(Debug, Clone)]
enum Pace {
    Controlled(StepControl, Option<Trial>),
    /// In fixed steps; length and end of the one being taken (s).
    Fixed(Clock, Option<(f64, f64)>),
}

/// One chain of a group.
#[derive(Debug, Clone)]
pub struct Lane {
    pace: Pace,
    /// Largest overlap change (m) and speed (m/s) so far: what errors are relative to.
    pub scales: (f64, f64),
    /// Smallest mass (kg).
    pub lightest: f64,
    time: f64,
    end: f64,
    pub last_step: (f64, f64),
    /// Whether what contacts will do is foreseen.
    watch: Watch,
    pub counts: Work,
    /// Why it stopped, if it did.
    pub failed: Option<IntegrateError>,
}

impl Lane {
    pub fn new(member: &Member<'_>, scheme: Scheme) -> Self {
        let speed = member.velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        let scales = (member.chain.impact_overlap(member.velocities), speed);
        Self {
            pace: match scheme {
                Scheme::Pair(pair, _) => Pace::Controlled(control(scales, pair), None),
                Scheme::Splitting(method, step) => Pace::Fixed(Clock::new(method, step, 0.0), None),
            },
            scales,
            lightest: member.chain.lightest(),
            time: 0.0,
            end: member.duration,
            last_step: (0.0, 0.0),
            watch: Watch::new(),
            counts: Work { force_evaluations: 1, ..Work::default() },
            failed: None,
        }
    }

    pub fn is_moving(&self) -> bool {
        self.time < self.end && self.failed.is_none()
    }

    /// Whether what its contacts will do is foreseen.
    pub fn is_watched(&self) -> bool {
        self.watch.is_on()
    }

    /// Whether a step of it is being tried.
    pub fn tries(&self) -> bool {
        matches!(self.pace, Pace::Controlled(_, Some(_)) | Pace::Fixed(_, Some(_)))
    }

    /// The next step; 0 for a lane that stands (s).
    pub fn choose(&mut self) -> f64 {
        let (moves, time, end) = (self.is_moving(), self.time, self.end);
        match &mut self.pace {
            Pace::Controlled(control, trial) => {
                *trial = None;
                if moves {
                    match control.trial(time, end) {
                        Ok(found) => *trial = Some(found),
                        Err(error) => self.failed = Some(error),
                    }
                }
                trial.map_or(0.0, |trial| trial.length)
            }
            Pace::Fixed(clock, step) => {
                *step = moves.then(|| clock.next(time, end));
                step.map_or(0.0, |(length, _)| length)
            }
        }
    }

    /// Tries only the first `share` of its step (1); the length of that (s).
    pub fn shorten(&mut self, share: f64) -> f64 {
        let Pace::Controlled(_, Some(trial)) = &mut self.pace else { return 0.0 };
        *trial = trial.shortened(self.time, share);
        self.watch.renew();
        trial.length
    }

    /// Whole steps that can be taken at once, as many as anybody likes where it stands.
    pub fn room(&self) -> u64 {
        match &self.pace {
            Pace::Fixed(clock, _) if self.is_moving() => clock.room(AT_ONCE, self.end),
            _ => AT_ONCE,
        }
    }

    /// The length of each of `count` whole steps that are taken next; 0 for a lane that stands (s).
    pub fn choose_several(&mut self, count: u64) -> f64 {
        let moves = self.is_moving();
        let Pace::Fixed(clock, step) = &mut self.pace else { return 0.0 };
        *step = moves.then(|| (clock.step(), clock.go(count)));
        step.map_or(0.0, |(length, _)| length)
    }

    /// Takes fixed steps that have just been made, unless a body is `lost`; `made` are steps and force evaluations.
    pub fn takes(&mut self, lost: Option<usize>, made: (u64, u64)) -> bool {
        let Pace::Fixed(_, Some((length, next))) = self.pace else { return false };
        self.counts.force_evaluations += made.1;
        if let Some(body) = lost {
            self.failed = Some(IntegrateError::NotFinite { body, time: self.time });
            return false;
        }
        (self.last_step, self.time) = ((next - length, length), next);
        self.counts.steps += made.0;
        true
    }

    /// Whether the step just tried is taken.
    pub fn judge(&mut self, work: &Workspace, index: usize) -> bool {
        let Pace::Controlled(control, Some(trial)) = &mut self.pace else { return false };
        let largest = &work.largest;
        let error = work.error(index);
        if !control.accepts(*trial, error, || first_lost(&work.next, index)) {
            self.counts.rejected += 1;
            self.watch.renew();
            return false;
        }
        self.last_step = (self.time, trial.length);
        self.time = trial.next;
        self.counts.steps += 1;
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
