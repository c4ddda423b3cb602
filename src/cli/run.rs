//! `hertzscope run`: scene in, recording and summary out.

use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::Args;
use serde_json::json;

use super::accuracy::accuracy;
use super::budget::DrawArguments;
use super::by_hand::{ByHand, step, tolerance};
use super::picture::PlotArguments;
use super::progress::JobProgress;
use crate::experiment::accuracy::{run_by_hand, run_to_accuracy};
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::outcome::Summary;
use crate::experiment::{Integration, facts};
use crate::measurement::arrivals::{Survey, survey};
use crate::measurement::statistics::statistics;
use crate::predict::UncertainPrediction;
use crate::recording::mcap::RecordingWriter;
use crate::recording::{Shot, TraceSet};
use crate::report;
use crate::scene::{FRAMES, Scene};

/// Most shots of a run.
const MAX_SHOTS: i64 = 100_000;

/// Simulate a scene: write what its oscilloscope records, print forces, times and speeds
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene (`hertzscope scenes` lists them), or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Recording to write, replacing what is there
    /// [default: SCENE.mcap; if it exists, SCENE-2.mcap and so on]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Relative error allowed in first-peak forces and times, 1e-11 to 0.1
    /// [default: the scene's, else 1e-6]
    #[arg(long, value_name = "X", value_parser = accuracy, allow_hyphen_values = true, conflicts_with_all = ["method", "step", "tolerance"])]
    accuracy: Option<f64>,
    /// Integration method, with --step or --tolerance, instead of --accuracy
    #[arg(long, value_enum)]
    method: Option<ByHand>,
    /// Step of --method, e.g. 50ns
    #[arg(long, value_name = "T", value_parser = step, allow_hyphen_values = true, requires = "method", conflicts_with = "tolerance")]
    step: Option<f64>,
    /// Error allowed in each step of --method, relative to the largest change of overlap and the
    /// largest speed, e.g. 1e-8
    #[arg(long, value_name = "X", value_parser = tolerance, allow_hyphen_values = true, requires = "method")]
    tolerance: Option<f64>,
    /// Random seed of noise and sampling phase [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// How often over the scene's duration the recording keeps the forces of all contacts and the
    /// displacements of all bodies, 2 to 50000: more for the spectra of a long run, fewer for a
    /// small file (sensors' forces are kept at the scope's samples)
    /// [default: the scene's, else 200]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(i64::from(*FRAMES.start())..=i64::from(*FRAMES.end())))]
    frames: Option<u32>,
    /// Number of impacts, each with its own noise and striker speed, in one recording
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=MAX_SHOTS), conflicts_with = "bands")]
    shots: u32,
    /// Also propagate the uncertainties in the scene's `[uncertainty]`: 95 % intervals of peaks,
    /// arrivals and speeds; with --json also of the traces
    #[arg(long)]
    bands: bool,
    #[command(flatten)]
    plot: PlotArguments,
    #[command(flatten)]
    draws: DrawArguments,
    /// Print the summary as JSON
    #[arg(long)]
    json: bool,
    /// Print no summary (unless --json asks for it), only errors and the name of the recording, on
    /// standard error
    #[arg(short, long)]
    quiet: bool,
}

