//! Text and pictures about a sweep.

use std::collections::BTreeMap;

use super::plot::{COLOURS, Plot, Series, Sheet, Stroke};
use crate::quantity::engineering;
use crate::sweep::gather::Gap;
use crate::sweep::summary::{Failure, GatherSummary, SweepSummary};
use crate::table::{Cell, Column, ColumnKind, Table};

/// Gaps that are named one by one.
const NAMED_GAPS: usize = 10;

/// A column that a picture of a sweep cannot show.
#[derive(Debug, thiserror::Error)]
#[error("found no column of numbers `{found}` in this sweep, expected one of {}", known.join(", "))]
pub struct SweepColumnError {
    /// The name as typed.
    found: String,
    /// Names of the columns that hold numbers.
    known: Vec<String>,
}

/// Columns that a picture of a sweep shows, by their place in the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SweepAxes {
    x: usize,
    y: usize,
}

impl SweepAxes {
    /// The columns named `x` and `y`, with or without their unit; by default the first one that is
    /// varied and the first peak.
    ///
    /// # Errors
    /// [`SweepColumnError`] if there is no such column of numbers.
    pub fn of(
        columns: &[Column],
        (x, y): (Option<&str>, Option<&str>),
    ) -> Result<Self, SweepColumnError> {
        let is_number = |column: &Column| column.kind == ColumnKind::Number;
        let place = |name: &dyn Fn(&Column) -> bool, typed: &str| {
            columns.iter().position(|column| is_number(column) && name(column)).ok_or_else(|| {
                let known = columns.iter().filter(|column| is_number(column));
                let known = known.map(|column| name_and_unit(&column.name).0.to_owned()).collect();
                SweepColumnError { found: typed.to_owned(), known }
            })
        };
        let named = |typed: &str| {
            place(&|column| column.name == typed || name_and_unit(&column.name).0 == typed, typed)
        };
        Ok(Self {
            x: x.map_or_else(|| place(&|_| true, "a varied one"), named)?,
            y: y.map_or_else(
                || place(&|column| column.name.ends_with(".peak (N)"), ".peak"),
                named,
            )?,
        })
    }
}

/// `striker.speed (m/s)` in its two parts.
fn name_and_unit(column: &str) -> (&str, &str) {
    let parts = column.strip_suffix(')').and_then(|text| text.rsplit_once(" ("));
    parts.unwrap_or((column, ""))
}

