//! Summaries of a sweep and of a gathering, as in `--json`: names are part of the interface.

use serde::Serialize;

use super::gather::Gap;
use super::work::RunCounts;

/// A run without results.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Failure {
    /// Its number.
    pub run: u64,
    /// Why it has none.
    pub reason: String,
}

/// Summary of a sweep, or of a shard of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SweepSummary {
    /// The sweep's file.
    pub sweep: String,
    /// The scene that is varied.
    pub scene: String,
    /// Runs of the whole sweep.
    pub runs: u64,
    /// The shard, `shard 3 of 7`; none for the whole.
    pub shard: Option<String>,
    /// Runs of the shard.
    pub of_shard: u64,
    /// Those of them that were finished before.
    pub finished_before: u64,
    /// Those that were done now.
    pub done: u64,
    /// How long that took (s).
    pub wall_s: f64,
    /// Threads.
    pub threads: usize,
    /// Instructions that runs are made with.
    pub instructions: String,
    /// Accuracy of all runs; none where each scene says (1).
    pub accuracy: Option<f64>,
    /// Of those done now, runs without results.
    pub failed: u64,
    /// The first of them.
    pub first_failed: Option<Failure>,
    /// The shard's log.
    pub log: String,
    /// Summary of all logs, where the sweep was run as a whole.
    pub gathered: Option<GatherSummary>,
}

/// Summary of a sweep's joined logs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GatherSummary {
    /// Folder of the logs.
    pub folder: String,
    /// How many logs.
    pub logs: usize,
    /// Runs of the whole sweep.
    pub runs: u64,
    /// Runs that are finished.
    pub finished: u64,
    /// Runs that are missing.
    pub missing: Vec<Gap>,
    /// Finished runs without results.
    pub failed: u64,
    /// The first of them.
    pub first_failed: Option<Failure>,
    /// Tables that were written.
    pub tables: Vec<String>,
    /// Notes for the user.
    pub notices: Vec<String>,
}

impl RunCounts {
    /// The first run without results.
    pub fn failure(&self) -> Option<Failure> {
        self.first_failed.clone().map(|(run, reason)| Failure { run, reason })
    }
}
