//! Scan mode: a sweep that writes points from left to right as time passes, with a blank ahead of it.
//!
//! Blank points stand at the converter's lowest level; times count from the screen's left edge. Source: records that
//! instruments of this family saved in scan mode, 250 such points in each, and all that a first sweep had not reached.

use std::collections::VecDeque;

use super::record::{Acquirer, Signals};
use crate::scope::acquire::{digitise, level};
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::waveform::LOWEST_CODE;
use crate::scope::{ChannelSetup, Source, Waveform};

/// A sweep under way.
#[derive(Debug, Clone, PartialEq)]
pub struct Sweep {
    started: f64,
    /// Points written since the start, all sweeps together.
    written: usize,
    lanes: [Lane; 4],
    batches: u32,
}

/// One channel.
#[derive(Debug, Clone, PartialEq)]
struct Lane {
    codes: Vec<i16>,
    /// Points that signals have brought and the sweep has not reached.
    ahead: VecDeque<i16>,
}

/// What became of a sweep as time passed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Progress {
    /// Points were written.
    pub moved: bool,
    /// Sweeps that reached the right edge.
    pub sweeps: u32,
}

impl Sweep {
    /// A sweep that starts at `now` (s) on a blank screen.
    pub fn start(by: &Acquirer<'_>, now: f64) -> Self {
        let codes = vec![LOWEST_CODE; by.setup.model.record_length];
        let lane = Lane { codes, ahead: VecDeque::new() };
        let lanes = std::array::from_fn(|_| lane.clone());
        Self { started: now, written: 0, lanes, batches: 0 }
    }

    /// Puts down what arrives now: the next points are its first sample of each interval.
    pub fn accept(&mut self, by: &Acquirer<'_>, signals: &Signals) {
        let Some(step) = step(by, signals.interval) else { return };
        for (number, channel, lane) in recorded(by, &mut self.lanes) {
            let volts = signals.volts.get(usize::from(number) - 1).map(Vec::as_slice);
            let volts = volts.unwrap_or_default();
            let mut noise = noise_stream(by.seed, signals.shot, number);
            let signal = condition(by.setup, channel, signals.interval, volts, &mut noise);
            let points = signal.iter().skip(signals.automatic).step_by(step);
            lane.ahead = points
                .take(by.setup.model.record_length)
                .map(|volts| level(&channel.vertical, *volts))
                .collect();
        }
    }

    /// Writes all points until `now` (s), of a single sweep no more than it has.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` takes a clock that runs backwards to zero"
    )]
    pub fn advance(&mut self, by: &Acquirer<'_>, now: f64, single: bool) -> Progress {
        let points = by.setup.model.record_length.max(1);
        let interval = by.setup.model.interval(by.setup.time_base);
        let due = ((now - self.started) / interval * (1.0 + 1e-12)).floor() as usize;
        let due = if single { due.min(points) } else { due };
        let before = self.written;
        let new = due.saturating_sub(before);
        if new == 0 {
            return Progress { moved: false, sweeps: 0 };
        }
        self.written = due;
        self.batches = self.batches.wrapping_add(1);
        // Points of sweeps that are over by now were overwritten.
        let first = due - new.min(points);
        let lost = first - before;
        let batch = u32::MAX - self.batches;
        for (number, channel, Lane { codes, ahead }) in recorded(by, &mut self.lanes) {
            ahead.drain(..lost.min(ahead.len()));
            let mut noise = noise_stream(by.seed, batch, number);
            let quiet = condition(by.setup, channel, interval, &vec![0.0; due - first], &mut noise);
            for (index, volts) in (first..due).zip(quiet) {
                let code = ahead.pop_front().unwrap_or_else(|| level(&channel.vertical, volts));
                if let Some(place) = codes.get_mut(index % points) {
                    *place = code;
                }
            }
        }
        let sweeps = u32::try_from(due / points - before / points).unwrap_or(u32::MAX);
        Progress { moved: true, sweeps }
    }

    /// What the screen shows of each channel that is recorded.
    pub fn records(&self, by: &Acquirer<'_>) -> Vec<Waveform> {
        let points = by.setup.model.record_length.max(1);
        let gap = gap(by);
        let end = self.written % points;
        let channels = (1..).zip(&by.setup.channels).zip(&self.lanes);
        let record = |((number, channel), lane): ((u8, &Option<ChannelSetup>), &Lane)| {
            let source = Source::Channel(number);
            let channel = channel.as_ref().filter(|_| by.panel.records(number))?;
            let mut record = digitise(by.setup, source, channel, &[], 0);
            record.codes.clone_from(&lane.codes);
            if self.written > points {
                for index in end..end + gap {
                    if let Some(code) = record.codes.get_mut(index % points) {
                        *code = LOWEST_CODE;
                    }
                }
            }
            record.preamble.x_zero = 0.0;
            record.trigger_point = 0.0;
            Some(record)
        };
        channels.filter_map(record).collect()
    }
}

/// Channels that are recorded, with what belongs to each.
fn recorded<'a>(
    by: &'a Acquirer<'_>,
    lanes: &'a mut [Lane; 4],
) -> impl Iterator<Item = (u8, &'a ChannelSetup, &'a mut Lane)> {
    let channels = (1..).zip(&by.setup.channels).zip(lanes);
    channels.filter_map(|((number, channel), lane)| {
        let on = by.panel.records(number);
        Some((number, channel.as_ref().filter(|_| on)?, lane))
    })
}

/// Samples of a signal at `interval` (s) in one of the record's.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "`as` takes what is below zero to zero"
)]
fn step(by: &Acquirer<'_>, interval: f64) -> Option<usize> {
    let ratio = by.setup.model.interval(by.setup.time_base) / interval;
    (ratio.is_finite() && ratio > 0.0).then(|| (ratio.round() as usize).max(1))
}

/// Blank points ahead of the sweep.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a record has a few thousand points"
)]
fn gap(by: &Acquirer<'_>) -> usize {
    let model = &by.setup.model;
    let points = model.record_length as f64 / model.horizontal_divisions * model.scan_gap;
    (points.round() as usize).min(model.record_length)
}
