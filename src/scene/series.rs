//! Lists of settings in an oscilloscope's file.

use super::reader::TableReader;
use crate::quantity::{Dimension, parse};

/// Most points that a record may have: what a scope of any make keeps in memory.
pub const MAX_RECORD_LENGTH: u64 = 1_000_000;

/// A list of quantities, ascending (unit).
pub fn series(
    table: &TableReader<'_>,
    key: &'static str,
    dimension: Dimension,
    required: bool,
) -> Option<Vec<f64>> {
    let expected = || format!("{dimension} above zero");
    if required && !table.has(key) {
        table.problem(key, "no such key", format!("a list, each {}", expected()));
    }
    if table.is_empty_list(key) {
        table.problem(key, "an empty list", format!("a list, each {}", expected()));
    }
    let mut values = Vec::new();
    for (text, place) in table.texts(key) {
        match parse(text, dimension) {
            Ok(value) if value > 0.0 => values.push(value),
            _ => table.problem_at(place, key, format!("\"{text}\""), expected()),
        }
    }
    values.sort_by(f64::total_cmp);
    (!values.is_empty()).then_some(values)
}
