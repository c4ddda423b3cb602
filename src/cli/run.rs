//! `hertzscope run`: scene in, recording and summary out.

use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::Args;
use serde::{Serialize, Serializer};

use super::accuracy::{ByHand, TOLERANCES, accuracy};
use super::budget::DrawArguments;
use super::picture::PlotArguments;
use super::progress::JobProgress;
use super::value::{ABOVE_ZERO, quantity};
use crate::experiment::accuracy::{run_by_hand, run_to_accuracy};
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::outcome::Summary;
use crate::experiment::{Integration, facts};
use crate::measurement::arrivals::survey;
use crate::measurement::statistics::{ShotStatistic, statistics};
use crate::predict::UncertainPrediction;
use crate::quantity::Dimension;
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
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, ABOVE_ZERO, "50ns"), allow_hyphen_values = true, requires = "method", conflicts_with = "tolerance")]
    step: Option<f64>,
    /// Error allowed in each step of --method, relative to the largest change of overlap and the
    /// largest speed, e.g. 1e-8
    #[arg(long, value_name = "X", value_parser = quantity(Dimension::NONE, TOLERANCES, "1e-8"), allow_hyphen_values = true, requires = "method")]
    tolerance: Option<f64>,
    /// Random seed of noise and sampling phase [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Number of times at which contact forces and displacements are stored, 2 to 50000
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
    // Before the recording's metadata are made.
    let mut scene = resolve_auto_effects(&scene, integration).into_owned();
    let known = facts::facts(&scene, integration)?;
    let attachments = facts::scene_attachments(&scene);
    // Before the work, so that a folder that cannot be written to costs no simulation.
    let mut writer = if let Some(file) = arguments.output.as_deref() {
        RecordingWriter::create(is_recording(file)?, &known, &attachments)?
    } else {
        let file = PathBuf::from(format!("{}.mcap", scene.name));
        RecordingWriter::create_numbered(&file, &known, &attachments)?
    };
    let mut progress = JobProgress::new(&scene.name, arguments.quiet);
    let set =
        TraceSet { attachments, metadata: known, ..TraceSet::default() };
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
        scene.keep_indentations(&outcome.indentations);
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
    // As it was typed.
    let recording = arguments.output.as_ref().unwrap_or(&file).display().to_string();
    let found = RunResult {
        statistics: (arguments.shots > 1).then(|| statistics(&surveys)),
        shots: summaries,
        recording,
        uncertainty: predicted,
    };
    let title = format!("{}: {}", scene.name, scene.title);
    arguments.plot.save(&found, || match &found.uncertainty {
        Some(predicted) => report::bands_picture(&predicted.bands, &title),
        None => report::shot_picture(first.as_ref(), &title),
    })?;
    if arguments.json || !arguments.quiet {
        return super::show(&found, arguments.json, RunResult::text);
    }
    // Scripts read standard output; the name may be one that the program chose.
    for note in found.shots.iter().flat_map(|summary| &summary.notes) {
        if note.code == "not_triggered" {
            super::say(&format!("note        {note}"));
        }
    }
    if arguments.output.is_none() {
        super::say(&format!("recording   {}", found.recording));
    }
    Ok(())
}

/// Result of the command: the summary of a single shot has its fields beside `recording`, several
/// are a list `shots`.
struct RunResult {
    shots: Vec<Summary>,
    statistics: Option<Vec<ShotStatistic>>,
    recording: String,
    uncertainty: Option<UncertainPrediction>,
}

impl Serialize for RunResult {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        #[serde(untagged)]
        enum Shots<'a> {
            One(&'a Summary),
            Several { shots: &'a [Summary], statistics: &'a Option<Vec<ShotStatistic>> },
        }
        #[derive(Serialize)]
        struct Fields<'a> {
            #[serde(flatten)]
            shots: Shots<'a>,
            recording: &'a str,
            #[serde(skip_serializing_if = "Option::is_none")]
            uncertainty: &'a Option<UncertainPrediction>,
        }
        let shots = match self.shots.as_slice() {
            [summary] => Shots::One(summary),
            shots => Shots::Several { shots, statistics: &self.statistics },
        };
        let (recording, uncertainty) = (self.recording.as_str(), &self.uncertainty);
        Fields { shots, recording, uncertainty }.serialize(serializer)
    }
}

impl RunResult {
    fn text(&self) -> String {
        let mut page = self.shots.first().map(report::summary).unwrap_or_default();
        if let Some(statistics) = &self.statistics {
            page = format!("shot 1 of {}\n\n{page}\n\n", self.shots.len());
            page.push_str(&report::statistics(statistics));
            page.push('\n');
        }
        if let Some(predicted) = &self.uncertainty {
            page.push_str("\n\n");
            page.push_str(&report::prediction_intervals(predicted));
        }
        format!("{page}\n  recording   {}", self.recording)
    }
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
