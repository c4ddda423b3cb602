//! `hertzscope info`: what is in a recording.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::input::{Selection, TableArguments};
use crate::recording::{Capture, Origin, Shot, TraceSet};
use crate::report;
use crate::trace::Trace;

/// Show what is in a recording or a scope's file
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), a folder of them, or a scope's address
    /// (see `acquire`) to record one shot from
    file: PathBuf,
    #[command(flatten)]
    table: TableArguments,
    #[command(flatten)]
    selection: Selection,
    /// Print as JSON
    #[arg(long)]
    json: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut recording = arguments.table.open(&arguments.file)?;
    let mut left = arguments.selection.shots(&recording)?.len();
    if arguments.json {
        // The shots are last, and are printed one by one.
        let page = serde_json::to_string_pretty(&facts(recording.facts()))?;
        let open = page.trim_end().trim_end_matches('}').trim_end();
        let (bracket, end) = if left > 0 { ("[", "  ]\n}") } else { ("[]", "}") };
        super::print(&format!("{open},\n  \"shots\": {bracket}"))?;
        arguments.selection.for_each_shot(&mut recording, |set| {
            left -= 1;
            let comma = if left > 0 { "," } else { "" };
            for found in &set.shots {
                let text = serde_json::to_string_pretty(&shot(found))?;
                super::print(&format!("    {}{comma}", text.replace('\n', "\n    ")))?;
            }
            Ok(())
        })?;
        return super::print(end);
    }
    let before = report::contents_before(recording.facts());
    if !before.is_empty() {
        super::print(&before)?;
    }
    let after = report::contents_after(recording.facts(), recording.traffic());
    arguments.selection.for_each_shot(&mut recording, |set| {
        left -= 1;
        for shot in &set.shots {
            let page = report::contents_of(shot);
            let is_last = left == 0 && after.is_empty();
            super::print(if is_last { page.trim_end() } else { &page })?;
        }
        Ok(())
    })?;
    if after.is_empty() { Ok(()) } else { super::print(&after) }
}

fn facts(set: &TraceSet) -> Value {
    let attachments = set
        .attachments
        .iter()
        .map(|a| json!({ "name": a.name, "media_type": a.media_type, "bytes": a.data.len() }));
    json!({
        "metadata": set.metadata,
        "attachments": attachments.collect::<Vec<_>>(),
        "log": set.log,
        "problems": set.problems,
    })
}

fn shot(shot: &Shot) -> Value {
    json!({
        "number": shot.number,
        "origin": match shot.origin {
            Origin::Simulated => "simulated",
            Origin::Measured => "measured",
        },
        "timestamp_ns": shot.timestamp_ns,
        "trigger_time_s": shot.trigger_time,
        "captures": shot.captures.iter().map(capture).collect::<Vec<_>>(),
        "truth": shot.truth.iter().map(series).collect::<Vec<_>>(),
    })
}

fn capture(capture: &Capture) -> Value {
    let waveform = &capture.waveform;
    let preamble = &waveform.preamble;
    let extremes = waveform.extremes();
    json!({
        "source": waveform.source.to_string(),
        "points": waveform.codes.len(),
        "x_incr": preamble.x_incr,
        "x_zero": preamble.x_zero,
        "x_unit": preamble.x_unit,
        "y_mult": preamble.y_mult,
        "y_off": preamble.y_off,
        "y_zero": preamble.y_zero,
        "y_unit": preamble.y_unit,
        "vertical_scale": waveform.vertical.scale,
        "position_div": waveform.vertical.position,
        "coupling": waveform.vertical.coupling.map(|c| c.to_string()),
        "probe": waveform.vertical.probe,
        "horizontal_scale": waveform.horizontal_scale,
        "trigger_point": waveform.trigger_point,
        "lowest": extremes.map(|[low, _]| low),
        "highest": extremes.map(|[_, high]| high),
        "clipped": waveform.clipped(),
        "model": capture.instrument.as_ref().map(|i| &i.model),
        "firmware": capture.instrument.as_ref().map(|i| &i.firmware),
        "notes": capture.notes,
    })
}

fn series(trace: &Trace) -> Value {
    json!({
        "name": trace.name,
        "unit": trace.unit,
        "start_s": trace.start,
        "interval_s": trace.interval,
        "values": trace.values.len(),
    })
}
