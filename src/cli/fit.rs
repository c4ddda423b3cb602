//! `hertzscope fit`: a scene's numbers from measured traces.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;

use super::AnswerIsNo;
use super::accuracy::accuracy;
use super::document;
use super::input::{Selection, TableArguments, assignment, shot};
use super::overwrite::ending;
use super::picture::PlotArguments;
use super::progress::JobProgress;
use super::provenance::Provenance;
use super::value::quantity;
use crate::analysis::gate::Gate;
use crate::files;
use crate::fit::blind::blind;
use crate::fit::{Fit, FitOptions, fit};
use crate::measurement::compare::ComparedShot;
use crate::measurement::compare::mapping::Assignment;
use crate::quantity::{Dimension, Quantity};
use crate::report;
use crate::report::page::{picture, text};
use crate::scene::adjust::{Adjustable, AdjustableNumber};
use crate::scene::random_inputs::RandomInputs;

/// Fit parameters of a scene to measured traces, with uncertainties: least squares, sensor and
/// scope included
#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address for
    /// one shot, then the scene; with --blind, only the scene
    #[arg(value_names = ["MEASURED", "SCENE"], num_args = 1..=2, required = true)]
    inputs: Vec<String>,
    /// Parameters to fit, by their paths in the scene, e.g.
    /// `striker.speed,materials.ptfe.youngs_modulus`; in `particles.*.mass` the * is every name,
    /// each a parameter; PATH=VALUE sets the start
    #[arg(long, value_name = "PATHS", value_delimiter = ',', required = true)]
    free: Vec<String>,
    /// Simulated sensor of a measured channel, e.g. CH1=p2,CH2=p14
    /// [default: as recorded, else equal numbers]
    #[arg(long, value_name = "CH=SENSOR", value_delimiter = ',', value_parser = assignment)]
    map: Vec<Assignment>,
    #[command(flatten)]
    table: TableArguments,
    #[command(flatten)]
    selection: Selection,
    /// Also fit a gain for each channel, without prior knowledge of it
    #[arg(long, conflicts_with = "gain_u")]
    gains: bool,
    /// Relative standard uncertainty of each channel's gain, e.g. 3%; 0 for exact ones
    /// [default: from the scope's and the sensor's files]
    #[arg(long, value_name = "SHARE", value_parser = quantity(Dimension::NONE, 0.0..1.0, "10%"))]
    gain_u: Option<f64>,
    /// Relative standard uncertainty of the record's times, e.g. 0.1%; 0 for exact ones
    /// [default: from the scope's file]
    #[arg(long, value_name = "SHARE", value_parser = quantity(Dimension::NONE, 0.0..0.1, "0.1%"))]
    time_base_u: Option<f64>,
    /// Take all other numbers of the scene as exact, whatever its `[uncertainty]` states: faster,
    /// and the results are those of noise alone
    #[arg(long)]
    exact_inputs: bool,
    /// Take the zeros of the channels as exact: do not fit an offset for each
    #[arg(long)]
    no_offsets: bool,
    /// Ignore samples before this time after the trigger
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    from: Option<f64>,
    /// Ignore samples after this time after the trigger
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    to: Option<f64>,
    /// Number of starting points, the scene's values among them
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(1..=1000))]
    starts: u32,
    /// Largest relative distance of starting points, or with --blind of true values, from the
    /// scene's values
    #[arg(long, value_name = "SHARE", default_value = "10%", value_parser = quantity(Dimension::NONE, 0.0..1.0, "10%"))]
    spread: f64,
    /// Random seed of starting points and true values
    #[arg(long, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Relative accuracy of the simulations
    #[arg(long, value_name = "X", default_value = "1e-7", value_parser = accuracy)]
    accuracy: f64,
    /// Compute profile-likelihood intervals of all parameters, not only of poorly determined ones
    #[arg(long)]
    profile: bool,
    /// Test the fit: simulate this many measurements with random true values; shows how many
    /// intervals contain them
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=100_000), conflicts_with_all = ["output", "plot"])]
    blind: Option<u32>,
    /// Write the fitted scene, with SCENE as its base (.toml), or a report with plots (.pdf, .html,
    /// .md); once for each
    #[arg(short, long, alias = "report", value_name = "FILE")]
    output: Vec<PathBuf>,
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
    outputs(arguments)?;
    arguments.plot.check()?;
    let options = FitOptions {
        gains: arguments.gains,
        gain_u: arguments.gain_u,
        time_base_u: arguments.time_base_u,
        exact_inputs: arguments.exact_inputs,
        offsets: !arguments.no_offsets,
        starts: arguments.starts,
        spread: arguments.spread,
        seed: arguments.seed,
        accuracy: arguments.accuracy,
        gate: Gate {
            from: arguments.from.unwrap_or(f64::NEG_INFINITY),
            to: arguments.to.unwrap_or(f64::INFINITY),
        },
        profile: arguments.profile,
    };
    match (arguments.inputs.as_slice(), arguments.blind) {
        ([scene], Some(trials)) => run_blind(arguments, scene, trials, &options),
        ([measured, scene], None) => run_fit(arguments, measured, scene, &options),
        ([_], None) => {
            bail!("found no scene, expected one behind the measurement: fit MEASURED SCENE")
        }
        _ => {
            bail!("found a measurement with --blind, expected the scene alone: fit --blind N SCENE")
        }
    }
}

