//! Where everything stands on the terminal.
//!
//! A graticule's division is a whole number of dots in both directions, so that division lines are
//! exact and a trace at 2 divisions lies on the line of 2 divisions. A cell has 2 dots across and 4
//! up.

use ratatui::layout::Rect;

use crate::tui::axis::{DIVISIONS_ACROSS, DIVISIONS_UP};

/// The narrowest terminal that the scope fits on, in columns.
pub const SMALLEST_WIDTH: u16 = 40;
/// The lowest terminal that the scope fits on, in rows.
pub const SMALLEST_HEIGHT: u16 = 12;

/// Columns for the ground markers.
const MARKER_WIDTH: u16 = 2;
/// Columns for the labels of the ordinate.
const LABEL_WIDTH: u16 = 7;
/// Columns of what stands beside the page.
pub const SIDE_WIDTH: u16 = 30;
/// From this width on there is room for that.
pub const WIDTH_WITH_SIDE: u16 = 72;
/// From this width on there is room for labels of the ordinate.
const WIDTH_WITH_LABELS: u16 = 60;

/// The parts of the screen; a part that the terminal has no room for has no height or no width.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScreenLayout {
    /// Title, state, shot and position of the centre.
    pub status: Rect,
    /// The trigger's marker, above the graticule or on its top row.
    pub trigger: Rect,
    /// Labels of the ordinate.
    pub labels: Rect,
    /// Ground markers.
    pub markers: Rect,
    /// The divisions with the traces.
    pub graticule: Rect,
    /// Labels of the abscissa.
    pub abscissa: Rect,
    /// Everything between status line and readings, for pages that are no graticule.
    pub page: Rect,
    /// The side panel; without width where it is closed or does not fit.
    pub side: Rect,
    /// One reading a channel, and the time base.
    pub channels: Rect,
    /// The selected trace in full.
    pub detail: Rect,
    /// Where in the record the screen is; on low terminals the same row as the hints.
    pub overview: Rect,
    /// The most important keys.
    pub hints: Rect,
    /// Dots in a division across.
    pub x_dots: u16,
    /// Dots in a division up.
    pub y_dots: u16,
}

/// Heights of the rows around the graticule.
struct Rows {
    trigger: u16,
    detail: u16,
    overview: u16,
    hints: u16,
}

impl Rows {
    /// The parts that fit on `height` rows; the graticule comes first.
    fn new(height: u16) -> Self {
        let (trigger, detail, overview, hints) = match height {
            40.. => (1, 1, 2, 1),
            24.. => (1, 1, 1, 1),
            18.. => (1, 1, 0, 1),
            14.. => (1, 1, 0, 0),
            _ => (0, 0, 0, 0),
        };
        Self { trigger, detail, overview, hints }
    }

    /// All rows but the graticule's; status, abscissa and channels are always there.
    fn sum(&self) -> u16 {
        3 + self.trigger + self.detail + self.overview + self.hints
    }
}

impl ScreenLayout {
    /// Divides `area`; `None` if it is too small.
    pub fn new(area: Rect) -> Option<Self> {
        Self::with_side(area, false)
    }

    /// The same with a column beside the page, if `beside` and there is room.
    pub fn with_side(area: Rect, beside: bool) -> Option<Self> {
        if area.width < SMALLEST_WIDTH || area.height < SMALLEST_HEIGHT {
            return None;
        }
        let side = if beside && area.width >= WIDTH_WITH_SIDE { SIDE_WIDTH } else { 0 };
        Some(Self::divided(area, side))
    }

    fn divided(area: Rect, side: u16) -> Self {
        let page_width = area.width - side;
        let rows = Rows::new(area.height);
        let label_width = if area.width < WIDTH_WITH_LABELS { 0 } else { LABEL_WIDTH };
        let gutter = label_width + MARKER_WIDTH;
        let x_dots = ((page_width - gutter).saturating_mul(2) - 1) / DIVISIONS_ACROSS;
        let y_dots = ((area.height - rows.sum()).saturating_mul(4) - 1) / DIVISIONS_UP;
        let width = x_dots * DIVISIONS_ACROSS / 2 + 1;
        let height = y_dots * DIVISIONS_UP / 4 + 1;

        let mut y = area.y;
        let mut next = |height: u16| {
            let rect = Rect::new(area.x, y, area.width, height);
            y += height;
            rect
        };
        let status = next(1);
        let above = next(rows.trigger);
        let middle = next(height);
        let abscissa = next(1);
        let channels = next(1);
        let detail = next(rows.detail);
        let overview = next(rows.overview);
        let hints = next(rows.hints);
        let graticule = Rect::new(area.x + gutter, middle.y, width, height);
        let page_height = abscissa.bottom() - status.bottom();
        let page = Rect::new(area.x, status.bottom(), page_width, page_height);
        Self {
            status,
            trigger: Rect { y: above.y, height: 1, ..graticule },
            labels: Rect { width: label_width, ..middle },
            markers: Rect { x: area.x + label_width, width: MARKER_WIDTH, ..middle },
            graticule,
            abscissa: Rect { width: page_width, ..abscissa },
            page,
            side: Rect { x: page.right(), width: side, ..page },
            channels,
            detail,
            overview: if rows.overview == 0 { hints } else { overview },
            hints,
            x_dots,
            y_dots,
        }
    }

    /// Columns of dots on the graticule.
    pub fn columns(&self) -> u16 {
        self.x_dots * DIVISIONS_ACROSS + 1
    }

    /// Rows of dots on the graticule.
    pub fn rows(&self) -> u16 {
        self.y_dots * DIVISIONS_UP + 1
    }
}

/// Row of dots, from the top, of a place counted in divisions upward from the centre (dots).
pub(in crate::tui) fn dot_of_division(layout: &ScreenLayout, division: f64) -> f64 {
    (f64::from(DIVISIONS_UP) / 2.0 - division) * f64::from(layout.y_dots)
}

/// A place on the screen from a number that is known to be one.
pub(in crate::tui) fn whole(value: f64) -> u16 {
    value as u16
}
