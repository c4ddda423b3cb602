//! Keys and mouse to actions: one table, from which the help and the line of hints are made too.

use ratatui::crossterm::event::{
    Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, MouseEvent, MouseEventKind,
};
use ratatui::layout::Position;

use crate::tui::axis::{DIVISIONS_ACROSS, Turn};
use crate::tui::model::{Action, Panel};
use crate::tui::view::layout::Layout;

/// A key with the modifiers that tell it from others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Key {
    /// The key; a letter carries its case.
    pub code: KeyCode,
    /// Control, Alt, and for keys without a case of their own Shift.
    pub modifiers: KeyModifiers,
}

/// Where a binding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// Everywhere.
    Everywhere,
    /// On the scope's screen.
    Scope,
    /// In a panel over it.
    Panels,
}

/// One line of the help: keys that belong together, and what each does.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// Where the keys hold.
    pub place: Place,
    /// The keys as people write them.
    pub label: &'static str,
    /// The keys and their actions.
    pub keys: &'static [(Key, Action)],
    /// What they do.
    pub help: &'static str,
    /// The same in a word for the line of hints; empty for keys that are not on it.
    pub hint: &'static str,
}

const fn plain(code: KeyCode) -> Key {
    Key { code, modifiers: KeyModifiers::NONE }
}

const fn letter(letter: char) -> Key {
    plain(KeyCode::Char(letter))
}

const fn shift(code: KeyCode) -> Key {
    Key { code, modifiers: KeyModifiers::SHIFT }
}

const fn control(letter: char) -> Key {
    Key { code: KeyCode::Char(letter), modifiers: KeyModifiers::CONTROL }
}

const fn time_per_division(turn: Turn) -> Action {
    Action::TimePerDivision { turn, anchor: 0.0 }
}

/// All keys.
pub const BINDINGS: &[Binding] = &[
    Binding {
        place: Place::Everywhere,
        label: "?",
        keys: &[(letter('?'), Action::Toggle(Panel::Help))],
        help: "this help, and away again",
        hint: "help",
    },
    Binding {
        place: Place::Everywhere,
        label: "q Esc",
        keys: &[
            (letter('q'), Action::Quit),
            (control('c'), Action::Quit),
            (plain(KeyCode::Esc), Action::Back),
        ],
        help: "quit; Esc closes an open panel first",
        hint: "quit",
    },
    Binding {
        place: Place::Scope,
        label: "1-4",
        keys: &[
            (letter('1'), Action::Channel(1)),
            (letter('2'), Action::Channel(2)),
            (letter('3'), Action::Channel(3)),
            (letter('4'), Action::Channel(4)),
        ],
        help: "select a channel; if it is selected: off, on",
        hint: "channel",
    },
    Binding {
        place: Place::Scope,
        label: "Tab Shift+Tab",
        keys: &[
            (plain(KeyCode::Tab), Action::NextTrace(Turn::Up)),
            (plain(KeyCode::BackTab), Action::NextTrace(Turn::Down)),
        ],
        help: "select the next, previous trace (MATH, REF too)",
        hint: "",
    },
    Binding {
        place: Place::Scope,
        label: "Enter",
        keys: &[(plain(KeyCode::Enter), Action::OnOff)],
        help: "selected trace off, on",
        hint: "",
    },
    Binding {
        place: Place::Scope,
        label: "↑ ↓",
        keys: &[
            (plain(KeyCode::Up), Action::VoltsPerDivision(Turn::Down)),
            (plain(KeyCode::Down), Action::VoltsPerDivision(Turn::Up)),
        ],
        help: "V/div: selected trace taller, flatter",
        hint: "V/div",
    },
    Binding {
        place: Place::Scope,
        label: "← →",
        keys: &[
            (plain(KeyCode::Left), time_per_division(Turn::Up)),
            (plain(KeyCode::Right), time_per_division(Turn::Down)),
        ],
        help: "s/div: zoom out, in; the mouse wheel does it too",
        hint: "s/div",
    },
    Binding {
        place: Place::Scope,
        label: "Shift+↑ ↓  K J",
        keys: &[
            (shift(KeyCode::Up), Action::Position(Turn::Up)),
            (letter('K'), Action::Position(Turn::Up)),
            (shift(KeyCode::Down), Action::Position(Turn::Down)),
            (letter('J'), Action::Position(Turn::Down)),
        ],
        help: "position: selected trace up, down by half a division",
        hint: "",
    },
    Binding {
        place: Place::Scope,
        label: "Shift+← →  H L",
        keys: &[
            (shift(KeyCode::Left), Action::Pan(Turn::Down)),
            (letter('H'), Action::Pan(Turn::Down)),
            (shift(KeyCode::Right), Action::Pan(Turn::Up)),
            (letter('L'), Action::Pan(Turn::Up)),
        ],
        help: "all traces left, right by half a division",
        hint: "",
    },
    Binding {
        place: Place::Scope,
        label: "z",
        keys: &[(letter('z'), Action::Reset)],
        help: "back to scales and positions as recorded",
        hint: "reset",
    },
    Binding {
        place: Place::Scope,
        label: ", .",
        keys: &[(letter(','), Action::Shot(Turn::Down)), (letter('.'), Action::Shot(Turn::Up))],
        help: "previous, next shot",
        hint: "shot",
    },
    Binding {
        place: Place::Everywhere,
        label: "l",
        keys: &[(letter('l'), Action::Toggle(Panel::Log))],
        help: "problems of the file and its log",
        hint: "log",
    },
    Binding {
        place: Place::Panels,
        label: "↑ ↓",
        keys: &[
            (plain(KeyCode::Up), Action::Scroll(Turn::Up)),
            (plain(KeyCode::Down), Action::Scroll(Turn::Down)),
        ],
        help: "in a panel: scroll",
        hint: "",
    },
];

