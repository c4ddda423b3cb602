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
) -> Binding {
    Binding { place, label, keys, help }
}

/// All keys, as the help groups them.
pub const GROUPS: &[(&str, &[Binding])] = &[
    ("Everywhere", ANYWHERE),
    ("Traces", TRACES),
    ("Time and shots", TIME),
    ("Readings", READINGS),
    ("Pages", PAGES),
    ("Bench and scope (striking a chain)", BENCH),
];

/// All keys.
pub fn bindings() -> impl Iterator<Item = &'static Binding> {
    GROUPS.iter().flat_map(|(_, bindings)| *bindings)
}

const ANYWHERE: &[Binding] = &[
    binding(
        (BindingScope::Everywhere, "?"),
        &[(letter('?'), Action::Toggle(Popup::Help))],
        "this help, and away again",
    ),
    binding(
        (BindingScope::Everywhere, "q Esc"),
        &[
            (letter('q'), Action::Quit),
            (control('c'), Action::Quit),
            (plain(KeyCode::Esc), Action::Back),
        ],
        "quit; Esc closes what is open first",
    ),
    binding(
        (BindingScope::Scope, "w :"),
        &[(letter('w'), Action::Prompt("write ")), (letter(':'), Action::Prompt(""))],
        "save; command line, see below",
    ),
    binding(
        (BindingScope::Everywhere, "l"),
        &[(letter('l'), Action::Toggle(Popup::Log))],
        "problems of the file and its log",
    ),
    binding(
        (BindingScope::Panels, "↑ ↓ /"),
        &[
            (plain(KeyCode::Up), Action::Scroll(TurnDirection::Up)),
            (plain(KeyCode::Down), Action::Scroll(TurnDirection::Down)),
            (letter('/'), Action::Search),
        ],
        "in a panel: scroll; search the keys",
    ),
];

const TRACES: &[Binding] = &[
    binding(
        (BindingScope::Scope, "1-4"),
        &[
            (letter('1'), Action::Channel(1)),
            (letter('2'), Action::Channel(2)),
            (letter('3'), Action::Channel(3)),
            (letter('4'), Action::Channel(4)),
        ],
        "select a channel; if it is selected: off, on; or click it",
    ),
    binding(
        (BindingScope::Scope, "Tab Shift+Tab"),
        &[
            (plain(KeyCode::Tab), Action::NextTrace(TurnDirection::Up)),
            (plain(KeyCode::BackTab), Action::NextTrace(TurnDirection::Down)),
        ],
        "select the next, previous trace (MATH, REF too)",
    ),
    binding(
        (BindingScope::Scope, "Enter"),
        &[(plain(KeyCode::Enter), Action::OnOff)],
        "selected trace off, on",
    ),
    binding(
        (BindingScope::Scope, "↑ ↓"),
        &[
            (plain(KeyCode::Up), Action::VoltsPerDivision(TurnDirection::Down)),
            (plain(KeyCode::Down), Action::VoltsPerDivision(TurnDirection::Up)),
        ],
        "V/div: taller, flatter; Ctrl + mouse wheel",
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
    ),
    binding(
        (BindingScope::Scope, "m R T"),
        &[
            (letter('m'), Action::Math),
            (letter('R'), Action::Reference),
            (letter('T'), Action::Truth),
        ],
        "math trace; keep trace as reference; truth over traces",
    ),
    binding(
        (BindingScope::Scope, "u p"),
        &[(letter('u'), Action::Unit), (letter('p'), Action::Persistence)],
        "volts or newtons; persistence",
    ),
];

