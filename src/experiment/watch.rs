//! Watched forces: their samples, and their pulses.

use super::bench::Grid;
use super::pulse::PulseRecorder;
use crate::chain::ForceProbe;
use crate::chain::stepper::{ChainStepper, Depth, Due, Trail};
use crate::integrate::Integrator;

/// One watched force.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Where.
    pub probe: ForceProbe,
    /// Its peaks and arrivals, up to the end of the scene's duration.
    pub pulse: PulseRecorder,
    /// Its dynamic force at the times of the sample grid (N).
    pub samples: Vec<f64>,
}

/// Takes the steps of `trail`, at least one, into the watches: samples that fall into them, and their pulses if `pulses`.
pub fn follow(
    stepper: &ChainStepper,
    trail: &mut Trail,
    (watches, grid): (&mut [Watch], Grid),
    pulses: bool,
) {
    if pulses {
        for (place, watch) in watches.iter().enumerate() {
            trail.ask(place, watch.pulse.asks());
        }
    }
    let due = watches.first().and_then(|watch| due(trail, grid, watch.samples.len()));
    stepper.read(trail, if due.is_some() { Depth::Sampled } else { Depth::Asked });
    for (place, watch) in watches.iter_mut().enumerate() {
        if let Some(due) = &due {
            stepper.sample(trail, place, due, &mut watch.samples);
        }
        if pulses {
            watch.pulse.follow(trail.seen(place), trail.wanted(place), trail.steps());
        }
    }
    trail.clear();
}

/// The times of `grid` that fall into the steps of `trail`, where `taken` of them are over; none if there is none.
fn due(trail: &Trail, grid: Grid, mut taken: usize) -> Option<Due> {
    let [.., end] = trail.times(trail.steps() - 1);
    if grid.time(taken) > end {
        return None;
    }
    let mut due = Due::default();
    // Divisions take long: one for all steps, and one for each.
    let rate = 1.0 / grid.interval;
    for step in 0..trail.steps() {
        let [start, length, end] = trail.times(step);
        let until = grid.samples_at(end, rate).max(taken);
        let share = 1.0 / length;
        due.counts[step] = until - taken;
        due.first[step] = (grid.time(taken) - start) * share;
        due.interval[step] = grid.interval * share;
        taken = until;
    }
    Some(due)
}

impl Watch {
    /// Takes in the last step of `integrator`, of so many bodies: samples that fall into it, and its pulses if `pulses`.
    pub(super) fn take(
        &mut self,
        integrator: &dyn Integrator,
        bodies: usize,
        grid: Grid,
        pulses: bool,
    ) {
        let segment = self.probe.over_step(integrator, bodies);
        let end = integrator.time();
        let mut time = grid.time(self.samples.len());
        while time <= end {
            self.samples.push(segment.force((time - segment.start) / segment.length));
            time = grid.time(self.samples.len());
        }
        if pulses {
            self.pulse.take(segment);
        }
    }
}
