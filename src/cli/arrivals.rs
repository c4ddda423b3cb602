//! `hertzscope arrivals`: when the pulse arrived at each sensor, and how fast it went.

use std::path::PathBuf;

use anyhow::Context as _;
use clap::Args;
use serde_json::json;

use super::input::{ReadingArguments, no_capture};
use super::picture;
use crate::files;
use crate::measurement::arrivals::survey;
use crate::measurement::statistics::statistics;
use crate::report;

/// Show when the first pulse arrived at each channel, its speed, and how well shots repeat; with
/// uncertainties
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address
    /// (see `acquire`) to record one shot from
    file: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Write statistics over all shots into this table
    #[arg(short, long, value_name = "FILE.csv", value_parser = csv)]
    output: Option<PathBuf>,
    /// Print as JSON: shots and statistics
    #[arg(long)]
    json: bool,
}

fn csv(text: &str) -> Result<PathBuf, String> {
    let file = picture::in_a_folder(PathBuf::from(text))?;
    match file.extension() {
        Some(ending) if ending.eq_ignore_ascii_case("csv") => Ok(file),
        _ => Err(format!("`{text}` does not end in .csv")),
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut recording = arguments.reading.open_recording(&arguments.file)?;
    let problems = recording.facts().problems.clone();
    let mut surveys = Vec::new();
    arguments.reading.for_each_shot(&mut recording, |set| {
        let shots = set.shots.iter().filter(|shot| !shot.captures.is_empty());
        surveys.extend(shots.map(|shot| survey(set, shot)));
        Ok(())
    })?;
    if surveys.is_empty() {
        return Err(no_capture(&problems));
    }
    let statistics = statistics(&surveys);
    if let Some(file) = &arguments.output {
        files::write(file, report::statistics_csv(&statistics))
            .with_context(|| file.display().to_string())?;
    }
    if arguments.json {
        let all = json!({ "shots": surveys, "statistics": statistics, "problems": problems });
        return super::print(&serde_json::to_string_pretty(&all)?);
    }
    let mut pages: Vec<String> = surveys.iter().map(report::arrivals).collect();
    if surveys.len() > 1 {
        pages.push(report::statistics(&statistics));
    }
    pages.extend(problems.iter().map(|problem| format!("problem: {problem}")));
    super::print(&pages.join("\n\n"))
}
