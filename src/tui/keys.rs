//! Keys to actions: one table, from which the help and the line of hints are made too; the keys
//! themselves stand in `bindings`.

mod binding;
mod bindings;
mod mouse;

pub use binding::{Binding, BindingScope, KeyPress};

use ratatui::crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::layout::Position;

use crate::tui::axis::TurnDirection;
use crate::tui::model::{Action, Popup, ScreenState};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::target::target;

pub use bindings::{GROUPS, KNOB_HINTS, RECORDING_HINTS, bindings, hints};
pub use mouse::{mouse_action, reading_action};

/// The action of a key press under `panel`; `None` for unbound keys.
pub fn key_action(event: KeyEvent, panel: Popup) -> Option<Action> {
    if event.kind == KeyEventKind::Release {
        return None;
    }
    if matches!(panel, Popup::Prompt | Popup::Search) {
        return typed(event);
    }
    bindings()
        .filter(|binding| match binding.place {
            BindingScope::Everywhere => true,
            BindingScope::Scope => panel == Popup::Scope,
            BindingScope::Panels => panel != Popup::Scope,
        })
        .flat_map(|binding| binding.keys)
        .find(|(key, _)| *key == pressed(event))
        .map(|(_, action)| *action)
}

/// A key event as the table writes it: terminals differ in whether a capital letter comes with
/// Shift.
fn pressed(event: KeyEvent) -> KeyPress {
    let told_apart = match event.code {
        KeyCode::Char(_) | KeyCode::BackTab => KeyModifiers::CONTROL | KeyModifiers::ALT,
        _ => KeyModifiers::CONTROL | KeyModifiers::ALT | KeyModifiers::SHIFT,
    };
    KeyPress { code: event.code, modifiers: event.modifiers & told_apart }
}

/// The action of a key on the command line, or where a search is typed.
fn typed(event: KeyEvent) -> Option<Action> {
    let control = event.modifiers.contains(KeyModifiers::CONTROL);
    match event.code {
        KeyCode::Enter => Some(Action::Submit),
        KeyCode::Esc => Some(Action::Back),
        KeyCode::Backspace => Some(Action::Erase),
        KeyCode::Char('c') if control => Some(Action::Back),
        KeyCode::Tab => Some(Action::Complete),
        KeyCode::Up => Some(Action::Recall(TurnDirection::Up)),
        KeyCode::Down => Some(Action::Recall(TurnDirection::Down)),
        KeyCode::Char(letter) if !control => Some(Action::Type(letter)),
        _ => None,
    }
}

/// The action of a terminal event; `None` for a mere redraw.
pub fn action(event: &Event, model: &ScreenState, layout: Option<&ScreenLayout>) -> Option<Action> {
    let panel = model.panel();
    match event {
        Event::Key(key) => key_action(*key, panel),
        Event::Mouse(mouse) => {
            let at = Position::new(mouse.column, mouse.row);
            let layout_below = layout.filter(|_| panel == Popup::Scope);
            let reading = layout_below.and_then(|layout| target(model, layout, at));
            match reading {
                Some(reading) => reading_action(*mouse, reading),
                // A list is scrolled as a panel's text is.
                None if model.is_list() => mouse_action(*mouse, Popup::Log, layout),
                None => mouse_action(*mouse, panel, layout),
            }
        }
        _ => None,
    }
}
