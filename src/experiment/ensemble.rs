//! Many chains at once, on all processors: each runs by itself, so that a result is the same to the
//! last bit however many threads there are.

use std::borrow::Borrow;

use super::auto_effects::resolve_auto_effects;
use super::bench::{Bench, Grid};
use super::parallel::{in_parallel, processors};
use super::pulse::PulseRecorder;
use super::{Integration, method_choice};
use crate::chain::{Chain, ForceProbe};
use crate::motion::kernel::InstructionSet;
use crate::motion::{IntegrateError, Method, Work};
use crate::scene::{PlacedSensor, Scene, Site};

/// One chain and what is to be read from it.
#[derive(Debug, Clone)]
pub struct Case {
    /// The chain.
    pub chain: Chain,
    /// Initial velocities of its bodies (m/s).
    pub velocities: Vec<f64>,
    /// Where forces are watched.
    pub probes: Vec<ForceProbe>,
    /// How long (s).
    pub duration: f64,
}

/// Result of a case.
#[derive(Debug, Clone)]
pub struct Readout {
    /// Readings of each probe.
    pub pulses: Vec<PulseRecorder>,
    /// Its cost.
    pub work: Work,
}

/// How many chains are run at once.
#[derive(Debug, Clone, Copy)]
pub struct Ensemble {
    integration: Integration,
    threads: usize,
    set: InstructionSet,
}

impl Ensemble {
    /// All processors, to `accuracy`: relative error of first-peak forces and times (1).
    pub fn new(accuracy: f64) -> Self {
        Self::by(Integration::Accuracy(accuracy))
    }

    /// All processors, each case integrated by `integration`.
    pub fn by(integration: Integration) -> Self {
        Self { integration, threads: processors(), set: InstructionSet::best() }
    }

    /// With this many threads.
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// With these instructions.
    pub fn instructions(self, set: InstructionSet) -> Self {
        Self { set, ..self }
    }

    /// Runs all `cases`; results are in their order. `done` is called with how many more are
    /// finished, from any thread.
    pub fn run<C: Borrow<Case>>(
        &self,
        cases: &[C],
        done: &(dyn Fn(usize) + Sync),
    ) -> Vec<Result<Readout, IntegrateError>> {
        let cases: Vec<&Case> = cases.iter().map(Borrow::borrow).collect();
        let run = |case: &&Case| {
            let found = case.run(self.integration, self.set);
            done(1);
            found
        };
        in_parallel(self.threads, &cases, &run, &|_| ())
    }
}

/// A place of a scene that is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbeSite {
    /// The sensor's name, or `wall`.
    pub name: String,
    /// The particle, counted from 1; none for the wall.
    pub particle: Option<usize>,
    /// Offset of the plate in particle lengths (1).
    pub offset: f64,
}

/// The places of `scene` where forces can be watched: its sensors in particles, from the top, and
/// the wall.
pub fn places(scene: &Scene) -> Vec<ProbeSite> {
    let sensor = |sensor: &PlacedSensor| match sensor.site {
        Site::Particle(particle) => {
            let (name, offset) = (sensor.name.clone(), sensor.offset);
            Some(ProbeSite { name, particle: Some(particle), offset })
        }
        Site::Wall => None,
    };
    let wall = scene.chain.wall_contact();
    let wall = wall.map(|_| ProbeSite { name: "wall".to_owned(), particle: None, offset: 0.0 });
    scene.sensors.iter().filter_map(sensor).chain(wall).collect()
}

impl Case {
    /// `scene`, its first shot, to `accuracy` (1), with the forces at `places` watched.
    pub fn of(scene: &Scene, accuracy: f64, places: &[ProbeSite]) -> Self {
        let settled = resolve_auto_effects(scene, Integration::Accuracy(accuracy));
        let chain = settled.chain.clone();
        let probe = |place: &ProbeSite| match place.particle {
            Some(particle) => ForceProbe::inside(&chain, particle, place.offset),
            None => chain.wall_contact().and_then(|j| ForceProbe::contact(&chain, j)),
        };
        let probes = places.iter().filter_map(probe).collect();
        Self { probes, velocities: settled.velocities(1), duration: settled.duration, chain }
    }

    fn method(&self, integration: Integration) -> Method {
        match integration {
            Integration::Accuracy(accuracy) => {
                method_choice::method_for(&self.chain, &self.velocities, accuracy)
            }
            Integration::Method(method) => method,
        }
    }

    /// Runs it with the instructions of `set`.
    ///
    /// # Errors
    /// [`IntegrateError`] where the integrator cannot go on.
    pub fn run(
        &self,
        integration: Integration,
        set: InstructionSet,
    ) -> Result<Readout, IntegrateError> {
        let method = self.method(integration);
        let mut bench = Bench::with_instructions(
            set,
            &self.chain,
            &self.velocities,
            method,
            &self.probes,
            Grid::NEVER,
            Grid::NEVER,
        );
        bench.run_until(self.duration, true, &mut |_| ())?;
        let work = bench.work();
        let pulses =
            bench.into_watches().into_iter().map(|mut watch| watch.pulse.readings()).collect();
        Ok(Readout { pulses, work })
    }
}