/// How to integrate.
fn integration(arguments: &Arguments, scene: &Scene) -> anyhow::Result<Integration> {
    let Some(method) = arguments.method else {
        return Ok(Integration::Accuracy(arguments.accuracy.unwrap_or(scene.accuracy)));
    };
    let method = method.method(arguments.step, arguments.tolerance);
    Ok(Integration::Method(method.map_err(|error| anyhow!(error))?))
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut scene = Scene::load(&arguments.scene)?;
    scene.seed = arguments.seed.unwrap_or(scene.seed);
    scene.frames = arguments.frames.unwrap_or(scene.frames);
    arguments.plot.check()?;
    let integration = integration(arguments, &scene)?;
    // Before the recording tells what it is of.
    let scene = resolve_auto_effects(&scene, integration);
    let known = facts::facts(&scene, integration)?;
    let attachments = [facts::scene_attachment(&scene)];
    // Before the work, so that a folder that cannot be written to costs no simulation.
    let mut writer = if let Some(file) = arguments.output.as_deref() {
        RecordingWriter::create(is_recording(file)?, &known, &attachments)?
    } else {
        let file = PathBuf::from(format!("{}.mcap", scene.name));
        RecordingWriter::create_numbered(&file, &known, &attachments)?
    };
    let mut progress = JobProgress::new(&scene.name, arguments.quiet);
    let set =
        TraceSet { attachments: attachments.to_vec(), metadata: known, ..TraceSet::default() };
    let (mut summaries, mut surveys) = (Vec::new(), Vec::new());
    let mut first: Option<Shot> = None;
    for number in 1..=arguments.shots {
        let before = f64::from(number - 1);
        let mut report = |share| progress.at((before + share) / f64::from(arguments.shots));
        let outcome = match integration {
            Integration::Accuracy(accuracy) => {
                run_to_accuracy(&scene, accuracy, number, &mut report)
            }
            Integration::Method(method) => run_by_hand(&scene, method, number, &mut report),
        };
        let outcome = outcome?;
        writer.add(&outcome.shot, &facts::shot_notes(&scene, &outcome))?;
        if arguments.shots > 1 {
            surveys.push(survey(&set, &outcome.shot));
        }
        summaries.push(outcome.summary);
        first.get_or_insert(outcome.shot);
    }
    progress.done();
    let file = writer.finish()?;
    let predicted = if arguments.bands {
        Some(arguments.draws.predict(&arguments.scene, true, arguments.quiet)?)
    } else {
        None
    };
    let title = format!("{}: {}", scene.name, scene.title);
    arguments.plot.save(|| match &predicted {
        Some(predicted) => report::bands_picture(&predicted.bands, &title),
        None => first.map_or_else(String::new, |shot| report::shot_picture(&shot, &title)),
    })?;
    // As it was typed.
    let recording = arguments.output.as_ref().unwrap_or(&file).display().to_string();
    tell(arguments, &summaries, &surveys, predicted.as_ref(), &recording)
}

/// Prints what happened.
fn tell(
    arguments: &Arguments,
    summaries: &[Summary],
    surveys: &[Survey],
    predicted: Option<&UncertainPrediction>,
    recording: &str,
) -> anyhow::Result<()> {
    if arguments.json {
        let mut summary = match summaries {
            [summary] => serde_json::to_value(summary)?,
            several => json!({ "shots": several, "statistics": statistics(surveys) }),
        };
        summary["recording"] = json!(recording);
        if let Some(predicted) = predicted {
            summary["uncertainty"] = serde_json::to_value(predicted)?;
        }
        super::print(&serde_json::to_string_pretty(&summary)?)?;
    } else if arguments.quiet {
        // Scripts read standard output; the name may be one that the program chose.
        for note in summaries.iter().flat_map(|summary| &summary.notes) {
            if note.code == "not_triggered" {
                eprintln!("note        {note}");
            }
        }
        eprintln!("recording   {recording}");
    } else {
        super::print(&summaries.first().map(report::summary).unwrap_or_default())?;
        if arguments.shots > 1 {
            super::print(&format!("\nabove shot 1 of {}\n", arguments.shots))?;
            super::print(&format!("{}\n", report::statistics(&statistics(surveys))))?;
        }
        if let Some(predicted) = predicted {
            super::print(&format!("\n{}", report::prediction_intervals(predicted)))?;
        }
        super::print(&format!("  recording   {recording}"))?;
    }
    Ok(())
}

/// Refuses file names without the ending of a recording.
fn is_recording(file: &Path) -> anyhow::Result<&Path> {
    if file.extension().is_none_or(|extension| extension != "mcap") {
        bail!(
            "{}: found no .mcap at the end, expected the name of a recording (see `hertzscope convert` for CSV)",
            file.display()
        );
    }
    Ok(file)
}
