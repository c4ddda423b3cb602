//! Time against accuracy on this scene, and the present setting.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::Line;
use ratatui::widgets::Paragraph;

use super::study;
use crate::studies::cost::{self, ChosenMethod, CostStudy, Point};
use crate::tui::model::{Page, PageSpec, ScreenState};
use crate::tui::view::axes::put;
use crate::tui::view::colours::colour;
use crate::tui::view::diagram::{Diagram, DiagramAxis};
use crate::tui::view::layout::ScreenLayout;

/// Errors that the plot reaches from (1).
const MIN_ERROR: f64 = 1e-14;

/// The page.
pub const PAGE: Page = Page(&PageSpec {
    name: "accuracy",
    key: 'k',
    help: "work against precision of every method",
    hints: &[("?", "help"), ("Esc", "traces"), ("y", "effects"), ("w", "save")],
    is_wide: true,
    opened,
    draw,
    ..PageSpec::PLAIN
});

/// Asks for the study, unless it is there.
fn opened(model: &mut ScreenState) {
    let Some(scene) = study::scene(model) else { return };
    study::ask(
        model,
        |jobs| &mut jobs.study,
        move |progress| cost::study(&scene, cost::TIMED_RUNS, progress).map(Box::new),
    );
}

/// Draws the page.
fn draw(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let words = ("the work-precision study", "the bench has changed: press k twice to compute it");
    if let Some(study) = study::done(&model.jobs.study, words, area, frame) {
        study_of(model, study, area, frame);
    }
}

/// A letter and a colour for each method.
fn method_style(index: usize) -> (char, Color) {
    const COLOURS: [Color; 9] = [
        Color::Yellow,
        Color::Cyan,
        Color::Magenta,
        Color::Green,
        Color::LightRed,
        Color::LightBlue,
        Color::White,
        Color::LightMagenta,
        Color::LightGreen,
    ];
    let letter = u8::try_from(index).ok().and_then(|i| b'a'.checked_add(i)).map_or('?', char::from);
    (letter, COLOURS.get(index).copied().unwrap_or(Color::Gray))
}

/// Time of a run (s) and the worst of its errors (1); none for a point that failed.
fn place_of(point: &Point) -> Option<(f64, f64)> {
    let errors = [point.error_peak?, point.error_arrival?];
    let is_timed = !point.failed && point.wall_s_median > 0.0;
    is_timed.then(|| (point.wall_s_median, errors.into_iter().fold(MIN_ERROR, f64::max)))
}

/// The choice of `--accuracy` nearest to the present setting.
fn present<'a>(model: &ScreenState, study: &'a CostStudy) -> Option<&'a ChosenMethod> {
    let wanted = model
        .recordings
        .front()
        .live
        .as_ref()
        .and_then(|live| live.summary.as_ref()?.accuracy)
        .or_else(|| Some(model.recordings.front().scene.as_ref()?.accuracy))
        .unwrap_or(crate::scene::DEFAULT_ACCURACY);
    let distance = |chosen: &ChosenMethod| (chosen.accuracy.log10() - wanted.log10()).abs();
    study.chosen.iter().min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

fn study_of(model: &ScreenState, study: &CostStudy, area: Rect, frame: &mut Frame) {
    let times = study.points.iter().filter_map(place_of).map(|(time, _)| time);
    let (low, high) =
        times.fold((f64::INFINITY, 0.0), |(low, high): (f64, f64), t| (low.min(t), high.max(t)));
    let (low, high) = if low.is_finite() { (low, high) } else { (1e-6, 1.0) };
    let grid = colour(model.palette(), Color::DarkGray);
    let legend = legend(model, study, area.width);
    let legend_rows = u16::try_from(legend.len()).unwrap_or(0);
    let below = Rect { y: area.y + 1, height: area.height.saturating_sub(1 + legend_rows), ..area };
    let axes = (
        DiagramAxis::logarithmic(low / 1.5, high * 1.5, "s"),
        DiagramAxis::logarithmic(MIN_ERROR, 1.0, ""),
    );
    let mut sheet = Diagram::new(below, axes.0, axes.1, grid);
    for (index, rows) in study.points.chunk_by(|a, b| a.method == b.method).enumerate() {
        let points = rows.iter().filter_map(place_of);
        sheet.line(points, colour(model.palette(), method_style(index).1));
    }
    sheet.level(study.reference.error.max(MIN_ERROR), colour(model.palette(), Color::Gray));
    sheet.draw(colour(model.palette(), Color::Gray), frame);
    for (index, rows) in study.points.chunk_by(|a, b| a.method == b.method).enumerate() {
        let (letter, tint) = method_style(index);
        let style = Style::new().fg(colour(model.palette(), tint));
        for point in rows {
            if let Some(at) = place_of(point) {
                sheet.write(at, &letter.to_string(), style, frame);
            }
        }
    }
    if let Some(chosen) = present(model, study) {
        let at = (chosen.wall_s_median, chosen.error.unwrap_or(1.0).max(MIN_ERROR));
        let style = Style::new().add_modifier(Modifier::REVERSED | Modifier::BOLD);
        let text = format!("◆ now: accuracy {:.0e}, {}", chosen.accuracy, chosen.method);
        sheet.write(at, &text, style, frame);
    }
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let head = format!("{}: error of peaks and arrivals (up) against time of one run", study.scene);
    put(frame.buffer_mut(), area, area.y, &head, bold);
    let y = area.bottom().saturating_sub(legend_rows);
    frame.render_widget(Paragraph::new(legend), Rect { y, height: legend_rows, ..area });
}

/// The methods with their letters, in as many lines of `width` columns as they need.
fn legend(model: &ScreenState, study: &CostStudy, width: u16) -> Vec<Line<'static>> {
    let mut lines = vec![Line::default()];
    for (index, rows) in study.points.chunk_by(|a, b| a.method == b.method).enumerate() {
        let (letter, tint) = method_style(index);
        let name = rows.first().map_or("", |point| point.method);
        let text = format!("{letter} {name}  ");
        let style = Style::new().fg(colour(model.palette(), tint));
        if lines.last().is_some_and(|line| line.width() + text.len() > usize::from(width)) {
            lines.push(Line::default());
        }
        if let Some(line) = lines.last_mut() {
            line.push_span(ratatui::text::Span::styled(text, style));
        }
    }
    lines
}
