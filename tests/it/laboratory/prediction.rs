//! Disturbances that are predicted from the samples before a pulse.

use super::{Disturbance, Random};
use hertzscope::analysis::disturbance::{DisturbanceKind, KnownParts};

/// Samples of a record and those of its baseline, their interval (s) and their level (div).
const RECORD: (usize, usize, f64, f64) = (2500, 350, 1e-6, 0.04);

/// The predicted zero at a place (div), its standard uncertainty alone and with what a single
/// sample has of faster 1/f noise, the true value, and what was found.
fn predicted(
    disturbance: Disturbance,
    place: usize,
    random: &mut Random,
) -> (f64, [f64; 2], f64, Vec<DisturbanceKind>) {
    let (length, baseline, interval, level) = RECORD;
    let mut truth = vec![0.0; length];
    Disturbance { white: 0.0, ..disturbance }.add(&mut truth, interval, random);
    let shown =
        |value: &f64| ((value + disturbance.white * random.normal()) / level).round() * level;
    let values: Vec<f64> = truth.iter().take(baseline).map(shown).collect();
    let mut parts = KnownParts::new(length, interval, level, 0);
    parts.add(&values, 0, 40, &[]);
    let found = hertzscope::analysis::disturbance::Disturbance::of(&[parts])
        .and_then(|mut found| found.pop())
        .expect("a prediction");
    let squares: f64 = found.modes().iter().map(|mode| mode[place].powi(2)).sum();
    // A single sample: 1/f noise faster than what is predicted adds to the modes.
    let u = [squares.sqrt(), squares.sqrt().hypot(found.fast_noise(&[1.0]))];
    (found.values()[place], u, truth[place], found.found)
}

/// 300 records of each kind: of 95 % intervals for the zero 300 samples behind the baseline, 92 %
/// or more hold the truth (three standard deviations of the binomial below 96 %).
#[test]
fn predictions_contain_what_disturbs() {
    let white = Disturbance { zero: 0.14, ..Disturbance::white(0.02) };
    let rows = [
        ("white noise", white),
        ("hum 0.05", Disturbance { hum: 0.05, ..white }),
        ("hum 0.3 of 60 Hz", Disturbance { hum: 0.3, hum_frequency: 60.0, ..white }),
        ("drift 0.3", Disturbance { drift: 0.3, ..white }),
        ("1/f 0.05", Disturbance { pink: 0.05, ..white }),
        ("all three", Disturbance { hum: 0.1, drift: 0.2, pink: 0.02, ..white }),
    ];
    for (name, disturbance) in rows {
        let mut inside = 0;
        for seed in 0..300 {
            let random = &mut Random::new(90_000 + seed);
            let (found, [_, u], truth, _) = predicted(disturbance, 650, random);
            inside += u32::from((found - truth).abs() <= 1.96 * u);
        }
        println!("{name}: {inside} of 300");
        assert!(inside >= 276, "{name}: {inside} of 300");
    }
}

/// In white noise the zero's uncertainty behind the baseline grows by what a slope, if there were
/// one, could add: less than 4.8 times that of the mean, which a free slope makes (by hand, with
/// 475 samples from the middle: `sqrt(1 + 12 (475/350)^2)`).
#[test]
fn white_noise_hardly_loses() {
    let mut all: Vec<f64> = (0..100)
        .map(|seed| predicted(Disturbance::white(0.02), 650, &mut Random::new(seed)).1[0])
        .collect();
    all.sort_by(f64::total_cmp);
    let mean = (0.02_f64.powi(2) + 0.04_f64.powi(2) / 12.0).sqrt() / 350_f64.sqrt();
    println!("{} times", all[50] / mean);
    assert!(all[50] < 4.8 * mean && all[50] > mean);
}

/// What is strong is named, and white noise has no name.
#[test]
fn kinds_that_are_strong_are_named() {
    let white = Disturbance::white(0.02);
    let named = |disturbance| {
        let of = |seed| predicted(disturbance, 650, &mut Random::new(seed)).3;
        (0..20).map(of).collect::<Vec<_>>()
    };
    assert!(named(white).iter().filter(|found| !found.is_empty()).count() <= 1);
    let pink = named(Disturbance { pink: 0.1, ..white });
    assert!(pink.iter().filter(|found| found.contains(&DisturbanceKind::Pink)).count() >= 18);
}