/// The files for the fitted scene and for the report, by their endings.
fn outputs(arguments: &Arguments) -> anyhow::Result<[Option<&PathBuf>; 2]> {
    let endings = [&["toml"], document::ENDINGS].concat();
    let mut files = [None; 2];
    for file in &arguments.output {
        let is_report = ending(file, &endings)? != "toml";
        if let Some(other) = files[usize::from(is_report)].replace(file) {
            let what = if is_report { "report" } else { "fitted scene" };
            bail!(
                "{}: found a second file for the {what}, expected one beside {}",
                file.display(),
                other.display()
            );
        }
    }
    Ok(files)
}

/// The scene and what is freed of it.
fn freed(
    arguments: &Arguments,
    scene: &str,
) -> anyhow::Result<(Adjustable, Vec<AdjustableNumber>)> {
    let mut scene = Adjustable::load(scene)?;
    let mut knobs = Vec::new();
    for text in arguments.free.iter().map(|text| text.trim()).filter(|text| !text.is_empty()) {
        let (path, start) = text.split_once('=').map_or((text, None), |(p, v)| (p.trim(), Some(v)));
        let mut found = scene.knobs(path)?;
        if let Some(start) = start {
            let start: Quantity = start.parse().with_context(|| format!("--free {text}"))?;
            for knob in &mut found {
                let unit = format!("1 {}", knob.unit).parse::<Quantity>().map(|one| one.dimension);
                let found = start.dimension;
                if unit != Ok(found) {
                    bail!("--free {text}: found {found}, expected a value in {}", knob.unit);
                }
                knob.value = start.value;
            }
        }
        knobs.extend(found);
    }
    if knobs.is_empty() {
        bail!("--free: found no path, expected at least one, e.g. striker.speed");
    }
    // Starting values have to be allowed, too.
    scene.with(&knobs.iter().map(|knob| (knob, knob.value)).collect::<Vec<_>>())?;
    Ok((scene, knobs))
}

