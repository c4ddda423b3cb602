//! Errors against work as a picture.

use std::fmt::Write as _;

use super::super::Row;

const COLOURS: [&str; 10] = [
    "#66ccee", "#228833", "#aa3377", "#ee6677", "#882255", "#332288", "#cc9966", "#cc6600",
    "#999999", "#000000",
];
/// Left, top, width and height of the plot (pixels).
const PLOT: [f64; 4] = [64.0, 46.0, 560.0, 420.0];
/// Decades of work and of errors.
const WORK: (f64, f64) = (2.0, 5.5);
const ERRORS: (f64, f64) = (-12.0, 0.0);

/// The picture, as SVG.
#[allow(clippy::cast_precision_loss, reason = "a few rows")]
pub fn svg(rows: &[Row]) -> String {
    let [left, top, width, height] = PLOT;
    let place = |count: f64, error: f64| {
        let x = (count.log10() - WORK.0) / (WORK.1 - WORK.0);
        let y = (ERRORS.1 - error.log10()) / (ERRORS.1 - ERRORS.0);
        (left + width * x.clamp(0.0, 1.0), top + height * y.clamp(0.0, 1.0))
    };
    let below = top + height + 66.0;
    let all = below + 20.0 * rows.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 650 {all}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"650\" height=\"{all}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"26\">largest error of a velocity against evaluations of all contact forces</text>\n"
    );
    for decade in 2..=5 {
        let (x, _) = place(10f64.powi(decade), 1.0);
        let (end, label) = (top + height, top + height + 18.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {top}V{end}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{label}\" text-anchor=\"middle\">1e{decade}</text>"
        );
    }
    for decade in (-12..=0).step_by(2) {
        let (_, y) = place(1e3, 10f64.powi(decade));
        let (end, label) = (left + width, left - 6.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{left} {y:.1}H{end}\" stroke=\"#ddd\"/><text x=\"{label}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>",
            y + 4.0
        );
    }
    for order in [2.0_f64, 4.0, 6.0, 8.0] {
        let reach = (12.0 / order).min(WORK.1 - WORK.0);
        let ((x0, y0), (x1, y1)) =
            (place(100.0, 1.0), place(10f64.powf(2.0 + reach), 10f64.powf(-order * reach)));
        let _ = writeln!(
            svg,
            "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#bbb\" stroke-dasharray=\"2 4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#999\" font-size=\"10\">order {order}</text>",
            x1 - 4.0,
            y1 - 4.0
        );
    }
    for (index, (row, colour)) in rows.iter().zip(COLOURS).enumerate() {
        let mut path = String::new();
        for (count, error) in row.points.iter().filter(|(_, error)| *error < 1.0) {
            let (x, y) = place(*count, *error);
            let _ = write!(path, "{}{x:.1} {y:.1}", if path.is_empty() { 'M' } else { 'L' });
        }
        let y = below + 20.0 * index as f64 - 12.0;
        let order = row.order().map_or(String::new(), |order| format!(", order {order:.1}"));
        let _ = writeln!(
            svg,
            "<path d=\"{path}M{left} {y}h24\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"1.6\"/><text x=\"{}\" y=\"{}\">{}{order}</text>",
            left + 32.0,
            y + 4.0,
            row.name
        );
    }
    svg.push_str("</svg>\n");
    svg
}
