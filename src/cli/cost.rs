//! `hertzscope cost`: what accuracy costs in time.

use std::path::{Path, PathBuf};

use anyhow::anyhow;
use clap::Args;

use super::picture::{self, PlotArguments};
use super::progress::JobProgress;
use crate::experiment::accuracy::run_to_accuracy;
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::{Integration, facts};
use crate::recording::Attachment;
use crate::recording::mcap;
use crate::report::{self, WorkMeasure};
use crate::scene::Scene;
use crate::studies::cost::{CostStudy, TIMED_RUNS, study};

/// Show what accuracy costs in time: errors and computing time of each accuracy, then of every
/// method and setting
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
    /// Also run the scene and write its recording, with the study as attachment `cost.json`
    #[arg(long, value_name = "FILE.mcap", value_parser = recording)]
    record: Option<PathBuf>,
    /// Draw errors over force evaluations instead of time
    #[arg(long)]
    evaluations: bool,
    /// Timed runs of each point
    #[arg(long, value_name = "N", default_value_t = TIMED_RUNS, value_parser = clap::value_parser!(u16).range(1..))]
    runs: u16,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    arguments.record.iter().try_for_each(|file| arguments.plot.overwrite.check(file))?;
    let scene = Scene::load(&arguments.scene)?;
    let mut progress = JobProgress::new(&scene.name, arguments.quiet);
    let found = study(&scene, arguments.runs, &mut |share| progress.at(share));
    progress.done();
    let found = found.map_err(|error| anyhow!("{}: no reference: {error}", scene.name))?;
    let work = if arguments.evaluations { WorkMeasure::Evaluations } else { WorkMeasure::Time };
    arguments.plot.save(&found, || report::work_precision_picture(&found, work))?;
    if let Some(file) = &arguments.record {
        record(file, &scene, &found)?;
    }
    if arguments.json {
        super::show(&found, true, |_| String::new())
    } else {
        super::print_as_it_is(&report::work_precision(&found, work, super::is_coloured()))
    }
}

fn recording(text: &str) -> Result<PathBuf, String> {
    let file = PathBuf::from(text);
    if file.extension().is_some_and(|ending| ending == "mcap") {
        picture::in_a_folder(file)
    } else {
        Err(format!("found {text}, expected the name of a recording, e.g. cost.mcap"))
    }
}

/// A shot at the scene's own accuracy, with the study beside it.
fn record(file: &Path, scene: &Scene, study: &CostStudy) -> anyhow::Result<()> {
    let accuracy = scene.accuracy;
    let integration = Integration::Accuracy(accuracy);
    let scene = resolve_auto_effects(scene, integration);
    let outcome = run_to_accuracy(&scene, accuracy, 1, &mut |_| ())?;
    let study = Attachment {
        name: "cost.json".to_owned(),
        media_type: "application/json".to_owned(),
        data: serde_json::to_vec_pretty(study)?,
    };
    let mut set = facts::recording(&scene, integration, [outcome])?;
    set.attachments.push(study);
    Ok(mcap::write(file, &set)?)
}
