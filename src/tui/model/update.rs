//! Actions, and what each does to the model.

use super::{Model, Panel};
use crate::scope::{Source, Waveform};
use crate::tui::axis::{Turn, Vertical, Window};
use crate::tui::keys::BINDINGS;

/// A division in so many presses of a position key (1).
const PRESSES_PER_DIVISION: f64 = 2.0;

/// What a key or the mouse asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Leave the screen.
    Quit,
    /// Close the open panel; without one, leave.
    Back,
    /// Open a panel, or close it when it is open.
    Toggle(Panel),
    /// Move the text of a panel.
    Scroll(Turn),
    /// Press a channel's button, counted from 1: selects it and turns it on; if it is selected, turns it off or on.
    Channel(u8),
    /// Select the next trace, or the one before.
    NextTrace(Turn),
    /// Turn the selected trace off or on.
    OnOff,
    /// Turn the selected trace's V/div knob.
    VoltsPerDivision(Turn),
    /// Turn the s/div knob.
    TimePerDivision {
        /// Up is more seconds a division.
        turn: Turn,
        /// What stays in place, to the right of the screen's centre (div).
        anchor: f64,
    },
    /// Move the selected trace down or up.
    Position(Turn),
    /// Move the picture left or right.
    Pan(Turn),
    /// Show another shot.
    Shot(Turn),
    /// Back to how everything was recorded.
    Reset,
}

/// Does what `action` asks.
pub fn update(model: &mut Model, action: Action) {
    model.notice = None;
    match action {
        Action::Quit => model.running = false,
        Action::Back if model.panel == Panel::Scope => model.running = false,
        Action::Back => model.panel = Panel::Scope,
        Action::Toggle(panel) => toggle(model, panel),
        Action::Scroll(turn) => scroll(model, turn),
        Action::Channel(number) => press(model, Source::Channel(number)),
        Action::NextTrace(turn) => next_trace(model, turn),
        Action::OnOff => {
            if let Some(source) = model.selected {
                press(model, source);
            }
        }
        Action::VoltsPerDivision(turn) => adjust(model, |waveform, vertical| Vertical {
            scale: vertical.turned(waveform, turn),
            ..vertical
        }),
        Action::Position(turn) => adjust(model, |_, vertical| Vertical {
            position: vertical.moved(turn.sign() / PRESSES_PER_DIVISION),
            ..vertical
        }),
        Action::TimePerDivision { turn, anchor } => {
            look(model, |window, waveform| window.zoomed(waveform, turn, anchor));
        }
        Action::Pan(turn) => look(model, |window, waveform| {
            window.panned(waveform, -turn.sign() / PRESSES_PER_DIVISION)
        }),
        Action::Shot(turn) => change_shot(model, turn),
        Action::Reset => {
            model.window = None;
            for adjustment in model.adjustments.values_mut() {
                adjustment.scale = None;
                adjustment.position = None;
            }
        }
    }
}

fn toggle(model: &mut Model, panel: Panel) {
    model.scroll = 0;
    model.panel = if model.panel == panel { Panel::Scope } else { panel };
}

/// Moves a panel's text by a line; there is always a line left to see.
fn scroll(model: &mut Model, turn: Turn) {
    let last = match model.panel {
        Panel::Scope => 0,
        Panel::Help => BINDINGS.len(),
        Panel::Log => model.set.problems.len() + model.set.log.len(),
    };
    model.scroll = match turn {
        Turn::Up => model.scroll.saturating_sub(1),
        Turn::Down => (model.scroll + 1).min(last),
    };
}

/// A press of a trace's button.
fn press(model: &mut Model, source: Source) {
    if model.find(source).is_none() {
        model.notice = Some(format!("{source} is not in this shot"));
        return;
    }
    let again = model.is_selected(source);
    let adjustment = model.adjustments.entry(source).or_default();
    adjustment.off = again && !adjustment.off;
    select(model, source);
}

/// Selects a trace; if it has another abscissa, the screen changes to that.
fn select(model: &mut Model, source: Source) {
    let unit = |model: &Model| model.selected().map(|c| c.waveform.preamble.x_unit.clone());
    let before = unit(model);
    model.selected = Some(source);
    if unit(model) != before {
        model.window = None;
    }
}

fn next_trace(model: &mut Model, turn: Turn) {
    let captures = model.captures();
    let Some(last) = captures.len().checked_sub(1) else {
        return;
    };
    let here = captures.iter().position(|c| model.is_selected(c.waveform.source)).unwrap_or(0);
    let next = match turn {
        Turn::Up if here == last => 0,
        Turn::Up => here + 1,
        Turn::Down => here.checked_sub(1).unwrap_or(last),
    };
    if let Some(source) = captures.get(next).map(|c| c.waveform.source) {
        select(model, source);
    }
}

/// Changes how the selected trace stands on the screen; back at the recorded setting, nothing is kept.
fn adjust(model: &mut Model, change: impl Fn(&Waveform, Vertical) -> Vertical) {
    let Some(waveform) = model.selected().map(|c| &c.waveform) else {
        return;
    };
    let source = waveform.source;
    let recorded = Vertical::recorded(waveform);
    let changed = change(waveform, model.vertical(waveform));
    let scale = Vertical { position: recorded.position, ..changed };
    let position = Vertical { scale: recorded.scale, ..changed };
    let adjustment = model.adjustments.entry(source).or_default();
    adjustment.scale = (!scale.same_as(&recorded)).then_some(changed.scale);
    adjustment.position = (!position.same_as(&recorded)).then_some(changed.position);
}

/// Changes what of the abscissa is on screen; back at the recorded window, nothing is kept.
fn look(model: &mut Model, change: impl Fn(Window, &Waveform) -> Window) {
    let (Some(window), Some(capture)) = (model.window(), model.selected()) else {
        return;
    };
    let recorded = Window::recorded(&capture.waveform);
    let window = change(window, &capture.waveform);
    model.window = (!window.same_as(&recorded)).then_some(window);
}

/// Shows another shot, the same part of it where it was recorded alike.
fn change_shot(model: &mut Model, turn: Turn) {
    let before = model.recorded_window();
    let next = match turn {
        Turn::Down => model.shot.checked_sub(1),
        Turn::Up => Some(model.shot + 1).filter(|next| *next < model.set.shots.len()),
    };
    let Some(next) = next else {
        model.notice = Some("there is no further shot in this direction".to_owned());
        return;
    };
    model.shot = next;
    model.keep_selection();
    let alike = match (before, model.recorded_window()) {
        (Some(before), Some(now)) => before.same_as(&now),
        _ => false,
    };
    if !alike {
        model.window = None;
    }
}
