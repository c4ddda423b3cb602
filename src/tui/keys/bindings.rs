//! The table of keys.

use ratatui::crossterm::event::{KeyCode, KeyModifiers};

use super::{Binding, BindingScope, KeyPress};
use crate::tui::axis::TurnDirection;
use crate::tui::model::{Action, Page, Popup, SidePanel};

const fn plain(code: KeyCode) -> KeyPress {
    KeyPress { code, modifiers: KeyModifiers::NONE }
}

const fn letter(letter: char) -> KeyPress {
    plain(KeyCode::Char(letter))
}

const fn shift(code: KeyCode) -> KeyPress {
    KeyPress { code, modifiers: KeyModifiers::SHIFT }
}

const fn control(letter: char) -> KeyPress {
    KeyPress { code: KeyCode::Char(letter), modifiers: KeyModifiers::CONTROL }
}

const fn time_per_division(turn: TurnDirection) -> Action {
    Action::TimePerDivision { turn, anchor: 0.0 }
}

const fn binding(
    (place, label): (BindingScope, &'static str),
    keys: &'static [(KeyPress, Action)],
    help: &'static str,
    hint: &'static str,
) -> Binding {
    Binding { place, label, keys, help, hint }
}

/// All keys.
pub const BINDINGS: &[Binding] = &[
    binding(
        (BindingScope::Everywhere, "?"),
        &[(letter('?'), Action::Toggle(Popup::Help))],
        "this help, and away again",
        "help",
    ),
    binding(
        (BindingScope::Everywhere, "q Esc"),
        &[
            (letter('q'), Action::Quit),
            (control('c'), Action::Quit),
            (plain(KeyCode::Esc), Action::Back),
        ],
        "quit; Esc closes what is open first",
        "quit",
    ),
    binding(
        (BindingScope::Scope, "1-4"),
        &[
            (letter('1'), Action::Channel(1)),
            (letter('2'), Action::Channel(2)),
            (letter('3'), Action::Channel(3)),
            (letter('4'), Action::Channel(4)),
        ],
        "select a channel; if it is selected: off, on; or click it",
        "channel",
    ),
    binding(
        (BindingScope::Scope, "Tab Shift+Tab"),
        &[
            (plain(KeyCode::Tab), Action::NextTrace(TurnDirection::Up)),
            (plain(KeyCode::BackTab), Action::NextTrace(TurnDirection::Down)),
        ],
        "select the next, previous trace (MATH, REF too)",
        "",
    ),
    binding(
        (BindingScope::Scope, "Enter"),
        &[(plain(KeyCode::Enter), Action::OnOff)],
        "selected trace off, on",
        "",
    ),
    binding(
        (BindingScope::Scope, "↑ ↓"),
        &[
            (plain(KeyCode::Up), Action::VoltsPerDivision(TurnDirection::Down)),
            (plain(KeyCode::Down), Action::VoltsPerDivision(TurnDirection::Up)),
        ],
        "V/div: taller, flatter; Ctrl + mouse wheel",
        "V/div",
    ),
    binding(
        (BindingScope::Scope, "← →"),
        &[
            (plain(KeyCode::Left), time_per_division(TurnDirection::Up)),
            (plain(KeyCode::Right), time_per_division(TurnDirection::Down)),
        ],
        "s/div, on spectra Hz/div: zoom out, in; mouse wheel",
        "s/div",
    ),
    binding(
        (BindingScope::Scope, "Shift+↑ ↓  K J"),
        &[
            (shift(KeyCode::Up), Action::Position(TurnDirection::Up)),
            (letter('K'), Action::Position(TurnDirection::Up)),
            (shift(KeyCode::Down), Action::Position(TurnDirection::Down)),
            (letter('J'), Action::Position(TurnDirection::Down)),
        ],
        "position: selected trace up, down; or drag it",
        "",
    ),
    binding(
        (BindingScope::Scope, "Shift+← →  H L"),
        &[
            (shift(KeyCode::Left), Action::Pan(TurnDirection::Down)),
            (letter('H'), Action::Pan(TurnDirection::Down)),
            (shift(KeyCode::Right), Action::Pan(TurnDirection::Up)),
            (letter('L'), Action::Pan(TurnDirection::Up)),
        ],
        "traces, spectra left, right; or drag them",
        "",
    ),
    binding(
        (BindingScope::Scope, "z a"),
        &[(letter('z'), Action::Reset), (letter('a'), Action::Autoset)],
        "view as recorded; autoset: show everything",
        "reset, auto",
    ),
    binding(
        (BindingScope::Scope, ", . Home End"),
        &[
            (letter(','), Action::Shot(TurnDirection::Down)),
            (letter('.'), Action::Shot(TurnDirection::Up)),
            (plain(KeyCode::Home), Action::Ends(TurnDirection::Down)),
            (plain(KeyCode::End), Action::Ends(TurnDirection::Up)),
        ],
        "previous, next, first, last shot",
        "shot",
    ),
    binding(
        (BindingScope::Scope, "Space < >"),
        &[
            (letter(' '), Action::RunStop),
            (letter('<'), Action::Speed(TurnDirection::Down)),
            (letter('>'), Action::Speed(TurnDirection::Up)),
        ],
        "recording: play, pause, slower, faster; bench: run, stop",
        "play",
    ),
    binding(
        (BindingScope::Scope, "c v"),
        &[(letter('c'), Action::Cursors), (letter('v'), Action::OtherCursor)],
        "cursors: time, volts, off; v moves the other one",
        "cursors",
    ),
    binding(
        (BindingScope::Scope, "[ ]  { }"),
        &[
            (letter('['), Action::MoveCursor(TurnDirection::Down)),
            (letter(']'), Action::MoveCursor(TurnDirection::Up)),
            (letter('{'), Action::Snap(TurnDirection::Down)),
            (letter('}'), Action::Snap(TurnDirection::Up)),
        ],
        "move cursor; snap to previous, next peak or edge",
        "",
    ),
    binding(
        (BindingScope::Scope, "M"),
        &[(letter('M'), Action::Side(SidePanel::Measurements))],
        "measurements, arrivals, speeds",
        "measure",
    ),
    binding(
        (BindingScope::Scope, "F S x"),
        &[
            (letter('F'), Action::Page(Page::Spectrum)),
            (letter('S'), Action::Page(Page::Map)),
            (letter('x'), Action::Page(Page::Xy)),
        ],
        "spectrum with band edges; over time; XY",
        "FFT",
    ),
    binding(
        (BindingScope::Scope, "b"),
        &[(letter('b'), Action::Page(Page::Bench))],
        "the chain in motion; Space , . < > work on it",
        "bench",
    ),
    binding(
        (BindingScope::Scope, "d"),
        &[(letter('d'), Action::Compare)],
        "comparison: both, overlay, difference, away",
        "compare",
    ),
    binding(
        (BindingScope::Scope, "k"),
        &[(letter('k'), Action::Page(Page::Accuracy))],
        "accuracy: work against precision, effects",
        "accuracy",
    ),
    binding(
        (BindingScope::Scope, "m R T"),
        &[
            (letter('m'), Action::Math),
            (letter('R'), Action::Reference),
            (letter('T'), Action::Truth),
        ],
        "math trace; keep trace as reference; truth over traces",
        "",
    ),
    binding(
        (BindingScope::Scope, "u p"),
        &[(letter('u'), Action::Unit), (letter('p'), Action::Persistence)],
        "volts or newtons; persistence",
        "",
    ),
    binding(
        (BindingScope::Scope, "n N  - +  o"),
        &[
            (letter('n'), Action::NextKnob(TurnDirection::Up)),
            (letter('N'), Action::NextKnob(TurnDirection::Down)),
            (letter('-'), Action::TurnKnob(TurnDirection::Down)),
            (letter('+'), Action::TurnKnob(TurnDirection::Up)),
            (letter('='), Action::TurnKnob(TurnDirection::Up)),
            (letter('o'), Action::Switch),
        ],
        "bench: next knob, turn it, effect on/off",
        "knob",
    ),
    binding(
        (BindingScope::Scope, "B i"),
        &[(letter('B'), Action::Side(SidePanel::Knobs)), (letter('i'), Action::Impact)],
        "bench: show the knobs; strike the chain",
        "",
    ),
    binding(
        (BindingScope::Scope, "s f"),
        &[(letter('s'), Action::Single), (letter('f'), Action::Force)],
        "bench: arm for one trigger; force one",
        "",
    ),
    binding(
        (BindingScope::Scope, "PgUp PgDn e t"),
        &[
            (plain(KeyCode::PageUp), Action::TriggerLevel(TurnDirection::Up)),
            (plain(KeyCode::PageDown), Action::TriggerLevel(TurnDirection::Down)),
            (letter('e'), Action::TriggerSlope),
            (letter('t'), Action::TriggerMode),
        ],
        "bench: trigger level, edge, mode; or wheel, click on it",
        "",
    ),
    binding(
        (BindingScope::Scope, "C P"),
        &[(letter('C'), Action::Coupling), (letter('P'), Action::Probe)],
        "bench: coupling (or click it), probe of the channel",
        "",
    ),
    binding(
        (BindingScope::Scope, "w :"),
        &[(letter('w'), Action::Prompt("write ")), (letter(':'), Action::Prompt(""))],
        "save; command line, see below",
        "save",
    ),
    binding(
        (BindingScope::Everywhere, "l"),
        &[(letter('l'), Action::Toggle(Popup::Log))],
        "problems of the file and its log",
        "",
    ),
    binding(
        (BindingScope::Panels, "↑ ↓"),
        &[
            (plain(KeyCode::Up), Action::Scroll(TurnDirection::Up)),
            (plain(KeyCode::Down), Action::Scroll(TurnDirection::Down)),
        ],
        "in a panel: scroll",
        "",
    ),
];
