//! From the volts at a probe's tip to the volts the converter sees: coupling, bandwidth, inversion,
//! errors of gain and zero, noise.
//!
//! Coupling and bandwidth are first-order filters, exact for input that runs straight between
//! samples. A probe attenuates and the scope multiplies back, so volts stay volts at the tip.

use std::f64::consts::TAU;

use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::model::{Model, RANGE_END_FACTOR};
use super::setup::{ChannelSetup, Setup};
use super::waveform::{Coupling, VerticalSetup};

/// Below this delay, in sample intervals, the bandwidth's only visible effect, a shift, is left out
/// (1).
pub const NEGLIGIBLE_DELAY: f64 = 0.01;

/// Random numbers of one channel and shot: a stream of its own, so that switching one channel off
/// does not change what another shows.
pub fn noise_stream(seed: u64, shot: u32, channel: u8) -> Pcg64 {
    Pcg64::new(u128::from(seed), (u128::from(shot) << 8) | u128::from(channel))
}

/// The signal of one channel as the converter sees it, from the signal at its probe (V).
pub fn condition(
    setup: &Setup,
    channel: &ChannelSetup,
    interval: f64,
    volts: &[f64],
    noise: &mut Pcg64,
) -> Vec<f64> {
    let model = &setup.model;
    let vertical = &channel.vertical;
    let mut signal = match vertical.coupling {
        // An unknown coupling leaves the input as it is.
        Some(Coupling::Dc) | None => volts.to_vec(),
        Some(Coupling::Ac) => high_pass(volts, interval * TAU * ac_corner(model, vertical.probe)),
        Some(Coupling::Ground) => vec![0.0; volts.len()],
    };
    let at_input = vertical.scale / vertical.probe;
    let ratio = bandwidth_ratio(setup, channel, interval);
    if ratio * NEGLIGIBLE_DELAY < 1.0 {
        signal = low_pass(&signal, ratio);
    }
    if vertical.inverted == Some(true) {
        for value in &mut signal {
            *value = -*value;
        }
    }
    let gain = 1.0 + channel.deviation.gain * model.accuracy.gain_at(at_input);
    let zero = channel.deviation.offset * model.accuracy.offset_at(at_input) * vertical.probe;
    let offset = channel.offset + zero;
    if gain.to_bits() != 1.0_f64.to_bits() || offset != 0.0 {
        for value in &mut signal {
            *value = gain * *value + offset;
        }
    }
    if setup.noise > 0.0 {
        let rms = setup.noise * vertical.scale;
        for value in &mut signal {
            let draw: f64 = StandardNormal.sample(noise);
            *value += rms * draw;
        }
    }
    signal
}

/// The `interval` (s) between samples over the time constant of the channel's bandwidth, which is
/// its delay (1).
pub fn bandwidth_ratio(setup: &Setup, channel: &ChannelSetup, interval: f64) -> f64 {
    let (model, vertical) = (&setup.model, &channel.vertical);
    let limited = vertical.bandwidth_limited == Some(true)
        || vertical.scale / vertical.probe * RANGE_END_FACTOR < model.full_bandwidth_from;
    let bandwidth = if limited { model.limited_bandwidth } else { model.bandwidth };
    interval * TAU * bandwidth
}

/// Time constant of the AC coupling of a channel set as `vertical`; none where it is not AC coupled
/// or the coupling is not known (s).
pub fn ac_time_constant(model: &Model, vertical: &VerticalSetup) -> Option<f64> {
    let is_coupled = vertical.coupling == Some(Coupling::Ac);
    is_coupled.then(|| 1.0 / (TAU * ac_corner(model, vertical.probe)))
}

/// Corner of AC coupling behind a probe, whose resistance lies in series with the coupling
/// capacitor (Hz).
fn ac_corner(model: &Model, probe: f64) -> f64 {
    let seen = if probe > 1.0 { model.probe_resistance } else { model.input_resistance };
    model.ac_corner * model.input_resistance / seen
}

/// First-order high-pass; `ratio` is the interval over the time constant (V).
pub fn high_pass(values: &[f64], ratio: f64) -> Vec<f64> {
    let slow = low_pass(values, ratio);
    values.iter().zip(slow).map(|(value, slow)| value - slow).collect()
}

/// First-order low-pass that starts settled: the exact response to straight lines between samples,
/// `y[n] = x[n] - s + (y[n-1] - x[n-1] + s) exp(-r)`, `s = (x[n] - x[n-1])/r` (V).
pub fn low_pass(values: &[f64], ratio: f64) -> Vec<f64> {
    let kept = (-ratio).exp();
    let mut before = values.first().copied().unwrap_or(0.0);
    let mut out = before;
    let mut follow = |now: &f64| {
        let slope = (now - before) / ratio;
        out = now - slope + (out - before + slope) * kept;
        before = *now;
        out
    };
    values.iter().map(&mut follow).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The step response (a ramp over one interval) against its closed form.
    #[test]
    fn low_pass_follows_a_ramp_exactly() {
        let (ratio, steps) = (0.25_f64, 40);
        let ramp: Vec<f64> = (0..steps).map(f64::from).collect();
        for (t, value) in ramp.iter().zip(low_pass(&ramp, ratio)) {
            let exact = t - (1.0 - (-ratio * t).exp()) / ratio;
            assert!((value - exact).abs() < 1e-12, "{t}: {value} {exact}");
        }
    }

    #[test]
    fn high_pass_forgets_the_mean() {
        let level = vec![2.0; 100_000];
        let mut step = vec![0.0; 10];
        step.extend(level);
        let out = high_pass(&step, 1e-3);
        assert!((out[10] - 2.0).abs() < 2e-3);
        assert!(out[100_009].abs() < 1e-12);
    }
}
