//! The table of keys.

use ratatui::crossterm::event::{KeyCode, KeyModifiers};

use super::{Binding, Key, Place};
use crate::tui::axis::Turn;
use crate::tui::model::{Action, Page, Panel, Side};

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

const fn binding(
    (place, label): (Place, &'static str),
    keys: &'static [(Key, Action)],
    help: &'static str,
    hint: &'static str,
) -> Binding {
    Binding { place, label, keys, help, hint }
}

/// All keys.
pub const BINDINGS: &[Binding] = &[
    binding(
        (Place::Everywhere, "?"),
        &[(letter('?'), Action::Toggle(Panel::Help))],
        "this help, and away again",
        "help",
    ),
    binding(
        (Place::Everywhere, "q Esc"),
        &[
            (letter('q'), Action::Quit),
            (control('c'), Action::Quit),
            (plain(KeyCode::Esc), Action::Back),
        ],
        "quit; Esc closes what is open first",
        "quit",
    ),
    binding(
        (Place::Scope, "1-4"),
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
        (Place::Scope, "Tab Shift+Tab"),
        &[
            (plain(KeyCode::Tab), Action::NextTrace(Turn::Up)),
            (plain(KeyCode::BackTab), Action::NextTrace(Turn::Down)),
        ],
        "select the next, previous trace (MATH, REF too)",
        "",
    ),
    binding(
        (Place::Scope, "Enter"),
        &[(plain(KeyCode::Enter), Action::OnOff)],
        "selected trace off, on",
        "",
    ),
    binding(
        (Place::Scope, "↑ ↓"),
        &[
            (plain(KeyCode::Up), Action::VoltsPerDivision(Turn::Down)),
            (plain(KeyCode::Down), Action::VoltsPerDivision(Turn::Up)),
        ],
        "V/div: taller, flatter; Ctrl + mouse wheel",
        "V/div",
    ),
    binding(
        (Place::Scope, "← →"),
        &[
            (plain(KeyCode::Left), time_per_division(Turn::Up)),
            (plain(KeyCode::Right), time_per_division(Turn::Down)),
        ],
        "s/div, on spectra Hz/div: zoom out, in; mouse wheel",
        "s/div",
    ),
    binding(
        (Place::Scope, "Shift+↑ ↓  K J"),
        &[
            (shift(KeyCode::Up), Action::Position(Turn::Up)),
            (letter('K'), Action::Position(Turn::Up)),
            (shift(KeyCode::Down), Action::Position(Turn::Down)),
            (letter('J'), Action::Position(Turn::Down)),
        ],
        "position: selected trace up, down; or drag it",
        "",
    ),
    binding(
        (Place::Scope, "Shift+← →  H L"),
        &[
            (shift(KeyCode::Left), Action::Pan(Turn::Down)),
            (letter('H'), Action::Pan(Turn::Down)),
            (shift(KeyCode::Right), Action::Pan(Turn::Up)),
            (letter('L'), Action::Pan(Turn::Up)),
        ],
        "traces, spectra left, right; or drag them",
        "",
    ),
    binding(
        (Place::Scope, "z a"),
        &[(letter('z'), Action::Reset), (letter('a'), Action::Autoset)],
        "view as recorded; autoset: show everything",
        "reset, auto",
    ),
    binding(
        (Place::Scope, ", . Home End"),
        &[
            (letter(','), Action::Shot(Turn::Down)),
            (letter('.'), Action::Shot(Turn::Up)),
            (plain(KeyCode::Home), Action::Ends(Turn::Down)),
            (plain(KeyCode::End), Action::Ends(Turn::Up)),
        ],
        "previous, next, first, last shot",
        "shot",
    ),
    binding(
        (Place::Scope, "Space < >"),
        &[
            (letter(' '), Action::RunStop),
            (letter('<'), Action::Speed(Turn::Down)),
            (letter('>'), Action::Speed(Turn::Up)),
        ],
        "recording: play, pause, slower, faster; bench: run, stop",
        "play",
    ),
    binding(
        (Place::Scope, "c v"),
        &[(letter('c'), Action::Cursors), (letter('v'), Action::OtherCursor)],
        "cursors: time, volts, off; v moves the other one",
        "cursors",
    ),
    binding(
        (Place::Scope, "[ ]  { }"),
        &[
            (letter('['), Action::MoveCursor(Turn::Down)),
            (letter(']'), Action::MoveCursor(Turn::Up)),
            (letter('{'), Action::Snap(Turn::Down)),
            (letter('}'), Action::Snap(Turn::Up)),
        ],
        "move cursor; snap to previous, next peak or edge",
        "",
    ),
    binding(
        (Place::Scope, "M"),
        &[(letter('M'), Action::Side(Side::Measurements))],
        "measurements, arrivals, speeds",
        "measure",
    ),
    binding(
        (Place::Scope, "F S x"),
        &[
            (letter('F'), Action::Page(Page::Spectrum)),
            (letter('S'), Action::Page(Page::Map)),
            (letter('x'), Action::Page(Page::Xy)),
        ],
        "spectrum with band edges; over time; XY",
        "FFT",
    ),
    binding(
        (Place::Scope, "b"),
        &[(letter('b'), Action::Page(Page::Bench))],
        "the chain in motion; Space , . < > work on it",
        "bench",
    ),
    binding(
        (Place::Scope, "d"),
        &[(letter('d'), Action::Compare)],
        "comparison: both, overlay, difference, away",
        "compare",
    ),
    binding(
        (Place::Scope, "k"),
        &[(letter('k'), Action::Page(Page::Accuracy))],
        "accuracy: work against precision, effects",
        "accuracy",
    ),
    binding(
        (Place::Scope, "m R T"),
        &[
            (letter('m'), Action::Math),
            (letter('R'), Action::Reference),
            (letter('T'), Action::Truth),
        ],
        "math trace; keep trace as reference; truth over traces",
        "",
    ),
    binding(
        (Place::Scope, "u p"),
        &[(letter('u'), Action::Unit), (letter('p'), Action::Persistence)],
        "volts or newtons; persistence",
        "",
    ),
    binding(
        (Place::Scope, "n N  - +  o"),
        &[
            (letter('n'), Action::NextKnob(Turn::Up)),
            (letter('N'), Action::NextKnob(Turn::Down)),
            (letter('-'), Action::TurnKnob(Turn::Down)),
            (letter('+'), Action::TurnKnob(Turn::Up)),
            (letter('='), Action::TurnKnob(Turn::Up)),
            (letter('o'), Action::Switch),
        ],
        "bench: next knob, turn it, effect on/off",
        "knob",
    ),
    binding(
        (Place::Scope, "B i"),
        &[(letter('B'), Action::Side(Side::Knobs)), (letter('i'), Action::Impact)],
        "bench: show the knobs; strike the chain",
        "",
    ),
    binding(
        (Place::Scope, "s f"),
        &[(letter('s'), Action::Single), (letter('f'), Action::Force)],
        "bench: arm for one trigger; force one",
        "",
    ),
    binding(
        (Place::Scope, "PgUp PgDn e t"),
        &[
            (plain(KeyCode::PageUp), Action::TriggerLevel(Turn::Up)),
            (plain(KeyCode::PageDown), Action::TriggerLevel(Turn::Down)),
            (letter('e'), Action::TriggerSlope),
            (letter('t'), Action::TriggerMode),
        ],
        "bench: trigger level, edge, mode; or wheel, click on it",
        "",
    ),
    binding(
        (Place::Scope, "C P"),
        &[(letter('C'), Action::Coupling), (letter('P'), Action::Probe)],
        "bench: coupling (or click it), probe of the channel",
        "",
    ),
    binding(
        (Place::Scope, "w :"),
        &[(letter('w'), Action::Prompt("write ")), (letter(':'), Action::Prompt(""))],
        "save; command line, see below",
        "save",
    ),
    binding(
        (Place::Everywhere, "l"),
        &[(letter('l'), Action::Toggle(Panel::Log))],
        "problems of the file and its log",
        "",
    ),
    binding(
        (Place::Panels, "↑ ↓"),
        &[
            (plain(KeyCode::Up), Action::Scroll(Turn::Up)),
            (plain(KeyCode::Down), Action::Scroll(Turn::Down)),
        ],
        "in a panel: scroll",
        "",
    ),
];
