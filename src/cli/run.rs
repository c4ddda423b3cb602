//! `hertzscope run`: scene in, recording and summary out.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{Args, ValueEnum};

use super::progress::Progress;
use crate::experiment::{self, Integration, facts};
use crate::integrate::Method;
use crate::quantity::{Dimension, parse};
use crate::recording::mcap::RecordingWriter;
use crate::report;
use crate::scene::{LOOSEST_ACCURACY, Scene, TIGHTEST_ACCURACY};

/// Simulate a scene: write the recording its oscilloscope makes, print what happened
#[derive(Debug, Args)]
pub struct Arguments {
    /// A scene that ships with the program (see `hertzscope scenes`), or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: String,
    /// Recording to write, overwriting what is there [default: <SCENE>.mcap, numbered if that exists]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Relative error allowed in first-peak forces and times, e.g. 1e-6 [default: the scene's]
    #[arg(long, value_name = "X", value_parser = accuracy, conflicts_with_all = ["method", "step"])]
    accuracy: Option<f64>,
    /// Integration method to use with a step of your own
    #[arg(long, value_enum, requires = "step")]
    method: Option<ByHand>,
    /// Its step, e.g. 50ns
    #[arg(long, value_name = "T", value_parser = step, requires = "method")]
    step: Option<f64>,
    /// Seed of noise and sample clock [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Print nothing but errors; with --json, the summary is still printed
    #[arg(short, long)]
    quiet: bool,
}

/// Methods that take a fixed step.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum ByHand {
    /// Order 2, symplectic
    VelocityVerlet,
    /// Order 4, symplectic
    Pefrl,
    /// Order 6, symplectic
    BlanesMoan,
}

impl ByHand {
    fn with(self, step: f64) -> Method {
        match self {
            Self::VelocityVerlet => Method::VelocityVerlet { step },
            Self::Pefrl => Method::Pefrl { step },
            Self::BlanesMoan => Method::BlanesMoan { step },
        }
    }
}

fn accuracy(text: &str) -> Result<f64, String> {
    let value = parse(text, Dimension::NONE).map_err(|error| error.to_string())?;
    if (TIGHTEST_ACCURACY..=LOOSEST_ACCURACY).contains(&value) {
        Ok(value)
    } else {
        Err(format!("found {value:e}, expected {TIGHTEST_ACCURACY:e} to {LOOSEST_ACCURACY}"))
    }
}

fn step(text: &str) -> Result<f64, String> {
    let expected = "expected a time above zero, e.g. 50ns";
    match parse(text, Dimension::TIME) {
        Ok(value) if value > 0.0 => Ok(value),
        Ok(_) => Err(format!("found {text}, {expected}")),
        Err(error) => Err(format!("found {error}, {expected}")),
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut scene = Scene::load(&arguments.scene)?;
    scene.seed = arguments.seed.unwrap_or(scene.seed);
    let integration = match (arguments.method, arguments.step) {
        (Some(method), Some(step)) => Integration::Method(method.with(step)),
        _ => Integration::Accuracy(arguments.accuracy.unwrap_or(scene.accuracy)),
    };
    let known = facts::facts(&scene, integration)?;
    let output = match &arguments.output {
        Some(output) if output.extension().is_none_or(|e| e != "mcap") => {
            bail!(
                "{}: found no .mcap at the end, expected the name of a recording (see `hertzscope convert` for CSV)",
                output.display()
            )
        }
        Some(output) => output.clone(),
        None => free_name(&scene.name),
    };
    // Before the work, so that a folder that cannot be written to costs no simulation.
    let mut writer = RecordingWriter::create(&output, &known, &[facts::scene_attachment(&scene)])?;
    let mut progress = Progress::new(&scene.name, arguments.quiet);
    let outcome = experiment::run(&scene, integration, 1, &mut |share| progress.at(share));
    progress.done();
    let outcome = outcome?;
    writer.add(&outcome.shot, &facts::shot_notes(&scene, &outcome))?;
    writer.finish()?;
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&outcome.summary)?)?;
    } else if !arguments.quiet {
        super::print(&report::summary(&outcome.summary))?;
        super::print(&format!("  recording   {}", output.display()))?;
    }
    Ok(())
}

/// `<name>.mcap`, or the first of `<name>-2.mcap`, `<name>-3.mcap`, ... that does not exist: nothing is lost.
fn free_name(name: &str) -> PathBuf {
    let first = PathBuf::from(format!("{name}.mcap"));
    let numbered = (2..).map(|number| PathBuf::from(format!("{name}-{number}.mcap")));
    std::iter::once(first).chain(numbered).find(|path| !Path::exists(path)).unwrap_or_default()
}
