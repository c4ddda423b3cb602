//! The scope's screen in a terminal: `hertzscope view FILE` shows a recording on it.
//!
//! The last room of the house: it reads a [`TraceSet`] and is read by people. An event becomes an
//! [`model::Action`] (`keys`), an action changes the [`Model`] (`model`), the model is drawn (`view`). Only this
//! file touches the terminal; everything else can be tested without one.
//!
//! The screen is drawn again when something has happened and never otherwise. Events that are already waiting
//! are taken together, so that holding a key down over a slow connection does not pile up frames.

pub mod axis;
pub mod keys;
pub mod model;
pub mod view;

use std::io;
use std::panic;
use std::time::{Duration, Instant};

use ratatui::DefaultTerminal;
use ratatui::crossterm::event::{self, DisableMouseCapture, EnableMouseCapture, Event};
use ratatui::crossterm::execute;
use ratatui::layout::{Position, Rect, Size};

use crate::recording::TraceSet;
use model::{Model, Palette};
use view::layout::Layout;

/// A picture is at most so much older than the first event that changed it.
const LONGEST_WAIT: Duration = Duration::from_millis(33);

/// Shows `set` under the name `title` until the user quits.
///
/// Takes over the terminal and gives it back, after a panic too. Colours are left out where the environment
/// variable `NO_COLOR` is set and not empty.
///
/// # Errors
/// When the terminal cannot be set up, read or written.
pub fn run(set: TraceSet, title: String) -> io::Result<()> {
    let plain = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let palette = if plain { Palette::Plain } else { Palette::Colour };
    let mut model = Model::new(set, title, palette);
    let mut terminal = ratatui::try_init()?;
    let result = watch_mouse().and_then(|()| show(&mut terminal, &mut model));
    let mouse = execute!(io::stdout(), DisableMouseCapture);
    let restored = ratatui::try_restore();
    result.and(mouse).and(restored)
}

/// Asks the terminal for the mouse wheel; a panic hands the mouse back before the terminal is restored.
fn watch_mouse() -> io::Result<()> {
    let restore_terminal = panic::take_hook();
    panic::set_hook(Box::new(move |info| {
        // Nothing can be done about a terminal that does not answer during a panic.
        let _ = execute!(io::stdout(), DisableMouseCapture);
        restore_terminal(info);
    }));
    execute!(io::stdout(), EnableMouseCapture)
}

/// Draws, waits, acts, until the model stops.
fn show(terminal: &mut DefaultTerminal, model: &mut Model) -> io::Result<()> {
    while model.is_running() {
        terminal.draw(|frame| view::draw(model, frame))?;
        let mut stale = false;
        while !stale {
            stale = take(&event::read()?, terminal.size()?, model);
        }
        let started = Instant::now();
        while model.is_running() && started.elapsed() < LONGEST_WAIT && event::poll(Duration::ZERO)?
        {
            take(&event::read()?, terminal.size()?, model);
        }
    }
    Ok(())
}

/// Lets one event act on the model; whether the picture has to be drawn again.
fn take(event: &Event, size: Size, model: &mut Model) -> bool {
    let layout = Layout::new(Rect::from((Position::ORIGIN, size)));
    match keys::action(event, model.panel(), layout.as_ref()) {
        Some(action) => {
            model::update(model, action);
            true
        }
        None => matches!(event, Event::Resize(..)),
    }
}
