//! The budget and the Monte-Carlo part.

use hertzscope::calibrate::equation::{InputKind, SpeedSource};
use hertzscope::calibrate::{Draws, calibrate};
use hertzscope::quantity::Uncertain;

use super::BENCH;

const DRAWS: Draws = Draws { seed: 4, count: 100_000 };

#[test]
fn the_budget_is_complete_and_monte_carlo_confirms_it() {
    let blind = BENCH.blind(7);
    let found = calibrate(&blind.strikes, &blind.common, DRAWS).expect("a calibration");
    let shares: f64 = found.budget.iter().map(|line| line.share).sum();
    assert!((shares - 1.0).abs() < 1e-12);
    let parts: f64 = found.budget.iter().map(|line| line.contribution.powi(2)).sum();
    assert!((parts.sqrt() / found.u - 1.0).abs() < 1e-12);
    let drawn = found.monte_carlo.expect("draws");
    // A standard deviation from 100,000 draws is good to 0.22 %.
    assert!(drawn.agrees && (drawn.u / found.u - 1.0).abs() < 0.01, "{drawn:?}");
    // Both intervals are told, and differ by no more than half a unit of the second digit of u
    // where 100,000 draws resolve it, else of the first.
    let [low, high] = drawn.propagated_95;
    assert!((0.5 * (high - low) / (1.96 * found.u) - 1.0).abs() < 0.01, "{drawn:?}");
    let apart = |end: usize| (drawn.interval_95[end] - drawn.propagated_95[end]).abs();
    assert!((apart(0).max(apart(1)) - drawn.difference).abs() < 1e-15);
    let first_digit = 10f64.powf(found.u.log10().floor());
    let tolerances = [0.05 * first_digit, 0.5 * first_digit];
    assert!(tolerances.iter().any(|t| (drawn.tolerance / t - 1.0).abs() < 1e-9), "{drawn:?}");
    assert_eq!(drawn.agrees, drawn.difference <= drawn.tolerance);
    let again = calibrate(&blind.strikes, &blind.common, DRAWS).expect("a calibration");
    assert_eq!(again, found, "the same seed gives the same");
    // Masses act in full, by their relative uncertainty.
    let mass = found.budget.iter().find(|line| line.kind == InputKind::Mass).expect("a mass");
    assert!(
        (mass.contribution.abs() / found.sensitivity / (mass.u / mass.value) - 1.0).abs() < 1e-6
    );
    let rebounds: Vec<f64> = found
        .budget
        .iter()
        .filter(|line| line.kind == InputKind::Rebound)
        .map(|line| line.contribution.abs() / found.sensitivity)
        .collect();
    // 1 % of half the momentum in each, by weights that add up to 1 and are close to even.
    assert_eq!(rebounds.len(), 6);
    let squares: f64 = rebounds.iter().map(|part| part * part).sum();
    assert!((rebounds.iter().sum::<f64>() / 0.005 - 1.0).abs() < 0.02, "{rebounds:?}");
    assert!((squares.sqrt() / (0.005 / 6f64.sqrt()) - 1.0).abs() < 0.05, "{rebounds:?}");
}

/// The same motion told as heights, gate times, flight times or speeds is the same momentum.
#[test]
fn ways_to_tell_a_speed_agree() {
    let mut blind = BENCH.blind(8);
    blind.common.gate_distance = Some(Uncertain::normal(20e-3, 20e-6));
    let plain = blind.calibrate().expect("a calibration").sensitivity;
    for strike in &mut blind.strikes {
        let SpeedSource::Speed(rebound) = strike.motion.rebound else { panic!("a speed") };
        let SpeedSource::Height(height) = strike.motion.incoming else { panic!("a height") };
        let incoming = (2.0 * 9.81 * height.value).sqrt();
        strike.motion.incoming = SpeedSource::GateTime(Uncertain::normal(20e-3 / incoming, 1e-6));
        strike.motion.rebound =
            SpeedSource::FlightTime(Uncertain::normal(2.0 * rebound.value / 9.81, 1e-4));
    }
    let other = blind.calibrate().expect("a calibration");
    // Weights differ with the uncertainties: a little of the scatter remains.
    assert!((other.sensitivity / plain - 1.0).abs() < 2e-3, "{} {plain}", other.sensitivity);
    let gates = other.budget.iter().filter(|line| line.kind == InputKind::GateDistance);
    assert_eq!(gates.count(), 1, "one distance for all");
}

