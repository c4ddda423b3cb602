//! Which traces are on the screen, and as what.

use super::{MathMode, ScreenState};
use crate::scope::Source;
use crate::tui::axis::TurnDirection;

pub(super) fn next_math(model: &mut ScreenState) {
    // Pairs whose channels were not recorded are passed over.
    for _ in 0..7 {
        model.math = model.math.next();
        model.reload_traces();
        let shown = model.find(Source::Math).is_some();
        if shown || model.math == MathMode::Off {
            break;
        }
    }
    model.notice = Some(format!("MATH {}", model.math.name()));
}

pub(super) fn truth(model: &mut ScreenState) {
    model.truth = !model.truth;
    let has = model.shot().is_some_and(|shot| !shot.truth.is_empty());
    let words = match (model.truth, has) {
        (true, true) => {
            "over each trace: what really happened at its sensor, before the electronics"
        }
        (true, false) => "this recording holds no truth: it was measured, or thinned",
        (false, _) => "truth off",
    };
    model.notice = Some(words.to_owned());
}

pub(super) fn unit(model: &mut ScreenState) {
    model.newtons = !model.newtons;
    for adjustment in model.adjustments.values_mut() {
        adjustment.scale = None;
        adjustment.position = None;
    }
    model.cursors.pair = None;
    let words = if model.newtons { "newtons: droop undone, baseline taken off" } else { "volts" };
    model.notice = Some(words.to_owned());
    model.reload_traces();
    model.place_cursors();
}

pub(super) fn reset(model: &mut ScreenState) {
    if model.shows_frequencies() {
        model.band = None;
        return;
    }
    model.window = None;
    for adjustment in model.adjustments.values_mut() {
        adjustment.scale = None;
        adjustment.position = None;
    }
}

/// A press of a trace's button.
pub(super) fn press(model: &mut ScreenState, source: Source) {
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
fn select(model: &mut ScreenState, source: Source) {
    let unit = |model: &ScreenState| model.selected().map(|c| c.waveform.preamble.x_unit.clone());
    let before = unit(model);
    model.selected = Some(source);
    if unit(model) != before {
        model.window = None;
    }
}

pub(super) fn next_trace(model: &mut ScreenState, turn: TurnDirection) {
    let captures = model.captures();
    let Some(last) = captures.len().checked_sub(1) else {
        return;
    };
    let here = captures.iter().position(|c| model.is_selected(c.waveform.source)).unwrap_or(0);
    let next = match turn {
        TurnDirection::Up if here == last => 0,
        TurnDirection::Up => here + 1,
        TurnDirection::Down => here.checked_sub(1).unwrap_or(last),
    };
    if let Some(source) = captures.get(next).map(|c| c.waveform.source) {
        select(model, source);
    }
}
