//! Turns the content of a foreign file into a capture: missing values are estimated, and each
//! estimate is noted in the capture. The dialects' readers fill an [`UnscaledImport`]; `times` and
//! `levels` estimate.
//!
//! `volts = (code - y_off) y_mult + y_zero`, and in the time domain `y_zero = 0`.

use super::column::{SampleColumn, one_two_five, ten_to};
use super::layout::PRINTING_ERROR;
use super::levels::{LevelSource, ValueGrid};
use super::rails::{FlatTop, flat_tops};
use super::times::{EvenTimes, StatedTimeBase};
use crate::quantity::engineering;
use crate::recording::error::RecordingError;
use crate::recording::{Capture, InstrumentIdentity};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{PointFormat, Preamble, Source, VerticalSetup, Waveform};

/// Points in one horizontal division of the family.
const POINTS_PER_DIVISION: f64 = 250.0;
/// A zero level that lies farther than this from a whole one did not come from the family's own
/// steps (1).
const ZERO_LEVEL_TOLERANCE: f64 = 0.02;
/// With fewer levels than this, their spacing is weak evidence.
const MIN_LEVELS: usize = 8;

/// One channel of a foreign file, before its vertical scale is known.
#[derive(Debug, Clone, Default)]
pub(super) struct UnscaledImport {
    pub(super) times: SampleColumn,
    pub(super) values: SampleColumn,
    pub(super) stated: StatedTimeBase,
    /// The spacing, where start and increment are told instead of times.
    pub(super) even: Option<EvenTimes>,
    pub(super) source: Option<Source>,
    /// Vertical scale (V/div; dB/div for an FFT).
    pub(super) scale: Option<f64>,
    /// How far zero stands above the centre (V); of an FFT, the value of level 0 (dB).
    pub(super) zero: Option<f64>,
    /// Time base (s/div; Hz/div for an FFT).
    pub(super) horizontal_scale: Option<f64>,
    /// Probe attenuation (1).
    pub(super) probe: Option<f64>,
    pub(super) x_unit: Option<String>,
    pub(super) y_unit: Option<String>,
    pub(super) point_format: Option<PointFormat>,
    pub(super) instrument: Option<InstrumentIdentity>,
    pub(super) notes: Vec<String>,
    /// Whether uneven times are resampled.
    pub(super) resample: bool,
    /// Whether the values are printed levels of the family's digitiser, which its scale gives with
    /// more digits.
    pub(super) are_levels: bool,
    /// Whether the values show the ends of the input's range.
    pub(super) is_cut: bool,
    /// Values that are taken as another one.
    pub(super) strays: Vec<usize>,
}

/// The digitiser's side of a capture.
struct Vertical {
    codes: Vec<i16>,
    y_mult: f64,
    y_off: f64,
    y_zero: f64,
    scale: f64,
    /// Where zero stands (div).
    position: f64,
}

