//! `hertzscope force`: volts become newtons, with their uncertainty.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::input::ReadingArguments;
use super::picture::PlotArguments;
use crate::measurement::force::{Forces, forces};
use crate::measurement::metadata;
use crate::report::{self, ForcePage};
use crate::table::{self, Cell, Column, Table};

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
    let scene = metadata::scene_of(&set, shot.number).and_then(Result::ok);
    let hosts = scene.iter().flat_map(|s| found.iter().filter_map(|f| f.sensor.host_note(s)));
    let notes = hosts.collect();
    let page = ForcePage { shot: shot.number, channels: found, problems, notes };
    let title = format!("{}, shot {}", arguments.file.display(), shot.number);
    arguments.plot.save(&page, || report::force_picture(&page.channels, &title))?;
    if let Some(file) = &arguments.output {
        table::write(file, &force_table(&page.channels))?;
    }
    super::show(&page, arguments.json, report::forces)
}

fn force_table(found: &[Forces]) -> Table {
    let mut columns = vec![Column::number("time_s")];
    for forces in found {
        let channel = forces.channel.to_lowercase();
        columns.extend(["n", "u_n"].map(|what| Column::number(format!("{channel}_{what}"))));
    }
    let axis = found.first().map(|first| &first.force);
    let rows = (0..axis.map_or(0, |axis| axis.values.len())).map(|index| {
        let mut row: Vec<Cell> = vec![axis.map(|axis| axis.time(index)).into()];
        row.extend(found.iter().flat_map(|forces| {
            [&forces.force.values, &forces.u].map(|values| values.get(index).copied().into())
        }));
        row
    });
    let rows = rows.collect();
    Table { columns, rows }
}
