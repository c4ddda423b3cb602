//! Arrivals, widths and delays of pulses whose shape is known in closed form, with and without
//! noise.

use hertzscope::analysis::arrival::Estimator;
use hertzscope::analysis::correlation::delay;
use hertzscope::analysis::droop::undo_droop;
use hertzscope::analysis::gate::Gate;
use hertzscope::analysis::pulse::{Conditions, Pulse, PulseError};
use hertzscope::analysis::speed::{speed, speed_over};
use hertzscope::quantity::Uncertain;
use hertzscope::trace::Trace;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::spectrum::sampled;

/// Standard deviation of the Gaussian pulses (s), samples every microsecond.
const SIGMA: f64 = 30e-6;

fn gaussian(centre: f64, height: f64) -> impl Fn(f64) -> f64 {
    move |t| height * (-0.5 * ((t - centre) / SIGMA).powi(2)).exp()
}

/// Arrivals of a Gaussian pulse by each estimator (s).
fn exact(estimator: Estimator, centre: f64) -> f64 {
    let before = match estimator {
        Estimator::HalfRise => (2.0 * 2f64.ln()).sqrt(),
        Estimator::Peak => 0.0,
        Estimator::TenPercent => (2.0 * 10f64.ln()).sqrt(),
        Estimator::MaximumSlope => 1.0,
    };
    centre - before * SIGMA
}

fn found(pulse: &Pulse, estimator: Estimator) -> Uncertain {
    pulse.arrival(estimator).expect("an arrival")
}

/// Without noise what remains is the shape: the Gaussian's first neglected term over the samples
/// taken moves no crossing by more than 0.05 us (the fifth over a third of sigma on either side),
/// the place of steepest rise by no more than 0.25 us (the sixth over 0.9 sigma), and the peak not
/// at all, by symmetry.
#[test]
fn gaussian_without_noise() {
    for shift in [0.0, 0.2e-6, 0.5e-6, 0.9e-6] {
        let centre = 500e-6 + shift;
        for sign in [1.0, -1.0] {
            let trace = sampled(1500, 1e-6, |t| 0.7 + sign * gaussian(centre, 2.0)(t));
            let pulse = Pulse::find(&trace, Conditions::default()).expect("a pulse");
            assert_eq!(pulse.inverted, sign < 0.0);
            for estimator in Estimator::ALL {
                let off = found(&pulse, estimator).value - exact(estimator, centre);
                let most = match estimator {
                    Estimator::Peak => 2e-9,
                    Estimator::HalfRise | Estimator::TenPercent => 0.05e-6,
                    Estimator::MaximumSlope => 0.25e-6,
                };
                println!("{estimator} {shift:e}: {off:.1e} s");
                assert!(off.abs() < most, "{estimator} {shift:e}: {off:e} s");
            }
            let width = pulse.width().expect("a width").value;
            assert!((width - 2.0 * (2.0 * 2f64.ln()).sqrt() * SIGMA).abs() < 0.3e-6, "{width}");
            assert!((pulse.height().expect("a height").value - 2.0).abs() < 2e-3);
            assert_eq!(pulse.count(0.05), 1);
        }
    }
}

/// Coarse samples: a rise over a few of them is still found to a fraction of the interval.
#[test]
fn coarse_samples() {
    for interval in [2e-6, 5e-6, 10e-6] {
        for phase in [0.0, 0.3, 0.6] {
            let centre = 500e-6 + phase * interval;
            let samples = (1.5e-3 / interval) as usize;
            let trace = sampled(samples, interval, gaussian(centre, 2.0));
            let pulse = Pulse::find(&trace, Conditions::default()).expect("a pulse");
            for estimator in [Estimator::HalfRise, Estimator::Peak] {
                let off = found(&pulse, estimator).value - exact(estimator, centre);
                println!("{interval:e} {phase} {estimator}: {off:.1e} s");
                assert!(off.abs() < 0.1 * interval, "{interval:e} {estimator}: {off:e} s");
            }
        }
    }
}