impl UnscaledImport {
    /// The capture; a channel that the file does not name is taken as number `channel`.
    pub(super) fn capture(mut self, file: &str, channel: u8) -> Result<Capture, RecordingError> {
        const FEWEST: usize = 2;
        let found = self.values.len();
        if found < FEWEST {
            let expected = format!("{FEWEST} to {} with samples", super::cells::MAX_ROWS);
            return Err(RecordingError::found(file, format!("{found} rows"), expected));
        }
        let x_unit = self.x_unit.take().unwrap_or_else(|| self.assume("s", "unit of the times"));
        let y_unit = self.y_unit.take().unwrap_or_else(|| self.assume("V", "unit of the values"));
        let unit = if x_unit == "Hz" { "Hz" } else { "s" };
        let times = match self.even {
            Some(even) => even,
            None => self.even_times((unit, &y_unit))?,
        };
        let vertical = self.vertical(&y_unit);
        let source = self.source.unwrap_or_else(|| {
            let name = format!("CH{channel}");
            self.assume(&name, "source");
            Source::Channel(channel)
        });
        let probe = self.probe.unwrap_or_else(|| {
            self.assume("1", "probe attenuation");
            1.0
        });
        let horizontal_scale = self.horizontal_scale(times.interval, unit);
        let codes = vertical.codes;
        let as_read = self.as_read(&codes, (vertical.y_mult, vertical.y_off, vertical.y_zero));
        let preamble = Preamble {
            x_zero: (0.0 - times.trigger_point) * times.interval,
            x_incr: times.interval,
            pt_off: 0,
            x_unit,
            y_mult: vertical.y_mult,
            y_zero: vertical.y_zero,
            y_off: vertical.y_off,
            y_unit,
            pt_fmt: self.point_format.unwrap_or(PointFormat::Sample),
        };
        let waveform = Waveform {
            source,
            codes,
            as_read,
            preamble,
            vertical: VerticalSetup {
                scale: vertical.scale,
                position: vertical.position,
                coupling: None,
                bandwidth_limited: None,
                inverted: None,
                probe,
            },
            horizontal_scale,
            trigger_point: times.trigger_point,
        };
        if self.zero.is_none() && !self.is_cut && waveform.clipped() > 0 {
            self.notes.push(
                "whether points are clipped is not sure: the vertical position is a guess"
                    .to_owned(),
            );
        }
        Ok(Capture { waveform, instrument: self.instrument, notes: self.notes })
    }