/// A sensor whose sensitivity really changes with force shows it: records scaled by up to 10 % with
/// force.
#[test]
fn a_nonlinear_sensor_is_told() {
    let mut blind = BENCH.blind(9);
    let linear = blind.calibrate().expect("a calibration").nonlinearity.expect("three levels");
    assert!(linear.change.abs() < 3.0 * linear.u, "{linear:?}");
    for (index, strike) in blind.strikes.iter_mut().enumerate() {
        // Two from each height, the highest first.
        let factor = [1.10, 1.05, 1.00][index / 2];
        let trace = &mut strike.record.trace;
        trace.values.iter_mut().for_each(|v| *v *= factor);
    }
    let found = blind.calibrate().expect("a calibration");
    let change = found.nonlinearity.expect("three levels");
    assert!((change.change - linear.change - 0.10).abs() < 0.02, "{change:?} {linear:?}");
    assert!(found.notes.iter().any(|note| note.contains("changes by")), "{:?}", found.notes);
}

/// Effective degrees of freedom by Welch and Satterthwaite (JCGM 100:2008, G.4.1): where impacts
/// scatter, their part is known from the scatter of `n` impacts alone, and all else exactly. With
/// `u^2` the sum of the squares of all contributions, `u^4 (n - 1)/(impacts' part)^4`.
#[test]
fn degrees_of_freedom_are_those_of_the_scatter() {
    let mut blind = BENCH.blind(10);
    blind.common.gain = Uncertain::normal(1.0, 0.01);
    for (index, strike) in blind.strikes.iter_mut().enumerate() {
        let factor = if index % 2 == 0 { 1.02 } else { 0.98 };
        strike.record.trace.values.iter_mut().for_each(|v| *v *= factor);
    }
    let found = blind.calibrate().expect("a calibration");
    let used = found.impacts.iter().filter(|impact| impact.used).count();
    assert!(found.birge_ratio > 1.5 && used == 6, "{} {used}", found.birge_ratio);
    let squares = |lines: &dyn Fn(InputKind) -> bool| -> f64 {
        let lines = found.budget.iter().filter(|line| lines(line.kind));
        lines.map(|line| line.contribution.powi(2)).sum()
    };
    // The time constant is common to all: what a record's own inputs do to it is in their lines.
    let own = found.impacts.iter().filter_map(|impact| impact.own_uncertainty);
    let weights: f64 = own.clone().map(|u| u.powi(-2)).sum();
    let part = found.birge_ratio.powi(2) / weights;
    assert_eq!(found.half_width, 0.0);
    let expected = 5.0 * squares(&|_| true).powi(2) / part.powi(2);
    assert!((found.freedom / expected - 1.0).abs() < 1e-6, "{} {expected}", found.freedom);
    assert!(expected > 5.5, "{expected}");
}

/// The zero that all records of a quiet scope have in common acts on all impacts at once: an error
/// `e` of it takes `e T (1 + T/(2 tau))` from an integral over the window `T` whose droop is
/// undone.
#[test]
fn the_common_zero_of_a_quiet_scope_is_in_the_budget() {
    let mut setup = BENCH.setup.clone();
    setup.noise = 0.0;
    let circuit = BENCH.designer.circuit().expect("a circuit");
    let mut blind = BENCH.designer.blind(&BENCH.striker, &BENCH.truths, circuit, (&setup, 11));
    let tau = circuit.time_constant;
    blind.common.tau = Some(Uncertain::normal(tau, 1e-3 * tau));
    let found = blind.calibrate().expect("a calibration");
    let line = found.budget.iter().find(|line| line.kind == InputKind::Zero).expect("a line");
    let shares = found.impacts.iter().zip(&blind.strikes).map(|(result, strike)| {
        let impact = result.impact.as_ref().expect("a record");
        assert!(impact.has_common_zero);
        let [from, to] = impact.window;
        let window = to - from;
        let momentum = blind.common.momentum(&strike.motion, impact.duration);
        impact.baseline.uncertainty * window * (1.0 + window / (2.0 * tau)) / momentum
    });
    let (low, high) =
        shares.fold((f64::MAX, 0.0_f64), |(low, high), one| (low.min(one), high.max(one)));
    // A weighted mean lies between them; half a sample at each end is 1 % of the window.
    let contribution = line.contribution.abs();
    assert!((0.98 * low..=1.02 * high).contains(&contribution), "{low} {contribution} {high}");
}
