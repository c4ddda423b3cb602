//! The mouse: its wheel zooms around the pointer or scrolls, its button drags the picture or a
//! cursor; over a readout, the wheel changes the setting that it shows. A turn up is a larger
//! value: wheel up zooms in, to fewer volts and seconds a division.

use ratatui::crossterm::event::{KeyModifiers, MouseButton, MouseEvent, MouseEventKind};
use ratatui::layout::Position;

use crate::tui::axis::{DIVISIONS_ACROSS, DIVISIONS_UP, TurnDirection};
use crate::tui::model::{Action, Popup};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::target::Target;

/// The action of a mouse event.
pub fn mouse_action(
    event: MouseEvent,
    panel: Popup,
    layout: Option<&ScreenLayout>,
) -> Option<Action> {
    let wheel = match event.kind {
        MouseEventKind::ScrollUp => Some(TurnDirection::Down),
        MouseEventKind::ScrollDown => Some(TurnDirection::Up),
        _ => None,
    };
    if panel != Popup::Scope {
        return wheel.map(|turn| Action::Scroll(turn.other(), 1));
    }
    let layout = layout?;
    let (x, y) = divisions(event, layout);
    let inside = layout.graticule.contains(Position::new(event.column, event.row));
    match (event.kind, wheel) {
        (_, Some(turn)) if inside && event.modifiers.contains(KeyModifiers::CONTROL) => {
            Some(Action::VoltsPerDivision(turn))
        }
        (_, Some(turn)) if inside => Some(Action::TimePerDivision { turn, anchor: x }),
        (MouseEventKind::Down(MouseButton::Left), _) if inside => Some(Action::Press { x, y }),
        // A drag continues outside the graticule.
        (MouseEventKind::Drag(MouseButton::Left), _) => Some(Action::Drag { x, y }),
        _ => None,
    }
}

/// The action of a mouse event on a readout.
pub fn reading_action(event: MouseEvent, target: Target) -> Option<Action> {
    let wheel = match event.kind {
        MouseEventKind::ScrollUp => Some(TurnDirection::Up),
        MouseEventKind::ScrollDown => Some(TurnDirection::Down),
        _ => None,
    };
    let click = match event.kind {
        MouseEventKind::Down(button) => Some(button),
        _ => None,
    };
    match (target, wheel, click) {
        (Target::Trace(_, true), Some(turn), _) => Some(Action::VoltsPerDivision(turn.other())),
        (Target::Trace(source, _), _, Some(MouseButton::Left)) => Some(Action::Trace(source)),
        (Target::TimeBase, Some(turn), _) => {
            Some(Action::TimePerDivision { turn: turn.other(), anchor: 0.0 })
        }
        (Target::Trigger, Some(turn), _) => Some(Action::TriggerLevel(turn)),
        (Target::Trigger, _, Some(MouseButton::Left)) => Some(Action::TriggerSlope),
        (Target::Trigger, _, Some(MouseButton::Right)) => Some(Action::TriggerMode),
        (Target::Coupling, _, Some(MouseButton::Left)) => Some(Action::Coupling),
        _ => None,
    }
}

/// The pointer's place from the graticule's centre, right and up, in divisions.
fn divisions(event: MouseEvent, layout: &ScreenLayout) -> (f64, f64) {
    // The middle of a cell, two dots wide and four high.
    let dots = |cell: u16, first: u16, wide: f64| {
        (f64::from(cell) - f64::from(first)) * wide + 0.5 * (wide - 1.0)
    };
    let x = dots(event.column, layout.graticule.x, 2.0) / f64::from(layout.x_dots);
    let y = dots(event.row, layout.graticule.y, 4.0) / f64::from(layout.y_dots);
    (x - f64::from(DIVISIONS_ACROSS) / 2.0, f64::from(DIVISIONS_UP) / 2.0 - y)
}
