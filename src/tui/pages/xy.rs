//! The first trace to the right and the selected one upward, as in the instrument's XY format.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Span;

use crate::scope::Waveform;
use crate::tui::model::{Page, PageSpec, ScreenState, Visibility, ordinate_unit};
use crate::tui::view::colours::{colour, colour_of};
use crate::tui::view::diagram::{Diagram, DiagramAxis};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::panel::message;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "xy",
    key: 'x',
    help: "XY: the selected trace against the first one",
    hints: &[
        ("?", "help"),
        ("Esc", "traces"),
        ("1-4", "vertical trace"),
        (", .", "shot"),
        ("w", "save"),
    ],
    draw,
    ..PageSpec::PLAIN
});

/// Lowest and highest value with a little room (unit).
fn range(waveform: &Waveform) -> (f64, f64) {
    let values = waveform.values();
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low < high { (low - 0.05 * (high - low), high + 0.05 * (high - low)) } else { (-1.0, 1.0) }
}

/// Draws the page.
fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let shown: Vec<&Waveform> = model
        .captures()
        .iter()
        .map(|capture| &capture.waveform)
        .filter(|waveform| model.visibility(waveform) == Visibility::Shown)
        .collect();
    // The first trace goes to the right, as CH1 does on the instrument.
    let pair = shown.first().and_then(|x| {
        let mut others =
            shown.iter().filter(|w| w.source != x.source && w.codes.len() == x.codes.len());
        let selected = model.selected().map(|capture| capture.waveform.source);
        let y = others.clone().find(|w| Some(w.source) == selected).or_else(|| others.next())?;
        Some((*x, *y))
    });
    let Some((x, y)) = pair else {
        return message("XY needs two traces of the same length: show them with 1-4", area, frame);
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
    let points = x.values().zip(y.values());
    sheet.line(points, colour_of(palette, y.source));
    sheet.draw(colour(palette, Color::Gray), frame);
    let head = format!("XY: {} upward, {} to the right", y.source, x.source);
    let bold = Style::new().add_modifier(Modifier::BOLD);
    frame.render_widget(Span::styled(head, bold), Rect { height: 1, ..area });
}