/// Noise of 1 % of the pulse and 8 bits over 1.2 pulses, as a scope has them.
fn noisy(trace: &Trace, rms: f64, level: f64, seed: u64) -> Trace {
    let mut stream = Pcg64::new(u128::from(seed), 7);
    let mut noisy = trace.clone();
    for value in &mut noisy.values {
        let draw: f64 = StandardNormal.sample(&mut stream);
        *value = ((*value + rms * draw) / level).round() * level;
    }
    noisy
}

/// How often twice the stated uncertainty covers the truth, and the root mean square of error over
/// uncertainty.
struct Coverage {
    inside: usize,
    squares: f64,
    count: usize,
}

impl Coverage {
    fn of(pairs: impl Iterator<Item = (Uncertain, f64)>) -> Self {
        let mut coverage = Self { inside: 0, squares: 0.0, count: 0 };
        for (measure, truth) in pairs {
            let error = (measure.value - truth) / measure.u;
            coverage.inside += usize::from(error.abs() <= 2.0);
            coverage.squares += error * error;
            coverage.count += 1;
        }
        coverage
    }

    /// 95.45 % are expected; of 400 independent draws fewer than 92.3 % come once in a thousand
    /// times. Stating too much is no virtue either: errors must be at least a third of what is
    /// stated.
    fn check(&self, what: &str) {
        let share = self.inside as f64 / self.count as f64;
        let ratio = (self.squares / self.count as f64).sqrt();
        println!("{what}: {:.1} % covered, rms error {ratio:.2} of stated", 100.0 * share);
        assert!(share >= 0.923, "{what}: {share}");
        assert!(ratio > 0.33, "{what}: {ratio}");
    }
}

#[test]
fn gaussian_in_noise_is_covered() {
    let draws = 400;
    let centre = |seed: u64| 500e-6 + 1e-6 * (seed as f64 * 0.618).fract();
    for (rms, level) in [(0.01, 0.008), (0.02, 0.04), (0.03, 0.008)] {
        let conditions = Conditions { level, ..Conditions::default() };
        let pulse = |seed: u64, later: f64| {
            let clean = sampled(1500, 1e-6, gaussian(centre(seed) + later, 1.0));
            let trace = noisy(&clean, rms, level, 2 * seed + u64::from(later > 0.0));
            Pulse::find(&trace, conditions).expect("a pulse")
        };
        let pulses: Vec<Pulse> = (0..draws).map(|seed| pulse(seed, 0.0)).collect();
        for estimator in Estimator::ALL {
            let pairs = (0..draws).zip(&pulses);
            let pairs: Vec<_> = pairs
                .filter_map(|(s, p)| Some((p.arrival(estimator)?, exact(estimator, centre(s)))))
                .collect();
            // Now and then noise leaves a rise without a steepest place, and the answer is that
            // there is none.
            assert!(pairs.len() as u64 >= draws * 98 / 100, "{estimator}: {}", pairs.len());
            Coverage::of(pairs.into_iter()).check(&format!("{estimator} at {rms}"));
        }
        let heights = pulses.iter().map(|p| (p.height().expect("a height"), 1.0));
        Coverage::of(heights).check("height");
        let full = 2.0 * (2.0 * 2f64.ln()).sqrt() * SIGMA;
        let widths = pulses.iter().map(|p| (p.width().expect("a width"), full));
        Coverage::of(widths).check("width");
        let delays = (0..draws).zip(&pulses);
        let delays = delays.map(|(s, p)| (delay(p, &pulse(s, 123.4e-6)).expect("a lag"), 123.4e-6));
        Coverage::of(delays).check("delay");
    }
}

