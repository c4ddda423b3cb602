//! Spectra of signals whose transform is known in closed form.

use std::f64::consts::{PI, TAU};

use hertzscope::analysis::gate::Gate;
use hertzscope::analysis::spectrum::Window;
use hertzscope::analysis::spectrum::{Analyser, Convention, SpectrumError, SpectrumSettings};
use hertzscope::trace::Trace;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// `signal` (s -> N) at `samples` times from zero.
pub fn sampled(samples: usize, interval: f64, signal: impl Fn(f64) -> f64) -> Trace {
    Trace {
        name: "test".into(),
        unit: "N".into(),
        start: 0.0,
        interval,
        values: (0..samples).map(|i| signal(i as f64 * interval)).collect(),
    }
}

/// Sines anywhere between bins: their frequency to a hundredth of the resolution, and their height.
///
/// The line of a sine is the window's transform; by its Taylor series the parabola through
/// logarithms is off by less than 1e-3 of a fifth of a bin, and the line of the negative frequency,
/// 100 resolutions away or more, adds at most 1/(pi 200) of its height with no window, far less
/// with one; 1/(100 pi) of the height moves a rectangular window's top by 0.01 resolutions. A flat
/// top has no point: within half a resolution of its middle it is high and low in turn, by 0.05 %
/// at most.
#[test]
fn sines_between_bins() {
    let (samples, interval) = (4000, 1e-6);
    let mut analyser = Analyser::new();
    for (window, moved, height) in [
        (Window::Rectangular, 0.01, 4e-3),
        (Window::Hann, 2e-4, 1e-4),
        (Window::FlatTop, 0.5, 5e-4),
    ] {
        for fraction in [0.0, 0.13, 0.31, 0.5, 0.77] {
            let frequency = (50.0 + fraction) / (samples as f64 * interval);
            let trace = sampled(samples, interval, |t| 3.0 * (TAU * frequency * t + 0.7).sin());
            let settings = SpectrumSettings { window, ..SpectrumSettings::default() };
            let spectrum = analyser.spectrum(&trace, &settings).expect("a spectrum");
            // A rectangular window's side lobes have 0.217 and 0.128 of their line.
            let peaks = spectrum.peaks(0.15);
            assert_eq!(peaks.len(), 1, "{window}: side lobes are no lines of their own");
            let off = (peaks[0].frequency - frequency).abs();
            assert!(off <= moved * spectrum.resolution, "{window} {fraction}: {off} Hz");
            assert!(off <= peaks[0].bound, "{window} {fraction}: {off} Hz");
            let ratio = peaks[0].amplitude / 1.5;
            assert!((ratio - 1.0).abs() <= height, "{window} {fraction}: {ratio}");
        }
    }
}

/// A pulse and its echo after 1.37 ms: `|X|` is that of one pulse times `2 |cos(pi f 1.37 ms)|`,
/// whose maxima are 730 Hz apart, and all are listed.
#[test]
fn lines_of_a_pulse_and_its_echo_are_all_listed() {
    let pulse = |t: f64| (-(t / 20e-6).powi(2)).exp();
    let trace = sampled(2500, 1e-6, |t| pulse(t - 0.3e-3) + pulse(t - 1.67e-3));
    let spectrum =
        Analyser::new().spectrum(&trace, &SpectrumSettings::default()).expect("a spectrum");
    let mut found: Vec<f64> = spectrum.peaks(0.3).iter().map(|peak| peak.frequency).collect();
    found.sort_by(f64::total_cmp);
    // The pulse's own spectrum falls to 0.3 of its height at 17.5 kHz.
    assert!(found.len() >= 20, "{found:?}");
    for (frequency, number) in found.iter().zip(1_u32..) {
        let expected = f64::from(number) / 1.37e-3;
        assert!((frequency - expected).abs() < 60.0, "{frequency} Hz, {expected} Hz");
    }
}