fn run_fit(
    arguments: &Arguments,
    measured: &str,
    scene: &str,
    options: &FitOptions,
) -> anyhow::Result<()> {
    let [scene_file, report_file] = outputs(arguments)?;
    let number = arguments.selection.single();
    let (mut scene, knobs) = freed(arguments, scene)?;
    let mut set = arguments.table.open_shot(Path::new(measured), number)?;
    arguments.selection.keep_channels(&mut set)?;
    let shot = shot(&set, measured, number)?;
    let side = ComparedShot { name: measured, set: &set, shot, scene: None };
    let mut progress = JobProgress::new("fit", arguments.quiet);
    let found =
        fit((&scene, &knobs), side, &arguments.map, options, &mut |share| progress.at(share));
    progress.done();
    if let Err(error) = &found
        && error.has_no_result()
    {
        super::say(&format!("not fitted: {error}"));
        return Err(AnswerIsNo.into());
    }
    let found = found?;
    report::check_finite(&found.report)?;
    if let Some(file) = scene_file {
        // Its numbers may come from the scene's files.
        RandomInputs::of(&mut scene)?;
        let text = fitted_scene(&scene, &knobs, &found, file);
        files::write(file, text).with_context(|| file.display().to_string())?;
    }
    if let Some(file) = report_file {
        let title = format!("{} fitted to {measured}", found.report.scene);
        let whole = scene.scene()?;
        let paths: Vec<&str> = knobs.iter().map(|knob| knob.path.as_str()).collect();
        let inputs = RandomInputs::of(&mut scene)?.beside(&paths, &whole);
        let meaning = if options.exact_inputs { FIXED } else { MOVED };
        let provenance = Provenance {
            measured: Path::new(measured),
            set: &set,
            scene: Some(&whole),
            uncertain: (inputs.list(), meaning),
        };
        let made_from = provenance.parts()?;
        let parts = |stem: &str| [report::fit_page(&found, stem), made_from.clone()].concat();
        document::write(file, &title, &parts)?;
    }
    let title = format!("{} fitted to {measured}", found.report.scene);
    arguments.plot.save(&found.report, || picture(&title, &report::fit_page(&found, "")))?;
    super::show(&found.report, arguments.json, |_| text(&report::fit_page(&found, "")))?;
    if let Some(file) = scene_file.filter(|_| !arguments.json) {
        super::print(&format!("  scene    {}", file.display()))?;
    }
    if found.report.only_noise_is_left { Ok(()) } else { Err(AnswerIsNo.into()) }
}

/// What a table of inputs is called that are held, and of those that move.
const FIXED: &str = "fixed values that the scene states as uncertain: the uncertainties above do not include them";
const MOVED: &str = "values that the scene states as uncertain, each fitted within what it states";

/// Inputs are written to two digits below this share: seven in all (1).
const INPUT_DIGITS: f64 = 1e-4;

/// The fitted scene; digits two places beyond the uncertainty's.
fn fitted_scene(
    scene: &Adjustable,
    knobs: &[AdjustableNumber],
    found: &Fit,
    file: &Path,
) -> String {
    let digits = |u: f64, scale: f64| {
        let digits = 3.0 - (u / scale).log10().floor();
        if digits.is_finite() { digits.clamp(0.0, 15.0) as usize } else { 15 }
    };
    let freed = knobs.iter().zip(&found.report.parameters).map(|(knob, parameter)| {
        (knob, parameter.value, digits(parameter.u, knob.scale))
    });
    let moved = found.inputs.values(&found.scores).into_iter().map(|(knob, value)| {
        (knob, value, digits(INPUT_DIGITS * value.abs(), knob.scale))
    });
    let title = format!("{} fitted to {}", found.report.scene, found.report.measured);
    scene.derived(&freed.chain(moved).collect::<Vec<_>>(), &title, file)
}

fn run_blind(
    arguments: &Arguments,
    name: &str,
    trials: u32,
    options: &FitOptions,
) -> anyhow::Result<()> {
    let (scene, knobs) = freed(arguments, name)?;
    let mut progress = JobProgress::new("blind fits", arguments.quiet);
    let found = blind(&scene, &knobs, trials, options, &mut |share| progress.at(share));
    progress.done();
    let found = found?;
    super::show(&found, arguments.json, |found| report::blind(found, name))
}
