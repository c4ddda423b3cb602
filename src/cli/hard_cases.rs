//! `hertzscope hard-cases`: what breaks integrators, and what becomes of it here.

use clap::Args;

use super::progress::JobProgress;
use crate::report;
use crate::studies::hard_cases::{CaseVerdict, run_all};

/// Compute the catalogue of hard cases: each right within its bound, or refused; exit code 1 if one is wrong
#[derive(Debug, Args)]
pub struct Arguments {
    /// Add what makes each case hard, its bound and its tightest figure
    #[arg(long)]
    why: bool,
    /// Print the catalogue as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

/// Whether no case is wrong.
pub fn run(arguments: &Arguments) -> anyhow::Result<bool> {
    let mut progress = JobProgress::new("hard cases", arguments.quiet);
    let findings = run_all(&mut |share| progress.at(share));
    progress.done();
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&findings)?)?;
    } else {
        super::print(&report::hard_cases(&findings, arguments.why))?;
    }
    Ok(findings.iter().all(|finding| finding.verdict != CaseVerdict::Wrong))
}