/// A sine on a bin: `|X|/M` is half its amplitude there, exactly, and zero on all bins a multiple
/// of the padding away.
#[test]
fn a_sine_on_a_bin_has_half_its_amplitude() {
    let trace = sampled(1000, 1e-3, |t| 2.0 * (TAU * 40.0 * t).cos() + 0.25);
    let spectrum =
        Analyser::new().spectrum(&trace, &SpectrumSettings::default()).expect("a spectrum");
    assert_eq!((spectrum.samples, spectrum.padded), (1000, 5000));
    assert!((spectrum.step - 0.2).abs() < 1e-15 && (spectrum.resolution - 1.0).abs() < 1e-15);
    for hertz in 0..500 {
        let expected = match hertz {
            0 => 0.25,
            40 => 1.0,
            _ => 0.0,
        };
        // Rounding of a sum of 1000 terms.
        assert!((spectrum.amplitude[5 * hertz] - expected).abs() < 1e-13, "{hertz} Hz");
    }
}

/// Every bin of a short record against the sum of Eq. (11) as it is printed, term by term.
#[test]
fn coefficients_are_the_papers_sum() {
    let trace = sampled(7, 0.1, |t| 1.0 + 3.0 * t - 20.0 * t * t * t);
    let spectrum =
        Analyser::new().spectrum(&trace, &SpectrumSettings::default()).expect("a spectrum");
    for (k, found) in spectrum.amplitude.iter().enumerate() {
        let (mut re, mut im) = (0.0, 0.0);
        for (j, x) in trace.values.iter().enumerate() {
            let angle = -TAU * (j * k) as f64 / 35.0;
            re += x / 7.0 * angle.cos();
            im += x / 7.0 * angle.sin();
        }
        assert!((found - re.hypot(im)).abs() < 1e-14, "bin {k}");
    }
    assert_eq!(spectrum.amplitude.len(), 18);
}

/// `A exp(-t/tau)`: the sampled sum is a geometric series, `A dt/|1 - r exp(-i w dt)|`, and
/// `A tau/sqrt(1 + (w tau)^2)` to second order in the interval once half of the first sample, the
/// jump, is accounted for.
#[test]
fn exponential_pulse() {
    let (samples, interval, tau) = (40_000, 1e-6, 1e-3);
    let trace = sampled(samples, interval, |t| 2.0 * (-t / tau).exp());
    let spectrum =
        Analyser::new().spectrum(&trace, &SpectrumSettings::default()).expect("a spectrum");
    let ratio = (-interval / tau).exp();
    let rest = (-(samples as f64) * interval / tau).exp();
    for bin in [0, 10, 77, 500, 3000, 60_000] {
        let omega = TAU * spectrum.frequency(bin);
        let (re, im) = (1.0 - ratio * (omega * interval).cos(), ratio * (omega * interval).sin());
        let series = 2.0 / re.hypot(im) / samples as f64;
        assert!((spectrum.amplitude[bin] / series - 1.0).abs() < 2.0 * rest + 1e-11, "bin {bin}");
        let smooth = 2.0 * tau / 1f64.hypot(omega * tau) / (samples as f64 * interval);
        if bin <= 500 {
            // The jump adds A dt/2, in phase with the transform's real part.
            let jump = interval / tau;
            assert!((spectrum.amplitude[bin] / smooth - 1.0).abs() < jump, "bin {bin}");
        }
    }
}

/// A Gaussian pulse: its transform is Gaussian, `A sigma sqrt(2 pi) exp(-(w sigma)^2/2)`; the
/// sampled sum differs by less than `exp(-2 (pi sigma/dt)^2)`, nothing (Poisson's summation).
#[test]
fn gaussian_pulse() {
    let (samples, interval, sigma) = (2000, 1e-6, 40e-6_f64);
    let centre = 1e-3;
    let trace = sampled(samples, interval, |t| 5.0 * (-0.5 * ((t - centre) / sigma).powi(2)).exp());
    let spectrum =
        Analyser::new().spectrum(&trace, &SpectrumSettings::default()).expect("a spectrum");
    for (bin, found) in spectrum.amplitude.iter().enumerate() {
        let exponent = -0.5 * (TAU * spectrum.frequency(bin) * sigma).powi(2);
        let exact = 5.0 * sigma * (2.0 * PI).sqrt() * exponent.exp() / (samples as f64 * interval);
        assert!((found - exact).abs() < 1e-14, "bin {bin}: {found} is not {exact}");
    }
}