/// One column of a sweep's table over another, with a line for each combination of the other values
/// that differ if there are few, else as dots.
pub fn sweep_picture(table: &Table, axes: SweepAxes, title: &str) -> Sheet {
    let SweepAxes { x, y } = axes;
    let columns = &table.columns;
    let varied = columns.iter().position(|column| column.name == "error").unwrap_or(0);
    let differs = |at: usize| table.rows.windows(2).any(|pair| pair[0].get(at) != pair[1].get(at));
    let is_count = |at: usize| ["run", "seed", "repeat"].contains(&columns[at].name.as_str());
    let others: Vec<usize> =
        (0..varied).filter(|at| *at != x && !is_count(*at) && differs(*at)).collect();
    let number = |row: &[Cell], at: usize| match row.get(at) {
        Some(Cell::Number(number)) => Some(*number),
        _ => None,
    };
    // Groups in the order of their first runs.
    let mut places: BTreeMap<String, usize> = BTreeMap::new();
    let mut groups: Vec<(String, Vec<(f64, f64)>)> = Vec::new();
    for row in &table.rows {
        let (Some(x), Some(y)) = (number(row, x), number(row, y)) else { continue };
        let name = group_name(columns, row, &others);
        let at = *places.entry(name.clone()).or_insert_with(|| {
            groups.push((name, Vec::new()));
            groups.len() - 1
        });
        groups[at].1.push((x, y));
    }
    for (_, points) in &mut groups {
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    // Sorted: of two that are not apart the second is no larger.
    let repeats = |points: &Vec<(f64, f64)>| points.windows(2).any(|pair| pair[1].0 <= pair[0].0);
    let lines = if groups.len() > COLOURS.len() {
        let all = groups.into_iter().flat_map(|(_, points)| points).collect();
        vec![Series::new("", all, COLOURS[0], Stroke::Dots)]
    } else {
        let line = |((name, points), colour): ((String, Vec<_>), &'static str)| {
            let stroke = if repeats(&points) { Stroke::Dots } else { Stroke::Solid };
            Series::new(name, points, colour, stroke)
        };
        groups.into_iter().zip(COLOURS).map(line).collect()
    };
    let [x, y] = [x, y].map(|at| {
        let (name, unit) = name_and_unit(&columns[at].name);
        [name, unit]
    });
    Sheet::stack(title, vec![Plot::fitted(x, y, lines)])
}

/// The values of the columns at `others`, with their names.
fn group_name(columns: &[Column], row: &[Cell], others: &[usize]) -> String {
    let value = |at: &usize| {
        let (name, unit) = name_and_unit(&columns[*at].name);
        let value = match row.get(*at) {
            Some(Cell::Number(number)) => engineering(*number, unit, 4),
            Some(Cell::Count(count)) => count.to_string(),
            Some(Cell::Text(text)) => text.clone(),
            Some(Cell::Absent) | None => "-".to_owned(),
        };
        format!("{name} {value}")
    };
    others.iter().map(value).collect::<Vec<_>>().join(", ")
}

/// Output of `sweep`.
pub fn sweep(summary: &SweepSummary) -> String {
    let SweepSummary { sweep, scene, runs, of_shard, finished_before, done, .. } = summary;
    let part = summary.shard.as_ref().map_or(String::new(), |s| format!(", {s}: {of_shard} runs"));
    let accuracy = summary
        .accuracy
        .map_or("each scene's accuracy".to_owned(), |accuracy| format!("accuracy {accuracy:e}"));
    let threads = if summary.threads == 1 { "thread" } else { "threads" };
    let mut lines = vec![
        format!("{sweep}: {} of {scene}{part}", counted(*runs)),
        format!("  at {accuracy}, {}, {} {threads}", summary.instructions, summary.threads),
    ];
    if *finished_before > 0 {
        lines.push(format!("  before      {}", counted(*finished_before)));
    }
    let rate = *done as f64 / summary.wall_s.max(1e-9);
    let speed = if *done > 0 {
        format!(" in {}, {rate:.0} a second", engineering(summary.wall_s, "s", 3))
    } else {
        String::new()
    };
    lines.push(format!("  now         {}{speed}", counted(*done)));
    if let Some(gathering) = &summary.gathered {
        lines.extend(results(gathering));
    } else {
        lines.extend(failures(summary.failed, summary.first_failed.as_ref()));
        lines.push(format!("  log         {}", summary.log));
    }
    lines.join("\n")
}

/// Output of `gather`.
pub fn gathering(gathering: &GatherSummary) -> String {
    let GatherSummary { folder, logs, runs, finished, .. } = gathering;
    let files = if *logs == 1 { "log" } else { "logs" };
    let mut lines = vec![format!("{folder}: {finished} of {} in {logs} {files}", counted(*runs))];
    lines.extend(results(gathering));
    lines.join("\n")
}

fn results(gathering: &GatherSummary) -> Vec<String> {
    let mut lines = failures(gathering.failed, gathering.first_failed.as_ref());
    let missing: u64 = gathering.missing.iter().map(|gap| gap.last - gap.first + 1).sum();
    if missing > 0 {
        let gaps = gathering.missing.iter().take(NAMED_GAPS).map(gap);
        let more = gathering.missing.len().saturating_sub(NAMED_GAPS);
        let more = if more > 0 { format!(" and {more} more rows") } else { String::new() };
        let gaps = gaps.collect::<Vec<_>>().join(", ");
        lines.push(format!("  missing     {}: {gaps}{more}", counted(missing)));
    }
    lines.extend(gathering.tables.iter().map(|table| format!("  table       {table}")));
    lines
}

fn failures(failed: u64, first: Option<&Failure>) -> Vec<String> {
    let Some(Failure { run, reason }) = first else { return Vec::new() };
    vec![format!("  no results  {}; the first, run {run}: {reason}", counted(failed))]
}

fn gap(gap: &Gap) -> String {
    if gap.first == gap.last {
        gap.first.to_string()
    } else {
        format!("{}-{}", gap.first, gap.last)
    }
}

fn counted(runs: u64) -> String {
    if runs == 1 { "1 run".to_owned() } else { format!("{runs} runs") }
}
