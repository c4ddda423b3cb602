//! The chain in motion, from the truth of a simulated shot: the force in every contact now, the
//! beads where they are, and above them the same for all times, so that pulses are seen as slanted
//! stripes.

use std::cmp::Ordering;

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use crate::recording::TrueSignal;
use crate::scene::{Scene, Site};
use crate::trace::Trace;
use crate::tui::axis::Steps;
use crate::tui::model::{Action, DerivedPart, FilmScales, Page, PageSpec, ScreenState};
use crate::tui::view::axes::put;
use crate::tui::view::colours::colour;
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::layout::whole;
use crate::tui::view::panel::message;
use crate::tui::view::readout::spelled;

/// Eighths of a cell, from nothing to full.
const EIGHTHS: [&str; 9] = [" ", "▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"];
/// On top of a bar that the scale cuts.
const BEYOND: &str = "▲";
/// Share by which a force that is as large as the scale may exceed it (1).
const ROUNDING: f64 = 1e-9;
/// Tones of the stripes, from little to much force.
const TONES: [&str; 5] = [" ", "·", "░", "▒", "█"];
/// Rows of the page that are neither bars nor stripes.
const FIXED_ROWS: u16 = 5;
/// One contact in so many may go beyond the scale: the striker's own is far above the others.
const OUTLIER_DIVISOR: usize = 10;
/// Columns left of the chain.
const LABEL_COLUMNS: u16 = 9;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "motion",
    key: 'b',
    help: "the chain in motion; Space , . < > work on it",
    hints: &[
        ("?", "help"),
        ("Esc", "traces"),
        ("Space", "play"),
        (", .", "frame"),
        ("< >", "slower, faster"),
        (":", "seek TIME"),
        ("n - +", "knob"),
        ("w", "save"),
    ],
    act,
    derive,
    draw,
    ..PageSpec::PLAIN
});

/// Steps from one end of the film to the other.
const FILM_STEPS: f64 = 200.0;
/// Slow motion of the film at speed 1: seconds of the bench in a second (1).
const PLAYBACK_TIME_SCALE: f64 = 1e-3;

/// The film is played, not the recording.
fn act(model: &mut ScreenState, action: Action) -> bool {
    let step = model.film_span().map(|(start, end)| (end - start) / FILM_STEPS);
    match (action, step) {
        (Action::RunStop, _) => model.play.running = !model.play.running,
        (Action::Shot(turn), Some(step)) => model.seek(turn.sign() * step),
        (Action::Tick(seconds), _) if model.play.running => {
            model.seek(seconds * model.play.speed * PLAYBACK_TIME_SCALE);
        }
        _ => return false,
    }
    true
}

impl ScreenState {
    /// Moves the bench's film by `seconds` of its own time (s); beyond its end it starts again.
    pub(in crate::tui) fn seek(&mut self, seconds: f64) {
        let Some((start, end)) = self.film_span() else { return };
        let time = self.play.bench_time + seconds;
        self.play.bench_time = if time > end {
            start
        } else if time < start {
            end
        } else {
            time
        };
    }

    /// First and last time of the film on the bench's own clock; none where the shot has none (s).
    pub fn film_span(&self) -> Option<(f64, f64)> {
        let is_contact =
            |trace: &&Trace| matches!(TrueSignal::of(trace), Some(TrueSignal::Contact(_)));
        let film = self.shot()?.truth.iter().find(is_contact)?;
        Some((film.start, film.time(film.values.len().checked_sub(1)?)))
    }
}

