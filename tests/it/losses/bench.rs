//! The bench with losses: a solution made elsewhere, and what losses do to speeds and oscillations.

use std::path::Path;

use hertzscope::chain::ForceProbe;
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::experiment::outcome::Reading;
use hertzscope::motion::Method;
use hertzscope::scene::Scene;
use serde_json::Value;

use super::{dashpot, simulate, viscoelastic};
use crate::chains::NEVER;

fn golden() -> Value {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/bench-goldens.json");
    let text = std::fs::read_to_string(path).expect("reference");
    let goldens: Value = serde_json::from_str(&text).expect("JSON");
    goldens["dissipative"]["gravity_0.61g_gamma0.5"].clone()
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

/// Gravity only, 0.61 g, 0.5 N s/m in every contact, which ends at zero overlap: forces with the
/// dashpots' part in them.
#[test]
fn dashpot_golden() {
    const ACCURACY: f64 = 1e-9;
    let golden = golden();
    let scene = dashpot("gravity-0.61g", 0.5, "zero_overlap");
    let summary = simulate(&scene, ACCURACY);
    for (reading, key) in summary.sensors.iter().zip(["p2", "p14", "p27"]) {
        let peak = reading.first_peak.expect("a peak");
        for (name, found) in [("F_total", peak.total_n), ("t", peak.time_s)] {
            let off = found / number(&golden[key][name]["value"]) - 1.0;
            println!("{key} {name}: {off:.1e}");
            assert!(off.abs() <= ACCURACY, "{key} {name}: {off:e}");
        }
    }
    assert!((summary.energy.initial / number(&golden["E0"]) - 1.0).abs() < 1e-14);
    // The state after 26 events, by a tighter run.
    let method = Method::DormandPrince853 { tolerance: 1e-14 };
    let mut bench = Bench::new(&scene.chain, &scene.initial_velocities, method, &[], NEVER, NEVER);
    bench.run_until(number(&golden["T"]), false, &mut |_| ()).expect("a run");
    let now = bench.energies().1;
    let end = now.total() / number(&golden["E_end"]["value"]) - 1.0;
    assert!(end.abs() < 2e-12, "{end:e}");
    let list = golden["u_end"].as_array().expect("a list");
    let stated = list.iter().map(|e| number(&e["err"])).fold(0.0, f64::max);
    for (body, (entry, u)) in list.iter().zip(&bench.state().position).enumerate() {
        let off = (number(&entry["value"]) - u).abs();
        assert!(off <= 2.0 * stated, "body {body}: {off:e} m, stated {stated:e}");
    }
}

/// Speed from particle 14 to 27 by the half-rise of the elastic part of the forces: the reference's
/// readings leave the losses' own part out, which a plate would feel.
fn elastic_speed(scene: &Scene, elastic: &Scene) -> f64 {
    let probe = |p: usize| ForceProbe::inside(&elastic.chain, p, 0.0).expect("a particle");
    let method = Method::DormandPrince853 { tolerance: 1e-8 };
    let velocities = &scene.initial_velocities;
    let probes = [probe(14), probe(27)];
    let mut bench = Bench::new(&scene.chain, velocities, method, &probes, NEVER, NEVER);
    bench.run_until(scene.duration, true, &mut |_| ()).expect("a run");
    let rises: Vec<f64> = bench
        .watches()
        .iter()
        .map(|w| Reading::of("", None, 0.0, &w.pulse).half_rise_s.expect("a rise"))
        .collect();
    elastic.chain.distance(14, 27) / (rises[1] - rises[0])
}

/// One dashpot raises the preloaded speed and lowers the unloaded one; Kuwabara and Kono's loss
/// that lowers the unloaded one as much does not raise the preloaded one.
#[test]
fn signs_of_the_speeds() {
    let change = |base: &str, lossy: &Scene| {
        let plain = Scene::load(base).expect("a scene");
        100.0 * (elastic_speed(lossy, &plain) / elastic_speed(&plain, &plain) - 1.0)
    };
    let dashpots = ["magnet-0.61g", "gravity-0.61g"]
        .map(|base| change(base, &dashpot(base, 3.0, "zero_overlap")));
    println!("dashpot: {dashpots:.2?} %");
    // To the digit printed, of speeds printed to four digits (170.9 m/s: 0.06 % of their ratio).
    for (found, expected) in dashpots.into_iter().zip([2.8, -6.8]) {
        assert!((found - expected).abs() < 0.05 + 0.06, "{found}, expected {expected}");
    }
    let viscoelastic = ["magnet-0.61g", "gravity-0.61g"]
        .map(|base| change(base, &viscoelastic(base, 2e-6, "zero_overlap")));
    println!("Kuwabara-Kono: {viscoelastic:.2?} %");
    assert!((viscoelastic[1] - dashpots[1]).abs() < 0.5, "{viscoelastic:?}");
    assert!(viscoelastic[0] < 0.0, "{viscoelastic:?}");
}

/// Entrance oscillations of the shock: mean frequency over the first five maxima of the elastic
/// force inside particle 2, heavy striker and magnet.
#[test]
fn entrance_oscillations_get_faster() {
    const INTERVAL: f64 = 50e-9;
    let plain = Scene::load("magnet-17.81g").expect("a scene");
    for (gamma, expected) in [(0.0, 10.5), (0.5, 11.5), (1.0, 12.5), (2.0, 15.1)] {
        let scene = dashpot("magnet-17.81g", gamma, "zero_overlap");
        let probe = ForceProbe::inside(&plain.chain, 2, 0.0).expect("a particle");
        let grid = Grid { start: 0.0, interval: INTERVAL };
        let method = Method::DormandPrince853 { tolerance: 1e-8 };
        let velocities = &scene.initial_velocities;
        let mut bench = Bench::new(&scene.chain, velocities, method, &[probe], grid, NEVER);
        bench.run_until(0.6e-3, false, &mut |_| ()).expect("a run");
        let force = &bench.watches()[0].samples;
        let maxima: Vec<f64> = (1..force.len() - 1)
            .filter(|i| force[*i] > force[i - 1] && force[*i] >= force[i + 1])
            .map(|i| i as f64 * INTERVAL)
            .collect();
        let frequency = 4.0 / (maxima[4] - maxima[0]) / 1e3;
        println!("{gamma} N s/m: {frequency:.2} kHz");
        assert!((frequency - expected).abs() < 0.06, "{gamma}: {frequency} kHz, not {expected}");
    }
}
