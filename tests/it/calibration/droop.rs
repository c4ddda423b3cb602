//! The sensor's filter, its inverse, and what the inverse makes of noise and baselines.

use hertzscope::analysis::droop::{error_gain, undo_droop};
use hertzscope::sensor::Circuit;
use hertzscope::trace::Trace;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const CIRCUIT: Circuit = Circuit { sensitivity: 0.37, time_constant: 0.97e-3 };

fn trace(values: Vec<f64>) -> Trace {
    Trace { name: "test".into(), unit: "N".into(), start: 0.0, interval: 0.4e-6, values }
}

/// A force that goes straight between corners drawn at random, 1 to 50 samples apart.
fn zigzag(samples: usize) -> Trace {
    let mut stream = Pcg64::new(7, 1);
    let mut draw = || -> f64 { StandardNormal.sample(&mut stream) };
    let mut values = vec![0.0];
    while values.len() <= samples {
        let length = 1 + (draw().abs() * 15.0) as usize;
        let (from, to) = (values[values.len() - 1], 10.0 * draw());
        values.extend((1..=length).map(|i| from + (to - from) * i as f64 / length as f64));
    }
    values.truncate(samples);
    trace(values)
}

/// `V(T) = S tau sum over segments of slope (exp(-(T - end)/tau) - exp(-(T - start)/tau))`, each
/// term from its closed form.
#[test]
fn the_filter_is_exact_on_straight_lines() {
    let force = zigzag(2500);
    let voltage = CIRCUIT.respond(&force);
    let tau = CIRCUIT.time_constant;
    for at in (0..2500).step_by(97).chain([2499]) {
        let now = force.time(at);
        let part = |i: usize| {
            let slope = (force.values[i + 1] - force.values[i]) / force.interval;
            let kept = (-(now - force.time(i + 1)) / tau).exp();
            slope * kept * -(-force.interval / tau).exp_m1()
        };
        let exact = CIRCUIT.sensitivity * tau * (0..at).map(part).sum::<f64>();
        assert!((voltage.values[at] - exact).abs() < 1e-12 * 10.0 * CIRCUIT.sensitivity, "{at}");
    }
}

#[test]
fn undone_droop_is_the_force_again() {
    let force = zigzag(2500);
    let felt = undo_droop(&CIRCUIT.respond(&force), CIRCUIT.time_constant);
    let worst = felt.values.iter().zip(&force.values);
    let worst = worst.map(|(f, n)| (f / CIRCUIT.sensitivity - n).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-9, "{worst:e} N");
}

/// 4,000 records of noise: a standard deviation from so many is good to 1.1 %.
#[test]
fn noise_and_baseline_grow_as_predicted() {
    let mut stream = Pcg64::new(11, 1);
    let checked = [0_usize, 500, 2499];
    let mut squares = [0.0; 3];
    let repeats = 4000;
    for _ in 0..repeats {
        let noise = (0..2500).map(|_| StandardNormal.sample(&mut stream)).collect();
        let felt = undo_droop(&trace(noise), CIRCUIT.time_constant);
        for (square, at) in squares.iter_mut().zip(checked) {
            *square += felt.values[at].powi(2);
        }
    }
    for (square, at) in squares.into_iter().zip(checked) {
        let found = (square / f64::from(repeats)).sqrt();
        let predicted = error_gain(at, 0.4e-6, CIRCUIT.time_constant).noise;
        assert!((found / predicted - 1.0).abs() < 0.05, "{at}: {found} {predicted}");
    }
    let off = undo_droop(&trace(vec![1.0; 2500]), CIRCUIT.time_constant);
    for at in checked {
        let predicted = error_gain(at, 0.4e-6, CIRCUIT.time_constant).baseline;
        assert!((off.values[at] / predicted - 1.0).abs() < 1e-12, "{at}");
        // 1 + T/tau, to what an interval more or less makes.
        let rule = 1.0 + at as f64 * 0.4e-6 / CIRCUIT.time_constant;
        assert!((predicted / rule - 1.0).abs() < 1e-3, "{at}");
    }
}