/// The motion of a shot: contacts and beads from the top, each with its place in the chain.
struct Film<'a> {
    contacts: Vec<(usize, &'a Trace)>,
    beads: Vec<(usize, &'a Trace)>,
    scales: FilmScales,
}

/// Traces of one kind with their numbers, in order.
fn numbered(truth: &[Trace], number: fn(&TrueSignal) -> Option<usize>) -> Vec<(usize, &Trace)> {
    let traces = truth.iter();
    let mut found: Vec<(usize, &Trace)> =
        traces.filter_map(|trace| Some((number(&TrueSignal::of(trace)?)?, trace))).collect();
    found.sort_by_key(|(number, _)| *number);
    found
}

fn contact(signal: &TrueSignal) -> Option<usize> {
    match signal {
        TrueSignal::Contact(contact) => Some(*contact),
        _ => None,
    }
}

fn body(signal: &TrueSignal) -> Option<usize> {
    match signal {
        TrueSignal::Displacement(body) => Some(*body),
        _ => None,
    }
}

impl<'a> Film<'a> {
    fn of(model: &'a ScreenState) -> Option<Self> {
        let truth = &model.shot()?.truth;
        let contacts = numbered(truth, contact);
        let scales = model.derived().film?;
        (!contacts.is_empty()).then(|| Self { contacts, beads: numbered(truth, body), scales })
    }
}

/// The scales of the film, for a thread: they need all of it.
fn derive(model: &ScreenState) -> Option<DerivedPart> {
    let truth = model.shot()?.truth.clone();
    let scene = model.recordings.front().scene.as_ref();
    let has_striker = scene.is_none_or(|scene| scene.chain.has_striker());
    Some(Box::new(move |derived| {
        let contacts = numbered(&truth, contact);
        let mut dynamic: Vec<f64> = contacts.iter().map(|(_, trace)| largest(trace)).collect();
        dynamic.sort_by(f64::total_cmp);
        let place = dynamic.len().saturating_sub(1 + dynamic.len() / OUTLIER_DIVISOR);
        let strongest = dynamic.get(place).copied().unwrap_or(0.0);
        let beads = numbered(&truth, body);
        // A striker goes farther than all others.
        let others = usize::from(beads.first().is_some_and(|(body, _)| *body == 0 && has_striker));
        let farthest =
            beads.iter().skip(others).map(|(_, trace)| largest(trace)).fold(0.0, f64::max);
        derived.film = Some(FilmScales { strongest, farthest });
    }))
}

/// The static force (N).
fn rest(trace: &Trace) -> f64 {
    trace.values.first().copied().unwrap_or(0.0)
}

/// The largest change of a trace (unit).
fn largest(trace: &Trace) -> f64 {
    trace.values.iter().map(|value| (value - rest(trace)).abs()).fold(0.0, f64::max)
}

/// The value at a time, at the nearest frame (unit).
fn at(trace: &Trace, time: f64) -> Option<f64> {
    let frame = ((time - trace.start) / trace.interval).round().max(0.0) as usize;
    trace.values.get(frame.min(trace.values.len().checked_sub(1)?)).copied()
}

/// The largest change between two times (unit).
fn farthest_between(trace: &Trace, from: f64, to: f64) -> f64 {
    let rest = rest(trace);
    // Only frames between these times are looked at: this is called for every cell.
    let frame = |time: f64| ((time - trace.start) / trace.interval).ceil().max(0.0) as usize;
    let (first, end) = (frame(from), frame(to).min(trace.values.len()));
    let inside = trace.values.get(first..end).unwrap_or_default();
    let changes = inside.iter().map(|value| value - rest);
    changes.fold(0.0, |most: f64, change| if change.abs() > most.abs() { change } else { most })
}

/// Draws the page.
fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let (Some(film), Some((start, end))) = (Film::of(model), model.film_span()) else {
        let words = if model.derived().is_pending {
            "computing ..."
        } else {
            "this shot has no simulated motion: only simulations have it"
        };
        return message(words, area, frame);
    };
    let now = model.play.bench_time.clamp(start, end);
    heading(model, &film, (now, end), frame, area);
    let free = area.height.saturating_sub(FIXED_ROWS);
    let bars = free.min((free / 2).max(3));
    let stripes = Rect { y: area.y + 1, height: free - bars, ..area };
    let chain = Rect { y: stripes.bottom(), height: bars, ..area };
    stripes_of(model, &film, (start, end, now), stripes, frame);
    bars_of(model, &film, now, chain, frame);
    beads_of(model, &film, now, Rect { y: chain.bottom(), height: 2, ..area }, frame);
    time_line(model, (start, end, now), Rect { y: chain.bottom() + 3, height: 1, ..area }, frame);
}

