//! Runs a shard of a sweep on several threads, block by block, and keeps every finished run.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Mutex;
use std::time::{Duration, Instant};

use super::SweepError;
use super::log::SweepLog;
use super::plan::{PreparedRun, SweepPlan};
use crate::experiment::ensemble::{Case, Ensemble, Readout};
use crate::motion::IntegrateError;
use crate::motion::kernel::InstructionSet;
use crate::scene::grid::PlannedRun;

/// Runs of a thread's first block: one group of lanes.
const FIRST_BLOCK: usize = 8;
/// Most runs of a block.
const MAX_BLOCK: usize = 1024;
/// A block grows until it takes this long: a process that is killed loses no more than that, and
/// writing costs nothing beside it.
const BLOCK_TIME: Duration = Duration::from_millis(100);

/// How a sweep is run.
#[derive(Debug, Clone)]
pub struct SweepOptions {
    /// The sweep's file.
    pub file: PathBuf,
    /// Another accuracy than its own (1).
    pub accuracy: Option<f64>,
    /// Instructions of all runs.
    pub instructions: InstructionSet,
    /// Threads that run blocks.
    pub threads: usize,
}

/// Counts of finished runs.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct RunCounts {
    /// Runs that have a line now.
    pub done: u64,
    /// Those of them that have no results.
    pub failed: u64,
    /// The first of these, with the reason.
    pub first_failed: Option<(u64, String)>,
}

/// Runs those `pending` of `plan`, which is that of `job`, and adds each to `log` as soon as its
/// block is finished; `done` is called with how many more are.
///
/// # Errors
/// [`SweepError`] where the log cannot be written, or where the sweep's files have changed.
pub fn work(
    job: &SweepOptions,
    plan: &SweepPlan,
    pending: &[u64],
    log: &mut SweepLog,
    done: &(dyn Fn(u64) + Sync),
) -> Result<RunCounts, SweepError> {
    let shared = Shared {
        job,
        done,
        rest: Mutex::new(pending),
        written: Mutex::new((log, RunCounts::default())),
        failed: Mutex::new(None),
    };
    // Trees of scenes stay in the thread that made them, so every further thread reads the sweep
    // itself.
    let hash = plan.hash();
    let further = || match SweepPlan::load(&job.file, job.accuracy) {
        Ok(plan) if plan.hash() == hash => shared.work(&plan),
        Ok(_) => shared.fail(SweepError::OtherSweep { file: job.file.display().to_string() }),
        Err(error) => shared.fail(error),
    };
    std::thread::scope(|scope| {
        for _ in 1..job.threads.min(pending.len()) {
            scope.spawn(further);
        }
        shared.work(plan);
    });
    if let Some(error) = shared.failed.into_inner().unwrap_or_default() {
        return Err(error);
    }
    // A thread that panics takes the scope with it.
    let tally =
        shared.written.into_inner().map_or_else(|_| RunCounts::default(), |(_, tally)| tally);
    log.finish()?;
    Ok(tally)
}

struct Shared<'a> {
    job: &'a SweepOptions,
    done: &'a (dyn Fn(u64) + Sync),
    /// Runs that no thread has taken yet.
    rest: Mutex<&'a [u64]>,
    written: Mutex<(&'a mut SweepLog, RunCounts)>,
    failed: Mutex<Option<SweepError>>,
}

impl Shared<'_> {
    fn work(&self, plan: &SweepPlan) {
        let mut size = FIRST_BLOCK;
        while let Some(block) = self.take(size) {
            let started = Instant::now();
            let lines = run_block(plan, self.job.instructions, block);
            if started.elapsed() < BLOCK_TIME {
                size = (2 * size).min(MAX_BLOCK);
            }
            if let Err(error) = self.keep(lines) {
                self.fail(error);
            }
            (self.done)(block.len() as u64);
        }
    }

    fn take(&self, size: usize) -> Option<&[u64]> {
        let mut rest = self.rest.lock().ok()?;
        let (block, others) = rest.split_at(size.min(rest.len()));
        *rest = others;
        (!block.is_empty()).then_some(block)
    }

    fn keep(&self, lines: Vec<Line>) -> Result<(), SweepError> {
        let Ok(mut written) = self.written.lock() else { return Ok(()) };
        let (log, tally) = &mut *written;
        let (texts, failures): (Vec<String>, Vec<Option<(u64, String)>>) =
            lines.into_iter().map(|line| (line.text, line.failure)).unzip();
        log.append(&texts)?;
        tally.done += texts.len() as u64;
        for failure in failures.into_iter().flatten() {
            tally.failed += 1;
            if tally.first_failed.as_ref().is_none_or(|(run, _)| failure.0 < *run) {
                tally.first_failed = Some(failure);
            }
        }
        Ok(())
    }

    /// Keeps the first error, and leaves the others nothing to do.
    fn fail(&self, error: SweepError) {
        if let Ok(mut failed) = self.failed.lock() {
            failed.get_or_insert(error);
        }
        if let Ok(mut rest) = self.rest.lock() {
            *rest = &[];
        }
    }
}

/// A run's results.
struct Line {
    text: String,
    failure: Option<(u64, String)>,
}

/// Runs `block` of `plan` in one thread.
fn run_block(plan: &SweepPlan, instructions: InstructionSet, block: &[u64]) -> Vec<Line> {
    let runs: Vec<(u64, PlannedRun)> =
        block.iter().map(|index| (*index, plan.run(*index))).collect();
    let prepared: Vec<Result<PreparedRun, String>> =
        runs.iter().map(|(_, run)| plan.prepare(run)).collect();
    let mut by_accuracy: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (place, prepared) in prepared.iter().enumerate() {
        if let Ok(prepared) = prepared {
            by_accuracy.entry(prepared.accuracy.to_bits()).or_default().push(place);
        }
    }
    let mut readouts: Vec<_> = (0..block.len()).map(|_| None).collect();
    for (accuracy, members) in by_accuracy {
        let ensemble = Ensemble::new(f64::from_bits(accuracy)).threads(1);
        let case = |place: &usize| prepared[*place].as_ref().ok().map(|p| &p.case);
        let cases: Vec<&Case> = members.iter().filter_map(case).collect();
        let found = ensemble.instructions(instructions).run(&cases, &|_| ());
        for (place, found) in members.into_iter().zip(found) {
            readouts[place] = Some(found);
        }
    }
    let all = runs.iter().zip(prepared).zip(readouts);
    all.map(|((run, prepared), readout)| line(plan, run, &prepared, readout)).collect()
}

/// The line of a run that was prepared and read out, as far as it could be.
fn line(
    plan: &SweepPlan,
    (index, run): &(u64, PlannedRun),
    prepared: &Result<PreparedRun, String>,
    readout: Option<Result<Readout, IntegrateError>>,
) -> Line {
    let found = match (prepared, readout) {
        (Ok(prepared), Some(Ok(readout))) => Ok((prepared, readout)),
        (Err(reason), _) => Err(reason.clone()),
        (_, Some(Err(error))) => Err(error.to_string()),
        (_, None) => Err("not run".to_owned()),
    };
    let shown = found.as_ref().map(|(prepared, readout)| (*prepared, readout));
    let text = plan.line((*index, run), shown.map_err(String::as_str));
    Line { text, failure: found.err().map(|reason| (*index, reason)) }
}
