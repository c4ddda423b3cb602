//! A thousand calibrations that do not know the truth. The same at will:
//! `hertzscope calibrate --simulate SENSOR --repeat 1000`.

use hertzscope::calibrate::blind::coverage;
use hertzscope::calibrate::design::Designer;
use hertzscope::calibrate::simulation::strike;
use hertzscope::quantity::Uncertain;
use hertzscope::scene::plan::lab::Laboratory;

use super::{BENCH, bench_with, shipped_lab};

/// Six impacts through droop and eight bits, sensor and scope as one chain; other sensor, phase,
/// readings and noise each time. The coverage of a true 95 % interval scatters by 0.7 % among a
/// thousand.
#[test]
fn stated_intervals_hold_the_truth() {
    let found = coverage(&BENCH.designer, &BENCH.candidate, 1000, 1, &mut |_| ()).expect("a test");
    println!("{found:?}");
    assert_eq!((found.repeats, found.failed), (1000, 0));
    assert!(found.bias.abs() < 1e-3, "bias {}", found.bias);
    // Impacts scatter as stated here. The Birge ratio counts from 1, with Student's t: 0.970 are
    // covered by six impacts whose own inputs make nearly all of the variance (computed apart from
    // this program, 6000 draws); a thousand scatter by 0.5 %.
    assert!((0.955..=0.985).contains(&found.coverage_95), "coverage {}", found.coverage_95);
    // The largest of a thousand has a ratio of 2 by chance.
    assert!(found.mean_expanded <= 0.01 && found.largest_expanded <= 0.03, "U {found:?}");
    assert!(found.tau_bias.abs() < 1e-3, "tau {}", found.tau_bias);
    // The raw voltage's integral is off by far more than it would claim.
    assert!(found.naive_bias < -0.06 && found.naive_coverage_95 == 0.0, "{}", found.naive_bias);
}

/// A gain known to 3 % is one input for all impacts: it does not average out.
#[test]
fn a_gain_does_not_average_out() {
    let lab = Laboratory { gain: Some(Uncertain::normal(1.0, 0.03)), ..shipped_lab() };
    let bench = bench_with(lab, 2.0, 3);
    let found = bench.blind(1).calibrate().expect("a calibration");
    let relative = found.u / found.sensitivity;
    assert!(relative > 0.03 && relative < 0.0305, "{relative}");
    let gain = found.budget.iter().find(|line| line.name == "scope gain").expect("a line");
    assert!(
        gain.share > 0.97 && (gain.contribution / (0.03 * found.sensitivity) - 1.0).abs() < 1e-9
    );
}

/// What the impact really was: Hertz's two-body collision, closed form, and momentum that balances.
#[test]
fn simulated_impacts_balance_and_obey_hertz() {
    let (m, anvil) = (1.22e-3_f64, 10.0);
    let compliance = |e: f64, nu: f64| (1.0 - nu * nu) / e;
    let modulus = 1.0 / (compliance(1.46e9, 0.46) + compliance(193e9, 0.30));
    let stiffness = 4.0 / 3.0 * modulus * 2.38e-3_f64.sqrt();
    let reduced = m * anvil / (m + anvil);
    for truth in &BENCH.truths {
        let v = truth.incoming;
        let overlap = (1.25 * reduced * v * v / stiffness).powf(0.4);
        let duration = 2.943275184324705 * overlap / v;
        let peak = truth.force.values.iter().copied().fold(0.0, f64::max);
        // Weight presses on: g T/v is 0.2 % to 0.5 % of the speed.
        let weight = 9.81 * duration / v;
        assert!((truth.duration / duration - 1.0).abs() < weight, "{} {duration}", truth.duration);
        assert!((peak / (stiffness * overlap.powf(1.5)) - 1.0).abs() < weight);
        let impulse: f64 = truth.force.values.iter().sum::<f64>() * truth.force.interval;
        let momentum = m * (v + truth.rebound) + m * 9.81 * truth.duration;
        assert!((impulse / momentum - 1.0).abs() < 1e-5, "{impulse} {momentum}");
        // The anvil takes m/M of the speed, twice.
        assert!((truth.rebound / v - 1.0 + 2.0 * m / anvil).abs() < 1e-5, "{}", truth.rebound / v);
    }
}

/// On the moon the anvil floats on its weight there. Two bodies that gravity alone pulls part as
/// fast as they met, and their momentum grows by `m g T`: the striker goes back with
/// `(v (M - m) - m g T)/(M + m)`. Support for another gravity would add `(9.81 - 1.62) T`, a
/// thousandth of the speed.
#[test]
fn an_anvil_floats_in_the_laboratorys_own_gravity() {
    let (m, anvil, gravity) = (BENCH.striker.mass.value, 10.0, 1.62);
    let speed = 0.5;
    let truth = strike(&BENCH.striker, speed, gravity).expect("an impact");
    let expected = (speed * (anvil - m) - m * gravity * truth.duration) / (anvil + m);
    assert!((truth.rebound / expected - 1.0).abs() < 1e-5, "{} {expected}", truth.rebound);
}

/// The progress of the search for a design rises to 1 and not beyond.
#[test]
fn the_progress_of_a_search_ends_at_one() {
    let lab = shipped_lab();
    let lab =
        Laboratory { strikers: lab.strikers[..2].to_vec(), heights: vec![5e-3, 10e-3], ..lab };
    let designer = Designer::new("pzt-5a-710pf", lab, 1).expect("a shipped sensor");
    let mut seen = Vec::new();
    designer.search(&mut |done| seen.push(done)).expect("impacts");
    assert_eq!(seen, [0.25, 0.5, 0.75, 1.0]);
}