fn heading(
    model: &ScreenState,
    film: &Film,
    (now, end): (f64, f64),
    frame: &mut Frame,
    area: Rect,
) {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let state = if model.is_playing() { "playing" } else { "paused" };
    let line = Line::from(vec![
        Span::styled("Forces along the chain  ", bold),
        Span::raw(format!("t {} of {}  ", spelled(now, "s", 4), spelled(end, "s", 3))),
        Span::raw(format!(
            "to +{}, ▲ more  {state}, {} ms/s",
            spelled(film.scales.strongest, "N", 3),
            model.play.speed
        )),
    ]);
    frame.render_widget(line, Rect { height: 1, ..area });
}

/// The contact behind a column of cells.
fn contact_at(column: u16, width: u16, count: usize) -> usize {
    usize::from(column) * count / usize::from(width.max(1))
}

/// All of the film: time downward, the chain to the right, tones by the force that was added.
/// Labels are round times, and the present one.
fn stripes_of(
    model: &ScreenState,
    film: &Film,
    (start, end, now): (f64, f64, f64),
    area: Rect,
    frame: &mut Frame,
) {
    let width = area.width.saturating_sub(LABEL_COLUMNS);
    let rows = f64::from(area.height.max(1));
    let round = Steps::OneTwoAndHalfFive.multiples((start, end), (end - start) / rows);
    for row in 0..area.height {
        let from = start + (end - start) * f64::from(row) / rows;
        let to = start + (end - start) * f64::from(row + 1) / rows;
        let here = (from..to).contains(&now) || (row + 1 == area.height && now >= to);
        let grey = Style::new().fg(colour(model.palette(), Color::Gray));
        let label_style = if here { grey.add_modifier(Modifier::REVERSED) } else { grey };
        let inside = round.iter().find(|(_, time)| (from..to).contains(time));
        let label = match inside {
            _ if here => spelled(now, "s", 3),
            Some((0, _)) => "0 s".to_owned(),
            Some((_, time)) => spelled(*time, "s", 3),
            None => String::new(),
        };
        put(
            frame.buffer_mut(),
            Rect { width: LABEL_COLUMNS - 1, ..area },
            area.y + row,
            &label,
            label_style,
        );
        for column in 0..width {
            let Some((_, trace)) =
                film.contacts.get(contact_at(column, width, film.contacts.len()))
            else {
                continue;
            };
            let added = farthest_between(trace, from, to);
            let (tone, style) = tone(model, added / film.scales.strongest);
            let place =
                Rect { x: area.x + LABEL_COLUMNS + column, y: area.y + row, width: 1, height: 1 };
            put(frame.buffer_mut(), place, place.y, tone, style);
        }
    }
}

/// A tone for a share of the strongest force; what was taken away is blue.
fn tone(model: &ScreenState, share: f64) -> (&'static str, Style) {
    const COLOURS: [Color; 5] =
        [Color::Reset, Color::DarkGray, Color::Yellow, Color::Yellow, Color::LightRed];
    let place = (share.abs() * 5.0).clamp(0.0, 4.0) as usize;
    let wanted =
        if share < 0.0 { Color::Blue } else { COLOURS.get(place).copied().unwrap_or(Color::Reset) };
    (TONES.get(place).copied().unwrap_or(" "), Style::new().fg(colour(model.palette(), wanted)))
}

/// The force in each contact now, upward, what pressed before included.
fn bars_of(model: &ScreenState, film: &Film, now: f64, area: Rect, frame: &mut Frame) {
    let width = area.width.saturating_sub(LABEL_COLUMNS);
    let pressed = film.contacts.iter().map(|(_, trace)| rest(trace)).fold(0.0, f64::max);
    let top = film.scales.strongest + pressed;
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    let labels = Rect { width: LABEL_COLUMNS - 1, ..area };
    put(frame.buffer_mut(), labels, area.y, &spelled(top, "N", 3), grey);
    put(frame.buffer_mut(), labels, area.bottom() - 1, "0 N", grey);
    let style = Style::new().fg(colour(model.palette(), Color::Yellow));
    for column in 0..width {
        let Some((_, trace)) = film.contacts.get(contact_at(column, width, film.contacts.len()))
        else {
            continue;
        };
        let force = at(trace, now).unwrap_or(0.0).max(0.0);
        let height = force / top * f64::from(area.height) * 8.0;
        let is_beyond = force > top * (1.0 + ROUNDING);
        for row in 0..area.height {
            let below = f64::from(area.height - 1 - row) * 8.0;
            let eighths = (height - below).round().clamp(0.0, 8.0) as usize;
            let place =
                Rect { x: area.x + LABEL_COLUMNS + column, y: area.y + row, width: 1, height: 1 };
            let sign = EIGHTHS.get(eighths).copied().unwrap_or(" ");
            let sign = if is_beyond && row == 0 { BEYOND } else { sign };
            put(frame.buffer_mut(), place, place.y, sign, style);
        }
    }
}