/// Rounding without noise: errors of neighbours go together, and the statement must know it. Pulses
/// whose height, zero and place fall differently between the levels stand for the draws.
#[test]
fn levels_without_noise_are_covered() {
    let level = 0.03;
    let draws = 400u64;
    for estimator in [Estimator::HalfRise, Estimator::Peak, Estimator::TenPercent] {
        let pairs = (0..draws).map(|s| {
            let part = |k: f64| (s as f64 * k).fract();
            let centre = 500e-6 + 1e-6 * part(0.618);
            let clean = gaussian(centre, 1.0 + level * part(0.755));
            let trace = sampled(1500, 1e-6, |t| clean(t) + level * part(0.570));
            let conditions = Conditions { level, ..Conditions::default() };
            let pulse = Pulse::find(&noisy(&trace, 0.0, level, s), conditions).expect("a pulse");
            (found(&pulse, estimator), exact(estimator, centre))
        });
        let coverage = Coverage::of(pairs);
        let share = coverage.inside as f64 / draws as f64;
        let ratio = (coverage.squares / draws as f64).sqrt();
        println!("{estimator}: {:.1} % covered, rms error {ratio:.2} of stated", 100.0 * share);
        assert!(share >= 0.923, "{estimator}: {share}");
    }
}

/// A force that jumps to 1 N and stays: the sensor's voltage is `S exp(-t/tau)`, and the force
/// comes back.
#[test]
fn droop_is_undone() {
    let tau = 1e-3;
    let step = |t: f64| if t < 100.5e-6 { 0.0 } else { (-(t - 101e-6) / tau).exp() };
    let felt = undo_droop(&sampled(3000, 1e-6, step), tau);
    for (index, value) in felt.values.iter().enumerate() {
        // A jump within one interval is read as a ramp, which loses dt/(2 tau) of it on the way.
        let exact = if index < 101 { 0.0 } else { 1.0 };
        assert!((value - exact).abs() < 0.51 * 1e-6 / tau, "{index}: {value}");
    }
}

/// Three pulses, the middle one too low to count as the first.
#[test]
fn first_peak_and_count() {
    let trace = sampled(3000, 1e-6, |t| {
        gaussian(600e-6, 0.2)(t) + gaussian(1.1e-3, 0.5)(t) + gaussian(1.6e-3, 1.0)(t)
    });
    let pulse = Pulse::find(&trace, Conditions::default()).expect("a pulse");
    assert!((found(&pulse, Estimator::Peak).value - 1.1e-3).abs() < 1e-8);
    assert_eq!((pulse.count(0.05), pulse.count(0.3)), (3, 2));
    let gate = Gate { from: 0.0, to: 200e-6 };
    let conditions = Conditions { baseline: Some(gate), ..Conditions::default() };
    let gated = Pulse::find(&trace, conditions).expect("a pulse");
    assert_eq!(gated.baseline.samples, 200);
}

#[test]
fn speeds_carry_the_uncertainty_of_distance_and_times() {
    let sure =
        |value: f64, standard_uncertainty: f64| Uncertain::normal(value, standard_uncertainty);
    let found = speed(sure(0.05, 1e-5), sure(1e-4, 1e-6), sure(4e-4, 1e-6)).expect("a speed");
    assert!((found.value - 166.666_666_666_666_67).abs() < 1e-10);
    // (1e-5/0.05)^2 + 2 (1e-6/3e-4)^2.
    let relative = (4e-8 + 2.0 / 9e4_f64).sqrt();
    assert!((found.u / found.value / relative - 1.0).abs() < 1e-12);
    assert_eq!(speed_over(sure(0.05, 1e-5), sure(0.0, 1e-6)), None);
}

#[test]
fn what_is_no_pulse_is_named() {
    let conditions = Conditions::default();
    let early = sampled(500, 1e-6, gaussian(300e-6, 1.0));
    let short = Conditions { baseline: Some(Gate { from: 0.0, to: 5e-6 }), ..conditions };
    let none = PulseError::NoBaseline { trace: "test".into(), samples: 5 };
    assert_eq!(Pulse::find(&early, short), Err(none));
    let silent = noisy(&sampled(500, 1e-6, |_| 0.0), 0.01, 1e-6, 1);
    let gate = Some(Gate { from: 0.0, to: 250e-6 });
    let found = Pulse::find(&silent, Conditions { baseline: gate, ..conditions });
    assert!(matches!(found, Err(PulseError::NoPulse { .. })), "{found:?}");
    let mut holed = early.clone();
    holed.values[3] = f64::NAN;
    assert!(matches!(Pulse::find(&holed, conditions), Err(PulseError::NotFinite { .. })));
    for short in [vec![], vec![1.0], vec![0.0; 100]] {
        let trace = Trace { values: short, ..early.clone() };
        assert!(Pulse::find(&trace, conditions).is_err());
    }
}