    /// The spacing of the times, which are resampled if they are uneven and the user wants it.
    fn even_times(&mut self, units: (&'static str, &str)) -> Result<EvenTimes, RecordingError> {
        let found = EvenTimes::fit(&self.times, self.stated, units.0, &mut self.notes);
        if found.is_ok() || !self.resample {
            return found;
        }
        if !self.values.beyond.is_empty() {
            let place = self.values.beyond.first().map(|(index, _)| self.values.place(*index));
            let place = place.map(|place| place.to_string()).unwrap_or_default();
            let (found, expected) = ("a value beyond the range", "none where times are resampled");
            return Err(RecordingError::found(place, found, expected));
        }
        EvenTimes::resample(&self.times, &mut self.values, units, &mut self.notes)
    }

    /// Notes that the file does not tell `what`, and returns what is taken instead.
    fn assume(&mut self, taken: &str, what: &str) -> String {
        self.notes.push(format!("{what} taken as {taken}: not given in the file"));
        taken.to_owned()
    }

    fn horizontal_scale(&mut self, interval: f64, unit: &str) -> f64 {
        self.horizontal_scale.filter(|scale| *scale > 0.0).unwrap_or_else(|| {
            let scale = super::column::rounded(POINTS_PER_DIVISION * interval, 9);
            let text = engineering(scale, &format!("{unit}/div"), 3);
            self.assume(&text, "time base, 250 points a division,");
            scale
        })
    }

    fn vertical(&mut self, unit: &str) -> Vertical {
        let stated = self.scale.filter(|scale| *scale > 0.0);
        if !self.values.beyond.is_empty() {
            return self.beyond_range(stated, unit);
        }
        let grid = ValueGrid::find(&self.values, stated);
        self.note_evidence(&grid, stated, unit);
        self.note_strays(&grid, unit);
        let scale = stated.unwrap_or_else(|| self.guess_scale(&grid, unit));
        self.strays.clone_from(&grid.strays);
        self.are_levels &= grid.evidence == LevelSource::Scale;
        let cut = self.cut(&grid, unit);
        if cut == [true, true] {
            return self.between_ends(scale);
        }
        self.is_cut = cut.contains(&true);
        let shift = if self.is_cut { shift_to_end(&grid, cut[0]) } else { self.shift(&grid, unit) };
        let zero_index = whole_if_near(grid.origin / grid.step);
        // The values are printed with fewer digits than the header's zero.
        let exact = |found: f64, stated: Option<f64>, tolerance: f64| {
            stated.filter(|stated| (found - stated).abs() <= tolerance).unwrap_or(found)
        };
        let (y_off, y_zero) = if unit == "dB" {
            let found = grid.origin - shift as f64 * grid.step;
            (0.0, exact(found, self.zero, 2.0 * self.values.tolerance(grid.origin)))
        } else {
            let stated = self.zero.filter(|_| grid.evidence == LevelSource::Scale);
            let levels = stated.map(|zero| whole_levels(zero / grid.step));
            (exact(shift as f64 - zero_index, levels, ZERO_LEVEL_TOLERANCE), 0.0)
        };
        let code = |index: &i64| {
            i16::try_from(index.saturating_add(shift)).unwrap_or(if *index < 0 {
                i16::MIN
            } else {
                i16::MAX
            })
        };
        let codes = grid.indices.iter().map(code).collect();
        let level = scale / LEVELS_PER_DIVISION;
        let position = match self.zero {
            _ if unit == "dB" => 0.0,
            _ if (grid.step - level).abs() <= 1e-6 * level => y_off / LEVELS_PER_DIVISION,
            zero => zero.unwrap_or_default() / scale,
        };
        Vertical { codes, y_mult: grid.step, y_off, y_zero, scale, position }
    }

    /// Whether the input's range ended at the largest and at the smallest value, if the file does
    /// not give it; notes what is certain and what is not.
    fn cut(&mut self, grid: &ValueGrid, unit: &str) -> [bool; 2] {
        let is_envelope = self.point_format == Some(PointFormat::Envelope);
        if self.zero.is_some() || is_envelope || unit == "dB" {
            return [false; 2];
        }
        let (low, high) = self.values.range();
        let level = match grid.evidence {
            LevelSource::Rounded(_) => 2.0 * self.values.tolerance(low.abs().max(high.abs())),
            _ => grid.step,
        };
        let tops = flat_tops(&self.values.values, level);
        for (top, end) in tops.iter().zip(["highest", "lowest"]) {
            let Some(FlatTop { value, samples, run, is_cut }) = top else { continue };
            let value = engineering(*value, unit, 4);
            self.notes.push(if *is_cut {
                format!(
                    "{samples} samples have the {end} value, {value}, up to {run} in a row between steep flanks: the input's range ended there, and they count as clipped"
                )
            } else {
                format!(
                    "the {end} value, {value}, occurs {run} times in a row between steep flanks: if the input's range ended there, the true values lie beyond"
                )
            });
        }
        tops.map(|top| top.is_some_and(|top| top.is_cut))
    }

    /// Values whose largest and smallest are the ends of the input's range: those of 16 bits.
    fn between_ends(&mut self, scale: f64) -> Vertical {
        const STEPS: f64 = 65_535.0;
        self.is_cut = true;
        let (low, high) = self.values.range();
        let step = (high - low) / STEPS;
        let y_off = f64::from(i16::MIN) - low / step;
        let code = |value: &f64| (value / step + y_off).round() as i16;
        let codes = self.values.values.iter().map(code).collect();
        let position = self.zero.unwrap_or_default() / scale;
        Vertical { codes, y_mult: step, y_off, y_zero: 0.0, scale, position }
    }

    /// The values as read, if those of the levels differ from them in more than round-off, or if
    /// they have more digits than a table of levels is printed with.
    fn as_read(&self, codes: &[i16], (y_mult, y_off, y_zero): (f64, f64, f64)) -> Vec<f64> {
        const PRINTED_DIGITS: i32 = 12;
        const ROUND_OFF: f64 = 1e-14;
        let level = |code: &i16| (f64::from(*code) - y_off) * y_mult + y_zero;
        let is_same =
            |(code, value): (&i16, &f64)| (level(code) - value).abs() <= ROUND_OFF * value.abs();
        let values = &self.values.values;
        let are_exact =
            || self.values.digits() <= PRINTED_DIGITS && codes.iter().zip(values).all(is_same);
        if self.are_levels || are_exact() {
            return Vec::new();
        }
        let mut values = values.clone();
        let beyond = self.values.beyond.iter().map(|(place, _)| place);
        for place in beyond.chain(&self.strays) {
            if let Some((value, code)) = values.get_mut(*place).zip(codes.get(*place)) {
                *value = level(code);
            }
        }
        values
    }

    /// Values of which some are beyond the instrument's range: they have the ends of 16 bits, just
    /// outside of all others.
    fn beyond_range(&mut self, stated: Option<f64>, unit: &str) -> Vertical {
        const STEPS: f64 = 65_530.0;
        const LOWEST: f64 = -32_765.0;
        let ends: std::collections::BTreeMap<usize, bool> =
            self.values.beyond.iter().copied().collect();
        let inside = self.values.values.iter().enumerate().filter(|(at, _)| !ends.contains_key(at));
        let (low, high) = inside
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (_, value)| {
                (low.min(*value), high.max(*value))
            });
        let (low, high) = if low <= high { (low, high) } else { (0.0, 0.0) };
        let digit = ten_to(-self.values.decimals());
        let step = ((high - low) / STEPS).max(digit / STEPS);
        let y_off = (LOWEST - low / step).round();
        let code = |(at, value): (usize, &f64)| match ends.get(&at) {
            Some(true) => i16::MAX,
            Some(false) => i16::MIN,
            None => (value / step + y_off).round() as i16,
        };
        let codes = self.values.values.iter().enumerate().map(code).collect();
        let eighth = (low.abs().max(high.abs()) / 4.0).max(step);
        let scale = stated.unwrap_or(eighth);
        self.notes.push(format!(
            "{} values are marked as beyond the instrument's range and count as clipped; values are kept in 16 bits, in steps of {}",
            ends.len(),
            engineering(step, unit, 4)
        ));
        let position = self.zero.unwrap_or_default() / scale;
        Vertical { codes, y_mult: step, y_off, y_zero: 0.0, scale, position }
    }

