//! Keys to actions: one table, from which the help and the line of hints are made too; the keys
//! themselves stand in `bindings`.

mod bindings;
mod mouse;

use ratatui::crossterm::event::{Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers};
use ratatui::layout::Position;
use tui_input::InputRequest;

use crate::tui::axis::TurnDirection;
use crate::tui::key::KeyPress;
use crate::tui::model::{Action, Page, Popup, ScreenState};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::target::target;

pub use bindings::{
    Binding, BindingScope, HelpRow, KNOB_HINTS, RECORDING_HINTS, TRACE_HINTS, bindings, groups,
};
pub use mouse::{mouse_action, reading_action};

/// The action of a key press on `page` under `panel`; `None` for unbound keys.
pub fn key_action(event: KeyEvent, panel: Popup, page: Option<Page>) -> Option<Action> {
    if event.kind == KeyEventKind::Release {
        return None;
    }
    if matches!(panel, Popup::Prompt | Popup::Search) {
        return typed(event);
    }
    let is_panel_open = panel != Popup::Scope;
    let pressed = pressed(event);
    let keys = page.filter(|_| !is_panel_open).map_or(&[][..], |page| page.0.keys);
    let of_page = keys.iter().find(|(key, _)| *key == pressed).map(|(_, action)| *action);
    of_page.or_else(|| bindings::general_action(pressed, is_panel_open))
}

/// A key event as the table writes it: terminals differ in whether a capital letter comes with
/// Shift.
fn pressed(event: KeyEvent) -> KeyPress {
    let relevant = match event.code {
        KeyCode::Char(_) | KeyCode::BackTab => KeyModifiers::CONTROL | KeyModifiers::ALT,
        _ => KeyModifiers::CONTROL | KeyModifiers::ALT | KeyModifiers::SHIFT,
    };
    KeyPress { code: event.code, modifiers: event.modifiers & relevant }
}

/// The action of a key on the command line, or where a search is typed.
fn typed(event: KeyEvent) -> Option<Action> {
    let control = event.modifiers.contains(KeyModifiers::CONTROL);
    match event.code {
        KeyCode::Enter => Some(Action::Submit),
        KeyCode::Esc => Some(Action::Back),
        KeyCode::Backspace => Some(Action::Erase),
        KeyCode::Char('c') if control => Some(Action::Back),
        KeyCode::Char('w') if control => Some(Action::Edit(InputRequest::DeletePrevWord)),
        KeyCode::Char('u') if control => Some(Action::Edit(InputRequest::DeleteLine)),
        KeyCode::Left => Some(Action::Edit(InputRequest::GoToPrevChar)),
        KeyCode::Right => Some(Action::Edit(InputRequest::GoToNextChar)),
        KeyCode::Home => Some(Action::Edit(InputRequest::GoToStart)),
        KeyCode::End => Some(Action::Edit(InputRequest::GoToEnd)),
        KeyCode::Delete => Some(Action::Edit(InputRequest::DeleteNextChar)),
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
        Event::Key(key) => key_action(*key, panel, model.page),
        Event::Mouse(mouse) => {
            let at = Position::new(mouse.column, mouse.row);
            let layout_below = layout.filter(|_| panel == Popup::Scope);
            let reading = layout_below.and_then(|layout| target(model, layout, at));
            match reading {
                Some(reading) => reading_action(*mouse, reading),
                // A list is scrolled as a panel's text is.
                None if model.page.is_some_and(|page| page.0.rows.is_some()) => {
                    mouse_action(*mouse, Popup::Log, layout)
                }
                None => mouse_action(*mouse, panel, layout),
            }
        }
        _ => None,
    }
}
