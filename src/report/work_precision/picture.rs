//! The study as a picture: a sheet with a panel for each kind of error.

use super::{
    Axes, MethodMark, PLOTTED_QUANTITIES, PlottedQuantity, WorkMeasure, digits, marks, observed,
    reference,
};
use crate::report::plot::{Axis, Plot, Series, Sheet, Stroke};
use crate::studies::cost::CostStudy;

/// Size of a panel's frame (pixels).
const PANEL_SIZE: (f64, f64) = (480.0, 430.0);
/// Orders whose slopes are shown.
const ORDERS: [f64; 4] = [2.0, 4.0, 6.0, 8.0];
/// Colour of slopes and limits.
const GUIDE_COLOUR: &str = "#999999";
/// Colour of what `--accuracy` chooses.
const CHOICE_COLOUR: &str = "#000000";

/// The study as a picture.
pub fn work_precision_picture(study: &CostStudy, work: WorkMeasure) -> Sheet {
    let marks = marks(study);
    let panels = PLOTTED_QUANTITIES.iter().map(|kind| panel(study, work, kind, &marks));
    let of_method = |(index, (method, _, colour, _)): (usize, &MethodMark)| {
        let order = study.orders.iter().find(|order| order.method == *method).and_then(observed);
        let order = order.map_or(String::new(), |order| format!(", order {order} here"));
        let name = format!("{method}{order}");
        Series { name, points: Vec::new(), colour, stroke: stroke(index) }
    };
    let chosen = Series {
        name: "what --accuracy chooses".to_owned(),
        points: Vec::new(),
        colour: CHOICE_COLOUR,
        stroke: Stroke::Dots,
    };
    Sheet {
        title: format!("{}: what accuracy costs", study.scene),
        columns: 2,
        size: PANEL_SIZE,
        panels: panels.collect(),
        legend: marks.iter().enumerate().map(of_method).chain([chosen]).collect(),
        note: format!("runs that failed are at the top; reference: {}", reference(study)),
    }
}

/// What colours do not tell apart, dashes do.
fn stroke(method: usize) -> Stroke {
    if method.is_multiple_of(2) { Stroke::Solid } else { Stroke::Dashed }
}

/// One kind of error against work, on decimal logarithms.
fn panel(
    study: &CostStudy,
    work: WorkMeasure,
    kind: &PlottedQuantity,
    marks: &[MethodMark],
) -> Plot {
    let axes = Axes::of(study, kind, work);
    let (few, many) = axes.work;
    let (low, high) = axes.error;
    let x = Axis {
        ticks: axes.ticks().map(|d| (d, work.tick(d))).collect(),
        ..decades(work.name(), axes.work)
    };
    let y = decades("relative error", axes.error);
    let mut plot = Plot::new(&format!("largest relative error of {}", kind.of), x, y);
    let mut line = |points: Vec<(f64, f64)>, colour: &'static str, stroke: Stroke| {
        plot.lines.push(Series { name: String::new(), points, colour, stroke });
    };
    for order in ORDERS {
        let reach = ((high - low) / order).min(many - few);
        let end = (few + reach, high - order * reach);
        line(vec![(few, high), end], GUIDE_COLOUR, Stroke::Dashed);
        let (left, above) = (0.09 * (many - few), 0.015 * (high - low));
        plot.words.push((end.0 - left, end.1 + above, format!("order {order}")));
    }
    if let Some(limit) = (kind.limit)(study) {
        if limit < 1.0 {
            let height = digits(limit);
            line(vec![(few, height), (many, height)], GUIDE_COLOUR, Stroke::Dashed);
            plot.words.push((few, height, kind.limit_name.to_owned()));
        } else {
            plot.words.push((
                few,
                high,
                format!("{} is {limit:.1}, above all of this", kind.limit_name),
            ));
        }
    }
    for (index, (method, _, colour, _)) in marks.iter().enumerate() {
        let shown = kind.shown(study, work, method);
        let mut points: Vec<(f64, f64)> =
            shown.map(|(n, error)| (n.log10(), digits(error))).collect();
        line(points.clone(), colour, stroke(index));
        // Failed runs are at the top.
        let failed = study.points.iter().filter(|p| p.method == *method && p.failed);
        points.extend(failed.filter_map(|point| Some((work.of(point)?.log10(), high))));
        line(points, colour, Stroke::Dots);
    }
    let choices: Vec<_> = kind.choices(study, work).collect();
    let place = |(_, amount, error): &(f64, f64, f64)| (amount.log10(), digits(*error));
    line(choices.iter().map(place).collect(), CHOICE_COLOUR, Stroke::Dots);
    let mut named = Vec::new();
    // Several accuracies may lead to one run.
    for same in choices.chunk_by(|a, b| (a.1, a.2) == (b.1, b.2)) {
        let names = same.iter().map(|(accuracy, ..)| format!("1e{}", digits(*accuracy).round()));
        let (x, mut y) = place(&same[0]);
        // Where points are crowded, names stand below each other.
        let (wide, line) = (0.1 * (many - few), 0.03 * (high - low));
        while named.iter().any(|(a, b): &(f64, f64)| (a - x).abs() < wide && (b - y).abs() < line) {
            y -= line;
        }
        named.push((x, y));
        plot.words.push((x, y, format!(" {}", names.collect::<Vec<_>>().join(", "))));
    }
    plot
}

/// An axis over decimal logarithms, powers of ten named.
fn decades(label: &str, (from, to): (f64, f64)) -> Axis {
    let ticks = (from as i32..=to as i32).map(|d| (f64::from(d), format!("1e{d}"))).collect();
    Axis { label: label.to_owned(), from, to, logarithmic: false, ticks }
}
