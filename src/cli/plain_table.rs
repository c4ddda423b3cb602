//! A recording as a plain table for other programs: `time_s,CH1_V,...`, one row a sample.

use std::fmt::Write as _;

use anyhow::bail;

use super::input::no_capture;
use crate::measurement::force::forces;
use crate::quantity::{engineering, printable_line};
use crate::recording::{Shot, TraceSet, TrueSignal};
use crate::trace::Trace;

/// Digits that a number is printed with at most: far below a digitiser's level and a picosecond of
/// a record.
const PRINTED_DIGITS: usize = 12;

/// What a table holds beside times and voltages.
#[derive(Debug, Clone, Copy)]
pub struct TableContent {
    /// True forces at the sensors, of a simulation, interpolated to the samples' times.
    pub truth: bool,
    /// Forces in newtons in the place of volts, by the sensors' calibrations.
    pub newtons: bool,
}

/// One column.
struct TableColumn {
    name: String,
    trace: Trace,
}

/// The table of all shots; a column `shot` stands in front where there are several.
pub fn plain_table(set: &TraceSet, content: TableContent) -> anyhow::Result<String> {
    let shots: Vec<&Shot> = set.shots.iter().filter(|shot| !shot.captures.is_empty()).collect();
    let Some(first) = shots.first() else {
        return Err(no_capture(&set.problems));
    };
    let names: Vec<String> =
        columns(set, first, content)?.iter().map(|c| printable_line(&c.name).into()).collect();
    let several = shots.len() > 1;
    let abscissa = if first.captures.iter().any(|c| c.waveform.preamble.x_unit == "s") {
        "time_s"
    } else {
        "frequency_Hz"
    };
    let shot_name = if several { "shot," } else { "" };
    let mut text = format!("{shot_name}{abscissa},{}\n", names.join(","));
    for shot in &shots {
        let columns = columns(set, shot, content)?;
        if !columns.iter().map(|c| printable_line(&c.name)).eq(names.iter().map(String::as_str)) {
            bail!(
                "shot {} has other channels than shot {}: choose them with --channel, or shots with --shot",
                shot.number,
                first.number
            );
        }
        rows(&mut text, several.then_some(shot.number), &columns);
    }
    Ok(text)
}

fn rows(text: &mut String, shot: Option<u32>, columns: &[TableColumn]) {
    let Some(first) = columns.first() else { return };
    for index in 0..first.trace.values.len() {
        // Writing to a String cannot fail.
        if let Some(number) = shot {
            let _ = write!(text, "{number},");
        }
        let _ = write!(text, "{}", printed(first.trace.time(index)));
        for column in columns {
            text.push(',');
            if let Some(value) = column.trace.values.get(index).filter(|value| value.is_finite()) {
                let _ = write!(text, "{}", printed(*value));
            }
        }
        text.push('\n');
    }
}

/// `value` without the round-off of double precision.
fn printed(value: f64) -> f64 {
    format!("{value:.*e}", PRINTED_DIGITS - 1).parse::<f64>().unwrap_or(value) + 0.0
}

fn columns(set: &TraceSet, shot: &Shot, content: TableContent) -> anyhow::Result<Vec<TableColumn>> {
    let mut columns = Vec::new();
    if content.newtons {
        for found in forces(set, shot) {
            let found = found?;
            columns.push(TableColumn { name: format!("{}_N", found.channel), trace: found.force });
        }
    } else {
        for capture in &shot.captures {
            let waveform = &capture.waveform;
            let values = waveform.codes.iter().map(|code| waveform.volts_of(*code)).collect();
            let unit = waveform.preamble.y_unit.clone();
            let trace = Trace {
                name: waveform.source.to_string(),
                unit: unit.clone(),
                start: waveform.time(0),
                interval: waveform.preamble.x_incr,
                values,
            };
            columns.push(TableColumn { name: format!("{}_{unit}", waveform.source), trace });
        }
    }
    let Some(axis) = columns.first().map(|column| column.trace.clone()) else {
        return Ok(columns);
    };
    let is_other = |column: &&TableColumn| {
        let trace = &column.trace;
        let off = (trace.start - axis.start).abs() + (trace.interval - axis.interval).abs();
        off > 1e-6 * axis.interval || trace.values.len() != axis.values.len()
    };
    if let Some(other) = columns.iter().find(is_other) {
        bail!(
            "shot {}: {} has other times than {} ({} an interval, {}): write one table for each with --channel",
            shot.number,
            other.name,
            axis.name,
            engineering(other.trace.interval, "s", 4),
            engineering(axis.interval, "s", 4)
        );
    }
    if content.truth {
        columns.extend(truth(shot, &axis)?);
    }
    Ok(columns)
}

/// True forces at the sensors, at the times of `axis`.
fn truth(shot: &Shot, axis: &Trace) -> anyhow::Result<Vec<TableColumn>> {
    let Some(trigger) = shot.trigger_time else {
        bail!("shot {} holds no truth: only simulations do", shot.number);
    };
    let sensors = shot
        .truth
        .iter()
        .filter_map(|trace| Some((TrueSignal::of(trace)?.sensor()?.to_owned(), trace)));
    let columns = sensors.map(|(name, trace)| {
        let at = |index: usize| interpolated(trace, axis.time(index) + trigger);
        let values = (0..axis.values.len()).map(at).collect();
        TableColumn {
            name: format!("truth_{name}_{}", trace.unit),
            trace: Trace { values, ..axis.clone() },
        }
    });
    Ok(columns.collect())
}

/// The value at `time` on the straight line between neighbouring samples; not a number outside the
/// record.
fn interpolated(trace: &Trace, time: f64) -> f64 {
    let place = (time - trace.start) / trace.interval;
    // Also a place that is not a number.
    if place.is_nan() || place < 0.0 {
        return f64::NAN;
    }
    let index = place.floor() as usize;
    let share = place - place.floor();
    match (trace.values.get(index), trace.values.get(index + 1)) {
        (Some(here), Some(next)) => here + share * (next - here),
        (Some(here), None) if share == 0.0 => *here,
        _ => f64::NAN,
    }
}
