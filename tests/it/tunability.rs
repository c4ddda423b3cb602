//! The tunability map against closed forms: how band edges and speeds go with each knob.

use hertzscope::analysis::dispersion::DiatomicChain;
use hertzscope::report;
use hertzscope::scene::Scene;
use hertzscope::studies::tunability::{TuneError, Tuning, TuningParameter, tune};

fn turned(scene: &str, knob: TuningParameter, span: f64) -> Tuning {
    let scene = Scene::load(scene).expect("a shipped scene");
    let mut found = tune(&scene, &[knob], 3, span, &|_| ()).expect("a map");
    found.pop().expect("the knob")
}

/// Highest over lowest value of what `of` reads.
fn ratio(tuning: &Tuning, of: impl Fn(&DiatomicChain) -> f64) -> f64 {
    let chain = |index: usize| tuning.points[index].chain.as_ref().expect("a preload");
    of(chain(2)) / of(chain(0))
}

fn agrees(found: f64, expected: f64) {
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} is not {expected}");
}

#[test]
fn band_edges_go_with_each_knob_as_the_closed_forms_do() {
    let preload = turned("magnet-0.61g", TuningParameter::Preload, 4.0);
    // Below particle 2 the magnet, the ferromagnetic sphere and one PTFE sphere press.
    let weight = (0.45e-3 + 0.1226e-3) * 9.81;
    let forces = |factor: f64| 2.38 * factor + weight;
    let expected = (forces(4.0) / forces(0.25)).powf(1.0 / 6.0);
    agrees(ratio(&preload, DiatomicChain::gap_bottom), expected);
    agrees(ratio(&preload, DiatomicChain::cutoff), expected);
    // The scene's own value lies in the middle: 7122.383 Hz at 2.38 N.
    let middle = preload.points[1].chain.expect("a preload").gap_bottom();
    assert!((middle / (7122.383 * (forces(1.0) / 2.38).powf(1.0 / 6.0)) - 1.0).abs() < 1e-7);

    let heavy = turned("magnet-0.61g", TuningParameter::HeavyMass, 1.5);
    // Cylinders above the contact weigh next to nothing against 2.38 N, and none stands above the
    // first sensor.
    agrees(ratio(&heavy, DiatomicChain::gap_bottom), 1.5_f64.recip());
    agrees(ratio(&heavy, DiatomicChain::gap_top), 1.0);

    let light = turned("magnet-0.61g", TuningParameter::LightMass, 1.5);
    let pressed = |factor: f64| 2.38 + (0.45e-3 + factor * 0.1226e-3) * 9.81;
    let stiffer = (pressed(1.5) / pressed(1.0 / 1.5)).powf(1.0 / 6.0);
    agrees(ratio(&light, DiatomicChain::gap_top), stiffer / 1.5);
    agrees(ratio(&light, DiatomicChain::gap_bottom), stiffer);

    let modulus = turned("magnet-0.61g", TuningParameter::Modulus, 2.0);
    // A goes with 1/(compliance of PTFE + compliance of steel), frequencies with its cubic root.
    let compliance =
        |factor: f64| (1.0 - 0.46 * 0.46) / (1.46e9 * factor) + (1.0 - 0.3 * 0.3) / 193e9;
    let expected = (compliance(0.5) / compliance(2.0)).cbrt();
    agrees(ratio(&modulus, DiatomicChain::gap_bottom), expected);
}

/// Without preload and weight a chain has no scale of its own: times go with `s^(-1/5)`, so speeds
/// with `s^(1/5)`.
#[test]
fn speeds_in_a_sonic_vacuum_go_with_the_strikers_speed() {
    let speed = turned("monatomic-vacuum", TuningParameter::StrikerSpeed, 2.0);
    let found: Vec<f64> = speed.points.iter().map(|p| p.pulse_speed.expect("a pulse")).collect();
    for pair in found.windows(2) {
        // Runs are accurate to 1e-5 of their times.
        assert!((pair[1] / pair[0] / 2.0_f64.powf(0.2) - 1.0).abs() < 5e-5, "{found:?}");
    }
    assert!(speed.points.iter().all(|point| point.chain.is_none()), "no preload, no linear chain");
}

#[test]
fn a_pulse_beyond_the_gap_is_not_let_through() {
    // Under 23.8 N the lightest striker's pulse is weak: what is let through ends at f1.
    let preload = turned("magnet-0.61g", TuningParameter::Preload, 10.0);
    let point = &preload.points[2];
    let chain = point.chain.expect("a preload");
    let rows = report::transmitted(point, 40);
    let at = |frequency: f64| rows[(frequency / 500.0) as usize];
    let below = at(0.5 * chain.gap_bottom());
    let inside = at((chain.gap_bottom() * chain.gap_top()).sqrt());
    assert!(below > -30.0 && inside < below - 20.0, "{below} dB below, {inside} dB inside the gap");
}

#[test]
fn knobs_that_a_scene_lacks_are_refused_and_named() {
    let scene = Scene::load("gravity-0.61g").expect("a shipped scene");
    assert!(!TuningParameter::of(&scene).contains(&TuningParameter::Preload));
    let refused =
        tune(&scene, &[TuningParameter::Preload], 3, 2.0, &|_| ()).expect_err("no preload");
    assert!(matches!(refused, TuneError::NoKnob { .. }));
    let words = refused.to_string();
    assert!(
        words.contains("found no preload in gravity-0.61g") && words.contains("heavy-mass"),
        "{words}"
    );
}

#[test]
fn maps_show_edges_and_speeds() {
    let tunings = [turned("magnet-0.61g", TuningParameter::Preload, 10.0)];
    let page = report::tunability("a chain", &tunings);
    for words in ["preload (the scene has 2.38 N)", "238 mN", "23.8 N", "long waves", "pulse"] {
        assert!(page.contains(words), "{words} in\n{page}");
    }
    let row = page.lines().find(|line| line.contains('1') && line.contains('│'));
    assert!(row.is_some(), "an edge in the map\n{page}");
    let sheet = report::tunability_picture("a chain", &tunings);
    let svg = report::plot::svg(&sheet, report::plot::Theme::Light);
    for words in
        ["preload (N)", "frequency (kHz)", "speed (m/s)", "long waves, linear", "f3", "-60 dB"]
    {
        assert!(svg.contains(words), "{words}");
    }
}
