//! The selected trace upward against the first other one to the right, as in the instrument's XY format.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Span;

use super::layout::ScreenLayout;
use super::sheet::{Diagram, DiagramAxis};
use super::{colour, colour_of, message};
use crate::scope::Waveform;
use crate::tui::model::{ScreenState, Visibility, ordinate_unit};

/// Lowest and highest value with a little room (unit).
fn range(waveform: &Waveform) -> (f64, f64) {
    let values = waveform.codes.iter().map(|code| waveform.volts_of(*code));
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low < high { (low - 0.05 * (high - low), high + 0.05 * (high - low)) } else { (-1.0, 1.0) }
}

/// Draws the page.
pub(super) fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let Some(y) = model.selected().map(|capture| &capture.waveform) else {
        return message("there is no trace", area, frame);
    };
    let others = model.captures().iter().map(|capture| &capture.waveform);
    let other = others
        .filter(|w| w.source != y.source && model.visibility(w) == Visibility::Shown)
        .find(|w| w.codes.len() == y.codes.len());
    let Some(x) = other else {
        return message("XY needs a second trace of the same length: select with 1-4", area, frame);
    };
    let palette = model.palette();
    let ((left, right), (low, high)) = (range(x), range(y));
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let grid = colour(palette, Color::DarkGray);
    let axes = (
        DiagramAxis::linear(left, right, ordinate_unit(x)),
        DiagramAxis::linear(low, high, ordinate_unit(y)),
    );
    let mut sheet = Diagram::new(below, axes.0, axes.1, grid);
    let points = x.codes.iter().zip(&y.codes).map(|(a, b)| (x.volts_of(*a), y.volts_of(*b)));
    sheet.line(points, colour_of(palette, y.source));
    sheet.draw(colour(palette, Color::Gray), frame);
    let head = format!("XY: {} upward, {} to the right", y.source, x.source);
    let bold = Style::new().add_modifier(Modifier::BOLD);
    frame.render_widget(Span::styled(head, bold), Rect { height: 1, ..area });
}
