//! One function for distances: the plates' offsets count wherever a speed is told.

use hertzscope::experiment::{Integration, run};
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot, compare};
use hertzscope::predict::{SampleOptions, judge, uncertain_prediction};
use hertzscope::scene::Scene;
use hertzscope::scene::adjust::Adjustable;

use super::uncertain::only;
use super::{recorded, scene, surveyed};

const OFFSETS: &str = "sensors.p14.offset = 0.4\nsensors.p27.offset = -0.4\n";

/// From 14 to 27 the centres are 51.123 mm apart; 0.4 of a sphere of 4.76 mm below one centre and
/// 0.4 of a cylinder of 3.12 mm above the other leave 51.123 - 0.4 (4.76 + 3.12) = 47.971 mm, by
/// hand.
#[test]
fn speeds_use_the_plate_offset() {
    let scene = scene("magnet-0.61g", OFFSETS);
    let expected = 51.123e-3 - 0.4 * (4.76e-3 + 3.12e-3);
    let integration = Integration::Accuracy(1e-6);
    let summary = run(&scene, integration, 1, &mut |_| ()).expect("a run").summary;
    let run = summary.speeds.iter().find(|s| s.from_sensor == "p14" && s.to_sensor == "p27");
    let run = run.expect("a speed by half-rise");
    assert!((run.distance_m - expected).abs() < 1e-6, "{run:?}");
    let set = recorded(&scene, 1e-6);
    let found = surveyed(&set);
    let half = found.speeds.iter().find(|s| s.from == "CH2" && s.estimator == "half_rise");
    let half = half.expect("a speed");
    assert!((half.distance_m - run.distance_m).abs() < 1e-12, "{half:?}");
    // One draw of the noise: three deviations.
    assert!((half.m_per_s.value - run.m_per_s).abs() < 3.0 * half.m_per_s.u, "{half:?} {run:?}");
    let side = ComparedShot { name: "bench", set: &set, shot: &set.shots[0], scene: None };
    let limits = ScoreLimits::default();
    let held = compare(side, side, (Align::Trigger, &[]), &limits).expect("a comparison");
    let score = held.comparison.speeds.iter().find(|s| s.from == "CH2").expect("a speed");
    assert!((score.distance_m - run.distance_m).abs() < 1e-12, "{score:?}");
}

/// 2 % of a sphere's length is 95.2 um; of 51 mm and 300 us with 0.3 us that is more than the
/// arrivals' part.
#[test]
fn the_stated_uncertainty_of_an_offset_counts_in_speeds() {
    let text = "[uncertainty]\n\"sensors.*.offset\" = 0.0\n";
    let exact = scene("magnet-0.61g", text);
    let stated = scene("magnet-0.61g", &format!("{text}sensors.p14.offset = 0.02\n"));
    let speeds = [exact, stated].map(|scene| surveyed(&recorded(&scene, 1e-5)).speeds);
    let of = |place: usize| {
        let speed = speeds[place].iter().find(|s| s.from == "CH2" && s.estimator == "half_rise");
        speed.expect("a speed").clone()
    };
    let (exact, stated) = (of(0), of(1));
    assert_eq!(exact.distance_u_m, 0.0);
    assert!((stated.distance_u_m - 0.02 * 4.76e-3).abs() < 1e-12, "{stated:?}");
    let part = stated.m_per_s.value * stated.distance_u_m / stated.distance_m;
    assert!((stated.m_per_s.u / exact.m_per_s.u.hypot(part) - 1.0).abs() < 1e-9, "{stated:?}");
}

/// Standard uncertainty of the distance between the two sensors of a lying chain of `particles`
/// and `segments`, with this `[uncertainty]` (m).
fn distance_u(particles: &str, segments: &str, sensors: [&str; 2], uncertainty: &str) -> f64 {
    let [upper, lower] =
        sensors.map(|keys| format!("model = \"pzt-5a-710pf\"\nsensitivity_u = \"3 %\"\n{keys}"));
    let text = format!(
        "title = \"a chain\"\nduration = \"1 ms\"\n{particles}[chain]\norientation = \"lying\"\n\
        top = \"free\"\nbottom = \"free\"\nsegments = [{segments}]\n\
        [striker]\nmaterial = \"stainless_steel\"\ndiameter = \"9.5 mm\"\nspeed = \"0.3 m/s\"\n\
        [sensors.upper]\n{upper}\n[sensors.lower]\n{lower}\n\
        [scope]\nmodel = \"tds2014\"\ntime_base = \"50 us/div\"\n\
        trigger = {{ source = \"CH1\", level = \"2 V\" }}\n\
        ch1 = {{ input = \"upper\", scale = \"5 V/div\" }}\n\
        ch2 = {{ input = \"lower\", scale = \"5 V/div\" }}\n[uncertainty]\n{uncertainty}"
    );
    let scene = Scene::from_text("chain", "chain.toml", &text).expect("a scene");
    let place = |name: &str| scene.sensors.iter().find(|s| s.name == name).expect("one").place();
    scene.distance(place("upper"), place("lower")).expect("a distance").u
}

