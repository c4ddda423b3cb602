//! One record of one impact: where its contact is, and the sums from which its integral follows for
//! any baseline and tau.

use serde::Serialize;

use super::record::{Exclusion, NOISE_TIMES, PreparedRecord, RawRecord, Surroundings};
use crate::analysis::baseline::Baseline;
use crate::analysis::droop::undo_droop;
use crate::trace::Trace;
/// Without a window given, the integral begins and ends this share of the contact outside it (1).
const WINDOW_MARGIN: f64 = 0.15;
/// A further pulse counts above this share of the first (1).
const SECOND_PULSE_SHARE: f64 = 0.1;
/// A window that ends above this share of the peak cuts the pulse (1).
const CUT_SHARE: f64 = 0.03;
/// Standard uncertainty of the contact's duration over itself: where Hertz's force passes 1 % of
/// its peak, 3 % are left (1).
const DURATION_U: f64 = 0.05;

/// Sums over a window, from which the integral follows: those of the voltage, and those of 1, which
/// the baseline is taken times.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sums {
    /// Of the voltage without its baseline, the first and the last by half (V).
    pub volts: f64,
    /// Of all samples before each of these (V).
    pub volts_before: f64,
    /// Of ones, weighted alike (1).
    pub count: f64,
    /// Of the samples before each of these (1).
    pub count_before: f64,
}

/// Numbers from one record.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Impact {
    /// Its baseline.
    #[serde(flatten)]
    pub baseline: Baseline,
    /// Standard uncertainty of one sample (V).
    #[serde(rename = "noise_v")]
    pub noise: f64,
    /// Whether its zero is that of all records of a quiet scope.
    #[serde(skip)]
    pub has_common_zero: bool,
    /// Whether the pulse is negative; everything here is turned over.
    #[serde(skip)]
    pub negative: bool,
    /// From one sample to the next (s).
    #[serde(skip)]
    pub interval: f64,
    /// Start of the contact after the trigger (s).
    #[serde(rename = "contact_s")]
    pub contact: f64,
    /// Duration of the contact (s).
    #[serde(rename = "duration_s")]
    pub duration: f64,
    /// Its standard uncertainty (s).
    #[serde(skip)]
    pub duration_u: f64,
    /// First and last time of the integral (s).
    #[serde(rename = "window_s")]
    pub window: [f64; 2],
    /// Share of the record before the contact (1).
    pub pre_trigger: f64,
    /// Largest value with the droop undone, `S` times the force (V).
    #[serde(skip)]
    pub peak: f64,
    /// Sums over the window.
    #[serde(skip)]
    pub sums: Sums,
    /// The voltage without its baseline.
    #[serde(skip)]
    pub signal: Trace,
    /// The same with its droop undone from the window's start on.
    #[serde(skip)]
    pub restored: Trace,
}

