//! Finds the digitiser levels behind a printed column of voltages. In this order, the first that
//! explains every value within its printed digits:
//!
//! 1. the grid that the header's scale gives, one level = V/div / 25 (10 dB/div: 0.4 dB);
//! 2. an even grid that the values themselves show by the gaps between them;
//! 3. the grid of the last printed digit: the file exactly as printed, if that takes no more than
//!    16 bits;
//! 4. a grid of 16 bits over the range, with the largest error in a note.
//!
//! Only 1 and 2 are levels of a converter. Values are never forced onto a grid that misses them:
//! rounding of more than a quarter of a level leaves more than one level possible, and rules a grid
//! out, unless a level is a whole number of last digits: then nothing was rounded (0.02 V at 0.5
//! V/div and two decimals).

use super::column::{SampleColumn, one_two_five, ten_to};
use crate::scope::waveform::LEVELS_PER_DIVISION;

/// Levels that 16 bits can tell apart, with some to spare at the ends.
const MAX_LEVELS: f64 = 65_000.0;
/// How much of a level the printed digits may leave open.
const DIGIT_TOLERANCE: f64 = 0.25;
/// The same for a first guess, which `on_grid` judges: half a last digit of a level of two is just
/// a quarter.
const GUESS_TOLERANCE: f64 = 0.3;
/// Rounding error of a level, as a share of it.
const LEVEL_ROUND_OFF: f64 = 1e-6;
/// Largest share of values that may be off the grid of the header's scale: single digits that were
/// changed (1).
const MAX_STRAY_SHARE: f64 = 0.01;
/// A gap between neighbouring values is searched for levels up to this many.
const MAX_LEVELS_IN_GAP: u32 = 8;

/// Where the levels come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum LevelSource {
    /// The header's scale.
    Scale,
    /// The gaps between the values.
    Gaps,
    /// The last printed digit.
    Digits,
    /// Nothing; the largest error is given (V; dB for an FFT).
    Rounded(f64),
}

/// Values on an even grid: `value = origin + step * index`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ValueGrid {
    /// One level (V; dB for an FFT).
    pub(super) step: f64,
    /// Value of index 0 (V; dB for an FFT).
    pub(super) origin: f64,
    pub(super) indices: Vec<i64>,
    pub(super) evidence: LevelSource,
    /// Values that are not on the grid, and have the nearest index.
    pub(super) strays: Vec<usize>,
}

impl ValueGrid {
    /// The grid of `column`; `scale` is the header's (V/div; dB/div for an FFT).
    pub(super) fn find(column: &SampleColumn, scale: Option<f64>) -> Self {
        let stated = scale.map(|scale| scale / LEVELS_PER_DIVISION);
        stated
            .and_then(|step| on_grid(column, step, LevelSource::Scale))
            .or_else(|| from_gaps(column))
            .or_else(|| from_digits(column))
            .unwrap_or_else(|| rounded(column))
    }

    /// Lowest and highest index.
    pub(super) fn range(&self) -> (i64, i64) {
        let low = self.indices.iter().min().copied().unwrap_or_default();
        (low, self.indices.iter().max().copied().unwrap_or_default())
    }

    /// Whether the levels are a converter's.
    pub(super) fn is_converter(&self) -> bool {
        matches!(self.evidence, LevelSource::Scale | LevelSource::Gaps)
    }
}

/// `column` on a grid of `step`, through zero or else through its first value.
fn on_grid(column: &SampleColumn, step: f64, evidence: LevelSource) -> Option<ValueGrid> {
    let (low, high) = column.range();
    let usable = step.is_finite() && step > 0.0 && high - low <= MAX_LEVELS * step;
    // That all values are multiples of one last digit shows nothing; of two or more, it does.
    let least = if evidence == LevelSource::Scale { 1.0 } else { 2.0 };
    let exact = column.digits_of(step).is_some_and(|count| count >= least);
    if !usable || !(exact || column.largest_tolerance() <= DIGIT_TOLERANCE * step) {
        return None;
    }
    let tolerance =
        |value| if exact { 4.0 * f64::EPSILON * f64::abs(value) } else { column.tolerance(value) };
    let first = column.values.first().copied().unwrap_or_default();
    [0.0, first].into_iter().find_map(|origin| {
        let spare = if origin == 0.0 { 0.0 } else { tolerance(first) };
        let index = |value: &f64| ((value - origin) / step).round();
        let is_off = |(_, value): &(usize, &f64)| {
            let off = (*value - origin - index(value) * step).abs();
            off > tolerance(**value) + spare + LEVEL_ROUND_OFF * step
        };
        let allowed = match evidence {
            LevelSource::Scale => (MAX_STRAY_SHARE * column.len() as f64) as usize,
            _ => 0,
        };
        let strays = column.values.iter().enumerate().filter(is_off).take(allowed + 1);
        let strays: Vec<usize> = strays.map(|(place, _)| place).collect();
        (strays.len() <= allowed).then(|| {
            let indices = column.values.iter().map(|value| whole(index(value))).collect();
            ValueGrid { step, origin, indices, evidence, strays }
        })
    })
}

