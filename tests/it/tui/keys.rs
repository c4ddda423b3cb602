//! Events to actions.

use super::bench::draw;
use super::live::Session;
use hertzscope::scope::Source;
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::key::KeyPress;
use hertzscope::tui::keys::{BindingScope, action, bindings, key_action, mouse_action};
use hertzscope::tui::model::{Action, Popup};
use hertzscope::tui::pages;
use hertzscope::tui::pages::PAGES;
use hertzscope::tui::view::{self, layout::ScreenLayout};
use ratatui::crossterm::event::{
    Event, KeyCode, KeyEvent, KeyEventKind, KeyModifiers, MouseButton, MouseEvent, MouseEventKind,
};
use ratatui::layout::Rect;

fn press(code: KeyCode, modifiers: KeyModifiers) -> Option<Action> {
    key_action(KeyEvent::new(code, modifiers), Popup::Scope, None)
}

#[test]
fn keys_ask_for_what_their_labels_say() {
    let none = KeyModifiers::NONE;
    let shift = KeyModifiers::SHIFT;
    let zoom_in = Action::TimePerDivision { turn: TurnDirection::Down, anchor: 0.0 };
    for (code, modifiers, action) in [
        (KeyCode::Char('q'), none, Action::Quit),
        (KeyCode::Char('c'), KeyModifiers::CONTROL, Action::Quit),
        (KeyCode::Esc, none, Action::Back),
        (KeyCode::Char('3'), none, Action::Channel(3)),
        (KeyCode::Up, none, Action::VoltsPerDivision(TurnDirection::Down)),
        (KeyCode::Down, none, Action::VoltsPerDivision(TurnDirection::Up)),
        (KeyCode::Right, none, zoom_in),
        (KeyCode::Up, shift, Action::Position(TurnDirection::Up)),
        (KeyCode::Left, shift, Action::Pan(TurnDirection::Down)),
        (KeyCode::Char('.'), none, Action::Shot(TurnDirection::Up)),
        (KeyCode::Tab, none, Action::NextTrace(TurnDirection::Up)),
        (KeyCode::Char('z'), none, Action::Reset),
        (KeyCode::Char('l'), none, Action::Toggle(Popup::Log)),
        (KeyCode::Char('O'), none, Action::NextRecording),
        (KeyCode::Char('r'), none, Action::Page(pages::remote::PAGE)),
        (KeyCode::Char('y'), none, Action::Page(pages::effects::PAGE)),
        (KeyCode::Char('h'), none, Action::Page(pages::hard_cases::PAGE)),
    ] {
        assert_eq!(press(code, modifiers), Some(action), "{code:?} {modifiers:?}");
    }
    assert_eq!(press(KeyCode::Char('c'), none), Some(Action::Cursors));
    assert_eq!(press(KeyCode::Char('j'), none), None);
    assert_eq!(press(KeyCode::F(1), none), None);
}

/// Some terminals report the Shift that a capital or a `?` needs, others do not.
#[test]
fn shift_on_a_letter_makes_no_difference() {
    for modifiers in [KeyModifiers::NONE, KeyModifiers::SHIFT] {
        let help = Some(Action::Toggle(Popup::Help));
        assert_eq!(press(KeyCode::Char('?'), modifiers), help);
        let up = Some(Action::Position(TurnDirection::Up));
        assert_eq!(press(KeyCode::Char('K'), modifiers), up);
        let back = Some(Action::NextTrace(TurnDirection::Down));
        assert_eq!(press(KeyCode::BackTab, modifiers), back);
    }
}

#[test]
fn letting_go_of_a_key_does_nothing() {
    let mut event = KeyEvent::new(KeyCode::Char('q'), KeyModifiers::NONE);
    event.kind = KeyEventKind::Release;
    assert_eq!(key_action(event, Popup::Scope, None), None);
}

#[test]
fn in_a_panel_arrows_scroll_and_scope_keys_rest() {
    let key = |code| key_action(KeyEvent::new(code, KeyModifiers::NONE), Popup::Log, None);
    assert_eq!(key(KeyCode::Down), Some(Action::Scroll(TurnDirection::Down, 1)));
    assert_eq!(key(KeyCode::Char('1')), None);
    assert_eq!(key(KeyCode::Char('q')), Some(Action::Quit));
}

