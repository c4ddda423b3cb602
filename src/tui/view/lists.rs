//! Pages that are lists: effects and hard cases as the commands of these names print them, and the
//! messages of the remote interface around a shot. The selected row stands below in full.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::Paragraph;

use super::accuracy::busy;
use super::layout::ScreenLayout;
use super::panel::wrapped;
use super::{colour, message};
use crate::recording::{Direction, ScpiLine};
use crate::studies::effects::EffectState;
use crate::tui::model::{JobState, Page, ScreenState};

/// Rows of a list that are shown at least, before what stands below it.
const LEAST_ROWS: u16 = 8;
/// What a command prints on reasons, which stand below the list here.
const WHY: &str = "--why";
/// Bytes of a message that are looked at: more never fit.
const MOST_BYTES: usize = 2000;

/// A list with what stands above and below it.
struct List {
    head: Vec<Line<'static>>,
    rows: Vec<Line<'static>>,
    /// The selected row in full.
    selected: String,
    /// Shown where there is room.
    foot: String,
}

/// Draws the page.
pub(super) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let list = match model.page() {
        Page::Effects => effects(model),
        Page::HardCases => hard_cases(model),
        _ => remote(model),
    };
    match list {
        Ok(list) => list_of(model, list, area, frame),
        Err(Waiting::Computing(what, share)) => busy(what, share, area, frame),
        Err(Waiting::Nothing(words)) => message(&words, area, frame),
    }
}

/// Why there is no list.
enum Waiting {
    Computing(&'static str, f64),
    Nothing(String),
}

/// The result of a job, or what is shown without it.
fn done<'a, T>(
    job: &'a JobState<T>,
    (what, again): (&'static str, &str),
) -> Result<&'a T, Waiting> {
    match job {
        JobState::Done(result) => Ok(result),
        JobState::Busy(share) => Err(Waiting::Computing(what, *share)),
        JobState::Failed(problem) => Err(Waiting::Nothing(problem.clone())),
        JobState::Idle => Err(Waiting::Nothing(again.to_owned())),
    }
}

/// A printed table in three parts: lines before the row of the first name, the rows, lines after
/// that of the last name.
fn parts(printed: &str, names: &[&str]) -> List {
    let is_row = |line: &str, name: &str| {
        line.trim_start()
            .strip_prefix(name)
            .is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
    };
    let lines: Vec<&str> = printed.lines().filter(|line| !line.is_empty()).collect();
    let first = lines.iter().position(|line| names.first().is_some_and(|name| is_row(line, name)));
    let (head, rest) = lines.split_at(first.unwrap_or(lines.len()));
    let (rows, foot) = rest.split_at(names.len().min(rest.len()));
    let raw = |lines: &[&str]| lines.iter().map(|line| Line::raw((*line).to_owned())).collect();
    let foot = foot.join(" ");
    let foot = foot.split(WHY).next().unwrap_or_default().trim_end_matches([' ', '(']).to_owned();
    List { head: raw(head), rows: raw(rows), selected: String::new(), foot }
}

fn effects(model: &ScreenState) -> Result<List, Waiting> {
    let words =
        ("effects, each with and without", "another bench than was measured: y, y asks again");
    let ledger = done(&model.questions().ledger, words)?;
    let names: Vec<&str> = ledger.entries.iter().map(|entry| entry.effect).collect();
    let mut list = parts(&model.tables().map_or_else(String::new, |t| (t.effects)(ledger)), &names);
    for (row, entry) in list.rows.iter_mut().zip(&ledger.entries) {
        let tint = match entry.state {
            EffectState::On => Color::LightGreen,
            EffectState::Auto => Color::Yellow,
            EffectState::Off => Color::Gray,
        };
        row.style = Style::new().fg(colour(model.palette(), tint));
    }
    let entry = ledger.entries.get(model.row());
    list.selected = entry.map_or_else(String::new, |entry| {
        let value = entry.value.map_or("not known".to_owned(), |value| match value.abs() {
            size if size == 0.0 || (1e-2..1e3).contains(&size) => format!("{value:.3}"),
            _ => format!("{value:.1e}"),
        });
        format!("{}: {} = {value}; {}", entry.effect, entry.criterion, entry.reason)
    });
    Ok(list)
}

fn hard_cases(model: &ScreenState) -> Result<List, Waiting> {
    let cases = done(&model.questions().hard_cases, ("the hard cases", "h, h asks again"))?;
    let names: Vec<&str> = cases.iter().map(|case| case.case).collect();
    let mut list =
        parts(&model.tables().map_or_else(String::new, |t| (t.hard_cases)(cases)), &names);
    list.selected = cases.get(model.row()).map_or_else(String::new, |case| {
        let [why, bound, figure] =
            [case.why, case.bound, &case.figure].map(|t| t.trim_end_matches('.'));
        format!("{}: {why}. Bound: {bound}. Figure: {figure}.", case.case)
    });
    Ok(list)
}

fn remote(model: &ScreenState) -> Result<List, Waiting> {
    let messages = model.remote_messages();
    let Some(shot) = model.shot().filter(|_| !messages.is_empty()) else {
        let words = "no remote commands around this shot: recordings of `serve --record` hold them";
        return Err(Waiting::Nothing(words.to_owned()));
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
    let selected = messages.get(model.row()).copied().flatten().map_or_else(String::new, |line| {
        format!("{}, {}: {}", clock_time(line.timestamp_ns), line.peer, text(line))
    });
    let head = vec![Line::styled(head, Style::new().add_modifier(Modifier::BOLD))];
    Ok(List { head, rows, selected, foot: String::new() })
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
        None => bytes.get(..MOST_BYTES).unwrap_or(bytes).escape_ascii().to_string(),
    }
}

/// Draws as many rows around the selected one as there is room for.
fn list_of(model: &ScreenState, list: List, area: Rect, frame: &mut Frame) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    let height = |lines: &[Line]| u16::try_from(lines.len()).unwrap_or(u16::MAX);
    let width = usize::from(area.width);
    let styled = |text: &str, style: Style| -> Vec<Line<'static>> {
        wrapped(text, width).into_iter().map(|line| Line::styled(line, style)).collect()
    };
    let free = area.height.saturating_sub(height(&list.head));
    let mut below = styled(&list.selected, bold);
    below.truncate(usize::from(free.saturating_sub(LEAST_ROWS)));
    let foot = styled(&list.foot, grey);
    // A sentence is always shown, an explanation where all rows are.
    let rows = if foot.len() > 1 { height(&list.rows) } else { LEAST_ROWS };
    if height(&below) + height(&foot) + rows <= free {
        below.extend(foot);
    }
    let rows = usize::from(free - height(&below).min(free)).min(list.rows.len());
    let first = model.row().saturating_sub(rows / 2).min(list.rows.len() - rows);
    let mut lines = list.head;
    let shown = list.rows.into_iter().enumerate().skip(first).take(rows);
    lines.extend(shown.map(|(place, mut row)| {
        if place == model.row() {
            row.style = row.style.add_modifier(Modifier::REVERSED);
        }
        row
    }));
    lines.extend(below);
    frame.render_widget(Paragraph::new(lines), area);
}
