//! The math trace: sums, differences, and the spectrum.
//!
//! The spectrum's law stands in the model's data file; on this family it was computed from real
//! files: 2048 of the 2500 points make 1024 bins; the sample rate of the transform is 250 points a
//! division, and 100/99 of that from 250 us/div on; a level is 0.4 dB from
//! `20 log10(V/div) - 20.9691`, and nothing lies lower than 100 levels below it.

use std::f64::consts::PI;

use rustfft::FftPlanner;
use rustfft::num_complex::Complex;

use crate::scope::model::{FftLaw, RANGE_END_FACTOR};
use crate::scope::panel::{FftWindow, MathFunction};
use crate::scope::waveform::{FAMILY_BITS, LEVELS_PER_DIVISION, codes, levels_per_division};
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

fn to_code(level: f64, lowest: f64, bits: u8) -> i16 {
    level.round().clamp(lowest, f64::from(*codes(bits).end())) as i16
}

/// Sum (`sign` 1) or difference (-1) of two records of one length, in levels of the coarser scale
/// (1).
pub fn combine(a: &Waveform, b: &Waveform, sign: f64) -> Option<Waveform> {
    if a.codes.len() != b.codes.len() {
        return None;
    }
    let mut sum = a.clone();
    sum.source = Source::Math;
    sum.vertical.scale = a.vertical.scale.max(b.vertical.scale);
    sum.vertical.position = 0.0;
    let bits = a.bits().unwrap_or(FAMILY_BITS);
    let lowest = f64::from(*codes(bits).start());
    sum.preamble.y_mult = sum.vertical.scale / levels_per_division(bits);
    sum.preamble.y_off = 0.0;
    sum.preamble.y_zero = 0.0;
    let codes = a.codes.iter().zip(&b.codes).map(|(x, y)| {
        let volts = a.volts_of(*x) + sign * b.volts_of(*y);
        to_code(volts / sum.preamble.y_mult, lowest, bits)
    });
    sum.codes = codes.collect();
    Some(sum)
}

fn spectrum(law: &FftLaw, record: &Waveform, window: FftWindow) -> Option<Waveform> {
    let points = law.points;
    let first = record.codes.len().checked_sub(points)? / 2;
    let codes = record.codes.get(first..first + points)?;
    let mut bins = Vec::with_capacity(points);
    let mut gain = 0.0;
    for (n, code) in codes.iter().enumerate() {
        let weight = weight(window, n as f64 / points as f64);
        gain += weight;
        bins.push(Complex::from(weight * record.volts_of(*code)));
    }
    FftPlanner::new().plan_fft_forward(points).process(&mut bins);
    let is_slow = record.horizontal_scale * RANGE_END_FACTOR >= law.slow_from;
    let rate = if is_slow { law.slow_rate } else { 1.0 } / record.preamble.x_incr;
    let y_zero = 20.0 * record.vertical.scale.log10() + law.reference;
    let level = |(bin, value): (usize, &Complex<f64>)| {
        let peak = value.norm() / gain * if bin == 0 { 1.0 } else { 2.0 };
        let rms = if bin == 0 { peak } else { peak / 2f64.sqrt() };
        to_code((20.0 * rms.log10() - y_zero) / law.level, law.lowest_level, FAMILY_BITS)
    };
    Some(Waveform {
        source: Source::Math,
        codes: bins.iter().take(points / 2).enumerate().map(level).collect(),
        as_read: Vec::new(),
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
