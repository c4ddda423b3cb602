//! One function for distances: the plates' offsets count wherever a speed is told.

use hertzscope::experiment::{Integration, run};
use hertzscope::measurement::compare::score_limits::ScoreLimits;
use hertzscope::measurement::compare::{Align, ComparedShot, compare};

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
