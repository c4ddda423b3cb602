//! A panel in letters.

use super::{Axes, Kind, marks};
use crate::studies::cost::{Point, Study};

/// Columns and rows of a plot.
const CELLS: (usize, usize) = (70, 18);
/// What `--accuracy` chooses.
const CHOSEN: char = '●';

/// Marks of the points that failed, at what they cost.
fn failed(study: &Study, axes: &Axes, column_of: impl Fn(f64) -> usize) -> String {
    let mut row = vec![' '; CELLS.0];
    for (method, mark, _) in marks(study) {
        let failed = |p: &&Point| p.method == method && p.failed && p.force_evaluations > 0;
        for point in study.points.iter().filter(failed) {
            let (x, _) = axes.place(point.force_evaluations, 1.0);
            if let Some(cell) = row.get_mut(column_of(x)) {
                *cell = mark;
            }
        }
    }
    row.into_iter().collect::<String>().trim_end().to_owned()
}

/// One kind of error against work.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places on a screen of a few dozen cells"
)]
pub fn plot(study: &Study, kind: &Kind) -> Vec<String> {
    let axes = Axes::of(study, kind);
    let (columns, rows) = CELLS;
    let mut cells = vec![vec![' '; columns]; rows];
    let row_of = |y: f64| (y * (rows - 1) as f64).round() as usize;
    let column_of = |x: f64| (x * (columns - 1) as f64).round() as usize;
    let limit = (kind.limit)(study);
    let inside = limit.filter(|limit| *limit < 1.0);
    if let Some(row) = inside.and_then(|limit| cells.get_mut(row_of(axes.place(1, limit).1))) {
        row.fill('·');
    }
    let mut set = |evaluations: u64, error: f64, mark: char| {
        let (x, y) = axes.place(evaluations, error);
        if let Some(cell) = cells.get_mut(row_of(y)).and_then(|row| row.get_mut(column_of(x))) {
            *cell = mark;
        }
    };
    for (method, mark, _) in marks(study) {
        kind.shown(study, method).for_each(|(evaluations, error)| set(evaluations, error, mark));
    }
    kind.choices(study).for_each(|(_, evaluations, error)| set(evaluations, error, CHOSEN));
    let mut lines = vec![
        format!("{}: largest relative error of {}", study.scene, kind.of),
        "against evaluations of all contact forces".to_owned(),
    ];
    let failed = failed(study, &axes, column_of);
    if !failed.is_empty() {
        lines.push(format!("failed |{failed}"));
    }
    let span = axes.error.1 - axes.error.0;
    let mut labelled = f64::NAN;
    for (index, row) in cells.iter().enumerate() {
        let exponent = (axes.error.1 - span * index as f64 / (rows - 1) as f64).round();
        let label =
            if (exponent - labelled).abs() < 0.5 { String::new() } else { format!("1e{exponent}") };
        labelled = exponent;
        let text: String = row.iter().collect();
        lines.push(format!("{label:>6} |{}", text.trim_end()));
    }
    lines.push(format!("{:>6} +{}", "", "-".repeat(columns)));
    let mut below = String::new();
    for decade in axes.ticks() {
        let x = (decade - axes.work.0) / (axes.work.1 - axes.work.0);
        let label = format!("1e{decade}");
        let start = column_of(x).saturating_sub(label.len() / 2);
        below.push_str(&" ".repeat(start.saturating_sub(below.len())));
        below.push_str(&label);
    }
    lines.push(format!("{:>8}{below}", ""));
    lines.push(format!("        {CHOSEN} what --accuracy chooses, from 1e-1 down a decade each"));
    if inside.is_some() {
        lines.push(format!("        · · · {}", kind.limit_name));
    } else if let Some(limit) = limit {
        lines.push(format!("        {} is {limit:.1}, above all of this", kind.limit_name));
    }
    lines
}
