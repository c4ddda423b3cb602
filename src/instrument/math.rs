//! The math trace: sums, differences, and the spectrum.
//!
//! The spectrum's law was computed from real files of this family: 2048 of the 2500 points make 1024 bins;
//! the sample rate of the transform is 250 points a division, and 100/99 of that from 250 us/div on; a level is 0.4 dB
//! from `20 log10(V/div) - 20.9691`, and nothing lies lower than 100 levels below it.

use std::f64::consts::PI;

use super::panel::{FftWindow, MathFunction};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{PointFormat, Preamble, Source, Waveform};

/// Points that are transformed, from the middle of the record.
const POINTS: usize = 2048;
/// Fastest time base whose transform has the odd sample rate (s/div).
const ODD_RATE_FROM: f64 = 250e-6;
/// One level of a spectrum (dB).
const DECIBELS_PER_LEVEL: f64 = 0.4;
/// Reference level of a spectrum at 1 V/div (dB).
const REFERENCE: f64 = -20.9691;
/// Lowest level of a spectrum.
const FLOOR: f64 = -100.0;

/// The math trace of the channels' records, where the records it needs are there.
#[must_use]
pub fn math<'a>(
    function: MathFunction,
    record: impl Fn(u8) -> Option<&'a Waveform>,
) -> Option<Waveform> {
    match function {
        MathFunction::Sum(a, b) => combine(record(a)?, record(b)?, 1.0),
        MathFunction::Difference(a, b) => combine(record(a)?, record(b)?, -1.0),
        MathFunction::Fft(channel, window) => spectrum(record(channel)?, window),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "clamped to the levels of a record")]
fn to_code(level: f64, lowest: f64) -> i16 {
    level.round().clamp(lowest, f64::from(HIGHEST_CODE)) as i16
}

fn combine(a: &Waveform, b: &Waveform, sign: f64) -> Option<Waveform> {
    if a.codes.len() != b.codes.len() {
        return None;
    }
    let mut sum = a.clone();
    sum.source = Source::Math;
    sum.vertical.scale = a.vertical.scale.max(b.vertical.scale);
    sum.vertical.position = 0.0;
    sum.preamble.y_mult = sum.vertical.scale / LEVELS_PER_DIVISION;
    sum.preamble.y_off = 0.0;
    sum.preamble.y_zero = 0.0;
    let codes = a.codes.iter().zip(&b.codes).map(|(x, y)| {
        let volts = a.volts_of(*x) + sign * b.volts_of(*y);
        to_code(volts / sum.preamble.y_mult, f64::from(LOWEST_CODE))
    });
    sum.codes = codes.collect();
    Some(sum)
}

#[allow(clippy::cast_precision_loss, reason = "a record has a few thousand points")]
fn spectrum(record: &Waveform, window: FftWindow) -> Option<Waveform> {
    let first = record.codes.len().checked_sub(POINTS)? / 2;
    let codes = record.codes.get(first..first + POINTS)?;
    let mut real = Vec::with_capacity(POINTS);
    let mut gain = 0.0;
    for (n, code) in codes.iter().enumerate() {
        let weight = weight(window, n as f64 / POINTS as f64);
        gain += weight;
        real.push(weight * record.volts_of(*code));
    }
    let mut imaginary = vec![0.0; POINTS];
    transform(&mut real, &mut imaginary);
    let rate = if record.horizontal_scale < ODD_RATE_FROM * (1.0 - 1e-9) {
        1.0 / record.preamble.x_incr
    } else {
        100.0 / 99.0 / record.preamble.x_incr
    };
    let y_zero = 20.0 * record.vertical.scale.log10() + REFERENCE;
    let level = |(bin, (re, im)): (usize, (&f64, &f64))| {
        let peak = re.hypot(*im) / gain * if bin == 0 { 1.0 } else { 2.0 };
        let rms = if bin == 0 { peak } else { peak / 2f64.sqrt() };
        to_code((20.0 * rms.log10() - y_zero) / DECIBELS_PER_LEVEL, FLOOR)
    };
    let bins = real.iter().zip(&imaginary).enumerate().take(POINTS / 2);
    Some(Waveform {
        source: Source::Math,
        codes: bins.map(level).collect(),
        preamble: Preamble {
            x_zero: 0.0,
            x_incr: rate / POINTS as f64,
            pt_off: 0,
            x_unit: "Hz".to_owned(),
            y_mult: DECIBELS_PER_LEVEL,
            y_zero,
            y_off: 0.0,
            y_unit: "dB".to_owned(),
            pt_fmt: PointFormat::Sample,
        },
        vertical: record.vertical,
        horizontal_scale: rate / 20.0,
        trigger_point: 0.0,
    })
}

