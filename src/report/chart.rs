//! Curves as an SVG picture: a sheet with one plot.

use super::plot::{Curve, PointSet};
use super::sheet::{Axis, Plot, Polyline, Sheet, Stroke, sheet_svg, ticks};
use crate::quantity::engineering;

/// Points of a line in order (unit).
pub type PlotLine = Vec<(f64, f64)>;

/// Size of the plot's frame (pixels).
pub(super) const SIZE: (f64, f64) = (780.0, 356.0);
/// Height of a mark's name, as a share of the frame's (1).
const NAME_HEIGHT: f64 = 16.0 / SIZE.1;
/// Distance of a mark's name from its line, as a share of the frame's width (1).
const NAME_DISTANCE: f64 = 4.0 / SIZE.0;
const CURVE_COLOUR: &str = "#1060b0";
const BACKGROUND_COLOUR: &str = "#909090";
const MARK_COLOUR: &str = "#c04020";

/// The picture of `curve`, titled `title`, with the units of `x` and `y`.
pub fn chart(curve: &Curve, title: &str, units: (&str, &str)) -> String {
    chart_over(curve, &[], title, units)
}

/// The same with the lines `under` below it, each with its points in order.
pub fn chart_over(curve: &Curve, under: &[PlotLine], title: &str, units: (&str, &str)) -> String {
    picture(title, plot_over(curve, under, units))
}

/// The picture of several curves, each in a plot of its own with the lines under it.
pub fn charts_over(panels: &[(Curve, Vec<PlotLine>)], title: &str, units: (&str, &str)) -> String {
    let panels = panels.iter().map(|(curve, under)| plot_over(curve, under, units)).collect();
    let (legend, note) = (Vec::new(), String::new());
    sheet_svg(&Sheet { title: title.to_owned(), columns: 1, size: SIZE, panels, legend, note })
}

fn plot_over(curve: &Curve, under: &[PlotLine], units: (&str, &str)) -> Plot {
    let points = [curve.points.clone(), under.concat()].concat();
    let all = Curve { points, ..curve.clone() };
    let ((x0, x1), (y0, y1)) = all.bounds();
    let x = axis(&curve.x_label, (x0, x1), units.0);
    let mut plot = Plot::new(&curve.y_label, x, axis("", (y0, y1), units.1));
    let inside = curve.marks.iter().filter(|(place, _)| (x0..=x1).contains(place));
    for ((place, name), number) in inside.zip(1_u32..) {
        plot.lines.push(line(&[(*place, y0), (*place, y1)], MARK_COLOUR, Stroke::Dashed));
        // Each name a line lower, so that marks close to each other stay readable.
        let height = y1 - f64::from(number) * NAME_HEIGHT * (y1 - y0);
        plot.words.push((place + NAME_DISTANCE * (x1 - x0), height, name.clone()));
    }
    let below = under.iter().map(|points| (points, BACKGROUND_COLOUR));
    for (points, colour) in below.chain([(&curve.points, CURVE_COLOUR)]) {
        if !points.is_empty() {
            plot.lines.push(line(points, colour, Stroke::Solid));
        }
    }
    plot
}

/// The picture of several curves with points on them, its axes labelled, from zero in both directions.
pub fn chart_with_points(
    curves: &[Vec<(f64, f64)>],
    clouds: &[PointSet<'_>],
    (title, labels): (&str, (&str, &str)),
    units: (&str, &str),
) -> String {
    let points = curves.iter().chain(clouds.iter().map(|cloud| &cloud.points)).flatten();
    let (x1, y1) = points.fold((0.0, 0.0), |(x, y): (f64, f64), p| (x.max(p.0), y.max(p.1)));
    let x = axis(labels.0, (0.0, x1), units.0);
    let mut plot = Plot::new(labels.1, x, axis("", (0.0, y1), units.1));
    plot.lines.extend(curves.iter().map(|curve| line(curve, CURVE_COLOUR, Stroke::Solid)));
    plot.lines.extend(clouds.iter().map(|cloud| Polyline {
        name: cloud.name.to_owned(),
        ..line(&cloud.points, cloud.colour, Stroke::Dots)
    }));
    picture(title, plot)
}

/// An axis with round numbers in engineering notation.
fn axis(label: &str, (from, to): (f64, f64), unit: &str) -> Axis {
    let name = |tick| (tick, engineering(tick, unit, 3));
    let ticks = ticks(from, to).into_iter().map(name).collect();
    Axis { label: label.to_owned(), from, to, logarithmic: false, ticks }
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
