//! The effects ledger as a page of text.

use super::table;
use super::text::{TERMINAL_WIDTH, hanging_indent, wrapped};
use crate::studies::effects::{EffectState, Ledger, LedgerEntry};

/// Legend of the table.
const TABLE_LEGEND: &str = "Cost: wall time of a step with it less that without it, openings and tries included, 0 within what timing tells. \
    Change: with it over without it, in first peaks, half-rises and speeds, the largest of all places, < where the accuracy is all that is known. \
    What is off: if it were on. * by auto.";
/// Where reasons begin (1).
const REASON_COLUMN: usize = 23;

/// The page that `effects` prints.
pub fn effects(ledger: &Ledger) -> String {
    let heading =
        ["effect", "state", "ns/step", "share", "speed", "peak", "arrival", "LSB", "samples"];
    let units = ["", "", "", "%", "%", "%", "%", "", ""];
    let mut rows = [heading, units].map(|row| row.map(str::to_owned).to_vec()).to_vec();
    rows.extend(ledger.entries.iter().map(|entry| row(entry, ledger.accuracy)));
    let mut lines =
        vec![format!("{}: the effects, at accuracy {:.1e}", ledger.scene, ledger.accuracy)];
    lines.extend(wrapped(TABLE_LEGEND, TERMINAL_WIDTH));
    lines.push(String::new());
    lines.extend(table::lines_apart(&rows, &[0, 1], " "));
    lines.push(String::new());
    for entry in &ledger.entries {
        lines.extend(reason(entry));
    }
    lines.join("\n")
}

fn row(entry: &LedgerEntry, accuracy: f64) -> Vec<String> {
    let count = |value: Option<f64>| value.map_or("-".to_owned(), |v| signed(v, decimals(v)));
    let change = entry.change;
    // What the electronics change is taken from one and the same motion, whose errors are in both.
    let moves = change.is_some_and(|change| change.speed.is_some());
    let known = if moves { accuracy } else { 0.0 };
    let share = |value: Option<f64>| value.map_or("-".to_owned(), |v| percent(v, known));
    // What is within twice its uncertainty is no cost.
    let seen = |(cost, u): (f64, f64)| if cost.abs() > 2.0 * u { cost } else { 0.0 };
    let cost = entry.cost_ns_per_step.zip(entry.cost_u_ns_per_step).map(seen);
    vec![
        entry.effect.to_owned(),
        match entry.state {
            EffectState::On => "on",
            EffectState::Off => "off",
            EffectState::Auto if entry.active => "on*",
            EffectState::Auto => "off*",
        }
        .to_owned(),
        cost.map_or("-".to_owned(), |v| signed(v, 0)),
        entry
            .cost_share
            .map_or("-".to_owned(), |v| signed(if cost == Some(0.0) { 0.0 } else { 100.0 * v }, 0)),
        share(change.and_then(|c| c.speed)),
        share(change.and_then(|c| c.peak)),
        share(change.and_then(|c| c.arrival)),
        count(change.and_then(|c| c.peak_lsb)),
        count(change.and_then(|c| c.arrival_samples)),
    ]
}

/// Decimals that a number of this size is shown with, so that columns stay narrow.
fn decimals(value: f64) -> usize {
    match value.abs() {
        size if size < 100.0 => 2,
        size if size < 1000.0 => 1,
        _ => 0,
    }
}

/// A number with its sign; what rounds to nothing is 0.
fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.contains(|c| ('1'..='9').contains(&c)) { text } else { "0".to_owned() }
}

/// A relative change in percent, powers of ten where it is small; of one that is smaller than what is `known` (1) no more than that.
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
