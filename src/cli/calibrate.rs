//! `hertzscope calibrate`: a sensor's sensitivity from impacts of known momentum.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::Args;
use serde::Serialize;

use super::AnswerIsNo;
use super::acquire::one_shot;
use super::document;
use super::input::TableArguments;
use super::overwrite::{OverwriteArguments, ending};
use super::picture::PictureArguments;
use super::progress::JobProgress;
use crate::calibrate::blind::{CalibrationCoverage, coverage};
use crate::calibrate::design::{Designer, TestDesign};
use crate::calibrate::report::sensor_file;
use crate::calibrate::{self, CalibrationReport};
use crate::client::Address;
use crate::files::{self, NewFolder};
use crate::recording::mcap;
use crate::report::calibration::page;
use crate::report::calibration_design::design_page;
use crate::report::dcc;
use crate::report::page::{html, markdown};
use crate::report::certificate::{
    SENSITIVITY_FILE, certificate, missing, pictures, sensitivity_picture,
};
use crate::report::plot::{Theme, svg};
use crate::report::{check_finite, to_json};
use crate::scene::plan::{self, CalibrationPlan, lab};

/// Calibrate a sensor from the momentum of impacts: sensitivity, time constant, uncertainty budget,
/// certificate
#[derive(Debug, Args)]
pub struct Arguments {
    /// Plan (TOML): recordings, and the striker's masses and speeds with their uncertainties; an
    /// impact whose recording is a scope's address is recorded now; `hertzscope help plan` shows
    /// one
    #[arg(required_unless_present = "simulate")]
    plan: Option<PathBuf>,
    /// Instead, design the calibration of this sensor (a name or a file): simulates it over the
    /// laboratory's strikers and drop heights, V/div and s/div, and shows the best; with --output,
    /// writes its plan and recordings
    #[arg(long, value_name = "SENSOR", conflicts_with = "plan")]
    simulate: Option<String>,
    /// With --simulate: try only strikers whose name contains this, e.g. ptfe
    #[arg(
        long,
        value_name = "NAME",
        requires = "simulate",
        default_value = "",
        hide_default_value = true
    )]
    striker: String,
    /// With --simulate: strikers, heights and instruments, each with its standard uncertainty
    /// [default: as `hertzscope help lab` prints]
    #[arg(long, value_name = "FILE.toml", requires = "simulate")]
    lab: Option<PathBuf>,
    /// With --simulate: repeat the best calibration this many times with hidden true values; shows
    /// bias and coverage
    #[arg(long, value_name = "N", requires = "simulate", value_parser = clap::value_parser!(u32).range(2..=100_000))]
    repeat: Option<u32>,
    /// With --simulate: random seed of readings, noise and true values
    #[arg(long, value_name = "N", requires = "simulate", default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    table: TableArguments,
    /// Write certificate, JSON, pictures and the sensor's file into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Write the certificate alone into this file (.pdf, .html, .md)
    #[arg(long, value_name = "FILE", conflicts_with = "simulate")]
    certificate: Option<PathBuf>,
    /// Write a digital calibration certificate (DCC 3.3.0) into this file
    #[arg(long, value_name = "FILE.xml", conflicts_with = "simulate")]
    dcc: Option<PathBuf>,
    /// Write a certificate although the plan's data contradict each other; replace a
    /// picture or a certificate
    #[arg(long, conflicts_with = "simulate")]
    force: bool,
    #[command(flatten)]
    plot: PictureArguments,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let Some(plan) = &arguments.plan else { return simulate(arguments) };
    let overwrite = OverwriteArguments::forced(arguments.force);
    arguments.plot.check(overwrite)?;
    if let Some(file) = &arguments.certificate {
        ending(file, document::ENDINGS)?;
        overwrite.check(file)?;
    }
    let file = plan;
    let mut plan = plan::load(file)?;
    if arguments.dcc.is_some() {
        dcc::check(&plan.particulars).with_context(|| file.display().to_string())?;
    }
    acquire_impacts(&mut plan)?;
    let found = calibrate::run(&plan, &arguments.table.columns())?;
    check_finite(&found)?;
    let refused = !found.contradictions.is_empty() && !arguments.force;
    if let Some(folder) = arguments.output.as_ref().filter(|_| !refused) {
        write(folder, &found)?;
    }
    if !refused {
        arguments.plot.save(&found, || sensitivity_picture(&found))?;
    }
    if let Some(file) = arguments.certificate.as_ref().filter(|_| !refused) {
        let (title, parts) = certificate(&found, &pictures(&found));
        document::write(file, &title, &|_| parts.clone())?;
    }
    if let Some(file) = arguments.dcc.as_ref().filter(|_| !refused) {
        let text = dcc::dcc(&found)?;
        files::write(file, text).with_context(|| file.display().to_string())?;
    }
    super::show(&found, arguments.json, page)?;
    if refused {
        let wrong = found.contradictions.join("; ");
        super::say(&format!(
            "refused, nothing is certified (--force certifies it all the same): {wrong}"
        ));
        return Err(AnswerIsNo.into());
    }
    if arguments.json {
        return Ok(());
    }
    let in_folder = arguments.output.as_ref().map(|folder| folder.join("certificate.html"));
    let written: Vec<&PathBuf> = in_folder.iter().chain(&arguments.certificate).collect();
    for file in &written {
        super::print(&format!("  certificate {}", file.display()))?;
    }
    if let Some(file) = &arguments.dcc {
        super::print(&format!("  digital     {}", file.display()))?;
    }
    let missing = missing(&found);
    if !written.is_empty() && !missing.is_empty() {
        let keys = missing.join(", ");
        super::print(&format!("  it lacks    what ISO/IEC 17025, 7.8, asks for: {keys}"))?;
    }
    Ok(())
}

