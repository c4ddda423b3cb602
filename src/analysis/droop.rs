//! Undoes the droop of a piezo sensor: from the voltage that leaks away back to the force
//! on the sensor.
//!
//! `V' + V/tau = S N'` has the inverse `S N = V + (1/tau) integral of V dt`. Sample by sample,
//! exact where the force runs straight between samples:
//! `S N[n] = S N[n-1] + (V[n] - a V[n-1]) dt / (tau (1 - a))`, `a = exp(-dt/tau)`. Source: the
//! charge equation of a leaking capacitor, solved for the force. Valid from a start at rest and
//! discharged; an error `b` of the baseline grows to `b (1 + T/tau)` after the time `T`, and noise
//! of standard deviation `s` in each sample walks off by `s sqrt(T dt)/tau`.

use crate::trace::Trace;

/// Gain of voltage errors by the inverse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorGain {
    /// Standard deviation of `S N` over that of independent noise in each sample (1).
    pub noise: f64,
    /// Error of `S N` over an error of the baseline (1).
    pub baseline: f64,
}

/// Gains at `sample`, counted from 0 where the inverse starts, for samples `interval` (s) apart and
/// `time_constant` (s).
///
/// `S N[n] = g (V[n] + (1 - a) sum over k < n of V[k])`, `g = dt/(tau (1 - a))`: so the noise of
/// `n + 1` samples makes `g sqrt(1 + n (1 - a)^2)`, and a baseline error `g (1 + n (1 - a))`, which
/// grows as `T/tau`.
pub fn error_gain(sample: usize, interval: f64, time_constant: f64) -> ErrorGain {
    let ratio = interval / time_constant;
    let leaked = -(-ratio).exp_m1();
    let (gained, count) = (ratio / leaked, sample as f64);
    ErrorGain {
        noise: gained * (1.0 + count * leaked * leaked).sqrt(),
        baseline: gained * (1.0 + count * leaked),
    }
}

/// `voltage` without its baseline, with its droop undone from sample `from` on. Before it the
/// sensor is at rest: on a quiet scope all samples there have the same rounding error, which would
/// add up.
pub fn undo_droop_from(voltage: &Trace, from: usize, time_constant: f64) -> Trace {
    let (rest, part) = voltage.values.split_at(from.min(voltage.values.len()));
    let part = Trace { start: voltage.time(from), values: part.to_vec(), ..voltage.clone() };
    let felt = undo_droop(&part, time_constant).values;
    Trace { values: [rest, &felt].concat(), ..voltage.clone() }
}

/// A pulse has begun where this share of the largest deviation is reached, and the signal is at
/// rest for this share of the samples before (1).
const PULSE_SHARE: f64 = 0.25;
const REST_SHARE: f64 = 2.0 / 3.0;

/// `trace` with the high pass of AC coupling undone, whose time constant (s) is known: another
/// droop behind the sensor's. As it is without one.
pub fn undo_coupling(trace: Trace, time_constant: Option<f64>) -> Trace {
    let Some(time_constant) = time_constant else { return trace };
    let Some(first) = trace.values.first().copied() else { return trace };
    let far = trace.values.iter().fold(0.0, |far: f64, v| far.max((v - first).abs()));
    let is_far = |v: &f64| (v - first).abs() >= PULSE_SHARE * far;
    let pulse = trace.values.iter().position(is_far).unwrap_or(0);
    let rest = (REST_SHARE * pulse as f64) as usize;
    let sum: f64 = trace.values.iter().take(rest).sum();
    let level = if rest > 0 { sum / rest as f64 } else { first };
    let above = trace.values.iter().map(|v| v - level).collect();
    let mut undone = undo_droop_from(&Trace { values: above, ..trace }, rest, time_constant);
    undone.values.iter_mut().for_each(|v| *v += level);
    undone
}

/// `S N` for a voltage that starts at rest, without its baseline, with the circuit's time constant
/// `tau` (s).
pub fn undo_droop(voltage: &Trace, time_constant: f64) -> Trace {
    let ratio = voltage.interval / time_constant;
    let kept = (-ratio).exp();
    let gained = ratio / -(-ratio).exp_m1();
    let mut before = 0.0;
    let mut felt = 0.0;
    let mut step = |now: &f64| {
        felt += (now - kept * before) * gained;
        before = *now;
        felt
    };
    let values = voltage.values.iter().map(&mut step).collect();
    Trace { values, ..voltage.clone() }
}
