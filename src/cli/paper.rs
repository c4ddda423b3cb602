//! `hertzscope paper`: the paper's figures and numbers, recomputed, each with a verdict.

use std::path::{Path, PathBuf};

use anyhow::Context as _;
use clap::Args;

use super::picture;
use super::progress::JobProgress;
use crate::experiment::facts;
use crate::files::{self, NewFolder};
use crate::recording::mcap;
use crate::report;
use crate::report::page::{html, markdown};
use crate::report::plot::{Theme, svg};
use crate::studies::paper::{FIGURES, FigureRun, PaperStudy, study};
use crate::table;

const TITLE: &str = "Herbold et al. (2009), recomputed";

/// Recompute the figures and numbers of Herbold et al. (2009) and compare each with what is printed
#[derive(Debug, Args)]
pub struct Arguments {
    /// Write figures (SVG, PNG), their data (CSV), recordings (MCAP), and a report (Markdown, HTML)
    /// into this folder
    #[arg(short, long = "output", alias = "out", value_name = "DIR")]
    out: Option<PathBuf>,
    /// Only this figure, with the statements that belong to it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(i64::from(*FIGURES.start())..=i64::from(*FIGURES.end())))]
    figure: Option<u8>,
    /// Print the verdicts as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    // Before the work, so that a folder that cannot be made costs no simulation.
    let shown = |folder: &PathBuf| folder.display().to_string();
    let new = arguments
        .out
        .as_ref()
        .map(|folder| NewFolder::replace(folder).with_context(|| shown(folder)));
    let new = new.transpose()?;
    let mut progress = JobProgress::new("paper", arguments.quiet);
    let found = study(arguments.figure, &mut |share| progress.at(share));
    progress.done();
    let found = found?;
    report::check_finite(&found.findings)?;
    if let (Some(folder), Some(new)) = (&arguments.out, new) {
        write(&new, &found)?;
        new.complete().with_context(|| shown(folder))?;
    }
    super::show(&found.findings, arguments.json, |_| report::paper(&found))?;
    match &arguments.out {
        _ if arguments.json => Ok(()),
        Some(folder) => super::print(&format!("report  {}", folder.join("report.html").display())),
        None => Ok(()),
    }
}

fn write(folder: &NewFolder, study: &PaperStudy) -> anyhow::Result<()> {
    let save = |name: &str, text: &str| {
        let file = folder.join(name);
        files::write(&file, text).with_context(|| file.display().to_string())
    };
    let pictures = report::paper_pictures(study);
    for drawn in &pictures {
        save(&format!("{}.svg", drawn.stem), &svg(&drawn.sheet, Theme::Light))?;
        if cfg!(feature = "png") {
            let file = folder.join(format!("{}.png", drawn.stem));
            picture::save(&file, &drawn.sheet, Theme::Light)?;
        }
        for (name, data) in &drawn.data {
            table::write(&folder.join(name), data)?;
        }
    }
    for figure in &study.figures {
        if let Some(run) = &figure.run {
            record(&folder.join(format!("figure-{:02}.mcap", figure.number)), run)?;
        }
    }
    let parts = report::paper_parts(study, &pictures);
    save("report.md", &markdown(&parts))?;
    save("report.html", &html(TITLE, &parts))?;
    save("verdicts.json", &report::to_json(&study.findings)?)
}

fn record(file: &Path, run: &FigureRun) -> anyhow::Result<()> {
    let set = facts::recording(&run.scene, run.integration, [run.outcome.clone()])?;
    Ok(mcap::write(file, &set)?)
}
