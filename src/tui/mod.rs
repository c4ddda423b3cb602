//! The scope's screen in a terminal: `hertzscope view` shows a recording on it, or a bench that can
//! be played with.
//!
//! An event becomes an [`model::Action`] (`keys`), an action changes the [`ScreenState`] (`model`),
//! the model is drawn (`view`, `pages`). What takes long or touches files is a [`job::Job`]:
//! threads (`work`) do it, and its result is a change of the model that comes through the same
//! channel as the keys. Only this file, `work` and the jobs touch the world; everything else can be
//! tested without one.
//!
//! The screen is drawn again when something has happened and never otherwise. Events that are
//! already waiting are taken together, so that holding a key down over a slow connection does not
//! pile up frames.

pub mod axis;
pub mod job;
pub mod key;
pub mod keys;
pub mod model;
pub mod pages;
pub mod view;
pub mod work;

use std::io;
use std::panic;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{DisableMouseCapture, EnableMouseCapture, Event};
use ratatui::crossterm::execute;
use ratatui::layout::{Position, Rect, Size};

use crate::recording::TraceSet;
use crate::recording::mcap::IndexedRecording;
use model::{Action, NoteOption, Palette, ScreenState};
use work::served::ServedConnection;
use work::{ScreenEvent, Workers};

/// A picture is at most so much older than the first event that changed it.
const MAX_FRAME_DELAY: Duration = Duration::from_millis(33);

/// The source of the shown data.
pub enum ViewSource {
    /// A recording that is in memory.
    Set(Box<TraceSet>),
    /// A recording that is read as it is looked at, and whether its newest shot is followed.
    IndexedRecording(Box<IndexedRecording>, bool),
    /// The bench of a scene: a name that ships, or a whole path.
    Bench(String),
    /// A scope that is served somewhere else.
    Served(Box<ServedConnection>),
}

/// Shows `subject` under the name `title` until the user quits, `behind` it the recordings with
/// these names, held against `against` if that is there.
///
/// Takes over the terminal and gives it back, after a panic too. Colours are left out where the
/// environment variable `NO_COLOR` is set and not empty.
///
/// # Errors
/// When the terminal cannot be set up, read or written.
pub fn run(
    subject: ViewSource,
    title: String,
    behind: Vec<(String, TraceSet)>,
    against: Option<String>,
    note_option: NoteOption,
) -> io::Result<()> {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let palette = if plain { Palette::Plain } else { Palette::Colour };
    let (mut recording, mut scope, mut is_followed) = (None, None, false);
    let mut model = ScreenState::new(TraceSet::default(), title.clone(), palette);
    match subject {
        ViewSource::Set(set) => model = ScreenState::new(*set, title, palette),
        ViewSource::IndexedRecording(file, follow) => {
            model.open_partial_recording(follow);
            (recording, is_followed) = (Some(*file), follow);
        }
        ViewSource::Bench(base) => model.open_bench(base),
        ViewSource::Served(served) => {
            model.open_served();
            scope = Some(*served);
        }
    }
    for (title, set) in behind {
        model.add_behind(title, set);
    }
    model.note_with(note_option);
    if let Some(against) = against {
        model.compare_with(against);
    }
    on_terminal(|terminal| {
        let (mut workers, events) = Workers::start(recording, is_followed);
        if let Some(scope) = scope {
            workers.watch(scope);
        }
        workers.listen();
        show(terminal, &mut model, &workers, &events)
    })
}

/// Runs `work` on the terminal's alternate screen with the mouse, and restores the terminal, after
/// a panic of this thread too.
///
/// # Errors
/// Those of `work`, or when the terminal cannot be set up or restored.
pub fn on_terminal(work: impl FnOnce(&mut DefaultTerminal) -> io::Result<()>) -> io::Result<()> {
    let mut terminal = ratatui::try_init()?;
    let result = watch_mouse().and_then(|()| work(&mut terminal));
    let mouse = execute!(io::stdout(), DisableMouseCapture);
    let restored = ratatui::try_restore();
    result.and(mouse).and(restored)
}

