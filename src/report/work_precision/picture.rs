//! The study as a picture: a panel for each kind of error, and below both what their marks mean.

use std::fmt::Write as _;

use super::{
    Axes, MethodMark, PLOTTED_QUANTITIES, PlottedQuantity, WorkMeasure, digits, marks, observed,
    reference,
};
use crate::report::escape;
use crate::studies::cost::{CostStudy, Point};

/// Size of a panel's plot, and what is left of it (pixels).
const PLOT_SIZE: (f64, f64) = (480.0, 430.0);
const LEFT_MARGIN: f64 = 72.0;
/// From the top to the plots (pixels).
const TOP_MARGIN: f64 = 74.0;
/// From one row of plots to the next (pixels).
const ROW_HEIGHT: f64 = PLOT_SIZE.1 + 88.0;
/// From the plots to the marks' meanings, and from one of these to the next (pixels).
const LEGEND: (f64, f64) = (72.0, 20.0);
/// Columns of meanings.
const LEGEND_COLUMNS: usize = 2;
/// Room that the name of a choice takes (pixels).
const NAME_OFFSET: (f64, f64) = (34.0, 11.0);
/// Width of the picture (pixels).
const WIDTH: f64 = 2.0 * (LEFT_MARGIN + PLOT_SIZE.0) + 24.0;

/// The study as an SVG picture.
pub fn work_precision_svg(study: &CostStudy, work: WorkMeasure) -> String {
    let marks = marks(study);
    let lines = (marks.len() + 1).div_ceil(LEGEND_COLUMNS) + 1;
    let below = TOP_MARGIN + ROW_HEIGHT + PLOT_SIZE.1;
    let height = below + LEGEND.0 + LEGEND.1 * lines as f64 + 10.0;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{WIDTH}\" height=\"{height}\" fill=\"white\"/>\n\
         <text x=\"{LEFT_MARGIN}\" y=\"28\" font-size=\"16\">{}: what accuracy costs</text>\n",
        escape(&study.scene)
    );
    for (kind, (row, column)) in
        PLOTTED_QUANTITIES.iter().zip([(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)])
    {
        let corner =
            (LEFT_MARGIN + column * (LEFT_MARGIN + PLOT_SIZE.0), TOP_MARGIN + row * ROW_HEIGHT);
        panel(&mut svg, study, work, (kind, &marks), corner);
    }
    let place = |index: usize| {
        let (row, column) = (index / LEGEND_COLUMNS, index % LEGEND_COLUMNS);
        let x = LEFT_MARGIN + column as f64 * (LEFT_MARGIN + PLOT_SIZE.0);
        (x, below + LEGEND.0 + LEGEND.1 * row as f64)
    };
    for (index, (method, _, colour, _)) in marks.iter().enumerate() {
        let (x, y) = place(index);
        let order = study.orders.iter().find(|order| order.method == *method).and_then(observed);
        let order = order.map_or(String::new(), |order| format!(", order {order} here"));
        let _ = writeln!(
            svg,
            "{}<text x=\"{}\" y=\"{}\">{method}{order}</text>",
            shape(index, (x, y), colour),
            x + 12.0,
            y + 4.0
        );
    }
    let (x, y) = place(marks.len());
    let _ = writeln!(
        svg,
        "{}<text x=\"{}\" y=\"{}\">what --accuracy chooses; crosses at the top: failed</text>",
        ring((x, y)),
        x + 12.0,
        y + 4.0
    );
    let (x, y) = (LEFT_MARGIN, height - 14.0);
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"{y}\" fill=\"#555\" font-size=\"12\">reference: {}</text>",
        escape(&reference(study))
    );
    svg.push_str("</svg>\n");
    svg
}