/// A pulse `1/cosh^2`, as in a precompressed chain: its foot goes down by a factor of e in half of
/// its `width`, so that a record that begins shortly before it never shows the zero. The stated
/// uncertainty covers what the foot does to the height, and is not beyond reason.
#[test]
fn a_foot_in_the_baseline_is_covered() {
    let (width, interval, noise) = (50e-6, 0.4e-6, 0.03);
    for widths in [10.0, 4.0, 3.4, 3.0] {
        let centre = widths * width;
        let pulse = |t: f64| ((t - centre) / width).cosh().powi(-2);
        let mut errors = Vec::new();
        for seed in 0..200 {
            let trace = noisy(&sampled(1500, interval, pulse), noise, interval, seed);
            // Refused where the foot is too large, or where noise hides the peak.
            if let Ok(found) = Pulse::find(&trace, Conditions::default()) {
                errors.extend(found.height().map(|height| (height.value - 1.0, height.u)));
            }
        }
        let count = errors.len();
        assert!(count >= 100, "{widths} widths: {count} of 200 determined");
        let inside = errors.iter().filter(|(off, u)| off.abs() <= 2.0 * u).count();
        let sum = |of: &dyn Fn(&(f64, f64)) -> f64| errors.iter().map(of).sum::<f64>();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| sum(of) / count as f64;
        let (rms, stated) = (mean(&|(off, _)| off * off).sqrt(), mean(&|(_, u)| *u));
        println!("{widths} widths: inside {inside} of {count}, rms {rms:.4}, u {stated:.4}");
        // 95 % are expected; 91 % of 200 or fewer come once in a thousand times.
        assert!(inside as f64 >= 0.91 * count as f64, "{widths} widths: {inside} of {count}");
        assert!(stated < 2.0 * rms, "{widths} widths: u {stated}, rms {rms}");
    }
}

/// The same where the foot is 12 % of the height at the record's start: no zero, and why.
#[test]
fn a_record_that_begins_in_the_foot_has_no_zero() {
    let pulse = |t: f64| ((t - 85e-6) / 50e-6).cosh().powi(-2);
    for seed in 0..20 {
        let trace = noisy(&sampled(1500, 0.4e-6, pulse), 0.005, 0.4e-6, seed);
        let found = Pulse::find(&trace, Conditions::default());
        assert!(matches!(found, Err(PulseError::NoZero { .. })), "{found:?}");
    }
}

/// A record that begins while the chain still moves, and holds a larger pulse later: no first
/// pulse.
#[test]
fn a_record_that_begins_in_motion_has_no_first_pulse() {
    let moving = |t: f64| 0.08 * (t / 40e-6).sin() + gaussian(600e-6, 1.0)(t);
    let trace = noisy(&sampled(1500, 1e-6, moving), 0.01, 1e-6, 5);
    let found = Pulse::find(&trace, Conditions::default());
    assert!(matches!(found, Err(PulseError::NotAtRest { .. })), "{found:?}");
    // The same at rest is one, whatever its noise.
    for noise in [0.002, 0.01, 0.05] {
        let trace = noisy(&sampled(1500, 1e-6, gaussian(600e-6, 1.0)), noise, 1e-6, 5);
        assert!(Pulse::find(&trace, Conditions::default()).is_ok(), "{noise}");
    }
}

