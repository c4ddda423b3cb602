//! A recording as a plain table for other programs: `time_s,CH1_V,...`, one row a sample.

use anyhow::bail;
use clap::ValueEnum;

use super::input::no_capture;
use crate::measurement::force::forces;
use crate::quantity::{engineering, printable};
use crate::recording::{Shot, TraceSet, TrueSignal};
use crate::scope::Waveform;
use crate::table::{Cell, Column, Table};
use crate::trace::Trace;

/// Digits that a number is printed with at most: far below a digitiser's level and a picosecond of
/// a record.
const PRINTED_DIGITS: usize = 12;

/// True signals in a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum TrueColumns {
    /// Forces at the sensors
    Sensors,
    /// Also the force in each contact and the displacement of each body
    All,
}

/// What a table holds beside times and voltages.
#[derive(Debug, Clone, Copy)]
pub struct TableContent {
    /// True signals of a simulation, interpolated to the samples' times.
    pub truth: Option<TrueColumns>,
    /// Forces in newtons in the place of volts, by the sensors' calibrations.
    pub newtons: bool,
}

/// One column: a trace of which some samples may be absent.
struct TraceColumn {
    name: String,
    start: f64,
    interval: f64,
    values: Vec<Option<f64>>,
}

impl TraceColumn {
    fn new(name: String, trace: &Trace) -> Self {
        let values = trace.values.iter().map(|value| Some(rounded(*value))).collect();
        Self { name, start: trace.start, interval: trace.interval, values }
    }

    fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
    }
}

/// The table of all shots; with several shots its first column is `shot`.
pub fn plain_table(set: &TraceSet, content: TableContent) -> anyhow::Result<Table> {
    let shots: Vec<&Shot> = set.shots.iter().filter(|shot| !shot.captures.is_empty()).collect();
    let Some(first) = shots.first() else {
        return Err(no_capture(&set.problems));
    };
    let names: Vec<String> =
        columns(set, first, content)?.into_iter().map(|column| column.name).collect();
    let several = shots.len() > 1;
    let over_time = first.captures.iter().any(|c| c.waveform.preamble.x_unit == "s");
    let abscissa = if over_time { "time_s" } else { "frequency_Hz" };
    let mut head: Vec<Column> = several.then(|| Column::count("shot")).into_iter().collect();
    head.extend(
        std::iter::once(abscissa)
            .chain(names.iter().map(String::as_str))
            .map(|name| Column::number(printable(name))),
    );
    let mut rows = Vec::new();
    for shot in &shots {
        let columns = columns(set, shot, content)?;
        if !columns.iter().map(|column| &column.name).eq(&names) {
            bail!(
                "shot {} has other channels than shot {}: choose them with --channel, or shots with --shot",
                shot.number,
                first.number
            );
        }
        let Some(axis) = columns.first() else { continue };
        rows.extend((0..axis.values.len()).map(|index| {
            let mut row: Vec<Cell> = several.then(|| shot.number.into()).into_iter().collect();
            row.push(rounded(axis.time(index)).into());
            let values = columns.iter().map(|column| column.values.get(index).copied().flatten());
            row.extend(values.map(Cell::from));
            row
        }));
    }
    Ok(Table { columns: head, rows })
}

/// `value` without the round-off of double precision.
fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", PRINTED_DIGITS - 1).parse::<f64>().unwrap_or(value) + 0.0
}

fn columns(set: &TraceSet, shot: &Shot, content: TableContent) -> anyhow::Result<Vec<TraceColumn>> {
    let mut columns = Vec::new();
    if content.newtons {
        for found in forces(set, shot) {
            let found = found?;
            columns.push(TraceColumn::new(format!("{}_N", found.channel), &found.force));
        }
    } else {
        columns.extend(shot.captures.iter().map(|capture| {
            let waveform = &capture.waveform;
            TraceColumn {
                name: format!("{}_{}", waveform.source, waveform.preamble.y_unit),
                start: waveform.time(0),
                interval: waveform.preamble.x_incr,
                values: values(waveform),
            }
        }));
    }
    let Some(axis) = columns.first() else { return Ok(columns) };
    let is_other = |column: &&TraceColumn| {
        let off = (column.start - axis.start).abs() + (column.interval - axis.interval).abs();
        off > 1e-6 * axis.interval || column.values.len() != axis.values.len()
    };
    if let Some(other) = columns.iter().find(is_other) {
        bail!(
            "shot {}: {} has other times than {} ({} an interval, {}): write one table for each with --channel",
            shot.number,
            other.name,
            axis.name,
            engineering(other.interval, "s", 4),
            engineering(axis.interval, "s", 4)
        );
    }
    if let Some(wanted) = content.truth {
        let truth = truth(shot, axis, wanted)?;
        columns.extend(truth);
    }
    Ok(columns)
}

/// The values of a record: as a file gave them, or of its levels.
fn values(waveform: &Waveform) -> Vec<Option<f64>> {
    let is_as_read = !waveform.as_read.is_empty();
    let printed = |value: f64| if is_as_read { value + 0.0 } else { rounded(value) };
    waveform.values().map(|value| Some(printed(value))).collect()
}

/// True signals at the times of `axis`: `truth_p2_N`, `truth_contact3_N`, `truth_bead3_m`.
fn truth(shot: &Shot, axis: &TraceColumn, wanted: TrueColumns) -> anyhow::Result<Vec<TraceColumn>> {
    let Some(trigger) = shot.trigger_time else {
        bail!("shot {} holds no truth: only simulations do", shot.number);
    };
    let name = |signal: TrueSignal| match signal {
        TrueSignal::Force(sensor) => Some(sensor),
        TrueSignal::Contact(_) | TrueSignal::Displacement(_) if wanted == TrueColumns::Sensors => {
            None
        }
        TrueSignal::Contact(contact) => Some(format!("contact{contact}")),
        TrueSignal::Displacement(body) => Some(format!("bead{body}")),
    };
    let signals =
        shot.truth.iter().filter_map(|trace| Some((name(TrueSignal::of(trace)?)?, trace)));
    let columns = signals.map(|(name, trace)| {
        let at = |index: usize| interpolated(trace, axis.time(index) + trigger);
        TraceColumn {
            name: format!("truth_{name}_{}", trace.unit),
            start: axis.start,
            interval: axis.interval,
            values: (0..axis.values.len()).map(|index| at(index).map(rounded)).collect(),
        }
    });
    Ok(columns.collect())
}

/// The value at `time` (s) on the straight line between neighbouring samples, absent outside the
/// record.
fn interpolated(trace: &Trace, time: f64) -> Option<f64> {
    let place = (time - trace.start) / trace.interval;
    if place.is_nan() || place < 0.0 {
        return None;
    }
    let index = place.floor() as usize;
    let share = place - place.floor();
    match (trace.values.get(index), trace.values.get(index + 1)) {
        (Some(here), Some(next)) => Some(here + share * (next - here)),
        (Some(here), None) if share == 0.0 => Some(*here),
        _ => None,
    }
}
