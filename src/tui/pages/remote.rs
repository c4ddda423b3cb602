//! The messages of the remote interface around a shot.

use ratatui::Frame;
use ratatui::style::{Modifier, Style};
use ratatui::text::Line;

use super::list::{self, List};
use crate::recording::{Direction, ScpiLine, Shot};
use crate::tui::model::{Page, PageSpec, ScreenState};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::panel::message;

/// Bytes of a message that are shown at most: more never fit.
const MAX_SHOWN_BYTES: usize = 2000;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "remote",
    key: 'r',
    help: "remote commands and replies around the shot",
    keys: list::KEYS,
    hints: &[
        ("?", "help"),
        ("Esc", "traces"),
        ("↑ ↓", "message"),
        ("PgUp PgDn", "10 rows"),
        (", .", "shot"),
        ("w", "save"),
    ],
    is_wide: true,
    rows: Some(|model| remote_messages(model).len()),
    opened: select_shot,
    shot_changed: select_shot,
    draw,
    ..PageSpec::PLAIN
});

/// Selects the row of the shot.
fn select_shot(model: &mut ScreenState) {
    let place = remote_messages(model).iter().position(Option::is_none);
    model.row = place.unwrap_or_default();
}

/// Messages of the remote interface from the shot before this one to the one after it, in
/// order; `None` stands where this one does.
fn remote_messages(model: &ScreenState) -> Vec<Option<&ScpiLine>> {
    let Some(here) = model.shot().map(|shot| shot.timestamp_ns) else { return Vec::new() };
    let times = || model.recordings.front().set.shots.iter().map(|shot: &Shot| shot.timestamp_ns);
    let from = times().filter(|at| *at < here).max().map_or(0, |at| at + 1);
    let to = times().filter(|at| *at > here).min().unwrap_or(u64::MAX);
    let inside = |line: &&ScpiLine| (from..=to).contains(&line.timestamp_ns);
    let lines: Vec<&ScpiLine> = model.recordings.front().set.lines.iter().filter(inside).collect();
    if lines.is_empty() {
        return Vec::new();
    }
    let (before, after) = lines.split_at(lines.partition_point(|l| l.timestamp_ns <= here));
    let before = before.iter().copied().map(Some);
    before.chain([None]).chain(after.iter().copied().map(Some)).collect()
}

fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let messages = remote_messages(model);
    let Some(shot) = model.shot().filter(|_| !messages.is_empty()) else {
        let words = "no remote commands around this shot: recordings of `serve --record` hold them";
        return message(words, layout.page, frame);
    };
    let mut peers: Vec<&str> = messages.iter().flatten().map(|line| line.peer.as_str()).collect();
    peers.sort_unstable();
    peers.dedup();
    let row = |message: Option<&ScpiLine>| {
        let Some(line) = message else {
            return Line::styled(
                format!("{:>12} ─── shot {} ───", "0 s", shot.number),
                Style::new().add_modifier(Modifier::BOLD),
            );
        };
        let arrow = match line.direction {
            Direction::Command => '>',
            Direction::Reply => '<',
        };
        let port = line.peer.rsplit(':').next().unwrap_or_default();
        let peer = if peers.len() > 1 { format!("{port:>6} ") } else { String::new() };
        Line::raw(format!(
            "{:>+10.3} s {peer}{arrow} {}",
            seconds_after(line, shot.timestamp_ns),
            text(line)
        ))
    };
    let rows = messages.iter().copied().map(row).collect();
    let commands = messages.iter().flatten().filter(|l| l.direction == Direction::Command).count();
    let replies = messages.iter().flatten().count() - commands;
    let clients = match peers.as_slice() {
        [peer] => (*peer).to_owned(),
        peers => format!("{} clients", peers.len()),
    };
    let head = format!(
        "Around shot {}: {commands} commands (>), {replies} replies (<), {clients}",
        shot.number
    );
    let selected = messages.get(model.row).copied().flatten().map_or_else(String::new, |line| {
        format!("{}, {}: {}", clock_time(line.timestamp_ns), line.peer, text(line))
    });
    let head = vec![Line::styled(head, Style::new().add_modifier(Modifier::BOLD))];
    let list = List { head, rows, selected, foot: String::new() };
    list::draw(model, list, layout.page, frame);
}

/// From a shot to a message (s).
fn seconds_after(line: &ScpiLine, shot_ns: u64) -> f64 {
    (i128::from(line.timestamp_ns) - i128::from(shot_ns)) as f64 * 1e-9
}

/// Time of the day.
fn clock_time(timestamp_ns: u64) -> String {
    let milliseconds = timestamp_ns / 1_000_000;
    let seconds = milliseconds / 1000;
    let (minutes, hours) = (seconds / 60, seconds / 3600);
    format!(
        "{:02}:{:02}:{:02}.{:03} UTC",
        hours % 24,
        minutes % 60,
        seconds % 60,
        milliseconds % 1000
    )
}

/// A message as a line of text; of a reply's binary block the length.
fn text(line: &ScpiLine) -> String {
    let bytes = line.bytes.trim_ascii_end();
    let digits = |place: &usize| match bytes.get(*place..) {
        Some([b'#', count @ b'1'..=b'9', ..]) => Some(usize::from(count - b'0')),
        _ => None,
    };
    let block = (0..bytes.len()).find_map(|place| Some(place + 2 + digits(&place)?));
    match block.filter(|_| line.direction == Direction::Reply) {
        Some(end) => {
            let head = bytes.get(..end).unwrap_or(bytes).escape_ascii();
            format!("{head}… {} bytes in all", line.bytes.len())
        }
        None => bytes.get(..MAX_SHOWN_BYTES).unwrap_or(bytes).escape_ascii().to_string(),
    }
}
