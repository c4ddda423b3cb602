//! The automatic measurements.
//!
//! Levels are taken from the record's extremes: the middle reference is half way between lowest and
//! highest level, and a crossing counts once the signal has left a band of a tenth of the swing
//! around the reference on the other side. Times of crossings are interpolated between points. What
//! a scan has left blank is no sample: extremes and mean are those of the others, and cycles and
//! edges are looked for in the longest part without a blank.

use super::event::Event;
use super::scan::blank;
use crate::scope::Waveform;
use crate::scope::panel::MeasurementType;

/// The reply without a result (unit).
pub const INVALID: f64 = 9.9e37;
/// Half width of the band around a reference, in parts of the swing (1).
const BAND_HALF_WIDTH: f64 = 0.05;
/// Smallest swing that has cycles and edges, in levels (1).
const MIN_SWING: f64 = 4.0;

/// One crossing of a level.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Crossing {
    /// Place between points (1).
    place: f64,
    upward: bool,
}

/// Volts of a record with what measurements ask of them.
struct Levels {
    volts: Vec<f64>,
    /// Where the longest part without a blank lies.
    part: std::ops::Range<usize>,
    low: f64,
    high: f64,
    interval: f64,
    step: f64,
}

/// The measurement's result in volts, seconds or hertz (unit).
///
/// # Errors
/// The event to report where there is no result.
pub fn measure(kind: MeasurementType, record: &Waveform) -> Result<f64, Event> {
    let levels = Levels::of(record).ok_or(Event::NoWaveform)?;
    match kind {
        MeasurementType::None => Err(Event::NoMeasurementType),
        MeasurementType::Minimum => Ok(levels.low),
        MeasurementType::Maximum => Ok(levels.high),
        MeasurementType::PeakToPeak => Ok(levels.high - levels.low),
        MeasurementType::Mean => Ok(mean(levels.volts.iter().copied())),
        MeasurementType::Period => levels.period(),
        MeasurementType::Frequency => levels.period().map(|period| 1.0 / period),
        MeasurementType::CycleRms => levels.cycle_rms(),
        MeasurementType::Rise => levels.edge(true),
        MeasurementType::Fall => levels.edge(false),
        MeasurementType::PositiveWidth => levels.width(true),
        MeasurementType::NegativeWidth => levels.width(false),
    }
}

/// The unit of a measurement's result.
pub fn unit(kind: MeasurementType) -> &'static str {
    match kind {
        MeasurementType::Frequency => "Hz",
        MeasurementType::Period
        | MeasurementType::Rise
        | MeasurementType::Fall
        | MeasurementType::PositiveWidth
        | MeasurementType::NegativeWidth => "s",
        MeasurementType::None
        | MeasurementType::Mean
        | MeasurementType::PeakToPeak
        | MeasurementType::CycleRms
        | MeasurementType::Minimum
        | MeasurementType::Maximum => "V",
    }
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len().max(1) as f64;
    values.sum::<f64>() / count
}

impl Levels {
    fn of(record: &Waveform) -> Option<Self> {
        let blank = blank(record);
        let mut volts = Vec::with_capacity(record.codes.len());
        let (mut part, mut begin) = (0..0, 0);
        for (code, blank) in record.codes.iter().zip(blank) {
            if blank {
                begin = volts.len();
                continue;
            }
            volts.push(record.volts_of(*code));
            if volts.len() - begin > part.len() {
                part = begin..volts.len();
            }
        }
        let low = volts.iter().copied().reduce(f64::min)?;
        let high = volts.iter().copied().reduce(f64::max)?;
        let (interval, step) = (record.preamble.x_incr, record.preamble.y_mult);
        Some(Self { volts, part, low, high, interval, step })
    }

    /// Samples that follow each other without a blank (V).
    fn connected(&self) -> &[f64] {
        self.volts.get(self.part.clone()).unwrap_or_default()
    }

    fn has_swing(&self) -> bool {
        self.high - self.low >= MIN_SWING * self.step
    }

    /// All crossings of the level that lies `share` of the way from lowest to highest.
    fn crossings(&self, share: f64) -> Vec<Crossing> {
        let swing = self.high - self.low;
        let reference = self.low + share * swing;
        let band = BAND_HALF_WIDTH * swing;
        let mut found = Vec::new();
        let mut was_above: Option<bool> = None;
        let mut last: Option<Crossing> = None;
        let volts = self.connected();
        let points = volts.iter().zip(volts.iter().skip(1)).enumerate();
        for (index, (before, after)) in points {
            if (*before < reference) != (*after < reference) {
                let place = index as f64 + (reference - before) / (after - before);
                last = Some(Crossing { place, upward: after > before });
            }
            let above = if *after >= reference + band {
                true
            } else if *after <= reference - band {
                false
            } else {
                continue;
            };
            let begun = volts.first().is_some_and(|first| *first >= reference);
            if was_above.unwrap_or(begun) != above
                && let Some(crossing) = last.filter(|crossing| crossing.upward == above)
            {
                found.push(crossing);
            }
            was_above = Some(above);
        }
        found
    }

    fn middle_crossings(&self) -> Vec<Crossing> {
        if self.has_swing() { self.crossings(0.5) } else { Vec::new() }
    }

    /// Where the first cycle begins and ends, in points.
    fn cycle(&self) -> Result<(f64, f64), Event> {
        match self.middle_crossings().as_slice() {
            [first, _, third, ..] => Ok((first.place, third.place)),
            _ => Err(Event::NoPeriod),
        }
    }

    fn period(&self) -> Result<f64, Event> {
        self.cycle().map(|(start, end)| (end - start) * self.interval)
    }

    fn cycle_rms(&self) -> Result<f64, Event> {
        let (start, end) = self.cycle()?;
        let range = start.ceil() as usize..end.ceil() as usize;
        let cycle = self.connected().get(range).ok_or(Event::NoPeriod)?;
        Ok(mean(cycle.iter().map(|volts| volts * volts)).sqrt())
    }

    fn width(&self, upward: bool) -> Result<f64, Event> {
        let crossings = self.middle_crossings();
        let pairs = crossings.iter().zip(crossings.iter().skip(1));
        let pulse = pairs.into_iter().find(|(start, _)| start.upward == upward);
        let (start, end) = pulse.ok_or(Event::NoCrossing)?;
        Ok((end.place - start.place) * self.interval)
    }

    /// Time of the first edge between 10 % and 90 %.
    fn edge(&self, upward: bool) -> Result<f64, Event> {
        let middles = self.middle_crossings();
        let middle = middles.iter().find(|c| c.upward == upward).ok_or(Event::NoCrossing)?;
        let (start, end) = if upward { (0.1, 0.9) } else { (0.9, 0.1) };
        let starts = self.crossings(start);
        let ends = self.crossings(end);
        let start = starts.iter().rev().find(|c| c.place <= middle.place && c.upward == upward);
        let end = ends.iter().find(|c| c.place >= middle.place && c.upward == upward);
        match (start, end) {
            (Some(start), Some(end)) => Ok((end.place - start.place) * self.interval),
            _ => Err(Event::NoCrossing),
        }
    }
}
