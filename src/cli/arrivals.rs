//! `hertzscope arrivals`: when the pulse arrived at each sensor, and how fast it went.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use crate::measurement::arrivals::survey;
use crate::recording::format::open;
use crate::report;

/// Show when the first pulse arrived at each channel, by several estimators with uncertainties, and its speed
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a TDS2000 file (.csv), or a folder of them
    file: PathBuf,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let set = open(&arguments.file)?;
    let shots = set.shots.iter().filter(|shot| !shot.captures.is_empty());
    let surveys: Vec<_> = shots.map(|shot| survey(&set, shot)).collect();
    if surveys.is_empty() {
        bail!("found no capture, expected at least one: the scope was not triggered");
    }
    if arguments.json {
        return super::print(&serde_json::to_string_pretty(&surveys)?);
    }
    let pages: Vec<String> = surveys.iter().map(report::arrivals).collect();
    super::print(&pages.join("\n\n"))
}
