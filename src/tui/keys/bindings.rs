//! The table of keys.

use ratatui::crossterm::event::KeyCode;

use crate::tui::axis::TurnDirection;
use crate::tui::key::KeyPress;
use crate::tui::model::{Action, Popup, SidePanel};
use crate::tui::pages::PAGES;

const fn time_per_division(turn: TurnDirection) -> Action {
    Action::TimePerDivision { turn, anchor: 0.0 }
}

/// Lines of a panel that the keys for a page move.
const PAGE_LINES: usize = 10;

/// Where a binding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingScope {
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
    pub place: BindingScope,
    /// The keys as people write them.
    pub label: &'static str,
    /// The keys and their actions.
    pub keys: &'static [(KeyPress, Action)],
    /// Help text.
    pub help: &'static str,
}

impl Binding {
    /// Its label and its text, as the help shows them.
    pub fn row(&self) -> HelpRow {
        (self.label.to_owned(), self.help)
    }
}

/// A key or command and the text on it in the help.
pub type HelpRow = (String, &'static str);

const fn plain(code: KeyCode) -> KeyPress {
    KeyPress::plain(code)
}

const fn letter(letter: char) -> KeyPress {
    KeyPress::letter(letter)
}

const fn shift(code: KeyCode) -> KeyPress {
    KeyPress::shift(code)
}

const fn control(letter: char) -> KeyPress {
    KeyPress::control(letter)
}

const fn binding(
    (place, label): (BindingScope, &'static str),
    keys: &'static [(KeyPress, Action)],
    help: &'static str,
) -> Binding {
    Binding { place, label, keys, help }
}

/// All keys but those of pages, as the help groups them.
const GROUPS: &[(&str, &[Binding])] = &[
    ("Everywhere", ANYWHERE),
    ("Traces", TRACES),
    ("Time and shots", TIME),
    ("Readings", READINGS),
    ("Bench and scope (striking a chain)", BENCH),
];

/// The group of the help behind that of the pages.
const GROUP_BEHIND_PAGES: &str = "Bench and scope (striking a chain)";

/// All keys but those of pages.
pub fn bindings() -> impl Iterator<Item = &'static Binding> {
    GROUPS.iter().flat_map(|(_, bindings)| *bindings)
}

/// The rows of the help, in groups.
pub fn groups() -> Vec<(&'static str, Vec<HelpRow>)> {
    let mut groups: Vec<(&str, Vec<HelpRow>)> = Vec::new();
    for (title, bindings) in GROUPS {
        if *title == GROUP_BEHIND_PAGES {
            let rows = PAGES.iter().map(|page| (page.0.key.to_string(), page.0.help));
            groups.push(("Pages", rows.collect()));
        }
        groups.push((title, bindings.iter().map(Binding::row).collect()));
    }
    groups
}

/// The action of `pressed` on the traces, or under a panel.
pub fn general_action(pressed: KeyPress, is_panel_open: bool) -> Option<Action> {
    let of_page = || {
        let page = PAGES.iter().find(|page| KeyPress::letter(page.0.key) == pressed);
        page.filter(|_| !is_panel_open).map(|page| Action::Page(*page))
    };
    bindings()
        .filter(|binding| match binding.place {
            BindingScope::Everywhere => true,
            BindingScope::Scope => !is_panel_open,
            BindingScope::Panels => is_panel_open,
        })
        .flat_map(|binding| binding.keys)
        .find(|(key, _)| *key == pressed)
        .map(|(_, action)| *action)
        .or_else(of_page)
}

const ANYWHERE: &[Binding] = &[
    binding(
        (BindingScope::Everywhere, "?"),
        &[(letter('?'), Action::Toggle(Popup::Help))],
        "help on, off",
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
        (BindingScope::Panels, "↑ ↓ PgUp PgDn /"),
        &[
            (plain(KeyCode::Up), Action::Scroll(TurnDirection::Up, 1)),
            (plain(KeyCode::Down), Action::Scroll(TurnDirection::Down, 1)),
            (plain(KeyCode::PageUp), Action::Scroll(TurnDirection::Up, PAGE_LINES)),
            (plain(KeyCode::PageDown), Action::Scroll(TurnDirection::Down, PAGE_LINES)),
            (plain(KeyCode::Home), Action::Scroll(TurnDirection::Up, usize::MAX)),
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
        "move cursor; snap to previous, next peak, edge; A: arrival",
    ),
    binding(
        (BindingScope::Scope, "M"),
        &[(letter('M'), Action::Side(SidePanel::Measurements))],
        "measurements, arrivals, speeds",
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
pub const RECORDING_HINTS: &[(&str, &str)] = &[("O", "next recording")];

/// Keys that the last line names on the traces, in order of use.
pub const TRACE_HINTS: &[(&str, &str)] = &[
    ("?", "help"),
    ("q", "quit"),
    ("1-4", "channel"),
    ("↑ ↓ ← →", "scales"),
    ("a", "auto"),
    ("c M", "readings"),
    ("F b d", "pages"),
    ("k y h", "accuracy, effects, hard cases"),
    (", .", "shot"),
    ("Space", "play"),
    ("n - +", "knob"),
    ("w", "save"),
];
