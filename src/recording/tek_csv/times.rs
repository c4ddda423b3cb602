//! Finds the even spacing behind a printed column of times: sample interval and trigger point. What
//! the header states is taken where the column agrees with it; else what the column tells, with a
//! note; a column that no even spacing explains is refused.
//!
//! `time(i) = (i - trigger point) * interval`, `i` from 0. An interval explains the column if one
//! start brings every row within the tolerance `d_i` of its printed digits:
//! `max (t_i - d_i - i dt) <= min (t_i + d_i - i dt)`. The difference of the two sides is convex in
//! `dt`: the intervals that explain the column lie between two ends, which cutting planes find
//! (Kelley 1960, J. Soc. Ind. Appl. Math. 8, 703).

use super::column::{SampleColumn, rounded};
use crate::numeric::statistics::median;
use crate::quantity::engineering;
use crate::recording::error::RecordingError;

/// How much of an interval a time near zero may be off, if times elsewhere are as coarse.
const MAX_TIME_DRIFT: f64 = 0.01;
/// Rounding error of a time, as a share of the interval.
const TIME_ROUND_OFF: f64 = 1e-6;
/// An interval that is known worse than this is told with its bounds (1).
const TOLD_INTERVAL_WIDTH: f64 = 1e-3;
/// A printed digit of more than this share of the interval cannot tell rounding from a missing row
/// (1).
const MAX_DIGIT_SHARE: f64 = 0.6;
/// Times that are off even spacing by less than this share of an interval are taken as even (1).
const MAX_UNEVEN_SHARE: f64 = 1e-3;
/// The same of times that single precision cannot tell apart better (1).
const MAX_SINGLE_SHARE: f64 = 0.1;
/// From this share of odd intervals on, times are uneven as a whole (1).
const UNEVEN_SHARE: f64 = 0.05;
/// Cutting planes until the best interval is found; a few suffice.
const MAX_CUTS: usize = 60;
/// Most digits of a number (1).
const MAX_DIGITS: usize = 15;

