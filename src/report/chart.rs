//! Curves as an SVG picture: a sheet with one plot.

use super::plot::{Curve, Label, PointSet};
use super::sheet::{Axis, Plot, Polyline, Sheet, Stroke, sheet_svg};

/// Points of a line in order (unit).
pub type PlotLine = Vec<(f64, f64)>;

/// Size of the plot's frame (pixels).
pub(super) const SIZE: (f64, f64) = (780.0, 356.0);
/// Height of a mark's name, as a share of the frame's (1).
const NAME_HEIGHT: f64 = 16.0 / SIZE.1;
/// Distance of a mark's name from its line, as a share of the frame's width (1).
const NAME_DISTANCE: f64 = 4.0 / SIZE.0;
/// Room above and below a curve, as a share of its height (1).
const PADDING: f64 = 0.04;
const CURVE_COLOUR: &str = "#1060b0";
const BACKGROUND_COLOUR: &str = "#909090";
const MARK_COLOUR: &str = "#c04020";

/// What lies under a curve, in grey: a line, or the area between two.
#[derive(Debug, Clone, PartialEq)]
pub struct Under {
    name: String,
    edges: Vec<PlotLine>,
}

impl Under {
    /// The line, or the area between both lines, called `name` in the legend.
    pub fn new(name: &str, edges: Vec<PlotLine>) -> Self {
        Self { name: name.to_owned(), edges }
    }
}

/// The picture of `curve`, titled `title`.
pub fn chart(curve: &Curve, title: &str) -> String {
    chart_over(curve, &[], title)
}

/// The same with lines and areas under it.
pub fn chart_over(curve: &Curve, under: &[Under], title: &str) -> String {
    picture(title, plot_over(curve, under))
}

/// The picture of several curves, each in a plot of its own with what is under it.
pub fn charts_over(panels: &[(Curve, Vec<Under>)], title: &str) -> String {
    let panels = panels.iter().map(|(curve, under)| plot_over(curve, under)).collect();
    let (legend, note) = (Vec::new(), String::new());
    sheet_svg(&Sheet { title: title.to_owned(), columns: 1, size: SIZE, panels, legend, note })
}

fn plot_over(curve: &Curve, under: &[Under]) -> Plot {
    let below = || under.iter().flat_map(|under| &under.edges).flatten().copied();
    let all =
        Curve { points: curve.points.iter().copied().chain(below()).collect(), ..curve.clone() };
    let ((x0, x1), (y0, y1)) = all.bounds();
    let padding = PADDING * (y1 - y0);
    let (y0, y1) = (if y0 < 0.0 { y0 - padding } else { y0 }, y1 + padding);
    let mut plot = Plot::new("", axis(&curve.x, (x0, x1)), axis(&curve.y, (y0, y1)));
    for Under { name, edges } in under {
        let (points, stroke) = match edges.as_slice() {
            [low, high] => (low.iter().chain(high.iter().rev()).copied().collect(), Stroke::Filled),
            lines => (lines.concat(), Stroke::Solid),
        };
        plot.lines
            .push(Polyline { name: name.clone(), ..line(&points, BACKGROUND_COLOUR, stroke) });
    }
    let inside = curve.marks.iter().filter(|(place, _)| (x0..=x1).contains(place));
    for ((place, name), number) in inside.zip(1_u32..) {
        plot.lines.push(line(&[(*place, y0), (*place, y1)], MARK_COLOUR, Stroke::Dashed));
        // Each name a line lower, so that marks close to each other stay readable.
        let height = y1 - f64::from(number) * NAME_HEIGHT * (y1 - y0);
        plot.words.push((place + NAME_DISTANCE * (x1 - x0), height, name.clone()));
    }
    if !curve.points.is_empty() {
        plot.lines.push(line(&curve.points, CURVE_COLOUR, Stroke::Solid));
    }
    plot
}

/// The picture of several curves with points on them, from zero in both directions.
pub fn chart_with_points(
    curves: &[Vec<(f64, f64)>],
    clouds: &[PointSet<'_>],
    title: &str,
    labels: &[Label; 2],
) -> String {
    let points = curves.iter().chain(clouds.iter().map(|cloud| &cloud.points)).flatten();
    let (x1, y1) = points.fold((0.0, 0.0), |(x, y): (f64, f64), p| (x.max(p.0), y.max(p.1)));
    let y1 = (1.0 + PADDING) * y1;
    let mut plot = Plot::new("", axis(&labels[0], (0.0, x1)), axis(&labels[1], (0.0, y1)));
    plot.lines.extend(curves.iter().map(|curve| line(curve, CURVE_COLOUR, Stroke::Solid)));
    plot.lines.extend(clouds.iter().map(|cloud| Polyline {
        name: cloud.name.to_owned(),
        ..line(&cloud.points, cloud.colour, Stroke::Dots)
    }));
    picture(title, plot)
}

fn axis(label: &Label, range: (f64, f64)) -> Axis {
    Axis::prefixed(&label.name, &label.unit, range)
}

fn line(points: &[(f64, f64)], colour: &'static str, stroke: Stroke) -> Polyline {
    Polyline { name: String::new(), points: points.to_vec(), colour, stroke }
}

/// A horizontal line across `x` at `height` (unit), for marks.
pub(super) fn level(x: &Axis, height: f64) -> Polyline {
    line(&[(x.from, height), (x.to, height)], MARK_COLOUR, Stroke::Dashed)
}

/// One plot as a picture.
pub(super) fn picture(title: &str, plot: Plot) -> String {
    sheet_svg(&Sheet {
        title: title.to_owned(),
        columns: 1,
        size: SIZE,
        panels: vec![plot],
        legend: Vec::new(),
        note: String::new(),
    })
}
