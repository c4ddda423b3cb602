//! The work-precision study as text and picture: errors of first peaks and of arrivals against
//! force evaluations, on logarithmic axes.

mod axes;
mod picture;
mod terminal;

pub use axes::WorkMeasure;
pub use picture::work_precision_picture;

use super::table;
use super::text::{TERMINAL_WIDTH, hanging_indent, wrapped};
use crate::quantity::engineering;
use crate::studies::cost::{ChosenMethod, CostStudy, Order, Point, Reference};
use axes::{Axes, MethodMark, PLOTTED_QUANTITIES, PlottedQuantity, digits, marks};
use terminal::plot;
/// How many of these the terminal shows: the others are in the table of what `--accuracy` chooses.
const TERMINAL_PLOTS: usize = 2;

/// Explanation of the methods' table.
const METHOD_LEGEND: &str = "failed: runs that ended in an error or lost a pulse; given up: runs that would take too many evaluations; \
    errors below the reference's own, last line, are not resolved";

/// The page that `cost` prints: what accuracy costs in time, then errors against `work`; in
/// `colour` for a terminal.
pub fn work_precision(study: &CostStudy, work: WorkMeasure, colour: bool) -> String {
    let mut lines = vec![format!("{}: what accuracy costs in time", study.scene)];
    lines.extend(choices(study));
    lines.push(String::new());
    for kind in &PLOTTED_QUANTITIES[..TERMINAL_PLOTS] {
        lines.extend(plot(study, kind, work, colour));
        lines.push(String::new());
    }
    let heading = ["method", "mark", "nominal", "observed order", "failed", "given up"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (method, mark, ..) in marks(study) {
        let order = study.orders.iter().find(|o| o.method == method);
        let of = |is: fn(&&Point) -> bool| {
            study.points.iter().filter(|p| p.method == method).filter(is).count()
        };
        let (failed, given_up) = (of(|p| p.failed), of(|p| p.given_up));
        rows.push(vec![
            method.to_owned(),
            mark.to_string(),
            order.map_or(String::new(), |o| o.nominal.to_string()),
            order.and_then(observed).unwrap_or_else(|| "-".to_owned()),
            failed.to_string(),
            given_up.to_string(),
        ]);
    }
    lines.extend(table::lines(&rows, &[0]));
    lines.extend(wrapped(METHOD_LEGEND, TERMINAL_WIDTH));
    lines.push(String::new());
    lines.extend(sources(study));
    lines.extend(hanging_indent("reference: ", &reference(study)));
    lines.join("\n")
}

/// An order as it was observed, with its expanded uncertainty.
fn observed(order: &Order) -> Option<String> {
    let (observed, expanded) = order.observed.zip(order.expanded)?;
    Some(format!("{observed:.1} ± {expanded:.1}"))
}

fn reference(study: &CostStudy) -> String {
    let Reference { method, second, error, error_trace } = &study.reference;
    format!("{method}, {error:.1e} from {second}, in traces {error_trace:.1e}")
}

/// Where each method is from.
fn sources(study: &CostStudy) -> Vec<String> {
    let mut all: Vec<(&str, &str)> = Vec::new();
    for order in &study.orders {
        if all.last().is_none_or(|(last, _)| *last != order.method) {
            all.push((order.method, order.source));
        }
    }
    let lines =
        |(name, source)| [vec![format!("  {name}")], hanging_indent("    ", source)].concat();
    all.into_iter().flat_map(lines).collect()
}

/// Accuracies that were not reached, those of which the reference cannot tell, and those whose
/// traces are not known to half of the digits.
fn warnings(study: &CostStudy) -> Vec<String> {
    let own = study.reference.error;
    let named = |is: &dyn Fn(&ChosenMethod) -> bool| {
        let those = study.chosen.iter().filter(|chosen| is(chosen));
        let names: Vec<String> = those.map(|chosen| format!("{:e}", chosen.accuracy)).collect();
        Some(names.join(", ")).filter(|names| !names.is_empty())
    };
    let error = |chosen: &ChosenMethod| chosen.error.unwrap_or(f64::INFINITY);
    let missed = named(&|c| error(c) > c.accuracy + own);
    let unclear = named(&|c| error(c) > c.accuracy && error(c) <= c.accuracy + own);
    let late = named(&|c| c.error_trace.is_some_and(|error| error > c.accuracy.sqrt()));
    let missed =
        missed.map(|names| hanging_indent("  not reached: ", &format!("{names}; a run says so")));
    let unclear = unclear.map(|names| {
        let own = format!("{names}; the reference itself may be {own:.1e} off");
        hanging_indent("  not to be judged: ", &own)
    });
    let late = late.map(|names| {
        let when = format!("{names}; a run says from when on, or takes shorter steps");
        hanging_indent("  traces off by more than half of the digits: ", &when)
    });
    missed.into_iter().chain(unclear).chain(late).flatten().collect()
}

/// One row an accuracy: errors and times.
fn choices(study: &CostStudy) -> Vec<String> {
    let heading = ["asked", "peaks", "arrivals", "traces", "time", "least", "with checks", "speed"];
    let words = |error: Option<f64>| error.map_or("-".to_owned(), |e| format!("{e:.1e}"));
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for chosen in &study.chosen {
        rows.push(vec![
            format!("{:e}", chosen.accuracy),
            words(chosen.error_peak),
            words(chosen.error_arrival),
            words(chosen.error_trace),
            engineering(chosen.wall_s_median, "s", 2),
            engineering(chosen.wall_s_min, "s", 2),
            engineering(chosen.wall_held_s_median, "s", 2),
            format!("{:.2}", chosen.simulated_over_wall),
        ]);
    }
    // The method stands above what it was chosen for.
    let mut lines = Vec::new();
    let mut above = None;
    for (number, line) in table::lines(&rows, &[]).into_iter().enumerate() {
        let method = number.checked_sub(1).and_then(|i| study.chosen.get(i)).map(|c| c.method);
        if method != above {
            lines.extend(method.map(|method| format!("  {method}")));
            above = method;
        }
        lines.push(line);
    }
    lines.extend(wrapped(
        "asked: --accuracy; errors relative, of traces relative to the largest force; time: median of one run; least: its shortest time, which a busy machine disturbs least; with checks: median with the runs that estimate the error; speed: simulated over wall time",
        TERMINAL_WIDTH,
    ));
    let level = study.level.map(|level| format!("one scope level is {level:.1e} of a first peak"));
    let sample = (PLOTTED_QUANTITIES[1].limit)(study);
    let sample = sample.map(|sample| format!("one sample interval is {sample:.1e} of an arrival"));
    let limits: Vec<String> = level.into_iter().chain(sample).collect();
    if !limits.is_empty() {
        lines.extend(hanging_indent("", &limits.join(", ")));
    }
    lines.extend(warnings(study));
    lines
}
