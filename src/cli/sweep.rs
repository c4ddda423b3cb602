//! `hertzscope sweep`: thousands of runs of a scene with other values.

use std::collections::HashSet;
use std::num::NonZero;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use anyhow::{Context as _, bail};
use clap::Args;

use super::accuracy::accuracy;
use super::gather::gathered;
use super::output::is_captured;
use super::overwrite::OverwriteArguments;
use super::picture::PictureArguments;
use super::progress::JobProgress;
use crate::experiment::parallel::processors;
use crate::motion::kernel::InstructionSet;
use crate::report::{self, SweepAxes};
use crate::sweep::SweepError;
use crate::sweep::gather::GatheredLogs;
use crate::sweep::log::{Scan, SweepLog, logs, scan};
use crate::sweep::plan::SweepPlan;
use crate::sweep::shard::Shard;
use crate::sweep::summary::SweepSummary;
use crate::sweep::work::{SweepOptions, work};
use crate::table;

/// Run a scene with thousands of parameter values: grid, random or Latin hypercube; an interrupted
/// sweep resumes
#[derive(Debug, Args)]
pub struct Arguments {
    /// The sweep (TOML): a scene and the values to run it with; `hertzscope help grid` shows one
    grid: PathBuf,
    /// Table to write when all runs are finished, .csv, .jsonl or .parquet; may be repeated
    /// [default: GRID.csv]
    #[arg(short, long, value_name = "FILE")]
    output: Vec<PathBuf>,
    #[command(flatten)]
    overwrite: OverwriteArguments,
    /// Folder of the logs of finished runs [default: GRID.sweep]
    #[arg(long, value_name = "DIR")]
    folder: Option<PathBuf>,
    /// Run only part K of N, 1/N to N/N; `hertzscope gather` joins them
    /// [default: from a Slurm array's task, else all]
    #[arg(long, value_name = "K/N")]
    shard: Option<String>,
    /// Number of threads [default: one for each processor]
    #[arg(long, value_name = "N")]
    threads: Option<NonZero<usize>>,
    /// Relative error allowed in first-peak forces and times, e.g. 1e-3
    /// [default: the sweep's, else each scene's]
    #[arg(long, value_name = "X", value_parser = accuracy)]
    accuracy: Option<f64>,
    /// Instruction set, avx512, avx2 or portable: with one for all, different machines give
    /// identical results [default: the best]
    #[arg(long, value_name = "SET")]
    instructions: Option<String>,
    #[command(flatten)]
    picture: PictureArguments,
    /// Column of the picture's ordinate, e.g. `p14.half_rise` [default: the first .peak]
    #[arg(long, value_name = "COLUMN", requires = "plot")]
    y: Option<String>,
    /// Column of its abscissa [default: the first varied one]; the others give its lines
    #[arg(long, value_name = "COLUMN", requires = "plot")]
    x: Option<String>,
    /// Print what was done as JSON
    #[arg(long)]
    json: bool,
    /// Print only errors
    #[arg(short, long)]
    quiet: bool,
}