/// A peak's time is given where the noise of the slope there is below 0.2 of what a parabola that
/// is half as high a rise away has at the fit's end. The slope of a polynomial of degree 5 over `n`
/// samples of noise `s` has a standard deviation of `s sqrt(57.4/n)` per half of the fit's width
/// (`sum of (2 k + 1) P_k'(0)^2` over Legendre's polynomials of degrees 1, 3 and 5), the parabola
/// `0.36` of the height: with a rise of 35 samples, `n = 43`, the limit is noise of 6.2 % of the
/// height. What noise does to rise and height moves it by about a tenth.
#[test]
fn a_peaks_time_is_refused_beyond_a_fifth_of_the_fit() {
    for (noise, is_given) in [(0.045, true), (0.085, false)] {
        for seed in 0..40 {
            let mut stream = Pcg64::new(seed, 60);
            let mut trace = sampled(1500, 1e-6, gaussian(700e-6, 1.0));
            for value in &mut trace.values {
                let draw: f64 = StandardNormal.sample(&mut stream);
                *value += noise * draw;
            }
            let pulse = Pulse::find(&trace, Conditions::default()).expect("a pulse");
            let found = pulse.arrival(Estimator::Peak);
            assert_eq!(found.is_some(), is_given, "{noise} {seed}: {found:?}");
        }
    }
}

/// A disturbance of less than 1 % of the largest value is no motion of the chain, also of a trace
/// that was never digitised; one of 3 % is.
#[test]
fn a_record_with_a_small_disturbance_is_at_rest() {
    for (rms, is_at_rest) in [(0.005, true), (0.03, false)] {
        let disturbance = |t: f64| rms * 2f64.sqrt() * (std::f64::consts::TAU * 5e3 * t).sin();
        let pulse = gaussian(900e-6, 1.0);
        let trace = sampled(1500, 1e-6, |t| pulse(t) + disturbance(t));
        match Pulse::find(&trace, Conditions::default()) {
            Ok(found) => {
                assert!(is_at_rest, "{rms}");
                // 0.7 % of the height, over a slope of 0.7 % in a microsecond at half of it.
                let off = found.arrival(Estimator::HalfRise).expect("an arrival").value
                    - exact(Estimator::HalfRise, 900e-6);
                assert!(off.abs() < 3e-6, "{off:e}");
            }
            Err(PulseError::NotAtRest { .. }) => assert!(!is_at_rest, "{rms}"),
            Err(error) => panic!("{rms}: {error}"),
        }
    }
}

/// A zero that moves by 4 standard deviations of white noise counts as moving within one level,
/// where 3.5 suffice, and as still across two, where it takes 4.5. The statistic is that of a
/// straight line: `|sum of (v - mean) x| sqrt(3/n)` over the root mean square, `x` from -1 to 1.
#[test]
fn a_moving_zero_has_a_limit_within_a_level_and_another_across_levels() {
    let record = |codes: &dyn Fn(usize) -> f64| {
        let pulse = gaussian(800e-6, 100.0);
        let values = (0..1500).map(|i| (pulse(i as f64 * 1e-6) + codes(i)).round());
        Trace { values: values.collect(), ..sampled(1500, 1e-6, |_| 0.0) }
    };
    let every = |i: usize, step: usize| f64::from(u8::from(i % step == step / 2));
    // Ones in the first half, and more of them in the second; or as many below as above.
    let within = record(&|i| if i < 200 { every(i, 33) } else { every(i, 6) });
    let across = record(&|i| if i < 200 { -every(i, 19) } else { every(i, 19) });
    for (trace, is_moving) in [(within, true), (across, false)] {
        let values = &trace.values[..400];
        let mean = values.iter().sum::<f64>() / 400.0;
        let rms = (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / 400.0).sqrt();
        let at = |i: usize| (2.0 * i as f64 + 1.0) / 400.0 - 1.0;
        let sum: f64 = values.iter().enumerate().map(|(i, v)| (v - mean) * at(i)).sum();
        let deviations = sum.abs() * (3.0_f64 / 400.0).sqrt() / rms;
        assert!((3.7..4.3).contains(&deviations), "{deviations}");
        let baseline = Some(Gate { from: 0.0, to: 400e-6 });
        let conditions = Conditions { level: 1.0, baseline, ..Conditions::default() };
        let pulse = Pulse::find(&trace, conditions).expect("a pulse");
        assert_eq!(pulse.baseline.is_moving, is_moving, "{deviations}");
    }
}