    fn note_evidence(&mut self, grid: &ValueGrid, stated: Option<f64>, unit: &str) {
        let step = engineering(grid.step, unit, 4);
        let instead = match stated {
            Some(scale) => {
                let level = engineering(scale / LEVELS_PER_DIVISION, unit, 4);
                format!("the values are no multiples of {level}, the scale's level; ")
            }
            None => String::new(),
        };
        let note = match grid.evidence {
            LevelSource::Scale => return,
            LevelSource::Gaps => {
                format!("{instead}levels {step} apart are taken from the gaps between the values")
            }
            LevelSource::Digits => format!(
                "{instead}no levels of a digitiser show in the values: kept as printed, in steps of {step}"
            ),
            LevelSource::Rounded(error) => format!(
                "{instead}no levels of a digitiser show in the values: kept as read; in 16 bits (.isf) they are in steps of {step}, within {}",
                engineering(error, unit, 2)
            ),
        };
        self.notes.push(note);
    }

    fn note_strays(&mut self, grid: &ValueGrid, unit: &str) {
        let Some(first) = grid.strays.first() else { return };
        let value = |list: Option<f64>| engineering(list.unwrap_or_default(), unit, 6);
        let taken = grid.indices.get(*first).map(|index| grid.origin + *index as f64 * grid.step);
        self.notes.push(format!(
            "{} values are not levels of the digitiser and are taken as the nearest one; the first, in line {}, is {}, taken as {}",
            grid.strays.len(),
            self.values.place(*first).line,
            value(self.values.values.get(*first).copied()),
            value(taken)
        ));
    }

