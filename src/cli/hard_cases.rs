//! `hertzscope hard-cases`: what breaks integrators, and what becomes of it here.

use clap::Args;

use super::picture::PlotArguments;
use super::progress::JobProgress;
use crate::report;
use crate::studies::hard_cases::{CaseVerdict, run_all};

/// Run cases that are hard to integrate: each must meet its error bound or be refused; exit code 1
/// if one fails
#[derive(Debug, Args)]
pub struct Arguments {
    /// Add what makes each case hard, its error bound and the result closest to the bound
    #[arg(long)]
    why: bool,
    #[command(flatten)]
    plot: PlotArguments,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let mut progress = JobProgress::new("hard cases", arguments.quiet);
    let findings = run_all(&mut |share| progress.at(share));
    progress.done();
    arguments.plot.save(&findings, || report::hard_cases_picture(&findings))?;
    super::show(&findings, arguments.json, |found| report::hard_cases(found, arguments.why))?;
    let is_wrong = findings.iter().any(|finding| finding.verdict == CaseVerdict::Wrong);
    if is_wrong { Err(super::AnswerIsNo.into()) } else { Ok(()) }
}
