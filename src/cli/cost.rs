//! `hertzscope cost`: what accuracy costs in time.

use std::path::PathBuf;

use anyhow::anyhow;
use clap::Args;

use super::picture;
use super::progress::Progress;
use crate::experiment::cost::study;
use crate::report;
use crate::scene::Scene;

/// Show what accuracy costs: every method over its settings, errors against work
#[derive(Debug, Args)]
pub struct Arguments {
    /// A scene that ships with the program, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: String,
    /// Print the study as JSON
    #[arg(long)]
    json: bool,
    /// Draw the study
    #[arg(long, value_name = picture::ENDINGS, value_parser = picture::file)]
    plot: Option<PathBuf>,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let scene = Scene::load(&arguments.scene)?;
    let mut progress = Progress::new(&scene.name, arguments.quiet);
    let found = study(&scene, &mut |share| progress.at(share));
    progress.done();
    let found = found.map_err(|error| anyhow!("{}: no reference: {error}", scene.name))?;
    if let Some(file) = &arguments.plot {
        picture::save(file, &report::work_precision_svg(&found))?;
    }
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&found)?)
    } else {
        super::print(&report::work_precision(&found))
    }
}
