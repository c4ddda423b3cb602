//! `hertzscope calibrate`: a sensor's sensitivity from impacts of known momentum.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;

use crate::experiment::calibration::{self, Calibrated, sensor_file};
use crate::report::calibration::{certificate, page, pictures};
use crate::scene::plan;

/// Calibrate a sensor through linear momentum: sensitivity, time constant, uncertainty budget, certificate
#[derive(Debug, Args)]
pub struct Arguments {
    /// The plan: recordings, strikers, speeds, each with its standard uncertainty
    plan: PathBuf,
    /// Write certificate, JSON, pictures and the sensor's file into this folder
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let plan = plan::load(&arguments.plan)?;
    let found = calibration::run(&plan)?;
    if let Some(folder) = &arguments.output {
        write(folder, &found)?;
    }
    if arguments.json {
        return super::print(&serde_json::to_string_pretty(&found.report)?);
    }
    super::print(&page(&found.report))?;
    if let Some(folder) = &arguments.output {
        super::print(&format!("  certificate {}", folder.join("certificate.md").display()))?;
    }
    Ok(())
}

fn write(folder: &Path, found: &Calibrated) -> anyhow::Result<()> {
    let report = &found.report;
    let pictures = pictures(&found.calibration, report);
    let (markdown, html) = certificate(report, &pictures);
    // A name is a name, no path.
    let sensor = report.sensor.replace(['/', '\\'], "-");
    let files = [
        ("certificate.md".to_owned(), markdown),
        ("certificate.html".to_owned(), html),
        ("calibration.json".to_owned(), serde_json::to_string_pretty(report)? + "\n"),
        (format!("{sensor}.toml"), sensor_file(report)),
    ];
    std::fs::create_dir_all(folder).with_context(|| folder.display().to_string())?;
    for (name, text) in files.into_iter().chain(pictures) {
        let file = folder.join(name);
        std::fs::write(&file, text).with_context(|| file.display().to_string())?;
    }
    Ok(())
}