impl Arguments {
    /// Columns of the picture, if one is wanted; refused before the runs.
    fn axes(&self, plan: &SweepPlan, shard: Shard) -> anyhow::Result<Option<SweepAxes>> {
        if !self.picture.is_wanted() {
            return Ok(None);
        }
        if !shard.is_whole() {
            bail!("found --plot with {shard}, expected it with all runs");
        }
        Ok(Some(SweepAxes::of(plan.columns(), (self.x.as_deref(), self.y.as_deref()))?))
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let shard = match &arguments.shard {
        Some(text) => Shard::parse(text)?,
        None => Shard::of_slurm(&|name| std::env::var(name).ok())?.unwrap_or(Shard::WHOLE),
    };
    let tables = match arguments.output.as_slice() {
        [] => vec![arguments.grid.with_extension("csv")],
        named => named.to_vec(),
    };
    tables.iter().try_for_each(|file| table::check(file))?;
    let plan = SweepPlan::load(&arguments.grid, arguments.accuracy)?;
    if shard.is_whole() && arguments.output.is_empty() && !arguments.overwrite.is_forced() {
        tables.iter().try_for_each(|file| table::check_own(file, plan.columns()))?;
    }
    arguments.picture.check(arguments.overwrite)?;
    let axes = arguments.axes(&plan, shard)?;
    let folder = arguments.folder.clone();
    let folder = folder.unwrap_or_else(|| arguments.grid.with_extension("sweep"));
    std::fs::create_dir_all(&folder).with_context(|| folder.display().to_string())?;
    let path = folder.join(shard.log());
    let chosen = arguments.instructions.as_deref().map(instructions).transpose()?;
    let chosen = chosen.map(InstructionSet::name);
    let best = InstructionSet::best().name();
    let (mut log, held, notices) = SweepLog::open(&path, &plan, (chosen, best))?;
    for notice in &notices {
        super::say(&format!("note: {notice}"));
    }
    let job = SweepOptions {
        file: arguments.grid.clone(),
        accuracy: arguments.accuracy,
        instructions: instructions(&held.header.instructions)?,
        threads: arguments.threads.map_or_else(processors, NonZero::get),
    };
    let mut finished = finished_elsewhere(&folder, &held)?;
    finished.extend(held.finished());
    let of_shard = (0..plan.count()).filter(|run| shard.has(*run)).count() as u64;
    let mine = (0..plan.count()).filter(|run| shard.has(*run));
    let pending: Vec<u64> = mine.filter(|run| !finished.contains(run)).collect();
    let started = Instant::now();
    let before = of_shard - pending.len() as u64;
    let progress = SharedProgress::new(&shown(&plan, shard), (before, of_shard), arguments.quiet);
    progress.tell_when_interrupted(path.display().to_string());
    let tally = work(&job, &plan, &pending, &mut log, &|more| progress.more(more));
    progress.done();
    let tally = tally?;
    let mut summary = SweepSummary {
        sweep: arguments.grid.display().to_string(),
        scene: plan.scene_name().to_owned(),
        runs: plan.count(),
        shard: (!shard.is_whole()).then(|| shard.to_string()),
        of_shard,
        finished_before: before,
        done: tally.done,
        wall_s: started.elapsed().as_secs_f64(),
        threads: job.threads,
        instructions: job.instructions.name().to_owned(),
        accuracy: plan.accuracy(),
        failed: tally.failed,
        first_failed: tally.failure(),
        log: path.display().to_string(),
        gathered: None,
    };
    if shard.is_whole() {
        let logs = GatheredLogs::read(&folder)?;
        if let Some(axes) = axes {
            let results = logs.table()?;
            let title = format!("{}: {}", summary.sweep, summary.scene);
            arguments.picture.save(&summary, || report::sweep_picture(&results, axes, &title))?;
        }
        summary.gathered = Some(gathered(&folder, logs, &tables, arguments.quiet)?);
    }
    if arguments.json || !arguments.quiet {
        super::show(&summary, arguments.json, report::sweep)?;
    }
    Ok(())
}

/// The instruction set of this name.
fn instructions(name: &str) -> Result<InstructionSet, SweepError> {
    let all = InstructionSet::available();
    let found = all.iter().find(|set| set.name().eq_ignore_ascii_case(name));
    let known = || all.iter().map(|set| set.name()).collect();
    found
        .copied()
        .ok_or_else(|| SweepError::Instructions { wanted: name.to_owned(), known: known() })
}

/// Runs that the folder's other logs hold; they are not repeated.
fn finished_elsewhere(folder: &Path, own: &Scan) -> Result<HashSet<u64>, SweepError> {
    let mut finished = HashSet::new();
    for file in logs(folder)?.into_iter().filter(|file| *file != own.file) {
        if let Some(scan) = scan(&file)? {
            if scan.header.sweep != own.header.sweep {
                return Err(SweepError::OtherSweep { file: file.display().to_string() });
            }
            finished.extend(scan.finished());
        }
    }
    Ok(finished)
}

fn shown(plan: &SweepPlan, shard: Shard) -> String {
    if shard.is_whole() { plan.scene_name().to_owned() } else { shard.to_string() }
}

/// A progress bar that threads share.
struct SharedProgress {
    bar: Mutex<JobProgress>,
    done: Arc<AtomicU64>,
    all: u64,
}

impl SharedProgress {
    /// A bar over `all` runs, of which some were done `before`.
    fn new(what: &str, (before, all): (u64, u64), quiet: bool) -> Self {
        let bar = JobProgress::resumed(what, quiet, before as f64 / all as f64);
        Self { bar: Mutex::new(bar), done: Arc::new(AtomicU64::new(before)), all }
    }

    /// Has Ctrl-C end the program with a sentence on what is kept. Runs are in the `log` before
    /// they count as done.
    fn tell_when_interrupted(&self, log: String) {
        // Within another program, signals are that program's.
        if is_captured() {
            return;
        }
        #[cfg(unix)]
        if let Ok(mut signals) = signal_hook::iterator::Signals::new([
            signal_hook::consts::SIGINT,
            signal_hook::consts::SIGTERM,
        ]) {
            let (done, all) = (self.done.clone(), self.all);
            std::thread::spawn(move || {
                let Some(signal) = signals.forever().next() else { return };
                let done = done.load(Ordering::Relaxed);
                super::say(&format!(
                    "\nstopped: {done} of {all} runs are kept in {log}; the same command goes on from there"
                ));
                std::process::exit(128 + signal);
            });
        }
    }

    fn more(&self, more: u64) {
        let done = self.done.fetch_add(more, Ordering::Relaxed) + more;
        let mut bar = self.bar.lock().unwrap_or_else(PoisonError::into_inner);
        bar.at(done as f64 / self.all as f64);
    }

    fn done(self) {
        if let Ok(bar) = self.bar.into_inner() {
            bar.done();
        }
    }
}
