//! Many chains at once: eight side by side in the lanes of the machine's registers, groups of eight on all its processors.
//!
//! Under error control every chain has steps of its own, in fixed steps those of one duration go in step. One alone runs in a lane as well, so
//! that a result is the same to the last bit however many threads there are and whatever else runs. Chains with losses run one by one.

use std::borrow::Borrow;

use super::auto_effects::settle;
use super::bench::{Bench, Grid};
use super::parallel::{in_parallel, processors};
use super::pulse::PulseRecorder;
use super::{Integration, losses};
use crate::chain::stepper::{ChainGroup, GroupTrail, InstructionSet, Kind, Member};
use crate::chain::{Chain, ForceProbe};
use crate::integrate::{IntegrateError, Method, Scheme, Work};
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

/// What came of a case.
#[derive(Debug, Clone)]
pub struct Readout {
    /// What each probe felt.
    pub pulses: Vec<PulseRecorder>,
    /// What it cost.
    pub work: Work,
}

/// Where a thread runs its groups, one after the other, so that each finds its memory where the one before has left it, next to the processor.
#[derive(Default)]
struct Room {
    group: Option<ChainGroup>,
    trail: GroupTrail,
    pulses: Vec<Vec<PulseRecorder>>,
}

/// What the chains of a group have in common.
type Sort = (Scheme, Kind);

/// Cases that a thread sorts at a time: so many that handing them out costs nothing.
const BLOCK: usize = 64;

/// How many chains are run at once.
#[derive(Debug, Clone, Copy)]
pub struct Ensemble {
    integration: Integration,
    threads: usize,
    set: InstructionSet,
}

impl Ensemble {
    /// All processors, to `accuracy`: relative error of first-peak forces and times (1).
    #[must_use]
    pub fn new(accuracy: f64) -> Self {
        Self::by(Integration::Accuracy(accuracy))
    }

    /// All processors, each case integrated by `integration`.
    #[must_use]
    pub fn by(integration: Integration) -> Self {
        Self { integration, threads: processors(), set: InstructionSet::best() }
    }

    /// With this many threads.
    #[must_use]
    pub fn threads(self, threads: usize) -> Self {
        Self { threads: threads.max(1), ..self }
    }

    /// With these instructions.
    #[must_use]
    pub fn instructions(self, set: InstructionSet) -> Self {
        Self { set, ..self }
    }

    /// Runs all `cases`; results stand in their order. `done` hears how many more are finished, from any thread.
    pub fn run<C: Borrow<Case>>(
        &self,
        cases: &[C],
        done: &(dyn Fn(usize) + Sync),
    ) -> Vec<Result<Readout, IntegrateError>> {
        let cases: Vec<&Case> = cases.iter().map(Borrow::borrow).collect();
        let blocks: Vec<&[&Case]> = cases.chunks(BLOCK).collect();
        let sort = |(): &mut (), block: &&[&Case]| -> Vec<Option<Sort>> {
            block.iter().map(|case| case.sort(self.integration)).collect()
        };
        let sorts = in_parallel(self.threads, &blocks, &sort, &|_| ()).concat();
        let groups = groups(&sorts);
        let run = |room: &mut Room, group: &Vec<usize>| {
            let found = self.run_group(room, &cases, group);
            done(group.len());
            found
        };
        let found = in_parallel(self.threads, &groups, &run, &|_| ());
        let mut results: Vec<_> =
            groups.iter().flatten().zip(found.into_iter().flatten()).collect();
        results.sort_by_key(|(index, _)| **index);
        results.into_iter().map(|(_, result)| result).collect()
    }

    fn run_group(
        &self,
        room: &mut Room,
        cases: &[&Case],
        group: &[usize],
    ) -> Vec<Result<Readout, IntegrateError>> {
        let members: Vec<&Case> = group.iter().map(|index| cases[*index]).collect();
        let first = members.first().filter(|case| case.chain.is_plain());
        match first.and_then(|case| case.method(self.integration).scheme()) {
            Some(scheme) => {
                let all: Vec<Member<'_>> = members.iter().map(|case| case.member()).collect();
                let group = match room.group.take() {
                    Some(group) => group.again(&all, scheme),
                    None => ChainGroup::new(&all, scheme, self.set),
                };
                let found = room.follow(group, &members);
                // Steps are taken several at once: alone it is found which body was lost first, and when.
                let alone = |case: &Case| case.run_alone(self.integration).err();
                let exact = |(case, failed)| alone(case).unwrap_or(failed);
                let found = members.iter().zip(found);
                found.map(|(case, found)| found.map_err(|failed| exact((case, failed)))).collect()
            }
            None => members.iter().map(|case| case.run_alone(self.integration)).collect(),
        }
    }
}

/// Cases that run side by side: each goes to the first group with a free lane of its sort, or is alone if it is of none.
fn groups(sorts: &[Option<Sort>]) -> Vec<Vec<usize>> {
    let (mut full, mut open): (Vec<Vec<usize>>, Vec<Vec<usize>>) = (Vec::new(), Vec::new());
    for (index, sort) in sorts.iter().enumerate() {
        if sort.is_none() {
            full.push(vec![index]);
            continue;
        }
        let Some(place) = open.iter().position(|group| sorts[group[0]] == *sort) else {
            open.push(vec![index]);
            continue;
        };
        open[place].push(index);
        if open[place].len() == ChainGroup::LANES {
            full.push(open.remove(place));
        }
    }
    full.append(&mut open);
    full
}

