//! The model as a picture: what is around the pages, and the traces. Nothing here changes the
//! model.

pub(in crate::tui) mod axes;
pub(in crate::tui) mod colours;
mod cursors;
pub(in crate::tui) mod diagram;
mod graticule;
mod help;
pub mod layout;
mod overview;
pub(in crate::tui) mod panel;
pub mod picture;
pub(in crate::tui) mod readout;
mod side;
mod status;
pub mod target;
mod trace;

use ratatui::Frame;
use ratatui::layout::{Alignment, Rect};
use ratatui::widgets::{Clear, Paragraph, Wrap};

use crate::tui::model::{Popup, ScreenState, SidePanel};
use layout::{SMALLEST_HEIGHT, SMALLEST_WIDTH, ScreenLayout};

/// From this width on there is room for tables and something beside them.
const WIDTH_WITH_TABLES: u16 = 112;

/// Where everything stands for `model` on a terminal of `area`; `None` if it is too small.
pub fn layout_of(model: &ScreenState, area: Rect) -> Option<ScreenLayout> {
    // Tables need all columns of a small terminal.
    let is_wide = model.page.is_some_and(|page| page.0.is_wide);
    let room = !is_wide || area.width >= WIDTH_WITH_TABLES;
    ScreenLayout::with_side(area, model.side() != SidePanel::Nothing && room)
}

/// Draws the whole screen.
pub fn draw(model: &ScreenState, frame: &mut Frame) {
    let area = frame.area();
    let Some(layout) = layout_of(model, area) else {
        too_small(area, frame);
        return;
    };
    status::draw(model, &layout, frame);
    match model.page {
        None => traces(model, &layout, frame),
        Some(page) => (page.0.draw)(model, &layout, frame),
    }
    if layout.side.width > 0 || model.page.is_none() {
        side::draw(model, &layout, frame);
    }
    readout::channels(model, &layout, frame);
    if !cursors::readout(model, &layout, frame) {
        readout::detail(model, &layout, frame);
    }
    let zoomed = model.is_zoomed() && model.page.is_none();
    let shared = layout.overview == layout.hints;
    let prompt = model.panel() == Popup::Prompt;
    if zoomed {
        overview::draw(model, &layout, frame);
    }
    if !(shared && zoomed) || model.notice.is_some() || prompt {
        status::hints(model, &layout, frame);
    }
    match model.panel() {
        Popup::Scope | Popup::Prompt => {}
        Popup::Help | Popup::Search => help::help(model, frame),
        Popup::Log => help::log(model, frame),
    }
}

/// The traces over time.
fn traces(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    graticule::draw(model, layout, frame);
    axes::draw(model, layout, frame);
    if model.captures().is_empty() {
        nothing(model, layout, frame);
    }
}

/// Says how much more room is needed.
fn too_small(area: Rect, frame: &mut Frame) {
    let text = format!(
        "This terminal is {} x {}; the scope needs {SMALLEST_WIDTH} x {SMALLEST_HEIGHT}. Please enlarge it, or press q.",
        area.width, area.height
    );
    frame.render_widget(Paragraph::new(text).wrap(Wrap { trim: true }), area);
}

/// Says why there is no trace.
fn nothing(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let text = match model.shot() {
        None => match &model.recordings.front().live {
            Some(live) => match &live.served {
                Some(served) if served.bench => {
                    "Waiting for the scope's first record: i strikes the chain"
                }
                Some(_) => "Waiting for the scope's first record",
                None => "Striking the chain ...",
            },
            None if model.is_growing() => "Waiting for the first shot ...",
            None => "This recording holds no shots.",
        },
        Some(shot) if !shot.truth.is_empty() => {
            "This shot holds no captures: b shows the chain in motion"
        }
        Some(_) => "This shot holds no captures.",
    };
    let area = layout.graticule;
    let middle = Rect { y: area.y + area.height / 2, height: 1, ..area };
    frame.render_widget(Clear, middle);
    frame.render_widget(Paragraph::new(text).alignment(Alignment::Center), middle);
}
