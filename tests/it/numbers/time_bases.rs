//! In Sample mode at slow time bases the circuit and the trigger still see the signal.

use hertzscope::experiment::{Integration, run};

use super::scene;

/// What a momentum test leaves behind its contact: the charge that has leaked during it, `-S I/tau`
/// of the impulse `I`, decaying with `tau`. Computed from the true force by the circuit's equation
/// in small steps.
#[test]
fn slow_time_bases_trigger_and_show_the_undershoot() {
    for (base, late) in [("5 ms/div", 100e-6), ("10 ms/div", 200e-6)] {
        let text =
            format!("duration = \"20 ms\"\n[scope]\ntime_base = \"{base}\"\nposition = \"0 s\"\n");
        let mut scene = scene("momentum-test", &text);
        let channel = scene.scope.channels[0].clone().expect("a channel");
        let circuit = scene.circuit(0, &channel).expect("a circuit");
        let (mut off, mut count) = (0.0, 0.0);
        for seed in 0..20 {
            scene.seed = seed;
            let shot =
                run(&scene, Integration::Accuracy(1e-4), 1, &mut |_| ()).expect("a run").shot;
            assert_eq!(shot.captures.len(), 1, "{base}, seed {seed}: not triggered");
            let force = shot.truth.iter().find(|t| t.name.starts_with("sensor/")).expect("forces");
            let still = force.values[0];
            let volts = shot.captures[0].trace().expect("volts");
            let trigger = shot.trigger_time.expect("a trigger");
            for index in 0..volts.values.len() {
                let time = volts.time(index);
                if !(late..late + 300e-6).contains(&time) {
                    continue;
                }
                // V(t) = S (N(t) - 1/tau integral of N(s) exp(-(t-s)/tau) ds).
                let tau = circuit.time_constant;
                let until = |s: f64| (s - trigger - time) / tau;
                let parts =
                    force.values.iter().enumerate().map(|(i, n)| (force.time(i), n - still));
                let before = parts.filter(|(s, _)| *s <= trigger + time);
                let leaked: f64 =
                    before.map(|(s, n)| n * until(s).exp()).sum::<f64>() * force.interval / tau;
                off += volts.values[index] + circuit.sensitivity * leaked;
                count += 1.0;
            }
        }
        // Noise of half a level and rounding, over the root of some hundred samples: a tenth of a
        // level of 40 mV.
        let off: f64 = off / count;
        assert!(off.abs() < 4e-3, "{base}: {off} V off on average of {count}");
    }
}
