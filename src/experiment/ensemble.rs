//! Many chains at once: eight side by side in the lanes of the machine's registers, groups of eight on all its processors.
//!
//! Every chain has steps and error control of its own, so that a result is the same to the last bit however many threads there are
//! and whatever else runs. Chains with losses run one by one.

use std::num::NonZero;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::bench::{Bench, Grid};
use super::losses;
use super::pulse::PulseRecorder;
use crate::chain::stepper::{ChainGroup, InstructionSet, Member, View};
use crate::chain::{Chain, ForceProbe};
use crate::integrate::{IntegrateError, Work};

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

/// How many chains are run at once.
#[derive(Debug, Clone, Copy)]
pub struct Ensemble {
    accuracy: f64,
    threads: usize,
    set: InstructionSet,
}

impl Ensemble {
    /// All processors, to `accuracy`: relative error of first-peak forces and times (1).
    #[must_use]
    pub fn new(accuracy: f64) -> Self {
        let threads = std::thread::available_parallelism().map_or(1, NonZero::get);
        Self { accuracy, threads, set: InstructionSet::best() }
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
    pub fn run(
        &self,
        cases: &[Case],
        done: &(dyn Fn(usize) + Sync),
    ) -> Vec<Result<Readout, IntegrateError>> {
        let groups = self.groups(cases);
        let next = AtomicUsize::new(0);
        let results = Mutex::new(vec![None; cases.len()]);
        let work = || {
            while let Some(group) = groups.get(next.fetch_add(1, Ordering::Relaxed)) {
                let found = self.run_group(cases, group);
                if let Ok(mut results) = results.lock() {
                    for (index, result) in group.iter().zip(found) {
                        results[*index] = Some(result);
                    }
                }
                done(group.len());
            }
        };
        std::thread::scope(|scope| {
            for _ in 1..self.threads.min(groups.len()) {
                scope.spawn(work);
            }
            work();
        });
        // Every case is in a group, and a thread that panics takes the scope with it.
        results.into_inner().unwrap_or_default().into_iter().flatten().collect()
    }

    /// Cases that run side by side: neighbours that fit each other, so that groups do not depend on what comes later.
    fn groups(&self, cases: &[Case]) -> Vec<Vec<usize>> {
        let mut groups: Vec<Vec<usize>> = Vec::new();
        let member = |index: usize| cases[index].member();
        for index in 0..cases.len() {
            let fits = |group: &Vec<usize>| {
                let Some(first) = group.first() else { return false };
                let plain = [*first, index].map(|i| cases[i].chain.is_plain());
                group.len() < ChainGroup::LANES
                    && plain == [true; 2]
                    && ChainGroup::fit(&member(*first), &member(index), self.accuracy)
            };
            match groups.last_mut().filter(|group| fits(group)) {
                Some(group) => group.push(index),
                None => groups.push(vec![index]),
            }
        }
        groups
    }

    fn run_group(&self, cases: &[Case], group: &[usize]) -> Vec<Result<Readout, IntegrateError>> {
        let members: Vec<&Case> = group.iter().filter_map(|index| cases.get(*index)).collect();
        let method = members
            .first()
            .map(|case| losses::method_for(&case.chain, &case.velocities, self.accuracy));
        match method.and_then(|method| method.nystrom()) {
            Some((pair, tolerance)) if members.len() > 1 => {
                let all: Vec<Member<'_>> = members.iter().map(|case| case.member()).collect();
                follow(ChainGroup::new(&all, pair, tolerance, self.set), &members)
            }
            _ => members.iter().map(|case| case.run_alone(self.accuracy)).collect(),
        }
    }
}

impl Case {
    fn member(&self) -> Member<'_> {
        Member { chain: &self.chain, velocities: &self.velocities, duration: self.duration }
    }

    fn run_alone(&self, accuracy: f64) -> Result<Readout, IntegrateError> {
        let never = Grid { start: f64::MAX, interval: 1.0 };
        let method = losses::method_for(&self.chain, &self.velocities, accuracy);
        let grids = (never, never);
        let mut bench = Bench::new(&self.chain, &self.velocities, method, &self.probes, grids);
        bench.run_until(self.duration, true, &mut |_| ())?;
        let pulses = bench.watches().iter().map(|watch| watch.pulse.clone()).collect();
        Ok(Readout { pulses, work: bench.work() })
    }
}

/// Moves a group to its end and reads its forces.
fn follow(mut group: ChainGroup, cases: &[&Case]) -> Vec<Result<Readout, IntegrateError>> {
    let views = |case: &&Case| case.probes.iter().map(View::new).collect();
    let mut views: Vec<Vec<View>> = cases.iter().map(views).collect();
    let recorders = |case: &&Case| case.probes.iter().cloned().map(PulseRecorder::new).collect();
    let mut pulses: Vec<Vec<PulseRecorder>> = cases.iter().map(recorders).collect();
    while !group.is_done() {
        let taken = group.step();
        group.look(&mut views, taken);
        for ((views, pulses), taken) in views.iter_mut().zip(&mut pulses).zip(taken) {
            for (view, pulse) in views.iter_mut().zip(pulses).filter(|_| taken) {
                pulse.meet(view);
            }
        }
    }
    let outcomes = pulses.into_iter().enumerate();
    outcomes.map(|(i, pulses)| Ok(Readout { pulses, work: group.outcome(i)? })).collect()
}
