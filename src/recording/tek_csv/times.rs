//! Finds the even spacing behind a printed column of times: sample interval and trigger point. What the
//! header states is taken where the column agrees with it; else what the column tells, with a note; a column
//! that no even spacing explains is refused.
//!
//! `time(i) = (i - trigger point) * interval`, `i` from 0.

use super::column::{SampleColumn, rounded};
use super::error::TekCsvError;

/// How much of an interval a time near zero may be off, if times elsewhere are as coarse.
const MAX_TIME_DRIFT: f64 = 0.01;
/// What of an interval means nothing.
const TIME_ROUND_OFF: f64 = 1e-6;

/// What a header says of the time base.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct StatedTimeBase {
    /// Sample interval (s; Hz for an FFT).
    pub(super) interval: Option<f64>,
    /// Index of the trigger (1).
    pub(super) trigger_point: Option<f64>,
}

/// An even spacing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct EvenTimes {
    /// Sample interval (s; Hz for an FFT).
    pub(super) interval: f64,
    /// Index of the trigger (1).
    pub(super) trigger_point: f64,
}

impl EvenTimes {
    /// The spacing of `column`; adds to `notes` what the header did not tell, or told otherwise.
    pub(super) fn fit(
        column: &SampleColumn,
        stated: StatedTimeBase,
        unit: &'static str,
        notes: &mut Vec<String>,
    ) -> Result<Self, TekCsvError> {
        let fitted = Self::between_ends(column, unit)?;
        let intervals = [stated.interval, Some(rounded(fitted.interval, 4)), Some(fitted.interval)];
        for interval in intervals.into_iter().flatten().filter(|interval| *interval > 0.0) {
            let first = column.values.first().copied().unwrap_or_default();
            let point = 0.0 - first / interval;
            for trigger_point in [stated.trigger_point, Some(point.round()), Some(point)] {
                let Some(trigger_point) = trigger_point else { continue };
                let times = Self { interval, trigger_point };
                if times.first_miss(column).is_none() {
                    times.compare(stated, unit, notes);
                    return Ok(times);
                }
            }
        }
        let miss = fitted.first_miss(column).unwrap_or_default();
        let place = column.place(miss);
        let found = column.values.get(miss).copied().unwrap_or_default();
        let expected = format!("{:.6e}", fitted.time(miss));
        Err(TekCsvError::Uneven { place, found, expected, unit })
    }

    fn between_ends(column: &SampleColumn, unit: &'static str) -> Result<Self, TekCsvError> {
        let first = column.values.first().copied().unwrap_or_default();
        let last = column.values.last().copied().unwrap_or_default();
        let interval = (last - first) / count(column.len().saturating_sub(1));
        if interval.is_finite() && interval > 0.0 {
            return Ok(Self { interval, trigger_point: 0.0 - first / interval });
        }
        let index = column.len().saturating_sub(1);
        let expected = format!("more than {first:e}");
        Err(TekCsvError::Uneven { place: column.place(index), found: last, expected, unit })
    }

    fn time(&self, index: usize) -> f64 {
        (count(index) - self.trigger_point) * self.interval
    }

    /// The first row that this spacing does not explain.
    fn first_miss(&self, column: &SampleColumn) -> Option<usize> {
        let (low, high) = column.range();
        let round_off = 4.0 * f64::EPSILON * low.abs().max(high.abs());
        // Programs add up times, and what should be zero comes out as -4.6E-11.
        let drift = column.largest_tolerance().min(MAX_TIME_DRIFT * self.interval);
        let spare = round_off + drift + TIME_ROUND_OFF * self.interval;
        column.values.iter().enumerate().position(|(index, value)| {
            let off = (value - self.time(index)).abs();
            // Also a difference that is not a number.
            !matches!(off.partial_cmp(&(column.tolerance(*value) + spare)), Some(order) if order.is_le())
        })
    }

    fn compare(&self, stated: StatedTimeBase, unit: &str, notes: &mut Vec<String>) {
        match stated.interval {
            None => notes.push(format!(
                "sample interval {:e} {unit} taken from the first column: no header tells it",
                self.interval
            )),
            Some(stated) if stated.to_bits() != self.interval.to_bits() => notes.push(format!(
                "sample interval {:e} {unit} taken from the column of times; the header says {stated:e} {unit}",
                self.interval
            )),
            Some(_) => {}
        }
        match stated.trigger_point {
            None => notes.push(format!(
                "trigger point {} taken from the time that is zero: no header tells it",
                self.trigger_point
            )),
            Some(stated) if stated.to_bits() != self.trigger_point.to_bits() => {
                notes.push(format!(
                    "trigger point {} taken from the column of times; the header says {stated}",
                    self.trigger_point
                ));
            }
            Some(_) => {}
        }
    }
}

#[allow(clippy::cast_precision_loss, reason = "at most a million rows")]
fn count(rows: usize) -> f64 {
    rows as f64
}