/// A place of a scene that is watched.
#[derive(Debug, Clone, PartialEq)]
pub struct Watched {
    /// The sensor's name, or `wall`.
    pub name: String,
    /// The particle, counted from 1; none for the wall.
    pub particle: Option<usize>,
    /// Offset of the plate in particle lengths (1).
    pub offset: f64,
}

/// The places of `scene` where forces can be watched: its sensors in particles, from the top, and the wall.
#[must_use]
pub fn places(scene: &Scene) -> Vec<Watched> {
    let sensor = |sensor: &PlacedSensor| match sensor.site {
        Site::Particle(particle) => {
            let (name, offset) = (sensor.name.clone(), sensor.offset);
            Some(Watched { name, particle: Some(particle), offset })
        }
        Site::Wall => None,
    };
    let wall = scene.chain.wall_contact();
    let wall = wall.map(|_| Watched { name: "wall".to_owned(), particle: None, offset: 0.0 });
    scene.sensors.iter().filter_map(sensor).chain(wall).collect()
}

impl Case {
    /// `scene`, its first shot, to `accuracy` (1), with the forces at `places` watched.
    #[must_use]
    pub fn of(scene: &Scene, accuracy: f64, places: &[Watched]) -> Self {
        let settled = settle(scene, Integration::Accuracy(accuracy));
        let chain = settled.chain.clone();
        let probe = |place: &Watched| match place.particle {
            Some(particle) => ForceProbe::inside(&chain, particle, place.offset),
            None => chain.wall_contact().and_then(|j| ForceProbe::contact(&chain, j)),
        };
        let probes = places.iter().filter_map(probe).collect();
        Self { probes, velocities: settled.velocities(1), duration: settled.duration, chain }
    }

    /// Has `pulses` be what its probes will have felt, nothing yet.
    fn listen(&self, pulses: &mut Vec<PulseRecorder>) {
        let (impact, velocities) = (self.chain.impact_force(&self.velocities), &self.velocities);
        pulses.truncate(self.probes.len());
        for (index, probe) in self.probes.iter().enumerate() {
            match pulses.get_mut(index) {
                Some(pulse) => pulse.again(probe, impact, velocities),
                None => pulses.push(PulseRecorder::new(probe, impact, velocities)),
            }
        }
    }

    fn member(&self) -> Member<'_> {
        Member { chain: &self.chain, velocities: &self.velocities, duration: self.duration }
    }

    /// None for a chain that runs alone.
    fn sort(&self, integration: Integration) -> Option<Sort> {
        let scheme = self.method(integration).scheme().filter(|_| self.chain.is_plain())?;
        Some((scheme, Kind::of(&self.member(), scheme)))
    }

    fn method(&self, integration: Integration) -> Method {
        match integration {
            Integration::Accuracy(accuracy) => {
                losses::method_for(&self.chain, &self.velocities, accuracy)
            }
            Integration::Method(method) | Integration::Tried { method, .. } => method,
        }
    }

    /// Runs it on its own stepper: as exact as in a lane, but not the same to the last bit.
    ///
    /// # Errors
    /// [`IntegrateError`] where the integrator cannot go on.
    pub fn run_alone(&self, integration: Integration) -> Result<Readout, IntegrateError> {
        let never = Grid { start: f64::MAX, interval: 1.0 };
        let method = self.method(integration);
        let grids = (never, never);
        let mut bench = Bench::new(&self.chain, &self.velocities, method, &self.probes, grids);
        bench.run_until(self.duration, true, &mut |_| ())?;
        let pulses = bench.watches().iter().map(|watch| watch.pulse.clone()).collect();
        Ok(Readout { pulses, work: bench.work() })
    }
}

impl Room {
    /// Moves a group to its end and reads its forces.
    fn follow(
        &mut self,
        mut group: ChainGroup,
        cases: &[&Case],
    ) -> Vec<Result<Readout, IntegrateError>> {
        let Self { trail, pulses, .. } = self;
        pulses.resize_with(cases.len(), Vec::new);
        pulses.iter_mut().zip(cases).for_each(|(pulses, case)| case.listen(pulses));
        let probes: Vec<&[ForceProbe]> = cases.iter().map(|case| &*case.probes).collect();
        group.begin_trail(trail, &probes);
        for (lane, pulses) in pulses.iter().enumerate() {
            for (place, pulse) in pulses.iter().enumerate() {
                trail.begin((place, lane), pulse.felt(), pulse.asks());
            }
        }
        while !group.is_done() {
            group.follow(trail);
            if trail.is_full() || group.is_done() {
                group.read(trail, &mut |(place, lane), before, seen| {
                    let pulse = &mut pulses[lane][place];
                    [pulse.go_on(before, seen, lane), pulse.asks()]
                });
            }
        }
        let readout = |(lane, pulses): (usize, &mut Vec<PulseRecorder>)| {
            let work = group.outcome(lane)?;
            Ok(Readout { pulses: pulses.iter_mut().map(PulseRecorder::readings).collect(), work })
        };
        let found = pulses.iter_mut().enumerate().map(readout).collect();
        self.group = Some(group);
        found
    }
}