/// Records each impact that the plan names a scope's address for; the recordings stay beside the
/// plan.
fn acquire_impacts(plan: &mut CalibrationPlan) -> anyhow::Result<()> {
    let count = plan.impacts.len();
    for (number, impact) in (1..).zip(&mut plan.impacts) {
        if Address::recognise(&impact.recording.to_string_lossy())?.is_none() {
            continue;
        }
        let striker = plan.strikers.get(impact.striker).map_or("", |(name, _)| name.as_str());
        super::say(&format!("impact {number} of {count}, striker {striker}"));
        let Some(set) = one_shot(&impact.recording)? else { continue };
        let stem = plan.file.file_stem().unwrap_or_default().to_string_lossy();
        let file = plan.file.with_file_name(format!("{stem}-impact-{number}.mcap"));
        impact.recording = mcap::write_numbered(&file, &set)?;
        impact.shot = 1;
        super::say(&format!("impact {number} of {count}: {}", impact.recording.display()));
    }
    Ok(())
}

/// The design of a calibration.
#[derive(Serialize)]
struct Design<'a> {
    sensor: &'a str,
    lab: Option<&'a Path>,
    best: &'a TestDesign,
    candidates: &'a [TestDesign],
    blind: Option<&'a CalibrationCoverage>,
}

fn simulate(arguments: &Arguments) -> anyhow::Result<()> {
    let sensor = arguments.simulate.as_deref().unwrap_or_default();
    let mut lab = lab::load(arguments.lab.as_deref())?;
    let names: Vec<String> = lab.strikers.iter().map(|striker| striker.name.clone()).collect();
    lab.strikers.retain(|striker| striker.name.contains(&arguments.striker));
    if lab.strikers.is_empty() {
        bail!("no striker's name contains `{}`: there are {}", arguments.striker, names.join(", "));
    }
    let designer = Designer::new(sensor, lab, arguments.seed)?;
    let mut progress = JobProgress::new("tests", arguments.quiet);
    let candidates = designer.search(&mut |share| progress.at(share));
    progress.done();
    let candidates = candidates?;
    let Some(best) = candidates.first().filter(|best| best.expanded.is_some()) else {
        bail!(
            "no test works with {sensor} and {}: give other strikers or heights (--lab)",
            names.join(", ")
        );
    };
    let mut progress = JobProgress::new("blind calibrations", arguments.quiet);
    let checked = arguments.repeat.map(|repeats| {
        coverage(&designer, best, repeats, arguments.seed, &mut |share| progress.at(share))
    });
    progress.done();
    let checked = checked.transpose()?;
    let written = match &arguments.output {
        Some(folder) => Some(write_test(folder, &designer, best)?),
        None => None,
    };
    let lab = arguments.lab.as_deref();
    let design = Design { sensor, lab, best, candidates: &candidates, blind: checked.as_ref() };
    super::show(&design, arguments.json, |design| {
        design_page(sensor, designer.lab(), &candidates, design.blind)
    })?;
    if let Some(plan) = written.filter(|_| !arguments.json) {
        super::print(&format!("  plan        {}", plan.display()))?;
    }
    Ok(())
}

/// The best test's plan and recordings, as a lab would bring them.
fn write_test(folder: &Path, designer: &Designer, best: &TestDesign) -> anyhow::Result<PathBuf> {
    let test = designer.test(best)?;
    let new = NewFolder::replace(folder).with_context(|| folder.display().to_string())?;
    for (name, set) in &test.recordings {
        mcap::write(&new.join(name), set)?;
    }
    files::write(&new.join("plan.toml"), test.plan)
        .and_then(|()| new.complete())
        .with_context(|| folder.display().to_string())?;
    Ok(folder.join("plan.toml"))
}

fn write(folder: &Path, report: &CalibrationReport) -> anyhow::Result<()> {
    let pictures = pictures(report);
    let (title, parts) = certificate(report, &pictures);
    // A name is a name, no path.
    let sensor = report.named.sensor.replace(['/', '\\'], "-");
    let files = [
        ("certificate.md".to_owned(), markdown(&parts).into_bytes()),
        ("certificate.html".to_owned(), html(&title, &parts).into_bytes()),
        #[cfg(feature = "png")]
        ("certificate.pdf".to_owned(), document::pdf("certificate.pdf", &title, &parts)?),
        ("calibration.json".to_owned(), (to_json(report)? + "\n").into_bytes()),
        (format!("{sensor}.toml"), sensor_file(report).into_bytes()),
    ];
    let write = || {
        let new = NewFolder::replace(folder)?;
        let pictures =
            pictures.iter().map(|(name, sheet)| (name.clone(), svg(sheet, Theme::Light).into_bytes()));
        let whole = svg(&sensitivity_picture(report), Theme::Light);
        files::write(&new.join(SENSITIVITY_FILE), whole)?;
        for (name, text) in files.into_iter().chain(pictures) {
            files::write(&new.join(name), text)?;
        }
        new.complete()
    };
    write().with_context(|| folder.display().to_string())
}
