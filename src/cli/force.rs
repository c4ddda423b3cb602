//! `hertzscope force`: volts become newtons, with their uncertainty.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context as _, bail};
use clap::Args;
use serde_json::{Value, json};

use super::input::ReadingArguments;
use super::picture::PlotArguments;
use crate::files;
use crate::measurement::force::{Forces, forces};
use crate::measurement::metadata;
use crate::report;

/// Convert volts into newtons by the sensors' calibration: corrected for droop, with uncertainties
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address
    /// (see `acquire`) to record one shot from
    file: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Write times, forces and standard uncertainties into this file
    #[arg(short, long, value_name = "FILE.csv")]
    output: Option<PathBuf>,
    #[command(flatten)]
    plot: PlotArguments,
    /// Print as JSON, all samples included
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let (set, shot) = arguments.reading.open_single(&arguments.file)?;
    let (mut found, mut problems) = (Vec::new(), Vec::new());
    for channel in forces(&set, &shot) {
        match channel {
            Ok(forces) => found.push(forces),
            Err(problem) => problems.push(problem.to_string()),
        }
    }
    if found.is_empty() {
        bail!("found no channel with forces, expected at least one: {}", problems.join("; "));
    }
    let title = format!("{}, shot {}", arguments.file.display(), shot.number);
    arguments.plot.save(|| report::force_picture(&found, &title))?;
    if let Some(file) = &arguments.output {
        files::write(file, csv(&found)).with_context(|| file.display().to_string())?;
    }
    let scene = metadata::scene_of(&set, shot.number).and_then(Result::ok);
    let hosts = scene.iter().flat_map(|s| found.iter().filter_map(|f| f.sensor.host_note(s)));
    let notes: Vec<String> = hosts.collect();
    if arguments.json {
        let channels: Vec<Value> = found.iter().map(as_json).collect();
        let all = json!({ "shot": shot.number, "channels": channels, "problems": problems, "notes": notes });
        return super::print(&serde_json::to_string_pretty(&all)?);
    }
    super::print(&report::forces(&found, &[problems, notes].concat()))
}

fn csv(found: &[Forces]) -> String {
    let mut text = "time_s".to_owned();
    for forces in found {
        let channel = forces.channel.to_lowercase();
        let _ = write!(text, ",{channel}_n,{channel}_u_n");
    }
    text.push('\n');
    let Some(first) = found.first() else { return text };
    for index in 0..first.force.values.len() {
        let _ = write!(text, "{:e}", first.force.time(index));
        for forces in found {
            match (forces.force.values.get(index), forces.u.get(index)) {
                (Some(force), Some(u)) => {
                    let _ = write!(text, ",{force:e},{u:e}");
                }
                _ => text.push_str(",,"),
            }
        }
        text.push('\n');
    }
    text
}

fn as_json(forces: &Forces) -> Value {
    json!({
        "channel": forces.channel,
        "sensor": forces.sensor.name,
        "sensitivity_v_per_n": forces.sensor.sensitivity,
        "sensitivity_u_relative": forces.sensor.sensitivity_u,
        "gain_u_relative": forces.sensor.gain_u,
        "gain_note": forces.sensor.gain_note(),
        "tau_s": forces.sensor.time_constant,
        "tau_u_relative": forces.sensor.time_constant_u,
        "start_s": forces.force.start,
        "interval_s": forces.force.interval,
        "force_n": forces.force.values,
        "u_n": forces.u,
        "U95_n": forces.expanded,
        "noise_u_n": forces.noise_u,
        "clipped": forces.clipped,
    })
}