/// Weight of a sample at `place`, 0 to 1 along the points (1).
fn weight(window: FftWindow, place: f64) -> f64 {
    let cosine = |order: f64| (2.0 * PI * order * place).cos();
    match window {
        FftWindow::Rectangular => 1.0,
        FftWindow::Hanning => 0.5 - 0.5 * cosine(1.0),
        // The flat top of ISO 18431-2.
        FftWindow::FlatTop => {
            1.0 - 1.933 * cosine(1.0) + 1.286 * cosine(2.0) - 0.388 * cosine(3.0)
                + 0.0322 * cosine(4.0)
        }
    }
}

/// Fourier transform in place by halves (Cooley and Tukey 1965); the length is a power of two.
#[allow(clippy::cast_precision_loss, reason = "a record has a few thousand points")]
fn transform(real: &mut [f64], imaginary: &mut [f64]) {
    let length = real.len();
    if length < 2 {
        return;
    }
    let half = length / 2;
    let split = |values: &[f64], start: usize| -> Vec<f64> {
        values.iter().skip(start).step_by(2).copied().collect()
    };
    let (mut even_re, mut even_im) = (split(real, 0), split(imaginary, 0));
    let (mut odd_re, mut odd_im) = (split(real, 1), split(imaginary, 1));
    transform(&mut even_re, &mut even_im);
    transform(&mut odd_re, &mut odd_im);
    let (low_re, high_re) = real.split_at_mut(half);
    let (low_im, high_im) = imaginary.split_at_mut(half);
    let outputs = low_re.iter_mut().zip(high_re).zip(low_im.iter_mut().zip(high_im));
    let evens = even_re.iter().zip(&even_im);
    let odds = odd_re.iter().zip(&odd_im);
    for (k, (((lr, hr), (li, hi)), ((er, ei), (or, oi)))) in
        outputs.zip(evens.zip(odds)).enumerate()
    {
        let (sin, cos) = (-2.0 * PI * k as f64 / length as f64).sin_cos();
        let (tr, ti) = (or * cos - oi * sin, or * sin + oi * cos);
        (*lr, *li) = (er + tr, ei + ti);
        (*hr, *hi) = (er - tr, ei - ti);
    }
}

#[cfg(test)]
mod tests {
    use super::transform;

    /// A cosine over a whole number of cycles is two lines of half the points.
    #[test]
    fn a_cosine_is_two_lines() {
        let points = 64_u32;
        let angle = |n: u32| std::f64::consts::TAU * 5.0 * f64::from(n) / f64::from(points);
        let mut real: Vec<f64> = (0..points).map(|n| angle(n).cos()).collect();
        let mut imaginary = vec![0.0; 64];
        transform(&mut real, &mut imaginary);
        for (bin, (re, im)) in real.iter().zip(&imaginary).enumerate() {
            let expected = if bin == 5 || bin == 59 { 32.0 } else { 0.0 };
            assert!((re - expected).abs() < 1e-12 && im.abs() < 1e-12, "bin {bin}: {re} {im}");
        }
    }
}
