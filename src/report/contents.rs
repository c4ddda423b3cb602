//! Contents of a recording, as a page of text.

use super::table;
use super::text::hanging_indent;
use crate::quantity::engineering;
use crate::recording::mcap::Traffic;
use crate::recording::{Capture, Origin, Shot, TraceSet};

/// A number with more characters than this is rounded where people read it.
const MAX_NUMBER_WIDTH: usize = 8;

/// Values are aligned after keys of at most this width (characters).
const MAX_KEY_WIDTH: usize = 40;

/// The page's part before the shots, for recordings that are read shot by shot.
pub fn contents_before(set: &TraceSet) -> String {
    let mut lines = Vec::new();
    for (group, facts) in &set.metadata {
        lines.push(group.clone());
        let is_short = |key: &&String| key.chars().count() <= MAX_KEY_WIDTH;
        let widest =
            facts.keys().filter(is_short).map(|key| key.chars().count()).max().unwrap_or(0);
        for (key, value) in facts {
            if is_short(&key) {
                lines.extend(hanging_indent(&format!("  {key:widest$}  "), &shown(value)));
            } else {
                lines.push(format!("  {key}  {value}"));
            }
        }
        lines.push(String::new());
    }
    lines.join("\n")
}

/// A value as people read it: numbers to six digits, a set-up with a space where a line may break.
fn shown(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if value.contains('.') && value.len() > MAX_NUMBER_WIDTH => {
            let rounded: f64 = format!("{number:.5e}").parse().unwrap_or(number);
            if (1e-4..1e6).contains(&rounded.abs()) {
                rounded.to_string()
            } else {
                format!("{rounded:e}")
            }
        }
        _ => value.replace(";:", "; :"),
    }
}

/// The page's part about a shot.
pub fn contents_of(shot: &Shot) -> String {
    let mut lines = shot_lines(shot);
    lines.push(String::new());
    lines.join("\n")
}

/// The page's part after the shots.
pub fn contents_after(set: &TraceSet, traffic: &Traffic) -> String {
    let mut lines = Vec::new();
    if traffic.commands + traffic.replies > 0 {
        lines.push(format!(
            "remote interface: {} commands and {} replies, {} connections",
            traffic.commands,
            traffic.replies,
            traffic.peers.len()
        ));
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
    let rows = table::titled(heading, shot.captures.iter().map(capture_row));
    let mut lines = vec![format!("shot {}, {origin}", shot.number)];
    lines.extend(table::lines(&rows, &[0]));
    if shot.origin == Origin::Measured && shot.timestamp_ns > 0 {
        lines.push(format!("  date of the file: {}", utc(shot.timestamp_ns)));
    }
    let notes = shot.captures.iter().flat_map(|capture| {
        capture.notes.iter().map(|note| format!("{}: {note}", capture.waveform.source))
    });
    lines.extend(table::joined(notes).iter().map(|note| format!("  {note}")));
    if !shot.truth.is_empty() {
        lines.push(format!("  and {} simulated signals (true forces, motion)", shot.truth.len()));
    }
    lines
}

fn capture_row(capture: &Capture) -> Vec<String> {
    let waveform = &capture.waveform;
    let preamble = &waveform.preamble;
    let extremes = waveform.extremes();
    let extreme = |which: usize| {
        let value = extremes.and_then(|extremes| extremes.get(which).copied());
        value.map_or("-".to_owned(), |value| engineering(value, &preamble.y_unit, 4))
    };
    vec![
        waveform.source.to_string(),
        waveform.codes.len().to_string(),
        engineering(waveform.vertical.scale, &format!("{}/div", preamble.y_unit), 3),
        // Zero without a sign.
        format!("{} div", waveform.vertical.position + 0.0),
        waveform.vertical.coupling.map_or("?".to_owned(), |c| c.to_string()),
        engineering(waveform.horizontal_scale, &format!("{}/div", preamble.x_unit), 3),
        ((1e3 * waveform.trigger_point).round() / 1e3).to_string(),
        extreme(0),
        extreme(1),
        waveform.clipped().to_string(),
    ]
}

/// A time in nanoseconds since 1970 as date and time of day, UTC. Calendar: E. M. Reingold and N.
/// Dershowitz, Calendrical Calculations (2018), with March as the first month of a year.
pub fn utc(nanoseconds: u64) -> String {
    let seconds = nanoseconds / 1_000_000_000;
    let (days, second) = (seconds / 86_400 + 719_468, seconds % 86_400);
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    let (hour, minute, second) = (second / 3600, second / 60 % 60, second % 60);
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_of_the_calendar() {
        for (seconds, text) in [
            (0, "1970-01-01 00:00:00 UTC"),
            (951_782_400, "2000-02-29 00:00:00 UTC"),
            (1_677_771_087, "2023-03-02 15:31:27 UTC"),
            (4_102_444_799, "2099-12-31 23:59:59 UTC"),
        ] {
            assert_eq!(utc(seconds * 1_000_000_000), text);
        }
    }
}