const TIME: &[Binding] = &[
    binding(
        (BindingScope::Scope, "← →"),
        &[
            (plain(KeyCode::Left), time_per_division(TurnDirection::Up)),
            (plain(KeyCode::Right), time_per_division(TurnDirection::Down)),
        ],
        "s/div, on spectra Hz/div: zoom out, in; mouse wheel",
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
    ),
    binding(
        (BindingScope::Scope, "z a"),
        &[(letter('z'), Action::Reset), (letter('a'), Action::Autoset)],
        "view as recorded; autoset: first pulses fill the screen",
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
    ),
    binding(
        (BindingScope::Scope, "O"),
        &[(letter('O'), Action::NextRecording)],
        "of several recordings, the next one in front",
    ),
    binding(
        (BindingScope::Scope, "Space < >"),
        &[
            (letter(' '), Action::RunStop),
            (letter('<'), Action::Speed(TurnDirection::Down)),
            (letter('>'), Action::Speed(TurnDirection::Up)),
        ],
        "recording: play, pause, slower, faster; bench: run, stop",
    ),
];

const READINGS: &[Binding] = &[
    binding(
        (BindingScope::Scope, "c v"),
        &[(letter('c'), Action::Cursors), (letter('v'), Action::OtherCursor)],
        "cursors: time, volts, off; v moves the other one",
    ),
    binding(
        (BindingScope::Scope, "[ ]  { }  A"),
        &[
            (letter('['), Action::MoveCursor(TurnDirection::Down)),
            (letter(']'), Action::MoveCursor(TurnDirection::Up)),
            (letter('{'), Action::Snap(TurnDirection::Down)),
            (letter('}'), Action::Snap(TurnDirection::Up)),
            (letter('A'), Action::SnapToArrival),
        ],
        "move cursor; snap to previous, next peak or edge; A: arrival",
    ),
    binding(
        (BindingScope::Scope, "M"),
        &[(letter('M'), Action::Side(SidePanel::Measurements))],
        "measurements, arrivals, speeds",
    ),
];

const PAGES: &[Binding] = &[
    binding(
        (BindingScope::Scope, "F S x"),
        &[
            (letter('F'), Action::Page(Page::Spectrum)),
            (letter('S'), Action::Page(Page::Map)),
            (letter('x'), Action::Page(Page::Xy)),
        ],
        "spectrum with band edges; over time; XY",
    ),
    binding(
        (BindingScope::Scope, "b"),
        &[(letter('b'), Action::Page(Page::Bench))],
        "the chain in motion; Space , . < > work on it",
    ),
    binding(
        (BindingScope::Scope, "d"),
        &[(letter('d'), Action::Compare)],
        "comparison: both, overlay, difference, away",
    ),
    binding(
        (BindingScope::Scope, "k y h"),
        &[
            (letter('k'), Action::Page(Page::Accuracy)),
            (letter('y'), Action::Page(Page::Effects)),
            (letter('h'), Action::Page(Page::HardCases)),
        ],
        "work against precision; effects; hard cases",
    ),
    binding(
        (BindingScope::Scope, "r"),
        &[(letter('r'), Action::Page(Page::Remote))],
        "remote commands and replies around the shot",
    ),
];

