//! `hertzscope compare`: a measurement compared with a simulation.

use std::path::{Path, PathBuf};

use anyhow::bail;
use clap::{Args, ValueEnum};
use serde::Serialize;

use super::budget::DrawArguments;
use super::document;
use super::input::{
    SensorAssignment, Selection, TableArguments, assignment, channels, shot, wire_all, wired,
};
use super::overwrite::ending;
use super::picture::PlotArguments;
use super::progress::JobProgress;
use super::provenance::Provenance;
use crate::experiment::{self, Integration, facts};
use crate::measurement::compare::mapping::Assignment;
use crate::measurement::compare::score_limits::ScoreLimits;
use crate::measurement::compare::{Align, Compared, ComparedShot, Comparison, compare};
use crate::predict::{
    JointTest, JudgedErrors, NormalisedError, TraceBand, UncertainPrediction, judge, normalised_errors,
};
use crate::recording::format::{Format, open_shot};
use crate::recording::tek_csv::TableColumns;
use crate::recording::{TraceSet, mcap};
use crate::report;
use crate::report::page;
use crate::scene::Scene;
use crate::scene::random_inputs::RandomInput;

/// Runs for the intervals of an uncertain scene where none are asked for: `E_n` to a few percent in
/// a third of a second.
const FIRST_SAMPLES: u32 = 300;

/// Compare a measurement with a simulation: scores for each channel; exit code 1 where they exceed
/// the tolerance
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address
    /// (see `acquire`) to record one shot from
    measured: PathBuf,
    /// A simulated recording, file or folder, or a scene to run (included, or a .toml file)
    simulated: String,
    #[command(flatten)]
    table: TableArguments,
    /// Limits of the scores, e.g. peak=5%,arrival=2us,rms=2lsb,correlation=0.99; also speed, gain,
    /// spectrum (%) and max (lsb, V, N)
    /// [default: where the scene has `[uncertainty]`, normalised errors `E_n` that 95 % of benches
    /// as stated keep; else rms=1lsb]
    #[arg(long, value_name = "LIST", value_parser = ScoreLimits::parse)]
    tolerance: Option<ScoreLimits>,
    #[command(flatten)]
    draws: DrawArguments,
    /// How measurement and simulation are aligned in time
    #[arg(long, value_enum, default_value = "arrival")]
    align: AlignBy,
    /// Simulated sensor or channel of a measured channel, e.g. CH1=p2,CH2=p14
    /// [default: as recorded, else equal numbers]
    #[arg(long, value_name = "CH=NAME", value_delimiter = ',', value_parser = assignment)]
    map: Vec<Assignment>,
    /// Calibration of the sensor at a measured channel, an included sensor or a file that
    /// `calibrate` wrote, e.g. CH1=sensor.toml
    #[arg(long, value_name = "CH=SENSOR", value_parser = wired)]
    sensor: Vec<SensorAssignment>,
    #[command(flatten)]
    selection: Selection,
    /// Shot of the simulated recording to compare with
    #[arg(long, value_name = "N", default_value_t = 1)]
    simulated_shot: u32,
    /// Write a report with plots (.pdf, .html, .md), or the measurement with its scores (.mcap)
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArguments,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum AlignBy {
    /// At equal trigger times
    Trigger,
    /// At equal arrival (half-rise) on the first channel with a pulse
    Arrival,
    /// By the shift with the least squared residuals over all channels
    LeastSquares,
}

impl From<AlignBy> for Align {
    fn from(by: AlignBy) -> Self {
        match by {
            AlignBy::Trigger => Self::Trigger,
            AlignBy::Arrival => Self::Arrival,
            AlignBy::LeastSquares => Self::LeastSquares,
        }
    }
}