/// What a key press asks for under `panel`; `None` for keys that mean nothing there.
#[must_use]
pub fn key_action(event: KeyEvent, panel: Panel) -> Option<Action> {
    if event.kind == KeyEventKind::Release {
        return None;
    }
    BINDINGS
        .iter()
        .filter(|binding| match binding.place {
            Place::Everywhere => true,
            Place::Scope => panel == Panel::Scope,
            Place::Panels => panel != Panel::Scope,
        })
        .flat_map(|binding| binding.keys)
        .find(|(key, _)| *key == pressed(event))
        .map(|(_, action)| *action)
}

/// A key event as the table writes it: terminals differ in whether a capital letter comes with Shift.
fn pressed(event: KeyEvent) -> Key {
    let told_apart = match event.code {
        KeyCode::Char(_) | KeyCode::BackTab => KeyModifiers::CONTROL | KeyModifiers::ALT,
        _ => KeyModifiers::CONTROL | KeyModifiers::ALT | KeyModifiers::SHIFT,
    };
    Key { code: event.code, modifiers: event.modifiers & told_apart }
}

/// What the mouse asks for: its wheel zooms around the pointer, or scrolls an open panel.
#[must_use]
pub fn mouse_action(event: MouseEvent, panel: Panel, layout: Option<&Layout>) -> Option<Action> {
    let turn = match event.kind {
        MouseEventKind::ScrollUp => Turn::Down,
        MouseEventKind::ScrollDown => Turn::Up,
        _ => return None,
    };
    if panel != Panel::Scope {
        return Some(Action::Scroll(match turn {
            Turn::Down => Turn::Up,
            Turn::Up => Turn::Down,
        }));
    }
    let layout = layout?;
    let pointer = Position::new(event.column, event.row);
    layout.graticule.contains(pointer).then(|| {
        // The middle of a cell, two dots wide.
        let dot = f64::from(event.column - layout.graticule.x) * 2.0 + 0.5;
        let division = dot / f64::from(layout.x_dots);
        Action::TimePerDivision { turn, anchor: division - f64::from(DIVISIONS_ACROSS) / 2.0 }
    })
}

/// What an event of the terminal asks for; `None` for what needs no more than a redraw.
#[must_use]
pub fn action(event: &Event, panel: Panel, layout: Option<&Layout>) -> Option<Action> {
    match event {
        Event::Key(key) => key_action(*key, panel),
        Event::Mouse(mouse) => mouse_action(*mouse, panel, layout),
        _ => None,
    }
}
