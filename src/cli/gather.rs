//! `hertzscope gather`: the logs of a sweep's shards into one table.

use std::path::{Path, PathBuf};

use clap::Args;

use super::AnswerIsNo;
use super::overwrite::OverwriteArguments;
use super::progress::JobProgress;
use crate::report;
use crate::sweep::SweepError;
use crate::sweep::gather::GatheredLogs;
use crate::sweep::summary::GatherSummary;
use crate::table;

/// Join the logs of a sweep's parts into one table and list missing runs; exit code 1 if there are
/// any
#[derive(Debug, Args)]
pub struct Arguments {
    /// Folder of the logs, GRID.sweep
    folder: PathBuf,
    /// Table to write, .csv, .jsonl or .parquet; may be repeated
    /// [default: GRID.csv beside the folder]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    overwrite: OverwriteArguments,
    /// Print what was found as JSON
    #[arg(long)]
    json: bool,
    /// Print only errors; the exit code says whether runs are missing
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    // `.` has no name that the table could have.
    let named = arguments.folder.file_name().is_some();
    let whole = if named { None } else { arguments.folder.canonicalize().ok() };
    let tables = match arguments.output.as_slice() {
        [] => vec![whole.as_ref().unwrap_or(&arguments.folder).with_extension("csv")],
        named => named.to_vec(),
    };
    tables.iter().try_for_each(|file| table::check(file))?;
    let logs = GatheredLogs::read(&arguments.folder)?;
    if arguments.output.is_empty() && !arguments.overwrite.is_forced() {
        tables.iter().try_for_each(|file| table::check_own(file, logs.columns()))?;
    }
    let found = gathered(&arguments.folder, logs, &tables, arguments.quiet)?;
    if arguments.json || !arguments.quiet {
        super::show(&found, arguments.json, report::gathering)?;
    }
    if found.missing.is_empty() { Ok(()) } else { Err(AnswerIsNo.into()) }
}

/// Joins the logs in `folder` into `tables`; prints notes on standard error.
pub fn gathered(
    folder: &Path,
    found: GatheredLogs,
    tables: &[PathBuf],
    quiet: bool,
) -> Result<GatherSummary, SweepError> {
    for notice in &found.notices {
        super::say(&format!("note: {notice}"));
    }
    let mut progress = JobProgress::new("table", quiet);
    let tally = found.write(tables, &mut |share| progress.at(share));
    progress.done();
    let tally = tally?;
    Ok(GatherSummary {
        folder: folder.display().to_string(),
        logs: found.files().len(),
        runs: found.runs(),
        finished: tally.done,
        missing: found.missing(),
        failed: tally.failed,
        first_failed: tally.failure(),
        tables: tables.iter().map(|table| table.display().to_string()).collect(),
        notices: found.notices,
    })
}
