//! `hertzscope effects`: which effects are on, what each changes, its time, and whether the scene
//! needs it.

use std::path::PathBuf;

use clap::Args;

use super::accuracy::accuracy;
use super::picture::PlotArguments;
use super::progress::JobProgress;
use crate::report;
use crate::scene::Scene;
use crate::studies::effects::ledger;

/// Show which effects a scene includes: what each changes, its computing time, and whether the
/// scene needs it
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Accuracy of the runs that are compared, 1e-11 to 0.1 [default: the scene's, else 1e-6]
    #[arg(long, value_name = "X", value_parser = accuracy, allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// Add the criterion by which each effect is on or off
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
    let scene = Scene::load(&arguments.scene)?;
    let accuracy = arguments.accuracy.unwrap_or(scene.accuracy);
    let mut progress = JobProgress::new(&scene.name, arguments.quiet);
    let found = ledger(&scene, accuracy, &mut |share| progress.at(share));
    progress.done();
    let found = found?;
    arguments.plot.save(&found.entries, || report::effects_picture(&found))?;
    super::show(&found.entries, arguments.json, |_| report::effects(&found, arguments.why))
}
