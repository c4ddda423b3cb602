//! The effects of a scene as a page of text: one line an effect.

use super::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke};
use super::table::{self, RowTable};
use super::text::{TERMINAL_WIDTH, hanging_indent, wrapped};
use crate::studies::effects::{Change, EffectState, Ledger, LedgerEntry};

/// Explanation of the table.
const TABLE_LEGEND: &str = "Numbers: largest change of a reading at any sensor with the effect; LSB: that of a first peak in digitiser levels; ±: 95 % of random draws. \
    Needed: more than the accuracy (records: a tenth of a level or sample). * by auto.";
/// The option that prints more.
const WHY_HINT: &str = "--why: reasons.";
/// Most decades of the picture's abscissa.
const MAX_DECADES: i32 = 8;
/// Column at which reasons begin.
const REASON_COLUMN: usize = 23;

/// The table of effects, a row for each.
pub fn effects_table(ledger: &Ledger) -> RowTable {
    let heading = ["effect", "state", "peak", "arrival", "speed", "LSB", "run", "time", ""];
    let units = ["", "", "%", "%", "%", "", "with", "w/o", "verdict"];
    let mut rows = [heading, units].map(|row| row.map(str::to_owned).to_vec()).to_vec();
    rows.extend(ledger.entries.iter().map(|entry| row(entry, ledger.accuracy)));
    let mut lines = table::lines_apart(&rows, &[0, 1, 8], " ").into_iter();
    let title = format!("{}: effects at accuracy {:.1e}", ledger.scene, ledger.accuracy);
    let mut head = vec![title];
    head.extend(lines.by_ref().take(2));
    RowTable { head, rows: lines.collect(), foot: format!("{} {TABLE_LEGEND}", summary(ledger)) }
}

/// The page that `effects` prints; with reasons and criteria where `why` is true.
pub fn effects(ledger: &Ledger, why: bool) -> String {
    let RowTable { head, rows, .. } = effects_table(ledger);
    let mut lines = head;
    lines.insert(1, String::new());
    lines.extend(rows);
    lines.push(String::new());
    if why {
        lines.extend(ledger.entries.iter().flat_map(reason));
    } else {
        lines.extend(wrapped(&summary(ledger), TERMINAL_WIDTH));
        lines.extend(wrapped(&format!("{TABLE_LEGEND} {WHY_HINT}"), TERMINAL_WIDTH));
    }
    lines.join("\n")
}

/// What is needed, and what is missing.
fn summary(ledger: &Ledger) -> String {
    let names = |verdict: &str| {
        let with = ledger.entries.iter().filter(|entry| entry.verdict.word() == verdict);
        let names: Vec<&str> = with.map(|entry| entry.effect).collect();
        if names.is_empty() { "none".to_owned() } else { names.join(", ") }
    };
    format!("On and needed: {}. Off, but would matter: {}.", names("needed"), names("matters"))
}

/// The largest change of readings by each effect, as a picture.
pub fn effects_picture(ledger: &Ledger) -> Sheet {
    type Share = fn(&Change) -> Option<f64>;
    // What was not measured has no point.
    let is_measured = |entry: &&LedgerEntry| {
        let of = |change: Change| [change.peak, change.arrival, change.speed];
        entry.change.into_iter().flat_map(of).flatten().any(|share| share.abs() > 0.0)
    };
    let entries = || ledger.entries.iter().filter(is_measured);
    let readings: [(_, Share); 3] =
        [("first peak", |c| c.peak), ("arrival", |c| c.arrival), ("speed", |c| c.speed)];
    let series = readings.into_iter().zip(COLOURS).map(|((name, of), colour)| {
        let percent = |entry: &LedgerEntry| Some(100.0 * entry.change.as_ref().and_then(of)?.abs());
        let points = entries().enumerate();
        let points = points.filter_map(|(row, entry)| Some((percent(entry)?, row as f64)));
        Series::new(name, points.collect(), colour, Stroke::Dots)
    });
    let lines: Vec<Series> = series.collect();
    let accuracy = 100.0 * ledger.accuracy;
    let sizes = lines.iter().flat_map(|series| &series.points).map(|(percent, _)| *percent);
    let label = "change by the effect (%); at the left end: or less";
    let x = Axis::powers(label, sizes.chain([accuracy]), MAX_DECADES);
    let mut plot = Plot::of_rows(x, entries().map(|entry| entry.effect.replace('_', " ")));
    let state = |entry: &LedgerEntry| if entry.active { "on" } else { "off" };
    plot.beside = entries()
        .enumerate()
        .map(|(row, entry)| (row as f64, format!("{}, {}", state(entry), entry.verdict.word())))
        .collect();
    plot.lines = lines;
    plot.marks = vec![(accuracy, "accuracy of the runs".to_owned())];
    Sheet::rows(format!("{}: what each effect changes", ledger.scene), plot)
}

fn row(entry: &LedgerEntry, accuracy: f64) -> Vec<String> {
    let sign = |text: String| if entry.is_drawn { text.replacen('+', "±", 1) } else { text };
    let count = |value: Option<f64>| value.map_or("-".to_owned(), |v| sign(signed(v, decimals(v))));
    let change = entry.change;
    // What the electronics change is taken from one and the same motion, whose errors are in both.
    let moves = change.is_some_and(|change| change.speed.is_some());
    let known = if moves { accuracy } else { 0.0 };
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |v| sign(percent(v, known)));
    let time = |value: Option<f64>| table::known(value, "s", 2);
    let state = match entry.state {
        EffectState::On => "on",
        EffectState::Off => "off",
        EffectState::Auto if entry.active => "on*",
        EffectState::Auto => "off*",
    };
    vec![
        entry.effect.to_owned(),
        state.to_owned(),
        share(change.and_then(|c| c.peak)),
        share(change.and_then(|c| c.arrival)),
        share(change.and_then(|c| c.speed)),
        count(change.and_then(|c| c.peak_lsb)),
        time(entry.run_times.map(|times| times.with_s)),
        time(entry.run_times.map(|times| times.without_s)),
        entry.verdict.word().to_owned(),
    ]
}

/// Decimals that a number of this size is shown with, three significant digits at most.
fn decimals(value: f64) -> usize {
    match value.abs() {
        size if size < 10.0 => 2,
        size if size < 100.0 => 1,
        _ => 0,
    }
}

/// A number with its sign; what rounds to nothing is 0.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.contains(|c| ('1'..='9').contains(&c)) { text } else { "0".to_owned() }
}

/// A relative change in percent, powers of ten where it is small; of one that is smaller than what
/// is `known` (1) no more than that.
fn percent(value: f64, known: f64) -> String {
    if value == 0.0 {
        "0".to_owned()
    } else if value.abs() < known {
        format!("<{:.0e}", 100.0 * known)
    } else if value.abs() < 1e-4 {
        format!("{:+.0e}", 100.0 * value)
    } else {
        signed(100.0 * value, decimals(100.0 * value))
    }
}

/// Criterion and reason, wrapped.
fn reason(entry: &LedgerEntry) -> Vec<String> {
    let value = entry.value.map_or("not known".to_owned(), |value| match value.abs() {
        size if size == 0.0 || (1e-2..1e3).contains(&size) => format!("{value:.3}"),
        _ => format!("{value:.1e}"),
    });
    let first = format!("  {:<width$}", entry.effect, width = REASON_COLUMN - 2);
    hanging_indent(&first, &format!("{} = {value}; {}", entry.criterion, entry.reason))
}