/// The grid on which the gaps between neighbouring values are whole numbers of steps.
fn from_gaps(column: &SampleColumn) -> Option<ValueGrid> {
    let mut sorted = column.values.clone();
    sorted.sort_by(f64::total_cmp);
    let tolerance = column.largest_tolerance();
    let mut gaps: Vec<f64> = sorted.windows(2).map(step_between).collect();
    gaps.retain(|gap| *gap > 2.0 * tolerance);
    let smallest = gaps.iter().copied().fold(f64::INFINITY, f64::min);
    if !smallest.is_finite() {
        return None;
    }
    let mut found: Option<ValueGrid> = None;
    for parts in 1..=MAX_LEVELS_IN_GAP {
        let Some(step) = refined(&gaps, smallest / f64::from(parts), tolerance) else { continue };
        let nice = one_two_five(step * LEVELS_PER_DIVISION, 1e-3);
        let exact =
            nice.and_then(|scale| on_grid(column, scale / LEVELS_PER_DIVISION, LevelSource::Gaps));
        if exact.is_some() {
            return exact;
        }
        found = found.or_else(|| on_grid(column, step, LevelSource::Gaps));
    }
    found
}

fn step_between(pair: &[f64]) -> f64 {
    match pair {
        [low, high] => high - low,
        _ => 0.0,
    }
}

/// A step near `guess`, from the whole range: the sum of the gaps over the sum of their levels.
fn refined(gaps: &[f64], guess: f64, tolerance: f64) -> Option<f64> {
    if tolerance > GUESS_TOLERANCE * guess {
        return None;
    }
    let (mut levels, mut sum, mut step) = (0.0, 0.0, guess);
    for gap in gaps {
        levels += (gap / step).round();
        sum += gap;
        // Short gaps carry the rounding of two values; the longer the way, the better the step is
        // known.
        if sum > 64.0 * guess {
            step = sum / levels;
        }
    }
    (levels > 0.0).then_some(sum / levels)
}

/// The values as printed.
fn from_digits(column: &SampleColumn) -> Option<ValueGrid> {
    let step = ten_to(-column.decimals());
    let (low, high) = column.range();
    let usable = step.is_finite() && step > 0.0 && high - low <= MAX_LEVELS * step;
    usable.then(|| {
        let indices = column.values.iter().map(|value| whole((value / step).round())).collect();
        ValueGrid { step, origin: 0.0, indices, evidence: LevelSource::Digits, strays: Vec::new() }
    })
}

/// The values in 16 bits, as well as that goes.
fn rounded(column: &SampleColumn) -> ValueGrid {
    let (low, high) = column.range();
    let least = ((high - low) / MAX_LEVELS).max(f64::MIN_POSITIVE);
    let decade = ten_to(whole_power(least));
    let steps = [1.0, 2.0, 5.0, 10.0, 20.0].map(|digit| digit * decade);
    let step = steps.into_iter().find(|step| *step >= least).unwrap_or(least);
    let index = |value: &f64| ((value - low) / step).round();
    let error = column
        .values
        .iter()
        .map(|value| (value - low - index(value) * step).abs())
        .fold(0.0, f64::max);
    let indices = column.values.iter().map(|value| whole(index(value))).collect();
    let evidence = LevelSource::Rounded(error);
    ValueGrid { step, origin: low, indices, evidence, strays: Vec::new() }
}

fn whole(index: f64) -> i64 {
    index as i64
}

fn whole_power(value: f64) -> i32 {
    value.log10().floor() as i32
}
