//! `hertzscope arrivals`: when the pulse arrived at each sensor, and how fast it went.

use std::path::PathBuf;

use clap::Args;
use serde::Serialize;

use super::input::{ReadingArguments, no_capture};
use super::picture::{self, PlotArguments};
use crate::measurement::arrivals::{Survey, survey};
use crate::measurement::statistics::{ShotStatistic, statistics};
use crate::recording::Shot;
use crate::report;
use crate::table;

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
    #[command(flatten)]
    plot: PlotArguments,
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

/// Arrivals of all shots.
#[derive(Serialize)]
struct AllArrivals {
    shots: Vec<Survey>,
    statistics: Vec<ShotStatistic>,
    problems: Vec<String>,
}

impl AllArrivals {
    fn text(&self) -> String {
        let mut pages: Vec<String> = self.shots.iter().map(report::arrivals).collect();
        if self.shots.len() > 1 {
            pages.push(report::statistics(&self.statistics));
        }
        pages.extend(self.problems.iter().map(|problem| format!("problem: {problem}")));
        pages.join("\n\n")
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let mut recording = arguments.reading.open_recording(&arguments.file)?;
    let problems = recording.facts().problems.clone();
    let mut surveys = Vec::new();
    let mut first: Option<Shot> = None;
    arguments.reading.for_each_shot(&mut recording, |set| {
        for shot in set.shots.iter().filter(|shot| !shot.captures.is_empty()) {
            surveys.push(survey(set, shot));
            first.get_or_insert_with(|| shot.clone());
        }
        Ok(())
    })?;
    if surveys.is_empty() {
        return Err(no_capture(&problems));
    }
    let statistics = statistics(&surveys);
    if let Some(file) = &arguments.output {
        table::write(file, &report::statistics_table(&statistics))?;
    }
    let all = AllArrivals { shots: surveys, statistics, problems };
    if let (Some(shot), Some(found)) = (&first, all.shots.first()) {
        let title = format!("{}, shot {}", arguments.file.display(), shot.number);
        arguments.plot.save(&all, || report::arrivals_picture(found, shot, &title))?;
    }
    super::show(&all, arguments.json, AllArrivals::text)
}