/// All by hand.
#[test]
fn stated_uncertainties_of_diameters_and_offsets_count_in_distances() {
    let kind = |name: &str, shape: &str| {
        format!("[particles.{name}]\nmaterial = \"stainless_steel\"\n{shape}\n")
    };
    let ball = kind("ball", "diameter = \"9.5 mm\"");
    let row = "{ particles = [\"ball\"], repeat = 24 }";
    let is = |found: f64, expected: f64| {
        assert!((found - expected).abs() < 1e-12, "{found}, expected {expected}");
    };
    // Nine whole balls and 0.5 - 0.1 and 0.5 - 0.2 of one, all of one diameter: 9.7 times 5 um.
    let shifted = ["particle = 7\noffset = 0.1", "particle = 17\noffset = -0.2"];
    is(distance_u(&ball, row, shifted, "particles.ball.diameter = \"5 um\"\n"), 48.5e-6);
    is(distance_u(&ball, row, shifted, "particles.\"*\".diameter = \"5 um\"\n"), 48.5e-6);
    // The same and 2 % of 9.5 mm at either plate, independent of each other: 190 um each.
    let offsets = "particles.ball.diameter = \"5 um\"\nsensors.\"*\".offset = ";
    let expected = 48.5e-6_f64.hypot(190e-6).hypot(190e-6);
    is(distance_u(&ball, row, shifted, &format!("{offsets}0.02\n")), expected);
    // Both plates 2 % further down leave the distance as it is.
    let together = "{ standard = 0.02, group = \"plates\" }";
    is(distance_u(&ball, row, shifted, &format!("{offsets}{together}\n")), 48.5e-6);
    // From ball 1 to cylinder 4: half a ball, a cylinder, a ball, half a cylinder: 1.5 of each.
    let two = format!("{ball}{}", kind("rod", "diameter = \"9.5 mm\"\nheight = \"6 mm\""));
    let turns = "{ particles = [\"ball\", \"rod\"], repeat = 4 }";
    let ends = ["particle = 1", "particle = 4\nhost = \"rod\""];
    let apart = "particles.ball.diameter = \"4 um\"\nparticles.rod.height = \"3 um\"\n";
    is(distance_u(&two, turns, ends, apart), 1.5 * 5e-6);
    let caliper = "particles.ball.diameter = { standard = \"4 um\", group = \"caliper\" }\n\
        particles.rod.height = { standard = \"3 um\", group = \"caliper\" }\n";
    is(distance_u(&two, turns, ends, caliper), 1.5 * 7e-6);
    // The width of a cylinder is not along the chain.
    is(distance_u(&two, turns, ends, "particles.rod.diameter = \"3 um\"\n"), 0.0);
    // Balls of 9.5, 4.75 and 2.375 mm, each so much off: half, one and half of them.
    let smaller = "{ particles = [\"ball\"], repeat = 3, factor = 0.5 }";
    let ends = ["particle = 1", "particle = 3"];
    let expected = (0.5 + 0.5 + 0.5 * 0.25) * 8e-6;
    is(distance_u(&ball, smaller, ends, "particles.ball.diameter = \"8 um\"\n"), expected);
    // A taper states its own diameters.
    let taper =
        "{ particles = [\"ball\"], repeat = 3, diameter = { from = \"8 mm\", to = \"6 mm\" } }";
    is(distance_u(&ball, taper, ends, "particles.ball.diameter = \"8 um\"\n"), 0.0);
}

