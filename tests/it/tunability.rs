//! The tunability map against closed forms: how band edges and speeds go with each number.

use hertzscope::analysis::dispersion::DiatomicChain;
use hertzscope::experiment::{Integration, run};
use hertzscope::measurement::metadata::cell;
use hertzscope::report;
use hertzscope::scene::adjust::Adjustable;
use hertzscope::scene::{Scene, Site};
use hertzscope::studies::tunability::{TunedNumber, Tuning, tune};

const PRELOAD: &str = "effects.magnet_preload.force";

fn tuned(mut scene: Adjustable, path: &str, span: f64) -> Tuning {
    let number = TunedNumber::at(&mut scene, path).expect("a number");
    let mut found = tune(&scene, vec![number], 3, span, &|_| ()).expect("a map");
    found.pop().expect("the number")
}

fn turned(scene: &str, path: &str, span: f64) -> Tuning {
    tuned(Adjustable::load(scene).expect("a shipped scene"), path, span)
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
    let preload = turned("magnet-0.61g", PRELOAD, 4.0);
    // Below particle 2 the magnet, the ferromagnetic sphere and one PTFE sphere press.
    let weight = (0.45e-3 + 0.1226e-3) * 9.81;
    let forces = |factor: f64| 2.38 * factor + weight;
    let expected = (forces(4.0) / forces(0.25)).powf(1.0 / 6.0);
    agrees(ratio(&preload, DiatomicChain::gap_bottom), expected);
    agrees(ratio(&preload, DiatomicChain::cutoff), expected);
    // The scene's own value lies in the middle: 7122.383 Hz at 2.38 N.
    let middle = preload.points[1].chain.expect("a preload").gap_bottom();
    assert!((middle / (7122.383 * (forces(1.0) / 2.38).powf(1.0 / 6.0)) - 1.0).abs() < 1e-7);

    let heavy = turned("magnet-0.61g", "particles.steel_cylinder.mass", 1.5);
    // Cylinders above the contact weigh next to nothing against 2.38 N, and none stands above the
    // first sensor.
    agrees(ratio(&heavy, DiatomicChain::gap_bottom), 1.5_f64.recip());
    agrees(ratio(&heavy, DiatomicChain::gap_top), 1.0);

    let light = turned("magnet-0.61g", "particles.ptfe_sphere.mass", 1.5);
    let pressed = |factor: f64| 2.38 + (0.45e-3 + factor * 0.1226e-3) * 9.81;
    let stiffer = (pressed(1.5) / pressed(1.0 / 1.5)).powf(1.0 / 6.0);
    agrees(ratio(&light, DiatomicChain::gap_top), stiffer / 1.5);
    agrees(ratio(&light, DiatomicChain::gap_bottom), stiffer);

    let modulus = turned("magnet-0.61g", "materials.ptfe.youngs_modulus", 2.0);
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
    let speed = turned("monatomic-vacuum", "striker.speed", 2.0);
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
    let preload = turned("magnet-0.61g", PRELOAD, 10.0);
    let point = &preload.points[2];
    let chain = point.chain.expect("a preload");
    let rows = report::transmitted(point, 40);
    let at = |frequency: f64| rows[(frequency / 500.0) as usize];
    let below = at(0.5 * chain.gap_bottom());
    let inside = at((chain.gap_bottom() * chain.gap_top()).sqrt());
    assert!(below > -30.0 && inside < below - 20.0, "{below} dB below, {inside} dB inside the gap");
}

/// Numbers that are varied without a choice, and a path that names nothing.
#[test]
fn paths_that_a_scene_lacks_are_refused_with_those_that_it_has() {
    let mut scene = Adjustable::load("gravity-0.61g").expect("a shipped scene");
    let numbers = TunedNumber::defaults(&mut scene).expect("numbers");
    let paths: Vec<&str> = numbers.iter().map(|number| number.path.as_str()).collect();
    assert_eq!(
        paths,
        [
            "particles.ferromagnetic_sphere.mass",
            "particles.ptfe_sphere.mass",
            "particles.steel_cylinder.mass",
            "striker.mass",
            "striker.speed",
            "materials.ptfe.youngs_modulus",
            "materials.stainless_steel.youngs_modulus",
        ]
    );
    let refused = TunedNumber::at(&mut scene, "striker.colour").expect_err("no colour").to_string();
    assert!(refused.contains("striker.colour") && refused.contains("speed"), "{refused}");
}

/// Two of the light spheres and one cylinder are heavier by what sits in them: the other sixteen
/// make the chain's period, `f = sqrt(2 beta/m)/(2 pi)` with the mass of a sphere without a sensor.
/// And what the map says of the scene itself is what a run says.
#[test]
fn band_edges_are_those_of_particles_without_sensors() {
    let hosts = "base = \"magnet-0.61g\"\n[sensors.p2]\nhost_mass = \"0.15 g\"\n\
                 [sensors.p14]\nhost_mass = \"0.15 g\"\n[sensors.p27]\nhost_mass = \"0.6 g\"\n";
    let scene = Scene::from_text("hosts", "hosts.toml", hosts).expect("a scene");
    // f1 = 7122.383 Hz at 2.38 N with 0.485 g; f2/f1 = sqrt(0.485/0.1226); 1.2 mN more weight above
    // the contact than in the plain scene move them by 4e-5.
    for (particle, above) in
        [(2, 0.45e-3 + 0.15e-3), (14, 0.45e-3 + 7.0 * 0.1226e-3 + 6.0 * 0.485e-3)]
    {
        let chain = cell(&scene, Site::Particle(particle)).expect("a cell");
        let force = 2.38 + above * 9.81;
        let bottom = 7122.383 * (force / 2.38_f64).powf(1.0 / 6.0);
        let top = bottom * (0.485_f64 / 0.1226).sqrt();
        assert!(
            (chain.gap_bottom() / bottom - 1.0).abs() < 1e-4,
            "{} {bottom}",
            chain.gap_bottom()
        );
        assert!((chain.gap_top() / top - 1.0).abs() < 1e-4, "{} {top}", chain.gap_top());
    }
    let outcome = run(&scene, Integration::Accuracy(1e-5), 1, &mut |_| ()).expect("a run");
    let peak = |index: usize| {
        outcome.summary.sensors[index].first_peak.as_ref().expect("a peak").dynamic_n
    };
    let adjustable = Adjustable::from_text("hosts", "hosts.toml", hosts).expect("a scene");
    let map = tuned(adjustable, "particles.ptfe_sphere.mass", 2.0);
    let ratio = map.points[1].transmission.expect("an arrival");
    assert!((ratio / (peak(2) / peak(0)) - 1.0).abs() < 1e-4, "{ratio}");
}

#[test]
fn maps_show_edges_and_speeds() {
    let tunings = [turned("magnet-0.61g", PRELOAD, 10.0)];
    let page = report::tunability("a chain", &tunings);
    for words in [
        "effects.magnet_preload.force (the scene has 2.38 N)",
        "238 mN",
        "23.8 N",
        "long waves",
        "pulse",
    ] {
        assert!(page.contains(words), "{words} in\n{page}");
    }
    let row = page.lines().find(|line| line.contains('1') && line.contains('│'));
    assert!(row.is_some(), "an edge in the map\n{page}");
    let sheet = report::tunability_picture("a chain", &tunings);
    let svg = report::plot::svg(&sheet, report::plot::Theme::Light);
    for words in [
        "effects.magnet_preload.force (N)",
        "frequency (kHz)",
        "speed (m/s)",
        "long waves, linear",
        "f3",
        "−60 dB",
    ] {
        assert!(svg.contains(words), "{words}");
    }
}