/// Asks the terminal for the mouse; a panic of the screen hands the mouse back before the terminal
/// is restored. One in a thread that works for the screen leaves the terminal alone: the screen
/// goes on, and tells of it.
fn watch_mouse() -> io::Result<()> {
    let restore_terminal = panic::take_hook();
    let screen = thread::current().id();
    panic::set_hook(Box::new(move |info| {
        if thread::current().id() != screen {
            return;
        }
        // Nothing can be done about a terminal that does not answer during a panic.
        let _ = execute!(io::stdout(), DisableMouseCapture);
        restore_terminal(info);
    }));
    execute!(io::stdout(), EnableMouseCapture)
}

/// Draws, waits, acts, until the model stops.
fn show(
    terminal: &mut DefaultTerminal,
    model: &mut ScreenState,
    workers: &Workers,
    events: &Receiver<ScreenEvent>,
) -> io::Result<()> {
    let mut clock = PlayClock::default();
    while model.is_running() {
        terminal.draw(|frame| view::draw(model, frame))?;
        let size = terminal.size()?;
        workers.serve(model, size);
        let mut wait = if model.is_playing() { Some(MAX_FRAME_DELAY) } else { None };
        let mut first = None;
        // Something that changes the picture, and then whatever is waiting already.
        while let Some(event) = next(events, wait) {
            if !take(event, size, model) {
                continue;
            }
            workers.serve(model, size);
            let since: &Instant = first.get_or_insert_with(Instant::now);
            if !model.is_running() || since.elapsed() >= MAX_FRAME_DELAY {
                break;
            }
            wait = Some(Duration::ZERO);
        }
        if let Some(seconds) = clock.elapsed(Instant::now(), model.is_playing()) {
            model::update(model, Action::Tick(seconds));
        }
    }
    Ok(())
}

/// Measures the time that is played: all of it since the last tick, drawing included.
#[derive(Debug, Default)]
struct PlayClock(Option<Instant>);

impl PlayClock {
    /// Time since the last call (s); none at the first call of a time of playing.
    fn elapsed(&mut self, now: Instant, is_playing: bool) -> Option<f64> {
        let before = std::mem::replace(&mut self.0, is_playing.then_some(now));
        let before = before.filter(|_| is_playing)?;
        Some(now.duration_since(before).as_secs_f64())
    }
}

/// The next event, for which it waits at most `wait`, or for ever.
fn next(events: &Receiver<ScreenEvent>, wait: Option<Duration>) -> Option<ScreenEvent> {
    match wait {
        None => Some(events.recv().unwrap_or(ScreenEvent::Closed)),
        Some(wait) => match events.recv_timeout(wait) {
            Ok(event) => Some(event),
            Err(RecvTimeoutError::Timeout) => None,
            Err(RecvTimeoutError::Disconnected) => Some(ScreenEvent::Closed),
        },
    }
}

/// Lets one event act on the model; whether the picture has to be drawn again.
fn take(event: ScreenEvent, size: Size, model: &mut ScreenState) -> bool {
    match event {
        ScreenEvent::Terminal(event) => return press(&event, size, model),
        ScreenEvent::Closed => model::update(model, Action::Quit),
        other => other.apply(model),
    }
    true
}

/// Lets one event of the terminal act on the model; the mouse moves often and means something
/// seldom.
fn press(event: &Event, size: Size, model: &mut ScreenState) -> bool {
    let layout = view::layout_of(model, Rect::from((Position::ORIGIN, size)));
    match keys::action(event, model, layout.as_ref()) {
        Some(action) => {
            model::update(model, action);
            true
        }
        None => matches!(event, Event::Resize(..)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_time_between_two_ticks_is_played() {
        let start = Instant::now();
        let at = |milliseconds| start + Duration::from_millis(milliseconds);
        let mut clock = PlayClock::default();
        assert_eq!(clock.elapsed(at(0), false), None);
        assert_eq!(clock.elapsed(at(500), true), None);
        let ticks = [533, 600, 633].map(|now| clock.elapsed(at(now), true).expect("a tick"));
        assert!((ticks.iter().sum::<f64>() - 0.133).abs() < 1e-12, "{ticks:?}");
        assert_eq!(clock.elapsed(at(900), false), None);
        assert_eq!(clock.elapsed(at(1000), true), None);
    }
}
