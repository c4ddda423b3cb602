//! Scan mode: a sweep that writes points from left to right as time passes, with a blank ahead of
//! it.
//!
//! Blank points stand at the converter's lowest level; times count from the screen's left edge.
//! Source: records that instruments of this family saved in scan mode, 250 such points in each, and
//! all that a first sweep had not reached. Peak detection keeps the extremes of each two intervals;
//! an average is that of the sweeps at each point, for which no real record speaks. A single
//! sequence ends after one sweep, or as many as are averaged.

use std::collections::VecDeque;

use super::record::{AcquisitionSettings, Signals};
use crate::scope::AcquireMode;
use crate::scope::acquire::{digitise, level};
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::waveform::{FAMILY_BITS, codes};
use crate::scope::{ChannelSetup, PointFormat, Source, Waveform};

/// Time base below which nothing scans, less rounding (s/div).
const SLOWEST_TRIGGERED: f64 = 0.1 * (1.0 - 1e-9);
/// Divisions of a record, of which a scan leaves one blank.
const DIVISIONS: usize = 10;

/// A sweep under way.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    started: f64,
    /// Points written since the start, all sweeps together.
    written: usize,
    lanes: [ScanChannel; 4],
    batches: u32,
}

/// One channel.
#[derive(Debug, Clone, PartialEq)]
struct ScanChannel {
    codes: Vec<i16>,
    /// Mean level of each point over the sweeps so far, where records are averaged.
    means: Vec<f64>,
    /// Points that signals have brought and the sweep has not reached.
    ahead: VecDeque<i16>,
}

/// Progress of a sweep.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ScanProgress {
    /// Points were written.
    pub moved: bool,
    /// Sweeps that reached the right edge.
    pub sweeps: u32,
}

impl Sweep {
    /// A sweep that starts at `now` (s) on a blank screen.
    pub fn start(settings: &AcquisitionSettings<'_>, now: f64) -> Self {
        let model = &settings.setup.model;
        let codes = vec![*model.codes().start(); model.record_length];
        let means = vec![0.0; codes.len()];
        let lane = ScanChannel { codes, means, ahead: VecDeque::new() };
        let lanes = std::array::from_fn(|_| lane.clone());
        Self { started: now, written: 0, lanes, batches: 0 }
    }

    /// Whether one point of the sweep is a whole number of samples of `signals`, to a percent of a
    /// sample.
    pub fn fits(settings: &AcquisitionSettings<'_>, signals: &Signals) -> bool {
        let ratio = settings.setup.model.interval(settings.setup.time_base) / signals.interval;
        ratio.is_finite() && ratio > 0.99 && (ratio - ratio.round()).abs() < 0.01
    }

    /// Puts down what arrives now: the next points are its first sample of each interval, or in
    /// peak detection its extremes.
    pub fn accept(&mut self, settings: &AcquisitionSettings<'_>, signals: &Signals) {
        let Some(step) = step(settings, signals.interval) else { return };
        for (number, channel, lane) in recorded(settings, &mut self.lanes) {
            let volts = signals.volts.get(usize::from(number) - 1).map(Vec::as_slice);
            let volts = volts.unwrap_or_default();
            let mut noise = noise_stream(settings.seed, signals.shot, number);
            let signal = condition(settings.setup, channel, signals.interval, volts, &mut noise);
            let signal = signal.get(signals.automatic..).unwrap_or_default();
            lane.ahead = points(settings, channel, signal, step).collect();
            lane.ahead.truncate(settings.setup.model.record_length);
        }
    }

    /// Writes all points until `now` (s), no more than those of `most` sweeps.
    pub fn advance(
        &mut self,
        settings: &AcquisitionSettings<'_>,
        now: f64,
        most: Option<u32>,
    ) -> ScanProgress {
        let points_of_sweep = settings.setup.model.record_length.max(1);
        let interval = settings.setup.model.interval(settings.setup.time_base);
        let dense = settings.setup.signal_interval();
        let per_point = step(settings, dense).unwrap_or(1);
        let due = ((now - self.started) / interval * (1.0 + 1e-12)).floor() as usize;
        // In peak detection two points belong together.
        let due = if peaks(settings) { due - due % 2 } else { due };
        let due =
            most.map_or(due, |sweeps| due.min(points_of_sweep.saturating_mul(sweeps as usize)));
        let before = self.written;
        let new = due.saturating_sub(before);
        if new == 0 {
            return ScanProgress { moved: false, sweeps: 0 };
        }
        self.written = due;
        self.batches = self.batches.wrapping_add(1);
        // Points of sweeps that are over by now were overwritten.
        let first = due - new.min(points_of_sweep);
        let lost = first - before;
        let batch = u32::MAX - self.batches;
        let depth = settings.panel.acquire.depth();
        for (number, channel, lane) in recorded(settings, &mut self.lanes) {
            lane.ahead.drain(..lost.min(lane.ahead.len()));
            let mut noise = noise_stream(settings.seed, batch, number);
            let silence = vec![0.0; (due - first) * per_point];
            let quiet = condition(settings.setup, channel, dense, &silence, &mut noise);
            for (index, quiet) in (first..due).zip(points(settings, channel, &quiet, per_point)) {
                let code = lane.ahead.pop_front().unwrap_or(quiet);
                lane.write(index % points_of_sweep, code, sweep(index / points_of_sweep, depth));
            }
        }
        let sweeps = due / points_of_sweep - before / points_of_sweep;
        let sweeps = u32::try_from(sweeps).unwrap_or(u32::MAX);
        ScanProgress { moved: true, sweeps }
    }

