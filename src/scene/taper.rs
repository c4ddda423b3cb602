//! Rows of a chain whose repetitions differ in size: `diameter = { from, to }`, in even steps, or
//! `factor`, each so many times as large as the one before. A body scales as a whole: its length
//! with the size, its mass with the cube.

use super::document::Value;
use super::reader::{Bound, TableReader};
use crate::quantity::Dimension;

/// How large each repetition of a row is, in sizes of its kinds; empty where all are alike, none
/// where it is wrong.
pub(super) fn sizes(
    segment: &TableReader<'_>,
    repeat: usize,
    diameters: &[Option<f64>],
) -> Option<Vec<f64>> {
    let (tapers, grows) = (segment.has("diameter"), segment.has("factor"));
    if tapers && grows {
        let _ = (segment.node("diameter"), segment.node("factor"));
        segment.problem("factor", "both `diameter` and `factor`", "one of them");
        return None;
    }
    let rows = (0..repeat).map(|row| row as f64);
    if grows {
        let factor = segment.quantity("factor", Dimension::NONE, Bound::Positive)?;
        let sizes: Vec<f64> = rows.map(|row| factor.powf(row)).collect();
        for size in sizes.last().into_iter().chain(sizes.first()) {
            size_fits(segment, "factor", *size, diameters)?;
        }
        return Some(sizes);
    }
    if !tapers {
        let _ = (segment.node("diameter"), segment.node("factor"));
        return Some(Vec::new());
    }
    let node = segment.node("diameter")?;
    if !matches!(node.value, Value::Table(_)) {
        segment.problem("diameter", node.describe(), "{ from = \"10 mm\", to = \"5 mm\" }");
        return None;
    }
    let table = segment.table("diameter")?;
    let end = |key| table.required(key, Dimension::LENGTH, Bound::LENGTH);
    let ends = (end("from"), end("to"));
    table.finish();
    let (from, to) = (ends.0?, ends.1?);
    let [diameter] = diameters else {
        let found = format!("a taper of {} kinds", diameters.len());
        segment.problem("diameter", found, "one kind in `particles`, or `factor`");
        return None;
    };
    if repeat < 2 {
        segment.problem("diameter", "a taper of a single row", "`repeat` of 2 or more");
        return None;
    }
    let steps = f64::from(u32::try_from(repeat - 1).unwrap_or(u32::MAX));
    // A kind that could not be read has left its problem.
    let own = diameter.unwrap_or(from);
    Some(rows.map(|row| (from + (to - from) * row / steps) / own).collect())
}

/// Refuses particles that would be too small or too large.
fn size_fits(
    segment: &TableReader<'_>,
    key: &str,
    size: f64,
    diameters: &[Option<f64>],
) -> Option<()> {
    for diameter in diameters.iter().flatten().map(|diameter| size * diameter) {
        if !Bound::LENGTH.holds(diameter) {
            let found = format!("particles of {diameter:.3e} m");
            segment.problem(key, found, format!("a length{}", Bound::LENGTH.broken_by(diameter)));
            return None;
        }
    }
    Some(())
}