const BENCH: &[Binding] = &[
    binding(
        (BindingScope::Scope, "B i U"),
        &[
            (letter('B'), Action::Side(SidePanel::Knobs)),
            (letter('i'), Action::Impact),
            (letter('U'), Action::Bands),
        ],
        "show the knobs; strike the chain; U: 95 % bands",
    ),
    binding(
        (BindingScope::Scope, "n N  - +  o E"),
        &[
            (letter('n'), Action::NextKnob(TurnDirection::Up)),
            (letter('N'), Action::NextKnob(TurnDirection::Down)),
            (letter('-'), Action::TurnKnob(TurnDirection::Down)),
            (letter('+'), Action::TurnKnob(TurnDirection::Up)),
            (letter('='), Action::TurnKnob(TurnDirection::Up)),
            (letter('o'), Action::Switch),
            (letter('E'), Action::TypeKnob),
        ],
        "next knob, turn it, effect on/off; E types a value",
    ),
    binding(
        (BindingScope::Scope, "s f"),
        &[(letter('s'), Action::Single), (letter('f'), Action::Force)],
        "arm for one trigger; force one",
    ),
    binding(
        (BindingScope::Scope, "PgUp PgDn e t"),
        &[
            (plain(KeyCode::PageUp), Action::TriggerLevel(TurnDirection::Up)),
            (plain(KeyCode::PageDown), Action::TriggerLevel(TurnDirection::Down)),
            (letter('e'), Action::TriggerSlope),
            (letter('t'), Action::TriggerMode),
        ],
        "trigger level, edge, mode; or wheel, click on it",
    ),
    binding(
        (BindingScope::Scope, "C P W X Y"),
        &[
            (letter('C'), Action::Coupling),
            (letter('P'), Action::Probe),
            (letter('W'), Action::Bandwidth),
            (letter('X'), Action::TriggerSource),
            (letter('Y'), Action::Acquisition),
        ],
        "coupling, probe, bandwidth; trigger source; averages",
    ),
];

/// Keys that come first on the last line while the panel of knobs is open.
pub const KNOB_HINTS: &[(&str, &str)] = &[("n - +", "knob"), ("E", "type"), ("o", "on, off")];
/// The same while several recordings are open.
pub const RECORDING_HINTS: &[(&str, &str)] = &[("O", "other in front")];

/// Keys that the last line names on a page, in order of use.
pub fn hints(page: Page) -> &'static [(&'static str, &'static str)] {
    match page {
        Page::Scope => &[
            ("?", "help"),
            ("q", "quit"),
            ("1-4", "channel"),
            ("↑ ↓", "V/div"),
            ("← →", "s/div"),
            ("z a", "reset, auto"),
            ("F", "FFT"),
            ("b", "bench"),
            ("d", "compare"),
            ("c", "cursors"),
            ("M", "measure"),
            ("k", "accuracy"),
            ("y h", "effects, hard cases"),
            (", .", "shot"),
            ("Space", "play"),
            ("n - +", "knob"),
            ("w", "save"),
        ],
        Page::Spectrum | Page::Map => &[
            ("?", "help"),
            ("Esc", "traces"),
            ("1-4", "channel"),
            ("← →", "Hz/div"),
            ("H L", "lower, higher"),
            ("z", "all"),
            ("F S", "spectrum, over time"),
            (", .", "shot"),
            ("w", "save"),
        ],
        Page::Xy => {
            &[("?", "help"), ("Esc", "traces"), ("1-4", "upward"), (", .", "shot"), ("w", "save")]
        }
        Page::Bench => &[
            ("?", "help"),
            ("Esc", "traces"),
            ("Space", "play"),
            (", .", "frame"),
            ("< >", "slower, faster"),
            (":", "seek TIME"),
            ("n - +", "knob"),
            ("w", "save"),
        ],
        Page::Compare => &[
            ("?", "help"),
            ("Esc", "traces"),
            ("d", "overlay, difference"),
            ("1-4", "channel"),
            ("↑ ↓", "V/div"),
            (", .", "shot"),
            ("w", "save"),
        ],
        Page::Accuracy => &[("?", "help"), ("Esc", "traces"), ("y", "effects"), ("w", "save")],
        Page::Effects => &[
            ("?", "help"),
            ("Esc", "traces"),
            ("↑ ↓", "effect"),
            ("o", "on, off"),
            ("h", "hard cases"),
            ("k", "accuracy"),
            ("w", "save"),
        ],
        Page::HardCases => {
            &[("?", "help"), ("Esc", "traces"), ("↑ ↓", "case"), ("y", "effects"), ("w", "save")]
        }
        Page::Remote => &[
            ("?", "help"),
            ("Esc", "traces"),
            ("↑ ↓", "message"),
            ("PgUp PgDn", "ten on"),
            (", .", "shot"),
            ("w", "save"),
        ],
    }
}
