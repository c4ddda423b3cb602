//! `hertzscope info`: what is in a recording.

use std::path::PathBuf;

use clap::Args;
use serde_json::{Value, json};

use super::input::{Selection, TableArguments};
use crate::recording::format::open_large;
use crate::recording::mcap::indexed_recording::IndexedRecording;
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
    if let Some(recording) = open_large(&arguments.file)? {
        return shot_by_shot(recording, arguments.json);
    }
    let mut set = arguments.table.open(&arguments.file)?;
    arguments.selection.apply(&mut set)?;
    if arguments.json {
        super::print(&serde_json::to_string_pretty(&as_json(&set))?)
    } else {
        super::print(&report::contents(&set))
    }
}

/// The same of a recording that is too large to be read at once.
fn shot_by_shot(mut recording: IndexedRecording, json: bool) -> anyhow::Result<()> {
    let facts = recording.facts();
    if !json {
        super::print(&report::contents_before(&facts))?;
        for place in 0..recording.shots() {
            if let Some(shot) = recording.shot(place)? {
                super::print(&report::contents_of(&shot))?;
            }
        }
        return super::print(&report::contents_after(&facts, recording.traffic()));
    }
    let mut page = as_json(&facts);
    if let Some(page) = page.as_object_mut() {
        page.remove("shots");
    }
    // The shots go last, one by one.
    let text = serde_json::to_string_pretty(&page)?;
    let open = text.trim_end().trim_end_matches('}').trim_end();
    super::print(&format!("{open},\n  \"shots\": ["))?;
    for place in 0..recording.shots() {
        if let Some(found) = recording.shot(place)? {
            let comma = if place == 0 { "" } else { "," };
            super::print(&format!("{comma}{}", serde_json::to_string(&shot(&found))?))?;
        }
    }
    super::print("  ]\n}")
}

fn as_json(set: &TraceSet) -> Value {
    let attachments = set
        .attachments
        .iter()
        .map(|a| json!({ "name": a.name, "media_type": a.media_type, "bytes": a.data.len() }));
    json!({
        "metadata": set.metadata,
        "shots": set.shots.iter().map(shot).collect::<Vec<_>>(),
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
    let volts = |code: Option<&i16>| code.map(|code| waveform.volts_of(*code));
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
        "lowest": volts(waveform.codes.iter().min()),
        "highest": volts(waveform.codes.iter().max()),
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
