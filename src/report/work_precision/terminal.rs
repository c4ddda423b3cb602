//! A panel in letters, with its legend beside it.

use super::{Axes, MethodMark, PlottedQuantity, WorkMeasure, marks};
use crate::studies::cost::CostStudy;

/// Columns and rows of a plot: with its scale and its legend it is 80 columns wide.
const PLOT_CELLS: (usize, usize) = (39, 17);
/// Mark of the choice of `--accuracy`.
const CHOSEN_MARK: char = '●';
/// Most methods of a plot: more cannot be told apart.
const MAX_METHODS: usize = 7;

/// Methods of the plots.
pub fn shown(study: &CostStudy) -> Vec<MethodMark> {
    marks(study).into_iter().take(MAX_METHODS).collect()
}

/// One kind of error against work; in `colour` by SGR codes.
pub fn plot(
    study: &CostStudy,
    kind: &PlottedQuantity,
    work: WorkMeasure,
    colour: bool,
) -> Vec<String> {
    let axes = Axes::of(study, kind, work);
    let (columns, rows) = PLOT_CELLS;
    let mut cells = vec![vec![(' ', 0); columns]; rows];
    let row_of = |y: f64| (y * (rows - 1) as f64).round() as usize;
    let column_of = |x: f64| (x * (columns - 1) as f64).round() as usize;
    let limit = (kind.limit)(study);
    let inside = limit.filter(|limit| *limit < 1.0);
    if let Some(row) = inside.and_then(|limit| cells.get_mut(row_of(axes.place(1.0, limit).1))) {
        row.fill(('·', 0));
    }
    let mut set = |amount: f64, error: f64, mark: (char, u8)| {
        let (x, y) = axes.place(amount, error);
        if let Some(cell) = cells.get_mut(row_of(y)).and_then(|row| row.get_mut(column_of(x))) {
            *cell = mark;
        }
    };
    let methods = shown(study);
    for (method, mark, _, code) in &methods {
        let points = kind.shown(study, work, method);
        points.for_each(|(amount, error)| set(amount, error, (*mark, *code)));
    }
    kind.choices(study, work).for_each(|(_, amount, error)| set(amount, error, (CHOSEN_MARK, 1)));
    let mut legend: Vec<String> = methods
        .iter()
        .map(|(method, mark, _, code)| format!("{} {method}", painted(*mark, *code, colour)))
        .collect();
    legend.push(format!("{} --accuracy, 1e-2 down", painted(CHOSEN_MARK, 1, colour)));
    let title = format!("{}: largest relative error of {}", study.scene, kind.of);
    let mut lines = vec![title, format!("against {}", work.name())];
    let span = axes.error.1 - axes.error.0;
    let mut labelled = f64::NAN;
    for (index, row) in cells.iter().enumerate() {
        let exponent = (axes.error.1 - span * index as f64 / (rows - 1) as f64).round();
        let label =
            if (exponent - labelled).abs() < 0.5 { String::new() } else { format!("1e{exponent}") };
        labelled = exponent;
        let text: String = row.iter().map(|(mark, code)| painted(*mark, *code, colour)).collect();
        let beside = legend.get(index).map_or("", String::as_str);
        lines.push(format!("{label:>6} |{text}|  {beside}").trim_end().to_owned());
    }
    lines.push(format!("{:>6} +{}+", "", "-".repeat(columns)));
    let mut below = String::new();
    for decade in axes.ticks() {
        let x = (decade - axes.work.0) / (axes.work.1 - axes.work.0);
        let label = work.tick(decade);
        let start = (8 + column_of(x)).saturating_sub(label.chars().count() / 2);
        if start <= below.chars().count() && !below.is_empty() {
            continue;
        }
        below.push_str(&" ".repeat(start.saturating_sub(below.chars().count())));
        below.push_str(&label);
    }
    lines.push(below);
    if inside.is_some() {
        lines.push(format!("        · · · {}", kind.limit_name));
    }
    if let Some(limit) = limit.filter(|limit| *limit >= 1.0) {
        lines.push(format!("        {} is {limit:.1}, above all of this", kind.limit_name));
    }
    lines
}

/// A mark in its colour.
fn painted(mark: char, code: u8, colour: bool) -> String {
    if colour && code != 0 { format!("\u{1b}[{code}m{mark}\u{1b}[0m") } else { mark.to_string() }
}