/// The time base as the header states it.
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
    ) -> Result<Self, RecordingError> {
        let rows = Rows::of(column);
        let (best, range) = rows.intervals();
        if let Some(index) = rows.gap(column).filter(|_| range.is_some()) {
            return Err(rows.uneven(column, best, Some(index), unit));
        }
        let by_header = stated.interval.filter(|interval| *interval > 0.0);
        let of_column = range.map(|(low, high)| simplest(low, high, best));
        let intervals = [by_header, of_column, Some(best)];
        for interval in intervals.into_iter().flatten().filter(|interval| *interval > 0.0) {
            let Some(starts) = rows.starts(interval) else { continue };
            let times = Self { interval, trigger_point: rows.trigger(interval, starts, stated) };
            times.compare(stated, (range, unit), notes);
            return Ok(times);
        }
        if let Some((times, off)) = rows.nearly_even(stated) {
            notes.push(format!(
                "times are off even spacing by up to {}, {} of an interval, as numbers of single precision are; even spacing is taken",
                engineering(off, unit, 2),
                share(off / times.interval)
            ));
            times.compare(stated, (None, unit), notes);
            return Ok(times);
        }
        Err(rows.uneven(column, best, None, unit))
    }

    /// Puts `values` at uneven `times` on an even grid of as many points, by straight lines between
    /// neighbours (`f(t) = f_i + (f_(i+1) - f_i)(t - t_i)/(t_(i+1) - t_i)`, error at most
    /// `h^2/8 max |f''|`); notes what that does.
    pub(super) fn resample(
        times: &SampleColumn,
        values: &mut SampleColumn,
        (unit, y_unit): (&'static str, &str),
        notes: &mut Vec<String>,
    ) -> Result<Self, RecordingError> {
        let found = times.values.as_slice();
        let steps = || found.iter().zip(found.iter().skip(1)).map(|(a, b)| b - a);
        if let Some(index) = steps().position(|step| step <= 0.0) {
            let (found, expected) =
                ("a time that is not after the one before", "rising times to resample");
            return Err(RecordingError::found(times.place(index + 1), found, expected));
        }
        let (first, last) = (found.first().copied(), found.last().copied());
        let (first, last) = (first.unwrap_or_default(), last.unwrap_or_default());
        let interval = (last - first) / (found.len().saturating_sub(1).max(1)) as f64;
        let [smallest, largest] = extremes(steps());
        let bend = values.values.windows(3).map(|three| match three {
            [a, b, c] => (a - 2.0 * b + c).abs(),
            _ => 0.0,
        });
        let bend = bend.fold(0.0, f64::max);
        let mut place = 0;
        let at = |time: f64, place: usize| {
            let [from, to] = [place, place + 1].map(|at| found.get(at).copied().unwrap_or(last));
            let [low, high] =
                [place, place + 1].map(|at| values.values.get(at).copied().unwrap_or_default());
            if to > from { low + (high - low) * (time - from) / (to - from) } else { low }
        };
        let resampled = (0..found.len()).map(|index| {
            let time = (first + index as f64 * interval).min(last);
            while place + 2 < found.len() && found.get(place + 1).is_some_and(|next| *next < time) {
                place += 1;
            }
            at(time, place)
        });
        let resampled: Vec<f64> = resampled.collect();
        values.replace(resampled);
        let shown = |time: f64| engineering(time, unit, 4);
        notes.push(format!(
            "uneven times, {} to {} apart, are resampled every {} by straight lines: add an uncertainty of up to {} to times and of about {} (an eighth of the largest bend) to values",
            shown(smallest),
            shown(largest),
            shown(interval),
            engineering(largest / 2.0, unit, 2),
            engineering(bend / 8.0, y_unit, 2)
        ));
        Ok(Self { interval, trigger_point: 0.0 - first / interval })
    }

    /// Whether one even spacing, forward in time, explains the column.
    pub(super) fn explain(column: &SampleColumn) -> bool {
        let rows = Rows::of(column);
        let (best, range) = rows.intervals();
        best > 0.0 && range.is_some() && rows.gap(column).is_none()
    }

    fn compare(
        &self,
        stated: StatedTimeBase,
        (range, unit): (Option<(f64, f64)>, &str),
        notes: &mut Vec<String>,
    ) {
        match stated.interval {
            None => {
                let coarse = range.filter(|(low, high)| high - low > TOLD_INTERVAL_WIDTH * self.interval);
                let bounds = coarse.map_or(String::new(), |(low, high)| {
                    let shown = |interval| engineering(interval, unit, 4);
                    format!(", between {} and {} by the printed digits", shown(low), shown(high))
                });
                notes.push(format!(
                    "sample interval {:e} {unit} taken from the column of times: not given in a header{bounds}",
                    self.interval
                ));
            }
            Some(stated) if stated.to_bits() != self.interval.to_bits() => notes.push(format!(
                "sample interval {:e} {unit} taken from the column of times; the header says {stated:e} {unit}",
                self.interval
            )),
            Some(_) => {}
        }
        match stated.trigger_point {
            // Where a header tells the interval, it gives the trigger by the time that is zero.
            None if stated.interval.is_some() => {}
            None => notes.push(format!(
                "trigger point {} taken from the time that is zero: not given in a header",
                (1e3 * self.trigger_point).round() / 1e3
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

/// Times and how far each may be off.
struct Rows<'a> {
    times: &'a [f64],
    tolerances: Vec<f64>,
}

/// Residuals of an interval: how far the rows miss it, and the slope of that over the interval.
#[derive(Clone, Copy)]
struct Miss {
    /// Above zero where no start explains all rows (s; Hz for an FFT).
    excess: f64,
    /// Largest lower and smallest upper bound of the start (s; Hz for an FFT).
    starts: (f64, f64),
    /// Rows that give them.
    rows: (usize, usize),
}

/// A cut: an interval (s; Hz for an FFT), its excess there, and its slope.
type Cut = (f64, f64, f64);

impl<'a> Rows<'a> {
    fn of(column: &'a SampleColumn) -> Self {
        let times = column.values.as_slice();
        let (low, high) = column.range();
        let span = high - low;
        let step = (span / ((column.len().saturating_sub(1)) as f64)).abs();
        let round_off = 4.0 * f64::EPSILON * low.abs().max(high.abs());
        // Programs add up times, and what should be zero comes out as -4.6E-11: with a fixed number
        // of digits, not of decimals.
        let (coarsest, finest) = (column.largest_tolerance(), column.tolerance(0.0));
        let drift = if coarsest > 1.5 * finest { coarsest.min(MAX_TIME_DRIFT * step) } else { 0.0 };
        let spare = round_off + drift + TIME_ROUND_OFF * step;
        let tolerances = times.iter().map(|value| column.tolerance(*value) + spare).collect();
        Self { times, tolerances }
    }

    fn miss(&self, interval: f64) -> Miss {
        let mut miss = Miss {
            excess: f64::INFINITY,
            starts: (f64::NEG_INFINITY, f64::INFINITY),
            rows: (0, 0),
        };
        for (index, (time, tolerance)) in self.times.iter().zip(&self.tolerances).enumerate() {
            let start = time - index as f64 * interval;
            if start - tolerance > miss.starts.0 {
                (miss.starts.0, miss.rows.0) = (start - tolerance, index);
            }
            if start + tolerance < miss.starts.1 {
                (miss.starts.1, miss.rows.1) = (start + tolerance, index);
            }
        }
        miss.excess = miss.starts.0 - miss.starts.1;
        miss
    }

    /// The starts with which `interval` explains every row.
    fn starts(&self, interval: f64) -> Option<(f64, f64)> {
        let miss = self.miss(interval);
        // Also a difference that is not a number.
        matches!(miss.excess.partial_cmp(&0.0), Some(order) if order.is_le()).then_some(miss.starts)
    }

    /// The interval that misses the rows least, and the ends of those that explain all rows, if any
    /// does.
    fn intervals(&self) -> (f64, Option<(f64, f64)>) {
        let last = self.times.len().saturating_sub(1);
        let ends = |start: f64, end: f64| (end - start) / ((last.max(1)) as f64);
        let first = self.times.first().copied().unwrap_or_default();
        let guess = ends(first, self.times.last().copied().unwrap_or_default());
        let best = self.least_miss(guess);
        let found = self.miss(best).excess <= 0.0;
        let range = found.then(|| (self.end(best, -1.0), self.end(best, 1.0)));
        (best, range)
    }

    /// The interval of least excess: the crossing of the steepest cuts from the left and from the
    /// right, again and again.
    fn least_miss(&self, guess: f64) -> f64 {
        let (mut left, mut right): (Option<Cut>, Option<Cut>) = (None, None);
        let (mut at, mut best) = (guess, (f64::INFINITY, guess));
        for _ in 0..MAX_CUTS {
            let miss = self.miss(at);
            if miss.excess < best.0 {
                best = (miss.excess, at);
            }
            // d/d(interval) of (t_p - p dt) - (t_q - q dt).
            let slope = miss.rows.1 as f64 - miss.rows.0 as f64;
            let cut = Some((at, miss.excess, slope));
            if slope < 0.0 {
                left = cut;
            } else if slope > 0.0 {
                right = cut;
            } else {
                break;
            }
            let next = match (left, right) {
                (Some((x, y, a)), Some((u, v, b))) => (v - y + a * x - b * u) / (a - b),
                // One side is still open: the step at which the other cut would lose what it has.
                (Some((x, y, a)), None) => x - (y.abs() + self.spread()) / a,
                (None, Some((u, v, b))) => u - (v.abs() + self.spread()) / b,
                (None, None) => break,
            };
            if next.to_bits() == at.to_bits() || !next.is_finite() {
                break;
            }
            at = next;
        }
        best.1
    }

    fn spread(&self) -> f64 {
        self.tolerances.iter().copied().fold(0.0, f64::max)
    }

    /// The last interval on one side of `best` that explains all rows.
    fn end(&self, best: f64, side: f64) -> f64 {
        let last = self.times.len().saturating_sub(1).max(1) as f64;
        let mut outside = best + side * 4.0 * self.spread() / last;
        // From outside, cuts lead to the end without passing it.
        for _ in 0..MAX_CUTS {
            let miss = self.miss(outside);
            let slope = miss.rows.1 as f64 - miss.rows.0 as f64;
            if miss.excess <= 0.0 || slope == 0.0 {
                break;
            }
            let next = outside - miss.excess / slope;
            if next.to_bits() == outside.to_bits() {
                break;
            }
            outside = next;
        }
        outside
    }

    /// An even spacing from which no time is farther than single precision rounds, or than a
    /// thousandth of an interval; and how far they are off.
    fn nearly_even(&self, stated: StatedTimeBase) -> Option<(EvenTimes, f64)> {
        let (first, last) = self.times.first().copied().zip(self.times.last().copied())?;
        let count = self.times.len().checked_sub(1).filter(|count| *count > 1)? as f64;
        let best = (last - first) / count;
        let largest = first.abs().max(last.abs()).max(f64::MIN_POSITIVE);
        let single = 2f64.powf(largest.log2().floor() - f64::from(f32::MANTISSA_DIGITS - 1));
        let limit = (MAX_UNEVEN_SHARE * best).max(single.min(MAX_SINGLE_SHARE * best));
        let width = 2.0 * limit / count;
        let by_header = stated.interval.filter(|interval| (interval - best).abs() <= width);
        let interval = by_header.unwrap_or_else(|| simplest(best - width, best + width, best));
        let left =
            self.times.iter().enumerate().map(|(index, time)| time - index as f64 * interval);
        let [low, high] = extremes(left);
        let off = 0.5 * (high - low);
        if !(interval > 0.0 && off <= limit) {
            return None;
        }
        let trigger_point = self.trigger(interval, (high - limit, low + limit), stated);
        Some((EvenTimes { interval, trigger_point }, off))
    }

    /// The trigger point: the header's, a whole one, that of the first row as printed, or the
    /// middle of what is possible.
    fn trigger(&self, interval: f64, (low, high): (f64, f64), stated: StatedTimeBase) -> f64 {
        let first = self.times.first().copied().unwrap_or_default();
        let middle = 0.0 - f64::midpoint(low, high) / interval;
        let whole = middle.round();
        let point = 0.0 - first / interval;
        let candidates = [stated.trigger_point, Some(point.round()), Some(whole), Some(point)];
        let fits = |point: &f64| (low..=high).contains(&(0.0 - point * interval));
        candidates.into_iter().flatten().find(fits).unwrap_or(middle)
    }

    /// The first row whose step from the one before no rounding explains: rounded multiples of one
    /// interval have steps that differ by at most one digit. Where a digit is more than
    /// [`MAX_DIGIT_SHARE`] of an interval, any difference may be a missing row.
    fn gap(&self, column: &SampleColumn) -> Option<usize> {
        if column.len() < 3 || column.largest_tolerance() > 1.5 * column.tolerance(0.0) {
            return None;
        }
        let digit = column.digit();
        let steps = || self.times.iter().zip(self.times.iter().skip(1)).map(|(a, b)| b - a);
        let smallest = steps().fold(f64::INFINITY, f64::min);
        let usual = median(steps().collect());
        let allowed = if digit > MAX_DIGIT_SHARE * usual { 0.5 } else { 1.5 };
        let wide = steps().any(|step| step - smallest > allowed * digit);
        let off = |step: f64| (step - usual).abs() > 0.5 * digit;
        wide.then(|| steps().position(off).map(|index| index + 1)).flatten()
    }

    fn uneven(
        &self,
        column: &SampleColumn,
        best: f64,
        gap: Option<usize>,
        unit: &'static str,
    ) -> RecordingError {
        let steps = || self.times.iter().zip(self.times.iter().skip(1)).map(|(a, b)| b - a);
        let [smallest, largest] = extremes(steps());
        let usual = median(steps().collect());
        let shown = |time: f64| engineering(time, unit, 4);
        let spread = format!(
            "the intervals are {} to {}, the median is {}",
            shown(smallest),
            shown(largest),
            shown(usual)
        );
        let advice = if smallest > 0.0 {
            format!("; {spread}: --resample puts the values on an even grid")
        } else {
            String::new()
        };
        let uneven = |found: String, expected: String, index: usize| {
            let expected = format!("{expected} {unit} by even spacing{advice}");
            RecordingError::found(column.place(index), format!("{found} {unit}"), expected)
        };
        let odd = steps().filter(|step| (step - usual).abs() > 0.5 * column.digit()).count();
        if smallest > 0.0 && odd as f64 > UNEVEN_SHARE * self.times.len() as f64 && gap.is_none() {
            let place = column.place(0).file;
            let problem = format!("found uneven times, expected even spacing; {spread}");
            let advice = "--resample puts the values on an even grid";
            return RecordingError::new(place, format_args!("{problem}: {advice}"));
        }
        let first = self.times.first().copied().unwrap_or_default();
        if best.is_nan() || best <= 0.0 {
            let index = self.times.len().saturating_sub(1);
            let found = self.times.last().copied().unwrap_or_default();
            let expected = format!("more than {}", column.printed(first));
            let found = column.printed(found);
            return uneven(found, expected, index);
        }
        // The median of steps over half the record, and of what it leaves: single rows do not
        // change them.
        let half = (self.times.len() / 2).max(1);
        let pairs = self.times.iter().zip(self.times.iter().skip(half));
        let interval = median(pairs.map(|(a, b)| (b - a) / half as f64).collect());
        let left = |index: usize, time: f64| time - index as f64 * interval;
        let start = median(self.times.iter().enumerate().map(|(i, t)| left(i, *t)).collect());
        let expected = |index: usize| start + index as f64 * interval;
        let rows = || self.times.iter().zip(&self.tolerances).enumerate();
        let far = |(index, (time, tolerance)): (usize, (&f64, &f64))| {
            (time - expected(index)).abs() > 2.0 * tolerance
        };
        let distance = |index: usize, time: f64| (time - expected(index)).abs();
        let farthest = || {
            let all = rows().map(|(index, (time, _))| (distance(index, *time), index));
            all.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, index)| index)
        };
        let miss = gap.or_else(|| rows().position(far)).or_else(farthest);
        let index = miss.unwrap_or_default();
        let time = |index: usize| self.times.get(index).copied();
        let found = column.printed(time(index).unwrap_or_default());
        // Behind a missing row, one step from the row before it is expected: the spacing of the
        // whole column is too wide.
        let steps = self.times.iter().zip(self.times.iter().skip(1)).map(|(a, b)| b - a);
        let next = gap.and_then(|gap| Some(time(gap.checked_sub(1)?)? + median(steps.collect())));
        let expected = column.printed(next.unwrap_or_else(|| expected(index)));
        uneven(found, expected, index)
    }
}

/// Smallest and largest of numbers.
fn extremes(numbers: impl Iterator<Item = f64>) -> [f64; 2] {
    numbers.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], number| {
        [low.min(number), high.max(number)]
    })
}

/// A share as a percentage with two digits.
fn share(share: f64) -> String {
    format!("{} %", rounded(100.0 * share, 2))
}

/// The number with the fewest digits between `low` and `high`; where many digits lie between them,
/// near `best`.
fn simplest(low: f64, high: f64, best: f64) -> f64 {
    let coarse = high - low > TOLD_INTERVAL_WIDTH * best.abs();
    let middle = f64::midpoint(low, high);
    let quarter = 0.25 * (high - low);
    let (low, high) = if coarse { (middle - quarter, middle + quarter) } else { (low, high) };
    let candidates = (1..=MAX_DIGITS).map(|digits| rounded(middle, digits));
    let mut inside = candidates.filter(|interval| (low..=high).contains(interval));
    inside.next().unwrap_or(middle)
}
