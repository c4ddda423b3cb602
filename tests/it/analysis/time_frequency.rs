//! The spectrogram of signals whose frequency at each time is known.

use std::f64::consts::TAU;

use hertzscope::analysis::gate::Gate;
use hertzscope::analysis::spectrum::Window;
use hertzscope::analysis::spectrum::{Analyser, SpectrumSettings};
use hertzscope::analysis::time_frequency::{Pieces, Spectrogram, SpectrogramError};

use super::spectrum::sampled;

/// A chirp's frequency is `f0 + rate t`: each piece's top is the frequency at its middle, by
/// symmetry, to a bin.
#[test]
fn a_chirps_ridge_is_its_frequency() {
    let (start, rate) = (5e3, 2e6);
    let trace = sampled(10_000, 1e-6, |t| (TAU * (start + 0.5 * rate * t) * t).sin());
    let settings = SpectrumSettings { window: Window::Hann, ..SpectrumSettings::default() };
    let pieces = Pieces { segment: 1000, hop: 250 };
    let found = Spectrogram::of(&mut Analyser::new(), &trace, &settings, pieces).expect("one");
    assert_eq!(found.columns.len(), 37);
    for (time, frequency) in found.times.iter().zip(found.ridge(0.0, 5e5)) {
        let off = frequency.expect("a ridge") - (start + rate * time);
        assert!(off.abs() <= found.columns[0].step, "{time}: {off} Hz");
    }
}

/// Two lines at the edges of a gap: pieces made for it leave it dark but for the window's side
/// lobes, 31 dB below (Harris 1978, Table 1). A sixteenth of this record would blur the lines into
/// one.
#[test]
fn pieces_show_the_gap() {
    let (f1, f2) = (7.1e3, 14.2e3);
    let trace = sampled(2500, 1e-6, |t| (TAU * f1 * t).sin() + (TAU * f2 * t).sin());
    let settings = SpectrumSettings { window: Window::Hann, ..SpectrumSettings::default() };
    let height = |gap| {
        let pieces = Pieces::of_record(2500, 1e-6, gap);
        let found = Spectrogram::of(&mut Analyser::new(), &trace, &settings, pieces).expect("one");
        let heights = found.columns.iter().map(|c| {
            let at = |frequency: f64| c.amplitude[(frequency / c.step).round() as usize];
            at(0.5 * (f1 + f2)) / at(f1)
        });
        heights.fold(0.0, f64::max)
    };
    assert!(height(Some(f2 - f1)) < 0.06, "{}", height(Some(f2 - f1)));
    assert!(height(None) > 0.3, "{}", height(None));
    // No more than half of the record, however narrow the gap; at least two samples.
    assert_eq!(Pieces::of_record(2500, 1e-6, Some(1.0)).segment, 1250);
    assert_eq!(Pieces::of_record(3, 1e-6, None), Pieces { segment: 2, hop: 1 });
}

/// A tone that ends and another that begins: pieces on either side hold one of them only.
#[test]
fn tones_are_where_they_sound() {
    let trace = sampled(8000, 1e-6, |t| {
        let frequency = if t < 4e-3 { 8e3 } else { 20e3 };
        (TAU * frequency * t).sin()
    });
    let pieces = Pieces { segment: 1000, hop: 1000 };
    let settings = SpectrumSettings {
        gate: Gate { from: 1e-3, to: 7e-3 },
        window: Window::Hann,
        ..SpectrumSettings::default()
    };
    let found = Spectrogram::of(&mut Analyser::new(), &trace, &settings, pieces).expect("one");
    assert_eq!(found.times.len(), 6);
    for (time, column) in found.times.iter().zip(&found.columns) {
        let height = |low, high| column.highest_between(low, high).expect("bins").1;
        let (low, high) = (height(7e3, 9e3), height(19e3, 21e3));
        let (sounding, silent) = if *time < 4e-3 { (low, high) } else { (high, low) };
        assert!((sounding - 0.5).abs() < 1e-3 && silent < 1e-3, "{time}: {low} {high}");
    }
}

#[test]
fn pieces_that_do_not_fit_are_named() {
    let trace = sampled(100, 1e-6, |t| t);
    let of = |segment, hop| {
        let pieces = Pieces { segment, hop };
        Spectrogram::of(&mut Analyser::new(), &trace, &SpectrumSettings::default(), pieces)
    };
    assert_eq!(of(101, 1), Err(SpectrogramError::Segment { segment: 101, samples: 100 }));
    assert_eq!(of(10, 0), Err(SpectrogramError::Hop));
    assert_eq!(of(100, 7).expect("one piece").times.len(), 1);
}