/// The beads: light ones small, those with a sensor numbered below; shifted to where they have
/// moved where there is room, the farthest by a place less a cell.
fn beads_of(model: &ScreenState, film: &Film, now: f64, area: Rect, frame: &mut Frame) {
    let width = area.width.saturating_sub(LABEL_COLUMNS);
    let count = film.beads.len();
    let farthest = film.scales.farthest;
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    put(frame.buffer_mut(), Rect { width: LABEL_COLUMNS - 1, ..area }, area.y, "beads", grey);
    for (place, (body, trace)) in film.beads.iter().enumerate() {
        let moved = at(trace, now).unwrap_or(0.0) - rest(trace);
        let (sign, style) = bead(model, *body, moved, farthest);
        let room = (usize::from(width) / count.max(1)).saturating_sub(1) as f64;
        let share = if farthest > 0.0 { (moved / farthest).clamp(-1.0, 1.0) } else { 0.0 };
        let rest = (place * usize::from(width) / count.max(1)) as f64;
        let shifted = (rest + share * room).round().clamp(0.0, f64::from(width.max(1) - 1));
        let x = area.x + LABEL_COLUMNS + shifted as u16;
        put(frame.buffer_mut(), Rect { x, width: 1, ..area }, area.y, sign, style);
    }
    let Some(scene) = model.recordings.front().scene.as_ref() else { return };
    for sensor in &scene.sensors {
        let body = match sensor.site {
            Site::Particle(particle) => scene.chain.body_of(particle),
            Site::Wall => count.saturating_sub(1),
        };
        let x = area.x
            + LABEL_COLUMNS
            + u16::try_from(body * usize::from(width) / count.max(1)).unwrap_or(0);
        let name = format!("↑{}", sensor.name);
        let room = Rect { x, width: area.right().saturating_sub(x), ..area };
        put(frame.buffer_mut(), room, area.y + 1, &name, grey);
    }
}

/// A bead's sign: its size by its mass, its colour by which way it has moved and how far.
fn bead(model: &ScreenState, body: usize, moved: f64, farthest: f64) -> (&'static str, Style) {
    let heavy = |scene: &Scene| {
        let bodies = scene.chain.bodies();
        let heaviest = bodies.iter().skip(1).map(|body| body.mass).fold(0.0, f64::max);
        bodies.get(body).is_some_and(|body| body.mass > 0.5 * heaviest)
    };
    let sign =
        if model.recordings.front().scene.as_ref().is_some_and(heavy) { "●" } else { "•" };
    let share = if farthest > 0.0 { moved / farthest } else { 0.0 };
    let wanted = if share > 0.05 {
        Color::LightRed
    } else if share < -0.05 {
        Color::LightBlue
    } else {
        Color::White
    };
    let style = Style::new().fg(colour(model.palette(), wanted));
    (sign, if share.abs() > 0.5 { style.add_modifier(Modifier::BOLD) } else { style })
}

fn time_line(
    model: &ScreenState,
    (start, end, now): (f64, f64, f64),
    area: Rect,
    frame: &mut Frame,
) {
    let width = area.width.saturating_sub(LABEL_COLUMNS);
    let done = whole((now - start) / (end - start) * f64::from(width.saturating_sub(1)));
    let line: String = (0..width)
        .map(|x| match x.cmp(&done) {
            Ordering::Equal => '●',
            Ordering::Less => '━',
            Ordering::Greater => '─',
        })
        .collect();
    let style = Style::new().fg(colour(model.palette(), Color::Cyan));
    put(
        frame.buffer_mut(),
        Rect { x: area.x + LABEL_COLUMNS, width, ..area },
        area.y,
        &line,
        style,
    );
    let grey = Style::new().fg(colour(model.palette(), Color::Gray));
    put(frame.buffer_mut(), Rect { width: LABEL_COLUMNS - 1, ..area }, area.y, "time", grey);
}
