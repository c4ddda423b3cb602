//! Watched forces: their samples, and their pulses.

use super::bench::Grid;
use super::pulse::PulseRecorder;
use crate::chain::stepper::{ChainStepper, View};
use crate::integrate::Integrator;

/// One watched force.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Its peaks and arrivals, up to the end of the scene's duration.
    pub pulse: PulseRecorder,
    /// Its dynamic force at the times of the sample grid (N).
    pub samples: Vec<f64>,
}

/// Takes the stepper's last step into the watches: samples that fall into it, and its pulses if `pulses`.
pub fn follow(
    stepper: &ChainStepper,
    views: &mut [View],
    (watches, grid): (&mut [Watch], Grid),
    pulses: bool,
) {
    let (start, length) = stepper.last_step();
    let end = stepper.time();
    let is_due = |watch: &Watch| grid.time(watch.samples.len()) <= end;
    let due = if watches.first().is_some_and(is_due) { grid.samples_until(end) } else { 0 };
    if due > 0 {
        // Whoever looks into the step sees its end, too.
        for view in views.iter_mut() {
            view.wanted = true;
        }
    } else if pulses {
        stepper.glance(views);
        for (view, watch) in views.iter_mut().zip(&*watches) {
            view.wanted = watch.pulse.wants(view);
        }
    } else {
        return;
    }
    stepper.look(views);
    for (view, watch) in views.iter().zip(watches) {
        let samples = &mut watch.samples;
        if let Some(count @ 1..) = due.checked_sub(samples.len()) {
            let first = (grid.time(samples.len()) - start) / length;
            stepper.sample(view, (first, grid.interval / length), count, samples);
        }
        if pulses {
            watch.pulse.meet(view);
        }
    }
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
        let segment = if pulses {
            self.pulse.take(integrator, bodies)
        } else {
            self.pulse.probe().over_step(integrator, bodies)
        };
        let end = integrator.time();
        let mut time = grid.time(self.samples.len());
        while time <= end {
            self.samples.push(segment.force((time - segment.start) / segment.length));
            time = grid.time(self.samples.len());
        }
    }
}