fn noise(samples: usize) -> Trace {
    let mut stream = Pcg64::new(2009, 1);
    let values: Vec<f64> = (0..samples).map(|_| StandardNormal.sample(&mut stream)).collect();
    Trace { name: "noise".into(), unit: "V".into(), start: 0.0, interval: 2e-6, values }
}

/// Parseval: the density's squares add up to the mean square of the windowed record, for odd and
/// even lengths, padded or not.
#[test]
fn density_keeps_the_mean_square() {
    for samples in [1000, 1001] {
        for padding in [1, 2, 5] {
            for window in Window::ALL {
                let trace = noise(samples);
                let settings = SpectrumSettings {
                    convention: Convention::Density,
                    window,
                    padding,
                    ..SpectrumSettings::default()
                };
                let spectrum = Analyser::new().spectrum(&trace, &settings).expect("a spectrum");
                assert_eq!(spectrum.unit, "V/sqrt(Hz)");
                let power: f64 = spectrum.amplitude.iter().map(|s| s * s * spectrum.step).sum();
                let weights = |i: usize| window.weight(i, samples);
                let squares: f64 =
                    (0..samples).map(|i| (weights(i) * trace.values[i]).powi(2)).sum();
                let gain: f64 = (0..samples).map(|i| weights(i).powi(2)).sum();
                assert!(
                    (power / (squares / gain) - 1.0).abs() < 1e-12,
                    "{samples} {padding} {window}"
                );
            }
        }
    }
}

/// White noise of 1 V rms up to half of 500 kHz has the density 1/sqrt(250 kHz): mean power over
/// 20,000 bins to 5 deviations.
#[test]
fn density_of_white_noise() {
    let trace = noise(40_000);
    for window in Window::ALL {
        let settings = SpectrumSettings {
            convention: Convention::Density,
            window,
            padding: 1,
            ..SpectrumSettings::default()
        };
        let spectrum = Analyser::new().spectrum(&trace, &settings).expect("a spectrum");
        let bins = &spectrum.amplitude[10..19_990];
        let mean: f64 = bins.iter().map(|s| s * s).sum::<f64>() / bins.len() as f64;
        // Powers scatter by as much as they are high; a window makes about 4 neighbours one at
        // most.
        assert!((mean * 250e3 - 1.0).abs() < 5.0 * (4.0 / 20_000f64).sqrt(), "{window}: {mean}");
    }
}

/// Half a gate's samples are its own, and none is counted twice.
#[test]
fn gates_follow_on_one_another() {
    let trace = Trace { start: -2e-3, ..sampled(15_000, 1e-6, |t| t) };
    let mut count = 0;
    for (from, to) in [(-1.0, 0.0), (0.0, 1e-3), (1e-3, 7e-3), (7e-3, 12e-3), (12e-3, 1.0)] {
        let range = Gate { from, to }.range(&trace);
        assert_eq!(range.start, count, "{from}");
        count = range.end;
    }
    assert_eq!(count, 15_000);
    assert_eq!(Gate { from: 0.0, to: 7e-3 }.range(&trace), 2000..9000);
    assert!(Gate { from: 3.0, to: 2.0 }.range(&trace).is_empty());
}

#[test]
fn what_cannot_be_transformed_is_named() {
    let mut analyser = Analyser::new();
    let trace = sampled(100, 1e-6, |t| t);
    let empty =
        SpectrumSettings { gate: Gate { from: 1.0, to: 2.0 }, ..SpectrumSettings::default() };
    let error = analyser.spectrum(&trace, &empty).expect_err("no samples");
    assert_eq!(error, SpectrumError::TooShort { trace: "test".into(), samples: 0 });
    let unpadded = SpectrumSettings { padding: 0, ..SpectrumSettings::default() };
    assert!(matches!(analyser.spectrum(&trace, &unpadded), Err(SpectrumError::Padding { .. })));
    let mut holed = trace.clone();
    holed.values[3] = f64::NAN;
    let error = analyser.spectrum(&holed, &SpectrumSettings::default()).expect_err("no number");
    assert!(error.to_string().contains("3e-6 s"), "{error}");
    let still = Trace { interval: 0.0, ..trace };
    let error = analyser.spectrum(&still, &SpectrumSettings::default()).expect_err("no interval");
    assert!(matches!(error, SpectrumError::Interval { .. }));
}
