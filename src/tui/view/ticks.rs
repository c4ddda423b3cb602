//! Ticks of the graticule's axes: at round values, wherever the axes are shifted to.

use super::divisions::{dot_of_division, whole};
use super::layout::ScreenLayout;
use crate::tui::axis::{DIVISIONS_UP, Steps, Vertical, ViewWindow};
use crate::tui::model::ScreenState;

/// Length of a tick.
const TICK_DOTS: u16 = 3;

/// Round values on the screen of a trace that stands so, each with its multiple of a round step
/// (unit).
pub(in crate::tui) fn ordinate_ticks(vertical: Vertical) -> Vec<(i64, f64)> {
    let half = f64::from(DIVISIONS_UP) / 2.0;
    let edge = |division: f64| (division - vertical.position) * vertical.scale;
    Steps::OneTwoFive.multiples((edge(-half), edge(half)), vertical.scale)
}

/// Round abscissae in a window, each with its multiple of a round step (s; Hz for an FFT).
pub(in crate::tui) fn abscissa_ticks(window: ViewWindow) -> Vec<(i64, f64)> {
    Steps::OneTwoAndHalfFive.multiples((window.left(), window.right()), window.scale)
}

/// Dots of the ticks at round values: at the bottom those of the abscissa, at the left those of the
/// selected trace. Of an axis that is not shifted they are the divisions' lines, and none is drawn.
pub(in crate::tui) fn ticks(
    model: &ScreenState,
    layout: &ScreenLayout,
    window: ViewWindow,
) -> Vec<(u16, u16)> {
    let (last_column, last_row) = (layout.columns() - 1, layout.rows() - 1);
    let density = f64::from(layout.x_dots) / window.scale;
    let columns = abscissa_ticks(window).into_iter();
    let columns = columns.map(|(_, value)| whole(((value - window.left()) * density).round()));
    let columns = columns.filter(|column| *column <= last_column && column % layout.x_dots > 0);
    let upward = columns
        .flat_map(|column| (1..=TICK_DOTS).map(move |dot| (column, last_row.saturating_sub(dot))));
    let selected = model.selected().map(|capture| model.vertical(&capture.waveform));
    let rows = selected.into_iter().flat_map(|vertical| {
        let division = move |value: f64| value / vertical.scale + vertical.position;
        let values = ordinate_ticks(vertical).into_iter();
        values.map(move |(_, value)| whole(dot_of_division(layout, division(value)).round()))
    });
    let rows = rows.filter(|row| *row <= last_row && row % layout.y_dots > 0);
    let inward = rows.flat_map(|row| (1..=TICK_DOTS).map(move |dot| (dot, row)));
    upward.chain(inward).collect()
}