/// `compare` counts the distance in the measured speed, but not in `E_n`: there the prediction has
/// other diameters, and so other delays.
#[test]
fn the_distance_counts_once_in_a_comparison() {
    let stated = "{ standard = \"1 %\", group = \"caliper\" }";
    let kinds = ["ptfe_sphere", "steel_cylinder", "ferromagnetic_sphere"];
    let lengths = kinds.map(|kind| {
        let key = if kind == "steel_cylinder" { "height" } else { "diameter" };
        (format!("particles.{kind}.{key}"), stated)
    });
    let lengths = lengths.each_ref().map(|(path, stated)| (path.as_str(), *stated));
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("test.toml");
    std::fs::write(&file, format!("base = \"magnet-0.61g\"\n{}", only(&lengths))).expect("a file");
    let mut adjustable = Adjustable::load(&file).expect("a scene");
    let set = recorded(&Scene::load(&file).expect("a scene"), 1e-5);
    let side = ComparedShot { name: "bench", set: &set, shot: &set.shots[0], scene: None };
    let limits = ScoreLimits::default();
    let mut compared = compare(side, side, (Align::Trigger, &[]), &limits).expect("a comparison");
    let score =
        compared.comparison.speeds.iter().find(|s| s.from == "CH2").expect("a speed").clone();
    // By hand: 6.5 spheres of 4.76 mm and 6.5 cylinders of 3.12 mm, all 1 % off together.
    assert!((score.distance_u_m - 0.01 * 51.22e-3).abs() < 1e-9, "{score:?}");
    let [measured, simulated] = [score.measured_m_per_s, score.simulated_m_per_s];
    let relative = score.distance_u_m / score.distance_m;
    let expected = simulated.u.hypot(relative * measured.value);
    assert!((measured.u / expected - 1.0).abs() < 1e-9, "{score:?}");
    let options = SampleOptions { samples: 100, seed: 1 };
    let predicted =
        uncertain_prediction(&mut adjustable, options, false, &|_| ()).expect("a prediction");
    let (errors, _) = judge(&mut compared, &predicted);
    let error = errors.iter().find(|e| e.quantity == "CH2 -> CH3 half-rise").expect("an error");
    assert!((error.measured.expect("one").u / simulated.u - 1.0).abs() < 1e-9, "{error:?}");
}

/// Two plates in particle 14: each by its name, and no decay within one host, nor between a sphere
/// and a cylinder.
#[test]
fn two_plates_in_one_particle_are_told_by_their_names() {
    let text = "sensors.p14.offset = 0.3\n[sensors.p14b]\nmodel = \"pzt-5a-710pf\"\nparticle = 14\noffset = -0.3\n\
        [scope.ch4]\ninput = \"p14b\"\nscale = \"1 V/div\"\nposition = \"-3 div\"\n";
    let scene = scene("magnet-0.61g", text);
    let summary = run(&scene, Integration::Accuracy(1e-5), 1, &mut |_| ()).expect("a run").summary;
    let mut labels: Vec<(String, String)> = summary
        .speeds
        .iter()
        .filter(|speed| speed.estimator == "peak")
        .map(|speed| (speed.from_sensor.clone(), speed.to_sensor.clone()))
        .collect();
    labels.sort();
    let expected = [("p14", "p27"), ("p14b", "p27"), ("p2", "p14"), ("p2", "p14b"), ("p2", "p27")];
    let expected = expected.map(|(from, to)| (from.to_owned(), to.to_owned()));
    assert_eq!(labels, expected);
    let page = hertzscope::report::summary(&summary);
    assert!(page.contains("p2 -> p14b") && page.contains("p14b -> p27"), "{page}");
    let found = surveyed(&recorded(&scene, 1e-5));
    let ends: Vec<(&str, &str)> =
        found.decays.iter().map(|decay| (decay.from.as_str(), decay.to.as_str())).collect();
    assert_eq!(ends, [("CH1", "CH4"), ("CH1", "CH2")], "spheres with spheres: {:?}", found.decays);
    // By hand: u(ln r / d) = u(r)/(r d) for distances without uncertainty, and d = -ln r / rate.
    for decay in &found.decays {
        let rate = decay.per_metre.expect("a rate");
        let distance = -decay.ratio.value.ln() / rate.value;
        let u = decay.ratio.u / decay.ratio.value / distance;
        assert!(rate.value > 0.0 && distance > 0.0 && u <= rate.u * 1.0001, "{decay:?}");
    }
}
