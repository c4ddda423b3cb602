//! Contents of a recording, as a page of text.

use std::collections::BTreeSet;

use super::table;
use crate::quantity::engineering;
use crate::recording::{Capture, Direction, Origin, Shot, TraceSet};

/// The page that `info` prints.
pub fn contents(set: &TraceSet) -> String {
    let mut lines = Vec::new();
    for (group, facts) in &set.metadata {
        lines.push(group.clone());
        let rows: Vec<Vec<String>> =
            facts.iter().map(|(key, value)| vec![key.clone(), value.clone()]).collect();
        lines.extend(table::lines(&rows, &[0, 1]));
        lines.push(String::new());
    }
    for shot in &set.shots {
        lines.extend(shot_lines(shot));
        lines.push(String::new());
    }
    if !set.lines.is_empty() {
        lines.push(session_line(set));
    }
    for attachment in &set.attachments {
        lines.push(format!(
            "attachment {} ({}, {} bytes)",
            attachment.name,
            attachment.media_type,
            attachment.data.len()
        ));
    }
    lines.extend(set.log.iter().map(|line| format!("log: {line}")));
    lines.extend(set.problems.iter().map(|problem| format!("problem: {problem}")));
    lines.join("\n").trim_end().to_owned()
}

/// How many commands and replies went over the remote interface, and between whom.
fn session_line(set: &TraceSet) -> String {
    let commands = set.lines.iter().filter(|line| line.direction == Direction::Command).count();
    let peers: BTreeSet<&str> = set.lines.iter().map(|line| line.peer.as_str()).collect();
    let replies = set.lines.len() - commands;
    format!(
        "remote interface: {commands} commands and {replies} replies, {} connections",
        peers.len()
    )
}

fn shot_lines(shot: &Shot) -> Vec<String> {
    let origin = match shot.origin {
        Origin::Simulated => "simulated",
        Origin::Measured => "measured",
    };
    let heading = [
        "channel",
        "points",
        "scale",
        "position",
        "coupling",
        "time base",
        "trigger point",
        "lowest",
        "highest",
        "clipped",
    ];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    rows.extend(shot.captures.iter().map(capture_row));
    let mut lines = vec![format!("shot {}, {origin}", shot.number)];
    lines.extend(table::lines(&rows, &[0]));
    for capture in &shot.captures {
        let source = capture.waveform.source;
        lines.extend(capture.notes.iter().map(|note| format!("  {source}: {note}")));
    }
    if !shot.truth.is_empty() {
        lines.push(format!("  and {} simulated signals (true forces, motion)", shot.truth.len()));
    }
    lines
}

fn capture_row(capture: &Capture) -> Vec<String> {
    let waveform = &capture.waveform;
    let preamble = &waveform.preamble;
    let extreme = |code: Option<&i16>| {
        code.map_or("-".to_owned(), |code| {
            engineering(waveform.volts_of(*code), &preamble.y_unit, 4)
        })
    };
    vec![
        waveform.source.to_string(),
        waveform.codes.len().to_string(),
        engineering(waveform.vertical.scale, &format!("{}/div", preamble.y_unit), 3),
        format!("{} div", waveform.vertical.position),
        waveform.vertical.coupling.map_or("?".to_owned(), |c| c.to_string()),
        engineering(waveform.horizontal_scale, &format!("{}/div", preamble.x_unit), 3),
        waveform.trigger_point.to_string(),
        extreme(waveform.codes.iter().min()),
        extreme(waveform.codes.iter().max()),
        waveform.clipped().to_string(),
    ]
}
