//! Readings under the mouse.

use ratatui::layout::Position;

use super::layout::ScreenLayout;
use super::readout::{READING_GAP, Readings, detail_parts, width};
use crate::scope::Source;
use crate::tui::model::ScreenState;

/// A reading that the mouse can turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// A trace's reading, and whether that is selected.
    Trace(Source, bool),
    /// The time base.
    TimeBase,
    /// The trigger.
    Trigger,
    /// The selected trace's coupling.
    Coupling,
}

/// The reading at a position; none beside the readings.
pub fn target(model: &ScreenState, layout: &ScreenLayout, at: Position) -> Option<Target> {
    if layout.detail.contains(at) {
        let coupling = model.selected()?.waveform.vertical.coupling?.to_string();
        let mut parts = detail_parts(model, layout);
        let place = parts.iter().position(|part| part.content == coupling)?;
        let word = parts.get(place)?.width();
        parts.truncate(place);
        let left = usize::from(layout.detail.x) + width(&parts);
        let inside = (left..left + word).contains(&usize::from(at.x));
        return inside.then_some(Target::Coupling);
    }
    if !layout.channels.contains(at) {
        return None;
    }
    let readings = Readings::of(model, layout);
    let x = usize::from(at.x - layout.channels.x);
    let from_right = usize::from(layout.channels.right() - at.x);
    let (base, trigger) = (readings.base.chars().count(), readings.trigger.chars().count());
    if from_right <= trigger {
        return Some(Target::Trigger);
    }
    if from_right <= trigger + READING_GAP.len() + base {
        return Some(Target::TimeBase);
    }
    let mut left = 0;
    readings.traces.iter().find_map(|(source, part)| {
        let inside = (left..left + part.width()).contains(&x);
        left += part.width() + READING_GAP.len();
        inside.then(|| Target::Trace(*source, model.is_selected(*source)))
    })
}
