//! What eight bits and droop do to the spectra of the paper's scenes: simulated scope traces
//! against the forces behind them.

use std::f64::consts::TAU;

use hertzscope::analysis::droop::undo_droop;
use hertzscope::analysis::gate::Gate;
use hertzscope::analysis::spectrum::{Analyser, Spectrum, SpectrumSettings};
use hertzscope::experiment::{Integration, run};
use hertzscope::scene::Scene;
use hertzscope::trace::Trace;

/// Trace of the sensor at CH1, CH2 or CH3, particle 2, 14 or 27, in newtons: as captured, with its
/// droop undone, and the truth on the same times; a level (N), and the time constant (s).
fn signals(name: &str, place: usize) -> (Trace, Trace, Trace, [f64; 2]) {
    let scene = Scene::load(name).expect("a shipped scene");
    let outcome = run(&scene, Integration::Accuracy(1e-4), 1, &mut |_| ()).expect("a run");
    let shot = outcome.shot;
    let channel = scene.scope.channels[place].as_ref().expect("a channel");
    let circuit = scene.circuit(place, channel).expect("a sensor");
    let mut seen = shot.captures[place].trace().expect("over time");
    seen.values.iter_mut().for_each(|v| *v /= circuit.sensitivity);
    let restored = undo_droop(&seen, circuit.time_constant);
    let whole = shot
        .truth
        .iter()
        .find(|t| t.name.starts_with(&format!("sensor/{}", scene.sensors[place].name)))
        .expect("the truth");
    let trigger = shot.trigger_time.expect("a trigger");
    let first = ((trigger + seen.start - whole.start) / whole.interval).round() as usize;
    let rest = whole.values[0];
    let part = &whole.values[first..(first + seen.values.len()).min(whole.values.len())];
    let truth = Trace { values: part.iter().map(|f| f - rest).collect(), ..seen.clone() };
    let length = truth.values.len();
    seen.values.truncate(length);
    let restored = Trace { values: restored.values[..length].to_vec(), ..truth.clone() };
    let level = channel.vertical.scale / 25.0 / circuit.sensitivity;
    (seen, restored, truth, [level, circuit.time_constant])
}

fn spectrum(trace: &Trace) -> Spectrum {
    let gate = Gate { from: -100e-6, to: 1400e-6 };
    Analyser::new()
        .spectrum(trace, &SpectrumSettings { gate, ..SpectrumSettings::default() })
        .expect("a spectrum")
}

/// What droop and digitising may change in the coefficient at `frequency`: droop takes away `d(t)`,
/// slow, whose transform is at most its end and all its changes over `2 pi f T`; samples' noise,
/// 0.02 div and the rounding of a level, is averaged over the record.
fn allowed(seen: &Trace, restored: &Trace, frequency: f64, level: f64) -> f64 {
    let taken: Vec<f64> = restored.values.iter().zip(&seen.values).map(|(r, s)| r - s).collect();
    let changes: f64 = taken.windows(2).map(|pair| (pair[1] - pair[0]).abs()).sum();
    let slow = (changes + taken[taken.len() - 1].abs()) / (TAU * frequency * 1.5e-3);
    let noise = level * (0.5 * 0.5 + 1.0 / 12.0_f64).sqrt() / (1.5e-3 / seen.interval).sqrt();
    slow + 5.0 * noise
}

/// The highest coefficient above 2.5 kHz stays where it is and as high as it was, to what droop and
/// digitising may do. The mean, which is what the pulse carries on the whole, does not: droop is a
/// high-pass with its corner at 1/(2 pi tau), 157 Hz, and leaves what its own equation tells;
/// undoing the droop brings it back.
#[test]
fn lines_stay_and_the_mean_goes() {
    let scenes = ["magnet-0.61g", "magnet-2.75g", "magnet-17.81g", "gravity-0.61g"];
    for (name, place) in scenes.into_iter().flat_map(|name| (0..3).map(move |place| (name, place)))
    {
        let (seen, restored, truth, [level, tau]) = signals(name, place);
        let [s, r, t] = [&seen, &restored, &truth].map(spectrum);
        let high = |s: &Spectrum| s.highest_between(2.5e3, 20e3).expect("bins");
        let ((bin, amplitude), (bin_seen, amplitude_seen)) = (high(&t), high(&s));
        let moved = (s.frequency(bin_seen) - t.frequency(bin)).abs();
        let mean = |spectrum: &Spectrum| spectrum.amplitude[0] / t.amplitude[0];
        let allowed = allowed(&seen, &restored, t.frequency(bin), level);
        println!(
            "| {name} | CH{} | {:.2} kHz | {moved:.0} Hz | {:+.1} % | {:.1} % | {:+.0} % | {:+.1} % |",
            place + 1,
            t.frequency(bin) / 1e3,
            100.0 * (amplitude_seen / amplitude - 1.0),
            100.0 * allowed / amplitude,
            100.0 * (mean(&s) - 1.0),
            100.0 * (mean(&r) - 1.0)
        );
        assert!(moved <= t.resolution, "{name} {place}: {moved}");
        assert!(
            (amplitude_seen - amplitude).abs() < allowed,
            "{name} {place}: {amplitude_seen} {amplitude}"
        );
        // V' + V/tau = S N', summed over the gate: droop leaves of the mean what its own time
        // constant tells.
        let gate = Gate { from: -100e-6, to: 1400e-6 }.range(&truth);
        let (first, last) = (gate.start, gate.end - 1);
        let taken = |i: usize| truth.values[i] - seen.values[i];
        let left = (tau * (taken(last) - taken(first)) / 1.5e-3).abs();
        let noise = level * (0.5 * 0.5 + 1.0 / 12.0_f64).sqrt() * 2.0_f64.sqrt() * tau / 1.5e-3;
        let off = s.amplitude[0] - left;
        assert!(off.abs() < 5.0 * noise, "{name} {place}: {off} N, noise {noise} N");
        assert!((mean(&r) - 1.0).abs() < 0.03, "{name} {place}: {}", mean(&r));
    }
}