    /// The shown part of each recorded channel; a sweep that goes on has a blank ahead of it.
    pub fn records(&self, settings: &AcquisitionSettings<'_>, goes_on: bool) -> Vec<Waveform> {
        let points = settings.setup.model.record_length.max(1);
        let gap = gap(settings);
        let end = self.written % points;
        let channels = (1..).zip(&settings.setup.channels).zip(&self.lanes);
        let record = |((number, channel), lane): ((u8, &Option<ChannelSetup>), &ScanChannel)| {
            let source = Source::Channel(number);
            let channel = channel.as_ref().filter(|_| settings.panel.records(number))?;
            let mut record = digitise(settings.setup, source, channel, &[], 0);
            record.codes.clone_from(&lane.codes);
            if goes_on && self.written > points {
                for index in end..end + gap {
                    if let Some(code) = record.codes.get_mut(index % points) {
                        *code = *settings.setup.model.codes().start();
                    }
                }
            }
            if peaks(settings) {
                record.preamble.pt_fmt = PointFormat::Envelope;
            }
            record.preamble.x_zero = 0.0;
            record.trigger_point = 0.0;
            Some(record)
        };
        channels.filter_map(record).collect()
    }
}

impl ScanChannel {
    /// Writes a point in sweep `sweep` (counted from 1), beyond the first as a mean with what
    /// stands there.
    fn write(&mut self, place: usize, code: i16, sweep: u32) {
        if let (Some(mean), Some(point)) = (self.means.get_mut(place), self.codes.get_mut(place)) {
            *mean = if sweep <= 1 {
                f64::from(code)
            } else {
                *mean + (f64::from(code) - *mean) / f64::from(sweep)
            };
            let level = mean.round() as i16;
            *point = level;
        }
    }
}

/// Which points of a record are blank: those that a scan has not reached, and those ahead of it.
/// None in other records.
///
/// A record does not mark them: a scan's begins at time zero without a trigger, at 100 ms/div or
/// slower, and blank points are those in a row of a division or more at the lowest level.
pub fn blank(record: &Waveform) -> Vec<bool> {
    let mut blank = vec![false; record.codes.len()];
    let is_scan = record.preamble.x_zero.abs() < f64::MIN_POSITIVE
        && record.trigger_point.abs() < f64::MIN_POSITIVE
        && record.preamble.x_unit == "s"
        && record.horizontal_scale >= SLOWEST_TRIGGERED;
    if !is_scan {
        return blank;
    }
    let points = record.codes.len();
    let least = points / DIVISIONS;
    let lowest = *codes(record.bits().unwrap_or(FAMILY_BITS)).start();
    // The blank may begin at the right edge and end at the left one.
    let mut run = 0;
    for index in (0..2 * points).map(|index| index % points) {
        run = if record.codes.get(index) == Some(&lowest) { run + 1 } else { 0 };
        if run >= least.max(1) {
            for back in 0..run.min(points) {
                if let Some(point) = blank.get_mut((index + points - back) % points) {
                    *point = true;
                }
            }
            if run >= points {
                break;
            }
        }
    }
    blank
}

fn peaks(settings: &AcquisitionSettings<'_>) -> bool {
    settings.panel.acquire.mode == AcquireMode::PeakDetect
}

/// Number of a sweep before which `index` were complete, counted from 1, no more than `most`.
fn sweep(index: usize, most: u32) -> u32 {
    u32::try_from(index).unwrap_or(u32::MAX).saturating_add(1).min(most)
}

/// Levels of the points of a signal with `step` samples to each: the first of them, or in peak
/// detection the lowest and the highest of two points' in turn.
fn points<'a>(
    settings: &AcquisitionSettings<'a>,
    channel: &'a ChannelSetup,
    signal: &'a [f64],
    step: usize,
) -> Box<dyn Iterator<Item = i16> + 'a> {
    let model = &settings.setup.model;
    let code = |volts: f64| level(model, &channel.vertical, volts);
    if !peaks(settings) {
        return Box::new(signal.iter().step_by(step).map(move |volts| code(*volts)));
    }
    Box::new(signal.chunks(2 * step).flat_map(move |window| {
        let low = window.iter().copied().fold(f64::INFINITY, f64::min);
        let high = window.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        [code(low), code(high)]
    }))
}

/// Channels that are recorded, with what belongs to each.
fn recorded<'a>(
    settings: &'a AcquisitionSettings<'_>,
    lanes: &'a mut [ScanChannel; 4],
) -> impl Iterator<Item = (u8, &'a ChannelSetup, &'a mut ScanChannel)> {
    let channels = (1..).zip(&settings.setup.channels).zip(lanes);
    channels.filter_map(|((number, channel), lane)| {
        let on = settings.panel.records(number);
        Some((number, channel.as_ref().filter(|_| on)?, lane))
    })
}

/// Samples of a signal at `interval` (s) in one of the record's.
fn step(settings: &AcquisitionSettings<'_>, interval: f64) -> Option<usize> {
    let ratio = settings.setup.model.interval(settings.setup.time_base) / interval;
    (ratio.is_finite() && ratio > 0.0).then(|| (ratio.round() as usize).max(1))
}

/// Blank points ahead of the sweep.
fn gap(settings: &AcquisitionSettings<'_>) -> usize {
    let model = &settings.setup.model;
    let points = model.record_length as f64 / model.horizontal_divisions * model.scan_gap;
    (points.round() as usize).min(model.record_length)
}
