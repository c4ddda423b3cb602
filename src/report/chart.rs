//! Curves as an SVG picture: axes with round numbers, the curve, marked places.

use std::fmt::Write as _;

use super::plot::{Curve, PointSet};
use crate::quantity::engineering;

/// Size of the picture and of the frame's margins: left, right, above, below (pixels).
const SIZE: (f64, f64) = (880.0, 460.0);
const MARGINS: (f64, f64, f64, f64) = (90.0, 30.0, 48.0, 56.0);
/// Wanted number of intervals on an axis.
const TARGET_INTERVALS: f64 = 6.0;

/// The picture of `curve`, titled `title`, with the units of `x` and `y`.
pub fn chart(curve: &Curve, title: &str, units: (&str, &str)) -> String {
    chart_over(curve, &[], title, units)
}

/// The same with the points `under` as a second, thinner line below it.
pub fn chart_over(curve: &Curve, under: &[(f64, f64)], title: &str, units: (&str, &str)) -> String {
    let (width, height) = SIZE;
    let (left, right, above, below) = MARGINS;
    let (across, down) = (width - left - right, height - above - below);
    let all = Curve { points: [&curve.points, under].concat(), ..curve.clone() };
    let ((x0, x1), (y0, y1)) = all.bounds();
    let x = |value: f64| (value - x0) / (x1 - x0) * across;
    let y = |value: f64| down - (value - y0) / (y1 - y0) * down;
    let mut svg = frame(title, ((x0, x1), (y0, y1)), units);
    let inside = curve.marks.iter().filter(|(place, _)| (x0..=x1).contains(place));
    let mut line = 0.0;
    for (place, name) in inside {
        // Each name a line lower, so that marks close to each other stay readable.
        line += 1.0;
        let at = x(*place);
        let _ = writeln!(
            svg,
            "<path d=\"M{at:.1} 0V{down}\" stroke=\"#c04020\" stroke-dasharray=\"5 4\"/>\n\
             <text x=\"{:.1}\" y=\"{}\" fill=\"#c04020\">{}</text>",
            at + 4.0,
            16.0 * line - 2.0,
            super::escape(name)
        );
    }
    for (points, stroke) in [
        (under, "stroke=\"#909090\" stroke-width=\"1\""),
        (&*curve.points, "stroke=\"#1060b0\" stroke-width=\"1.6\""),
    ] {
        let mut path = String::new();
        for (index, (px, py)) in points.iter().enumerate() {
            let start = if index == 0 { 'M' } else { 'L' };
            let _ = write!(path, "{start}{:.1} {:.1}", x(*px), y(*py));
        }
        if !points.is_empty() {
            let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" {stroke}/>");
        }
    }
    let _ = writeln!(
        svg,
        "<rect width=\"{across}\" height=\"{down}\" fill=\"none\" stroke=\"#404040\"/>\n\
         <text x=\"{across}\" y=\"{}\" text-anchor=\"end\">{}</text>\n\
         <text x=\"0\" y=\"-6\">{}</text>",
        down + 40.0,
        super::escape(&curve.x_label),
        super::escape(&curve.y_label)
    );
    svg.push_str("</g>\n</svg>\n");
    svg
}

/// The picture's beginning: title, ticks and their lines.
fn frame(
    title: &str,
    ((x0, x1), (y0, y1)): ((f64, f64), (f64, f64)),
    units: (&str, &str),
) -> String {
    let (width, height) = SIZE;
    let (left, right, above, below) = MARGINS;
    let (across, down) = (width - left - right, height - above - below);
    let x = |value: f64| (value - x0) / (x1 - x0) * across;
    let y = |value: f64| down - (value - y0) / (y1 - y0) * down;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n\
         <text x=\"{left}\" y=\"26\" font-size=\"15\">{}</text>\n\
         <g transform=\"translate({left} {above})\">\n",
        super::escape(title)
    );
    for tick in ticks(x0, x1) {
        let (at, text) = (x(tick), engineering(tick, units.0, 3));
        let _ = writeln!(svg, "<path d=\"M{at:.1} 0V{down}\" stroke=\"#e0e0e0\"/>");
        let _ = writeln!(
            svg,
            "<text x=\"{at:.1}\" y=\"{}\" text-anchor=\"middle\">{text}</text>",
            down + 18.0
        );
    }
    for tick in ticks(y0, y1) {
        let (at, text) = (y(tick), engineering(tick, units.1, 3));
        let _ = writeln!(svg, "<path d=\"M0 {at:.1}H{across}\" stroke=\"#e0e0e0\"/>");
        let _ =
            writeln!(svg, "<text x=\"-8\" y=\"{:.1}\" text-anchor=\"end\">{text}</text>", at + 4.0);
    }
    svg
}

/// The picture of several curves with points on them, titled `words.0`, its axes labelled `words.1`, from zero in both directions.
pub fn chart_with_points(
    curves: &[Vec<(f64, f64)>],
    clouds: &[PointSet<'_>],
    (title, labels): (&str, (&str, &str)),
    units: (&str, &str),
) -> String {
    let (width, height) = SIZE;
    let (left, right, above, below) = MARGINS;
    let (across, down) = (width - left - right, height - above - below);
    let points = curves.iter().chain(clouds.iter().map(|cloud| &cloud.points)).flatten();
    let (x1, y1) = points.fold((0.0, 0.0), |(x, y): (f64, f64), p| (x.max(p.0), y.max(p.1)));
    let mut svg = frame(title, ((0.0, x1), (0.0, y1)), units);
    let place = |(x, y): (f64, f64)| (x / x1 * across, down - y / y1 * down);
    for curve in curves {
        let mut path = String::new();
        for (index, point) in curve.iter().enumerate() {
            let ((x, y), start) = (place(*point), if index == 0 { 'M' } else { 'L' });
            let _ = write!(path, "{start}{x:.1} {y:.1}");
        }
        let _ = writeln!(
            svg,
            "<path d=\"{path}\" fill=\"none\" stroke=\"#1060b0\" stroke-width=\"1.6\"/>"
        );
    }
    for (cloud, line) in clouds.iter().zip(1_i32..) {
        for point in &cloud.points {
            let (x, y) = place(*point);
            let _ = writeln!(
                svg,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{}\"/>",
                cloud.colour
            );
        }
        let name = super::escape(cloud.name);
        let y = down - 8.0 - 16.0 * f64::from(line);
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{y:.1}\" text-anchor=\"end\" fill=\"{}\">{name}</text>",
            across - 12.0,
            cloud.colour
        );
    }
    let _ = writeln!(
        svg,
        "<rect width=\"{across}\" height=\"{down}\" fill=\"none\" stroke=\"#404040\"/>\n\
         <text x=\"{across}\" y=\"{}\" text-anchor=\"end\">{}</text>\n\
         <text x=\"0\" y=\"-6\">{}</text>\n</g>\n</svg>",
        down + 40.0,
        super::escape(labels.0),
        super::escape(labels.1)
    );
    svg
}

/// Round numbers from `low` to `high`: steps of 1, 2 or 5 of a power of ten.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "the number of ticks is small"
)]
pub(super) fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / TARGET_INTERVALS;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|step| *step >= rough);
    let step = step.unwrap_or(rough);
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last).map(|n| n as f64 * step).collect()
}

/// Every whole number from `low` to `high`, without a name.
#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "a few dozen")]
pub(super) fn whole_numbers(low: f64, high: f64) -> Vec<(f64, String)> {
    ((low.ceil() as i64)..=(high.floor() as i64)).map(|n| (n as f64, String::new())).collect()
}
