//! The math trace: sums, differences, and the spectrum.
//!
//! The spectrum's law stands in the model's data file; on this family it was computed from real files: 2048 of the 2500
//! points make 1024 bins; the sample rate of the transform is 250 points a division, and 100/99 of that from 250 us/div
//! on; a level is 0.4 dB from `20 log10(V/div) - 20.9691`, and nothing lies lower than 100 levels below it.

use std::f64::consts::PI;

use super::panel::{FftWindow, MathFunction};
use crate::scope::model::{FftLaw, RANGE_END_FACTOR};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{PointFormat, Preamble, Source, VerticalSetup, Waveform};

/// The math trace of the channels' records, where the records it needs are there.
pub fn math<'a>(
    law: &FftLaw,
    function: MathFunction,
    record: impl Fn(u8) -> Option<&'a Waveform>,
) -> Option<Waveform> {
    match function {
        MathFunction::Sum(a, b) => combine(record(a)?, record(b)?, 1.0),
        MathFunction::Difference(a, b) => combine(record(a)?, record(b)?, -1.0),
        MathFunction::Fft(channel, window) => spectrum(law, record(channel)?, window),
    }
}

#[allow(clippy::cast_possible_truncation, reason = "clamped to the levels of a record")]
fn to_code(level: f64, lowest: f64) -> i16 {
    level.round().clamp(lowest, f64::from(HIGHEST_CODE)) as i16
}

/// Sum (`sign` 1) or difference (-1) of two records of one length, in levels of the coarser scale (1).
pub fn combine(a: &Waveform, b: &Waveform, sign: f64) -> Option<Waveform> {
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
fn spectrum(law: &FftLaw, record: &Waveform, window: FftWindow) -> Option<Waveform> {
    let points = law.points;
    let first = record.codes.len().checked_sub(points)? / 2;
    let codes = record.codes.get(first..first + points)?;
    let mut real = Vec::with_capacity(points);
    let mut gain = 0.0;
    for (n, code) in codes.iter().enumerate() {
        let weight = weight(window, n as f64 / points as f64);
        gain += weight;
        real.push(weight * record.volts_of(*code));
    }
    let mut imaginary = vec![0.0; points];
    transform(&mut real, &mut imaginary);
    let is_slow = record.horizontal_scale * RANGE_END_FACTOR >= law.slow_from;
    let rate = if is_slow { law.slow_rate } else { 1.0 } / record.preamble.x_incr;
    let y_zero = 20.0 * record.vertical.scale.log10() + law.reference;
    let level = |(bin, (re, im)): (usize, (&f64, &f64))| {
        let peak = re.hypot(*im) / gain * if bin == 0 { 1.0 } else { 2.0 };
        let rms = if bin == 0 { peak } else { peak / 2f64.sqrt() };
        to_code((20.0 * rms.log10() - y_zero) / law.level, law.lowest_level)
    };
    let bins = real.iter().zip(&imaginary).enumerate().take(points / 2);
    Some(Waveform {
        source: Source::Math,
        codes: bins.map(level).collect(),
        preamble: Preamble {
            x_zero: 0.0,
            x_incr: rate / points as f64,
            pt_off: 0,
            x_unit: "Hz".to_owned(),
            y_mult: law.level,
            y_zero,
            y_off: 0.0,
            y_unit: "dB".to_owned(),
            pt_fmt: PointFormat::Sample,
        },
        // A spectrum has a scale of its own.
        vertical: VerticalSetup {
            scale: LEVELS_PER_DIVISION * law.level,
            position: 0.0,
            ..record.vertical
        },
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
