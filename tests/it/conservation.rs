//! Momentum always, energy where nothing takes it.

use hertzscope::chain::Chain;
use hertzscope::experiment::bench::Bench;
use hertzscope::integrate::Method;

use super::chains::{NEVER, diatomic, kicked, pressed, ptfe_sphere, steel_cylinder};

fn drift(bench: &Bench<'_>) -> f64 {
    let (before, now) = bench.energies();
    (now.total() - before.total()) / before.kinetic
}

/// Free ends, openings and closings, either method: forces come in pairs, so only rounding can change momentum.
#[test]
fn momentum_is_conserved() {
    let particles: Vec<_> = (0..10).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    let chain = Chain::new(&pressed(particles, 0.0, false)).expect("a chain");
    for method in [
        Method::DormandPrince853 { tolerance: 1e-8 },
        Method::DormandElMikkawyPrince86 { tolerance: 1e-8 },
        Method::VelocityVerlet { step: 1e-6 },
        Method::BlanesMoan { step: 5e-6 },
    ] {
        let mut bench = kicked(&chain, (0, 0.44), method, &[], NEVER);
        let before = chain.momentum(bench.state());
        bench.run_until(2e-3, false, &mut |_| ()).expect("a run");
        let change = chain.momentum(bench.state()) / before - 1.0;
        assert!(change.abs() < 1e-12, "{method}: {change:e}");
    }
}

/// The error control keeps energy to its tolerance although nothing in the method knows about energy.
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

/// With every contact closed, Verlet's energy error stays within a bound of order step squared: ten times as long a run is no
/// worse, half the step is four times better.
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
