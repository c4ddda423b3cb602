//! The first pulse is none that chance makes of many samples.

use hertzscope::analysis::arrival::Estimator;
use hertzscope::analysis::pulse::{Conditions, Pulse};
use hertzscope::trace::Trace;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// A pulse of 0.85 V in noise of 0.08 V, 480 records: a quarter of its height is 2.7 standard deviations of noise, which some of 900 samples before it
/// pass; none is a first pulse.
#[test]
fn noise_is_no_first_pulse() {
    let interval = 1e-6;
    for seed in 0..480 {
        let mut numbers = Pcg64::new(seed, 7);
        let value = |i: u32| {
            let noise: f64 = StandardNormal.sample(&mut numbers);
            let along = (f64::from(i) - 900.0) / 120.0;
            let pulse = if (0.0..1.0).contains(&along) {
                0.85 * (std::f64::consts::PI * along).sin().powi(2)
            } else {
                0.0
            };
            (25.0 * (pulse + 0.08 * noise)).round() / 25.0
        };
        let values = (0..2500).map(value).collect();
        let trace = Trace {
            name: "CH1".to_owned(),
            unit: "V".to_owned(),
            start: -900.0 * interval,
            interval,
            values,
        };
        let conditions = Conditions { level: 0.04, time_constant: Some(1e-3), baseline: None };
        let Ok(pulse) = Pulse::find(&trace, conditions) else { continue };
        let Some(arrival) = pulse.arrival(Estimator::HalfRise) else { continue };
        assert!((arrival.value - 30e-6).abs() < 40e-6, "seed {seed}: {arrival:?}");
    }
}
