//! Momentum always, energy where nothing takes it.

use hertzscope::chain::{Chain, ForceProbe};
use hertzscope::experiment::bench::Bench;
use hertzscope::motion::Method;

use super::chains::{NEVER, diatomic, kicked, pressed, ptfe_sphere, steel_cylinder};

fn drift(bench: &Bench<'_>) -> f64 {
    let (before, now) = bench.energies();
    (now.total() - before.total()) / before.kinetic
}

/// Free ends, openings and closings, either method: forces come in pairs, so only rounding can
/// change momentum.
#[test]
fn momentum_is_conserved() {
    let particles: Vec<_> = (0..10).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    let chain = Chain::new(&pressed(particles, 0.0, false)).expect("a chain");
    for method in [
        Method::DormandPrince853 { tolerance: 1e-8 },
        Method::DormandElMikkawyPrince86 { tolerance: 1e-8 },
        Method::VelocityVerlet { step: 1e-6 },
        Method::ForceGradient { step: 5e-6 },
    ] {
        let mut bench = kicked(&chain, (0, 0.44), method, &[], NEVER);
        let before = chain.momentum(&bench.state());
        bench.run_until(2e-3, false, &mut |_| ()).expect("a run");
        let change = chain.momentum(&bench.state()) / before - 1.0;
        assert!(change.abs() < 1e-12, "{method}: {change:e}");
    }
}

/// The error control keeps energy to its tolerance although nothing in the method knows about
/// energy.
#[test]
fn adaptive_method_keeps_energy_to_its_tolerance() {
    let chain = diatomic(20, 2.38, false);
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let method = Method::DormandPrince853 { tolerance };
        let mut bench = kicked(&chain, (0, 0.2), method, &[], NEVER);
        bench.run_until(2e-3, false, &mut |_| ()).expect("a run");
        // A few hundred steps may each be off by the tolerance.
        let drift = drift(&bench);
        assert!(drift.abs() < 1e3 * tolerance, "{tolerance:e}: {drift:e}");
    }
}

/// With every contact closed, Verlet's energy error stays within a bound of order step squared: ten
/// times as long a run is no worse, half the step is four times better.
#[test]
fn verlet_energy_is_bounded_while_contacts_stay_closed() {
    let chain = diatomic(20, 2.38, false);
    let worst = |step: f64, end: f64| {
        let mut bench = kicked(&chain, (0, 0.05), Method::VelocityVerlet { step }, &[], NEVER);
        let mut worst = 0.0_f64;
        for part in 1..=200 {
            bench.run_until(end * f64::from(part) / 200.0, false, &mut |_| ()).expect("a run");
            worst = worst.max(drift(&bench).abs());
        }
        worst
    };
    let (short, long) = (worst(1e-6, 1e-3), worst(1e-6, 1e-2));
    assert!(long < 1.5 * short, "{short:e} became {long:e}");
    let finer = worst(0.5e-6, 1e-3);
    assert!((2.5..6.0).contains(&(short / finer)), "{short:e} and {finer:e}");
}

/// Where contacts open and close it is not: each time the force has a kink within a step, the
/// energy changes by a little, up as well as down, for good. Over many motions it wanders away as
/// the root of the time does, and less in shorter steps; the ledger tells it.
#[test]
fn verlet_energy_wanders_where_contacts_open() {
    let chain = diatomic(3, 0.5, false);
    // Root mean square over motions of what the energy is off, up and down within 2 ms averaged
    // out, at two times (1).
    let wandered = |step: f64, at: [f64; 2]| {
        let mut squares = [0.0; 2];
        for motion in 0..32_u8 {
            let kick = (0, 0.5 + 1e-3 * f64::from(motion));
            let mut bench = kicked(&chain, kick, Method::VelocityVerlet { step }, &[], NEVER);
            for (square, from) in squares.iter_mut().zip(at) {
                let mut sum = 0.0;
                for part in 1..=20 {
                    let time = from + 1e-4 * f64::from(part);
                    bench.run_until(time, false, &mut |_| ()).expect("a run");
                    sum += drift(&bench) / 20.0;
                }
                *square += sum * sum / 32.0;
            }
        }
        squares.map(f64::sqrt)
    };
    let [early, late] = wandered(4e-6, [0.02, 2.0]);
    let [_, finer] = wandered(1e-6, [0.02, 2.0]);
    println!("{early:.1e} after 20 ms, {late:.1e} after 2 s, {finer:.1e} by a fourth of the step");
    assert!((2.5..25.0).contains(&(late / early)), "{early:e}, {late:e}");
    assert!(finer < 0.2 * late, "{late:e}, {finer:e}");
}

/// Times that do not divide evenly leave a remainder of the rounding's size; a step of its own
/// would divide by it. The first peak of a force that is still rising is none.
#[test]
fn remainders_of_rounding_are_no_steps() {
    let chain = diatomic(10, 2.38, false);
    let probe = ForceProbe::inside(&chain, 9, 0.0).expect("a particle");
    for step in [25e-9, 50e-9, 100e-9] {
        for end in [120e-6, 150e-6, 180e-6] {
            let method = Method::VelocityVerlet { step };
            let mut bench = kicked(&chain, (0, 0.2), method, std::slice::from_ref(&probe), NEVER);
            bench.run_until(end, true, &mut |_| ()).expect("a run");
            let steps = (end / step).round() as u64;
            assert_eq!(bench.work().steps, steps, "{step:e} into {end:e}");
            let exact = Method::DormandPrince853 { tolerance: 1e-12 };
            let mut tight = kicked(&chain, (0, 0.2), exact, std::slice::from_ref(&probe), NEVER);
            tight.run_until(end, true, &mut |_| ()).expect("a run");
            let peaks = [&bench, &tight].map(|b| b.watches()[0].pulse.first_peak().is_some());
            assert_eq!(peaks[0], peaks[1], "{step:e} into {end:e}");
        }
    }
}

/// A step cut short by an interval's end starts a new count: no step is longer than the one chosen.
#[test]
fn no_step_is_longer_than_the_one_chosen() {
    let chain = diatomic(10, 2.38, false);
    let mut bench = kicked(&chain, (0, 0.2), Method::VelocityVerlet { step: 1e-6 }, &[], NEVER);
    bench.run_until(10.05e-6, false, &mut |_| ()).expect("a run");
    bench.run_until(20.05e-6, false, &mut |_| ()).expect("a run");
    assert_eq!(bench.work().steps, 11 + 10);
}