/// The scores, with the normalised errors of an uncertain scene.
#[derive(Serialize)]
struct Scores<'a> {
    #[serde(flatten)]
    comparison: &'a Comparison,
    normalised_errors: Vec<NormalisedError>,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint_test: Option<JointTest>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let endings = [document::ENDINGS, &["mcap"]].concat();
    if let Some(file) = &arguments.output {
        ending(file, &endings)?;
    }
    let number = arguments.selection.single();
    if Format::of(Path::new(&arguments.simulated)).is_none() {
        // Errors of the scene are reported before a scope is waited for.
        Scene::load(&arguments.simulated)?;
    }
    let mut set = arguments.table.open_shot(&arguments.measured, number)?;
    arguments.selection.keep_channels(&mut set)?;
    let names = channels(&set);
    wire_all(&mut set, &names, &arguments.sensor)?;
    let simulation = Simulation::of(arguments)?;
    let name = arguments.measured.display().to_string();
    let measured =
        ComparedShot { name: &name, set: &set, shot: shot(&set, &name, number)?, scene: None };
    let simulated = ComparedShot {
        name: &arguments.simulated,
        set: &simulation.set,
        shot: shot(&simulation.set, &arguments.simulated, simulation.shot)?,
        scene: simulation.scene.as_ref(),
    };
    let how = (arguments.align.into(), arguments.map.as_slice());
    let limits = arguments.tolerance.clone().unwrap_or_default();
    let mut compared = compare(measured, simulated, how, &limits)?;
    let ((normalised_errors, joint_test), predicted) =
        errors(arguments, &simulation, &mut compared)?;
    fail_left_out(&arguments.sensor, &mut compared.comparison);
    let comparison = &compared.comparison;
    let scores = Scores { comparison, normalised_errors, joint_test };
    report::check_finite(&scores)?;
    let parts = |stem: &str| {
        let mut parts = report::comparison_page(&compared, &predicted.bands, stem);
        parts.extend(report::normalised_error_parts(&scores.normalised_errors, predicted.samples));
        parts
    };
    let provenance = Provenance {
        measured: &arguments.measured,
        set: &set,
        scene: simulation.scene.as_ref(),
        uncertain: (&predicted.inputs, "uncertain inputs of the scene, in the simulated intervals"),
    };
    let title = format!("{name} against {}", arguments.simulated);
    if let Some(file) = &arguments.output {
        if ending(file, &endings)? == "mcap" {
            let facts = report::comparison_facts(comparison);
            write_scores(file, &arguments.measured, &mut set, facts)?;
        } else {
            let made_from = provenance.parts()?;
            let parts = |stem: &str| [parts(stem), made_from.clone()].concat();
            document::write(file, &title, &parts)?;
        }
    }
    let picture = || page::picture(&title, &report::comparison_page(&compared, &predicted.bands, ""));
    arguments.plot.save(&scores, picture)?;
    super::show(&scores, arguments.json, |_| page::text(&parts("")))?;
    if comparison.failures.is_empty() { Ok(()) } else { Err(super::AnswerIsNo.into()) }
}

/// A channel that the user gave a sensor and that has no partner never passes.
fn fail_left_out(sensors: &[SensorAssignment], comparison: &mut Comparison) {
    for SensorAssignment { channel, .. } in sensors {
        if !comparison.channels.iter().any(|score| score.name.eq_ignore_ascii_case(channel)) {
            let failure = format!("{channel}: not compared, it has no partner in the simulation");
            comparison.failures.push(failure);
            comparison.verdict = "fail";
        }
    }
}

/// What a scene's uncertainty makes of its prediction.
#[derive(Default)]
struct Predicted {
    samples: usize,
    inputs: Vec<RandomInput>,
    bands: Vec<TraceBand>,
}

/// Normalised errors and their joint test where the simulated side is a scene that states its
/// uncertainty, and what they are from; without a tolerance they give the verdict.
fn errors(
    arguments: &Arguments,
    simulation: &Simulation,
    compared: &mut Compared,
) -> anyhow::Result<(JudgedErrors, Predicted)> {
    let is_uncertain = |scene: &Scene| !scene.uncertainty.is_empty();
    if !simulation.scene.as_ref().is_some_and(is_uncertain) {
        return Ok(((Vec::new(), None), Predicted::default()));
    }
    let predicted = arguments.draws.or(FIRST_SAMPLES).predict(&arguments.simulated, true, arguments.quiet)?;
    let errors = match arguments.tolerance {
        Some(_) => normalised_errors(compared, &predicted),
        None => judge(compared, &predicted),
    };
    let UncertainPrediction { samples, inputs, bands, .. } = predicted;
    Ok((errors, Predicted { samples, inputs, bands }))
}

/// The simulated side.
struct Simulation {
    set: TraceSet,
    shot: u32,
    scene: Option<Scene>,
}

impl Simulation {
    /// Opens a recording, or runs a scene.
    fn of(arguments: &Arguments) -> anyhow::Result<Self> {
        let path = Path::new(&arguments.simulated);
        if Format::of(path).is_some() {
            let set = open_shot(path, arguments.simulated_shot, &TableColumns::default())?;
            return Ok(Self { set, shot: arguments.simulated_shot, scene: None });
        }
        let scene = Scene::load(&arguments.simulated)?;
        let integration = Integration::Accuracy(scene.accuracy);
        let mut progress = JobProgress::new(&scene.name, arguments.quiet);
        let outcome = experiment::run(&scene, integration, 1, &mut |share| progress.at(share));
        progress.done();
        let set = facts::recording(&scene, integration, [outcome?])?;
        Ok(Self { set, shot: 1, scene: Some(scene) })
    }
}

/// The measurement as a recording with its scores among the metadata.
fn write_scores(
    file: &Path,
    input: &Path,
    set: &mut TraceSet,
    facts: facts::Facts,
) -> anyhow::Result<()> {
    let same = |input: PathBuf| std::fs::canonicalize(file).is_ok_and(|file| file == input);
    if std::fs::canonicalize(input).is_ok_and(same) {
        bail!("{}: found the input as the output, expected another file", file.display());
    }
    set.metadata.retain(|name, _| !name.starts_with("hertzscope:comparison"));
    set.metadata.extend(facts);
    Ok(mcap::write(file, set)?)
}