/// One kind of error against work.
fn panel(
    svg: &mut String,
    study: &CostStudy,
    work: WorkMeasure,
    (kind, marks): (&PlottedQuantity, &[MethodMark]),
    (left, top): (f64, f64),
) {
    let axes = Axes::of(study, kind, work);
    let at = |x: f64, y: f64| (left + x * PLOT_SIZE.0, top + y * PLOT_SIZE.1);
    let place = |amount: f64, error: f64| {
        let (x, y) = axes.place(amount, error);
        at(x, y)
    };
    let _ = writeln!(
        svg,
        "<text x=\"{left}\" y=\"{}\">largest relative error of {}</text>",
        top - 14.0,
        kind.of
    );
    grid(svg, (&axes, work), &at);
    slopes(svg, &axes, &at);
    let x1 = left + PLOT_SIZE.0;
    let limit = (kind.limit)(study);
    if let Some(limit) = limit.filter(|limit| *limit >= 1.0) {
        let _ = writeln!(
            svg,
            "<text x=\"{x1:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#555\" font-size=\"11\">{} is {limit:.1}, above all of this</text>",
            top - 14.0,
            kind.limit_name
        );
    }
    if let Some(limit) = limit.filter(|limit| *limit < 1.0) {
        let (x0, y) = place(1.0, limit);
        let _ = writeln!(
            svg,
            "<path d=\"M{x0:.1} {y:.1}H{x1:.1}\" stroke=\"#555\" stroke-dasharray=\"6 4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#555\" font-size=\"11\">{}</text>",
            x1 - 4.0,
            y - 5.0,
            kind.limit_name
        );
    }
    for (index, (method, _, colour, _)) in marks.iter().enumerate() {
        let points: Vec<_> =
            kind.shown(study, work, method).map(|(n, error)| place(n, error)).collect();
        let mut path = String::new();
        for (x, y) in &points {
            let _ = write!(path, "{}{x:.1} {y:.1}", if path.is_empty() { 'M' } else { 'L' });
        }
        let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\"/>");
        svg.extend(points.iter().map(|point| shape(index, *point, colour)));
        let failed = |p: &&Point| p.method == *method && p.failed;
        for amount in study.points.iter().filter(failed).filter_map(|point| work.of(point)) {
            let (x, y) = place(amount, 1.0);
            let (x, y) = (x - 4.0, y - 4.0);
            let _ = writeln!(svg, "<path d=\"M{x:.1} {y:.1}l8 8m0 -8l-8 8\" stroke=\"{colour}\"/>");
        }
    }
    let choices: Vec<_> = kind.choices(study, work).collect();
    let mut named: Vec<(f64, f64)> = Vec::new();
    // Several accuracies may lead to one run. To the lower left of it there is nothing: what is chosen is next to the best.
    for same in choices.chunk_by(|a, b| (a.1, a.2) == (b.1, b.2)) {
        let Some((_, amount, error)) = same.first() else { continue };
        let (x, y) = place(*amount, *error);
        let words = same.iter().map(|(accuracy, ..)| format!("1e{}", digits(*accuracy).round()));
        // Where points are crowded names stand below each other.
        let mut name = (x - 9.0, y + 8.0);
        let covers = |(x, y): &(f64, f64), name: (f64, f64)| {
            (x - name.0).abs() < NAME_OFFSET.0 && (y - name.1).abs() < NAME_OFFSET.1 - 1.0
        };
        while let Some((_, y)) = named.iter().find(|other| covers(other, name)) {
            name.1 = y + NAME_OFFSET.1;
        }
        named.push(name);
        let _ = writeln!(
            svg,
            "{}<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" font-size=\"10\">{}</text>",
            ring((x, y)),
            name.0,
            name.1,
            words.collect::<Vec<_>>().join(", ")
        );
    }
}

/// Slopes of a few orders, from the upper left corner down.
fn slopes(svg: &mut String, axes: &Axes, at: &dyn Fn(f64, f64) -> (f64, f64)) {
    let (decades, digits) = (axes.work.1 - axes.work.0, axes.error.1 - axes.error.0);
    let (x0, y0) = at(0.0, 0.0);
    for order in [2.0, 4.0, 6.0, 8.0] {
        let reach = (digits / order).min(decades);
        let (x1, y1) = at(reach / decades, order * reach / digits);
        let _ = writeln!(
            svg,
            "<path d=\"M{x0:.1} {y0:.1}L{x1:.1} {y1:.1}\" stroke=\"#bbb\" stroke-dasharray=\"2 4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#999\" font-size=\"10\">order {order}</text>",
            x1 - 4.0,
            y1 - 4.0
        );
    }
}

/// The mark of method number `index`: shapes tell apart what colours do not.
fn shape(index: usize, (x, y): (f64, f64), colour: &str) -> String {
    let path = match index % 4 {
        0 => return format!("<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>\n"),
        1 => format!("M{:.1} {:.1}h6v6h-6z", x - 3.0, y - 3.0),
        2 => format!("M{x:.1} {:.1}l4 7h-8z", y - 4.0),
        _ => format!("M{x:.1} {:.1}l4 4l-4 4l-4 -4z", y - 4.0),
    };
    format!("<path d=\"{path}\" fill=\"{colour}\"/>\n")
}

fn ring((x, y): (f64, f64)) -> String {
    format!(
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"6\" fill=\"none\" stroke=\"black\" stroke-width=\"1.6\"/>\n"
    )
}

fn grid(svg: &mut String, (axes, work): (&Axes, WorkMeasure), at: &dyn Fn(f64, f64) -> (f64, f64)) {
    let ((few, many), (low, high)) = (axes.work, axes.error);
    let (corner, end) = (at(0.0, 0.0), at(1.0, 1.0));
    for decade in axes.ticks() {
        let (x, _) = at((decade - few) / (many - few), 0.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            corner.1,
            end.1,
            end.1 + 18.0,
            work.tick(decade)
        );
    }
    let mut decade = low;
    while decade <= high {
        let (_, y) = at(0.0, (high - decade) / (high - low));
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>",
            corner.0,
            end.0,
            corner.0 - 6.0,
            y + 4.0
        );
        decade += 1.0;
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
        0.5 * (corner.0 + end.0),
        end.1 + 38.0,
        work.name()
    );
}
