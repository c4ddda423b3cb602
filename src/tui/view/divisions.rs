//! From divisions of the graticule to dots of the terminal.

use super::layout::ScreenLayout;
use crate::tui::axis::DIVISIONS_UP;

/// Row of dots, from the top, of a place counted in divisions upward from the centre (dots).
pub(in crate::tui) fn dot_of_division(layout: &ScreenLayout, division: f64) -> f64 {
    (f64::from(DIVISIONS_UP) / 2.0 - division) * f64::from(layout.y_dots)
}

/// A place on the screen from a number that is known to be one.
pub(in crate::tui) fn whole(value: f64) -> u16 {
    value as u16
}