impl Impact {
    /// Reads `record` with what is known from all of its range, and the time constant `tau` (s).
    ///
    /// # Errors
    /// [`Exclusion`]: why it is no good.
    pub fn read(record: &RawRecord, known: &Surroundings, tau: f64) -> Result<Self, Exclusion> {
        let prepared = PreparedRecord::new(record, known)?;
        let signal = &prepared.signal;
        let rise = prepared.rise().ok_or(Exclusion::NoPreTrigger { samples: 0 })?;
        let length = signal.values.len();
        let whole = restored(signal, prepared.start().unwrap_or(rise), tau);
        let cut = |what, index| Exclusion::Cut { what, time: signal.time(index) };
        let fall = prepared.fall(&whole.values, prepared.threshold);
        let fall = fall.ok_or_else(|| cut("record", length - 1))?;
        let margin = (WINDOW_MARGIN * (fall - rise) as f64).max(3.0) as usize;
        let (from, to) = if let Some(gate) = record.window {
            let range = gate.range(&record.trace);
            (range.start, range.end.saturating_sub(1))
        } else {
            if fall + margin >= length {
                return Err(cut("record", length - 1));
            }
            (rise.saturating_sub(margin), fall + margin)
        };
        let top = whole.values.iter().copied().fold(0.0, f64::max);
        let edge = (CUT_SHARE * top).max(NOISE_TIMES * prepared.noise);
        // A window may begin and end inside the outermost of the contact, where next to nothing is
        // left.
        let inside = |index: usize| whole.values.get(index).is_some_and(|v| *v > edge);
        if from > rise && inside(from) || from >= prepared.peak {
            return Err(cut("window", from));
        }
        if to < fall && inside(to) || to <= prepared.peak {
            return Err(cut("window", to));
        }
        let second = (SECOND_PULSE_SHARE * top).max(2.0 * NOISE_TIMES * prepared.noise);
        // Where the pulse begins, noise crosses the threshold more than once.
        let before = signal.values.get(..rise.saturating_sub(margin)).unwrap_or_default();
        let early = before.iter().position(|v| v.abs() > second);
        let late = whole.values.iter().skip(fall + margin).position(|v| *v > second);
        if let Some(index) = early.or(late.map(|i| fall + margin + i)) {
            return Err(Exclusion::TwoImpacts { time: signal.time(index) });
        }
        let duration = (fall - rise) as f64 * signal.interval;
        let mut baseline = prepared.baseline.clone();
        if baseline.disturbance.is_some() {
            // What counts is the zero during the contact.
            let squares = prepared.contact_modes().iter().map(|mode| mode * mode).sum::<f64>();
            baseline.uncertainty = squares.sqrt();
        }
        Ok(Self {
            has_common_zero: known.has_common_zero && prepared.rest.is_some(),
            baseline,
            noise: prepared.noise,
            negative: prepared.negative,
            interval: signal.interval,
            contact: signal.time(rise),
            duration,
            duration_u: (DURATION_U * duration).max(2.0 * signal.interval),
            window: [signal.time(from), signal.time(to)],
            pre_trigger: rise as f64 / length as f64,
            peak: top,
            sums: sums(signal.values.get(from..=to).unwrap_or_default()),
            restored: restored(signal, from, tau),
            signal: prepared.signal,
        })
    }

    /// Integral of the voltage with its droop undone: exact where the force runs straight between
    /// samples (V s).
    pub fn integral(&self, tau: f64) -> f64 {
        self.integral_off(1.0 / tau, 0.0)
    }

    /// The same for `1/tau` (1/s) and a baseline that is `off` higher (V) (V s).
    pub fn integral_off(&self, inverse_tau: f64, off: f64) -> f64 {
        let Sums { volts, volts_before, count, count_before } = self.sums;
        let ratio = self.interval * inverse_tau;
        let leaked = -(-ratio).exp_m1();
        let gained = if ratio == 0.0 { 1.0 } else { ratio / leaked };
        let felt = (volts - off * count) + leaked * (volts_before - off * count_before);
        self.interval * gained * felt
    }

    /// Integral of the voltage as it is (V s).
    pub fn naive_integral(&self) -> f64 {
        self.interval * self.sums.volts
    }

    /// Standard uncertainty of the integral from the noise of its samples (V s).
    ///
    /// Sample `k` of the window takes part in itself and in all later ones:
    /// `g (w[k] + (1 - a) sum over i > k of w[i])`.
    pub fn noise_u(&self, tau: f64) -> f64 {
        let ratio = self.interval / tau;
        let leaked = -(-ratio).exp_m1();
        // The outermost two count by half: one interval less than samples.
        let last = self.sums.count.round() as usize;
        let square = |k: usize| {
            let own = if k == 0 || k == last { 0.5 } else { 1.0 };
            let later = if k == last { 0.0 } else { (last - k) as f64 - 0.5 };
            (own + leaked * later).powi(2)
        };
        let squares: f64 = (0..=last).map(square).sum();
        self.interval * (ratio / leaked) * self.noise * squares.sqrt()
    }
}

/// `signal` with its droop undone from sample `from` on; zero before.
fn restored(signal: &Trace, from: usize, tau: f64) -> Trace {
    let part = Trace {
        start: signal.time(from),
        values: signal.values.get(from..).unwrap_or_default().to_vec(),
        ..signal.clone()
    };
    let felt = if tau.is_finite() { undo_droop(&part, tau) } else { part };
    let mut values = vec![0.0; from.min(signal.values.len())];
    values.extend(felt.values);
    Trace { values, ..signal.clone() }
}

fn sums(window: &[f64]) -> Sums {
    let mut sums = Sums::default();
    let mut before = 0.0;
    let last = window.len().saturating_sub(1);
    for (index, value) in window.iter().enumerate() {
        let weight = if index == 0 || index == last { 0.5 } else { 1.0 };
        sums.volts += weight * value;
        sums.volts_before += weight * before;
        sums.count += weight;
        sums.count_before += weight * index as f64;
        before += value;
    }
    sums
}