#[test]
fn no_key_has_two_meanings_in_one_place() {
    let keys: Vec<_> = bindings()
        .flat_map(|binding| binding.keys.iter().map(move |(key, _)| (binding.place, *key)))
        .collect();
    let pages = PAGES.iter().map(|page| (BindingScope::Scope, KeyPress::letter(page.0.key)));
    let keys: Vec<_> = keys.into_iter().chain(pages).collect();
    for (index, (place, key)) in keys.iter().enumerate() {
        for (other_place, other_key) in &keys[index + 1..] {
            let together = place == other_place
                || *place == BindingScope::Everywhere
                || *other_place == BindingScope::Everywhere;
            assert!(!(together && key == other_key), "{key:?} is bound twice");
        }
    }
}

#[test]
fn the_wheel_zooms_around_the_pointer() {
    let layout = ScreenLayout::new(Rect::new(0, 0, 80, 24)).expect("room for the scope");
    let wheel = |column, row| MouseEvent {
        kind: MouseEventKind::ScrollUp,
        column,
        row,
        modifiers: KeyModifiers::NONE,
    };
    let action = |column, row| mouse_action(wheel(column, row), Popup::Scope, Some(&layout));
    // Three divisions right of the left edge, which is 2 left of the centre; half a cell is 1/14
    // division.
    let Some(Action::TimePerDivision { turn, anchor }) = action(9 + 21, 10) else {
        panic!("no zoom");
    };
    assert_eq!(turn, TurnDirection::Down);
    assert!((anchor + 2.0).abs() < 1.0 / 14.0, "{anchor}");
    assert_eq!(action(3, 10), None, "left of the graticule");
    assert_eq!(
        mouse_action(wheel(3, 10), Popup::Help, Some(&layout)),
        Some(Action::Scroll(TurnDirection::Up, 1))
    );
}

/// The mouse on the lines of readings: what stands under the pointer is what is turned.
#[test]
fn readings_are_turned_with_the_mouse() {
    let session = Session::bench("magnet-0.61g");
    let model = &session.model;
    let area = Rect::new(0, 0, 80, 24);
    let layout = view::layout_of(model, area).expect("room");
    let screen = draw(model, 80, 24);
    let at = |text: &str, kind: MouseEventKind| {
        let (column, row) = screen.find(text);
        let event = MouseEvent { kind, column: column + 1, row, modifiers: KeyModifiers::NONE };
        action(&Event::Mouse(event), model, Some(&layout))
    };
    let (up, down) = (MouseEventKind::ScrollUp, MouseEventKind::ScrollDown);
    let left = MouseEventKind::Down(MouseButton::Left);
    let right = MouseEventKind::Down(MouseButton::Right);
    for (text, kind, expected) in [
        ("CH1 1.00V  ", up, Some(Action::VoltsPerDivision(TurnDirection::Down))),
        ("CH1 1.00V  ", left, Some(Action::Trace(Source::Channel(1)))),
        ("CH3 1.00V  ", left, Some(Action::Trace(Source::Channel(3)))),
        ("CH3 1.00V  ", up, None),
        ("CH4 2.00V", left, Some(Action::Trace(Source::Channel(4)))),
        ("M 250", down, Some(Action::TimePerDivision { turn: TurnDirection::Up, anchor: 0.0 })),
        ("CH1↑500mV", up, Some(Action::TriggerLevel(TurnDirection::Up))),
        ("CH1↑500mV", left, Some(Action::TriggerSlope)),
        ("CH1↑500mV", right, Some(Action::TriggerMode)),
        ("DC", left, Some(Action::Coupling)),
        ("probe 1X", left, None),
    ] {
        assert_eq!(at(text, kind), expected, "{text} {kind:?}");
    }
}

/// A page's own keys come before those of the traces.
#[test]
fn arrows_move_the_row_of_a_list() {
    let key = |code, page| key_action(KeyEvent::new(code, KeyModifiers::NONE), Popup::Scope, page);
    let list = Some(hertzscope::tui::pages::remote::PAGE);
    assert_eq!(key(KeyCode::Down, list), Some(Action::Row(TurnDirection::Down, 1)));
    assert_eq!(key(KeyCode::PageUp, list), Some(Action::Row(TurnDirection::Up, 10)));
    assert_eq!(key(KeyCode::Down, None), Some(Action::VoltsPerDivision(TurnDirection::Up)));
}