    /// The scale behind the levels, or one at which the screen holds all of them.
    fn guess_scale(&mut self, grid: &ValueGrid, unit: &str) -> f64 {
        let per_division = format!("{unit}/div");
        let (low, high) = grid.range();
        if grid.evidence == LevelSource::Gaps && high - low <= i64::from(HIGHEST_CODE - LOWEST_CODE)
        {
            let scale = grid.step * LEVELS_PER_DIVISION;
            let scale = one_two_five(scale, 1e-9).unwrap_or(scale);
            let text = engineering(scale, &per_division, 3);
            self.notes.push(format!(
                "vertical scale taken as {text}, 25 levels a division: not given in the file"
            ));
            let mut levels = grid.indices.clone();
            levels.sort_unstable();
            levels.dedup();
            if levels.len() < MIN_LEVELS {
                self.notes
                    .push(format!("the scale is a weak guess: only {} levels occur", levels.len()));
            }
            return scale;
        }
        let (low, high) = self.values.range();
        let eighth = (low.abs().max(high.abs()) / 4.0).max(grid.step);
        let decade = ten_to(eighth.log10().floor() as i32);
        let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * decade);
        let scale = steps.into_iter().find(|step| *step >= eighth).unwrap_or(eighth);
        let text = engineering(scale, &per_division, 3);
        self.notes.push(format!(
            "vertical scale taken as {text}, to show all values: not given in the file"
        ));
        scale
    }

    /// Offset from an index to the digitiser's level.
    fn shift(&mut self, grid: &ValueGrid, unit: &str) -> i64 {
        let (low, high) = grid.range();
        let middle = i64::midpoint(low, high);
        if !grid.is_converter() {
            // The ends of 16 bits stand for clipped samples.
            return if fits::<i16>(low - 1, high + 1) { 0 } else { -middle };
        }
        let lowest = i64::from(LOWEST_CODE) - low;
        let highest = i64::from(HIGHEST_CODE) - high;
        let Some(zero) = self.zero else {
            if fits::<i8>(low, high) {
                self.notes
                    .push("vertical position taken as 0 div: not given in the file".to_owned());
                return 0;
            }
            self.notes.push("vertical position taken so that the record is in the screen's middle: not given in the file".to_owned());
            return -middle;
        };
        let wanted = match unit {
            "dB" => (grid.origin - zero) / grid.step,
            _ => (zero + grid.origin) / grid.step,
        };
        let shift = nearest(wanted);
        if unit != "dB" && (wanted - shift as f64).abs() > ZERO_LEVEL_TOLERANCE {
            self.notes.push(format!(
                "zero is {} levels from the screen's centre by the header, not a whole number; taken as {shift}: the levels may be off by one, the voltages are not",
                super::column::rounded(wanted, 6)
            ));
        }
        if lowest <= highest && !(lowest..=highest).contains(&shift) {
            let near = shift.clamp(lowest, highest);
            self.notes.push(format!(
                "the header puts zero at level {shift}, where the values leave the digitiser's range; taken as {near}"
            ));
            return near;
        }
        if lowest > highest {
            self.notes.push(format!(
                "the values take {} levels, more than the 256 of an 8-bit digitiser",
                high - low + 1
            ));
            return if fits::<i16>(low + shift, high + shift) { shift } else { -middle };
        }
        shift
    }
}

/// Offset from an index to the level at which the largest (or smallest) value has the last level of
/// the 8-bit converter, or of 16 bits where 8 do not hold all.
fn shift_to_end(grid: &ValueGrid, is_high: bool) -> i64 {
    let (low, high) = grid.range();
    let is_narrow =
        grid.is_converter() && high - low <= i64::from(HIGHEST_CODE) - i64::from(LOWEST_CODE);
    let ends = if is_narrow { (LOWEST_CODE, HIGHEST_CODE) } else { (i16::MIN, i16::MAX) };
    if is_high { i64::from(ends.1) - high } else { i64::from(ends.0) - low }
}

fn fits<T: TryFrom<i64>>(low: i64, high: i64) -> bool {
    T::try_from(low).is_ok() && T::try_from(high).is_ok()
}

/// `levels` of a printed offset, without the error of printing if it means a whole number.
fn whole_levels(levels: f64) -> f64 {
    let whole = levels.round();
    if (whole - levels).abs() <= PRINTING_ERROR * levels.abs() { whole } else { levels }
}

/// `levels` without round-off, where it means a whole number.
fn whole_if_near(levels: f64) -> f64 {
    let whole = levels.round();
    if (levels - whole).abs() <= 1e-9 * whole.abs().max(1.0) { whole } else { levels }
}

fn nearest(levels: f64) -> i64 {
    // Far outside any range, and far inside of what can be added to.
    const FAR: f64 = 1e12;
    levels.clamp(-FAR, FAR).round() as i64
}
