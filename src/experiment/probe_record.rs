//! Watched forces: their samples, and their pulses.

use super::grid::Grid;
use super::pulse::PulseRecorder;
use crate::chain::ForceProbe;
use crate::motion::Integrator;
use crate::motion::force_segment::over_step;
use crate::motion::kernel::InstructionSet;
use crate::motion::probe_step::ProbeTracker;

/// One watched force.
#[derive(Debug, Clone)]
pub struct ProbeRecord {
    /// Where.
    pub probe: ForceProbe,
    /// Its peaks and arrivals, up to the end of the scene's duration.
    pub pulse: PulseRecorder,
    /// Its dynamic force at the times of the sample grid (N).
    pub samples: Vec<f64>,
}

impl ProbeRecord {
    /// Takes in the last step of the vector path, which ended at `end` (s): samples that fall into
    /// it, and its pulses if `pulses`.
    pub(super) fn take_step(
        &mut self,
        set: InstructionSet,
        tracker: &ProbeTracker,
        end: f64,
        grid: Grid,
        pulses: bool,
    ) {
        let taken = self.samples.len();
        let time = grid.time(taken);
        if time <= end {
            let (step, count) = (tracker.overlaps(), grid.samples_until(end) - taken);
            let first = (time - step.start) / step.length;
            let times = (first, grid.interval / step.length, count);
            tracker.pair().sample(set, &step, times, &mut self.samples);
        }
        if pulses {
            self.pulse.take_step(tracker);
        }
    }

    /// Takes in the last step of `integrator`, of so many bodies: samples that fall into it, and
    /// its pulses if `pulses`.
    pub(super) fn take(
        &mut self,
        integrator: &dyn Integrator,
        bodies: usize,
        grid: Grid,
        pulses: bool,
    ) {
        let segment = over_step(&self.probe, integrator, bodies);
        let end = integrator.time();
        let mut time = grid.time(self.samples.len());
        while time <= end {
            self.samples.push(segment.force((time - segment.start) / segment.length));
            time = grid.time(self.samples.len());
        }
        if pulses {
            self.pulse.process_step(segment);
        }
    }
}
