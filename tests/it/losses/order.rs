//! Orders across jumps, and methods for losses that are stiff.

use hertzscope::chain::{Chain, EndOfContact, LossKind, LossSpec};
use hertzscope::experiment::bench::Bench;
use hertzscope::motion::{Method, Scales, Scheme, System};

use super::{dashpot, simulate};
use crate::chains::{NEVER, kicked, pressed, ptfe_sphere, steel_cylinder};

/// Five bodies that only touch, with a dashpot: contacts close and open in turn.
fn rattling(gamma: f64) -> Chain {
    let particles = (0..5).map(|i| if i % 2 == 0 { ptfe_sphere() } else { steel_cylinder() });
    let mut spec = pressed(particles.collect(), 0.0, false);
    if gamma > 0.0 {
        let dashpot = LossSpec::everywhere(gamma, EndOfContact::ZeroOverlap);
        spec.effects = spec.effects.with_loss(LossKind::Dashpot, dashpot);
    }
    Chain::new(&spec).expect("a chain")
}

type Make = fn(f64) -> Method;

const SPEED: f64 = 0.3;
const TIME: f64 = 0.3e-3;

fn velocities(bench: &Bench<'_>) -> Vec<f64> {
    bench.state().velocity[..5].to_vec()
}

fn run(chain: &Chain, method: Method) -> Vec<f64> {
    let mut bench = kicked(chain, (0, SPEED), method, &[], NEVER);
    bench.run_until(TIME, false, &mut |_| ()).expect("a run");
    velocities(&bench)
}

fn farthest(found: &[f64], exact: &[f64]) -> f64 {
    found.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// The same contacts with the sign of the overlap for a flag, as a loop that knows no flags would
/// have it.
struct Unflagged {
    chain: Chain,
    gamma: f64,
}

impl System for Unflagged {
    fn len(&self) -> usize {
        self.chain.bodies().len()
    }

    fn accelerations(&mut self, position: &[f64], velocity: &[f64], acceleration: &mut [f64]) {
        acceleration.fill(0.0);
        for j in 1..self.len() {
            let overlap = position[j - 1] - position[j];
            if overlap > 0.0 {
                let elastic = self.chain.contacts()[j].force_change(overlap);
                let force = elastic + self.gamma * (velocity[j - 1] - velocity[j]);
                acceleration[j - 1] -= force / self.chain.bodies()[j - 1].mass;
                acceleration[j] += force / self.chain.bodies()[j].mass;
            }
        }
    }

    fn scales(&self, _position: &[f64], _velocity: &[f64]) -> Scales {
        Scales { position: 1e-6, velocity: SPEED }
    }
}

/// With contact flags as state and steps cut at their events, the fixed step keeps the order that
/// Hertz's own kink leaves (2.5: the force goes as `t^1.5` from where a contact closes); with the
/// sign of the overlap in their place it falls to 1.
#[test]
fn flags_keep_the_order_that_signs_lose() {
    let gamma = 2.0;
    let chain = rattling(gamma);
    let exact = run(&chain, Method::DormandPrince853 { tolerance: 1e-14 });
    let steps = [50_u32, 200, 800, 3200, 12800];
    let order = |errors: &[f64]| {
        let octaves = f64::from(steps[steps.len() - 1] / steps[0]).log2();
        (errors[0] / errors[errors.len() - 1]).log2() / octaves
    };
    let flagged: Vec<f64> = steps
        .iter()
        .map(|n| farthest(&run(&chain, Method::RungeKutta4 { step: TIME / f64::from(*n) }), &exact))
        .collect();
    let unflagged: Vec<f64> = steps
        .iter()
        .map(|n| {
            let system = Unflagged { chain: rattling(0.0), gamma };
            let method = Method::RungeKutta4 { step: TIME / f64::from(*n) };
            let mut state = chain.initial_state(&[SPEED, 0.0, 0.0, 0.0, 0.0]);
            state.position.truncate(5);
            state.velocity.truncate(5);
            let Scheme::General(scheme) = method.scheme() else { panic!("a lossless method") };
            let mut integrator = scheme.start(Box::new(system), state);
            while integrator.state().time < TIME {
                integrator.step(TIME).expect("a step");
            }
            farthest(&integrator.state().velocity, &exact)
        })
        .collect();
    println!(
        "flags {flagged:?}: {:.2}\nsigns {unflagged:?}: {:.2}",
        order(&flagged),
        order(&unflagged)
    );
    assert!(order(&flagged) > 2.2, "{flagged:?}");
    assert!(order(&unflagged) < 1.5, "{unflagged:?}");
}

/// Error-controlled methods keep to their tolerance across jumps, whatever the tolerance.
#[test]
fn tolerances_are_kept_across_jumps() {
    let chain = rattling(2.0);
    let exact = run(&chain, Method::DormandPrince853 { tolerance: 1e-14 });
    let methods: [Make; 3] = [
        |tolerance| Method::DormandPrince54 { tolerance },
        |tolerance| Method::DormandPrince853 { tolerance },
        |tolerance| Method::Rodas { tolerance },
    ];
    for make in methods {
        for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
            let error = farthest(&run(&chain, make(tolerance)), &exact) / SPEED;
            println!("{}: {error:.1e}", make(tolerance));
            // Some tens of steps may each be off by the tolerance.
            assert!(error < 50.0 * tolerance, "{}: {error:e}", make(tolerance));
        }
    }
}

/// From no loss to overdamped: the method that `--accuracy` chooses keeps to it, and where losses
/// are stiff it pays less than the explicit pair's stability would cost.
#[test]
fn dashpots_of_any_size_are_served() {
    for base in ["magnet-0.61g", "gravity-0.61g"] {
        for (gamma, implicit) in
            [(0.1, false), (1.0, false), (10.0, true), (100.0, true), (1000.0, true)]
        {
            for end in ["zero_overlap", "zero_force"] {
                let scene = dashpot(base, gamma, end);
                let tight = simulate(&scene, 1e-9);
                let found = simulate(&scene, 1e-6);
                println!(
                    "{base} {gamma} {end}: {} {}, {} {}",
                    found.method, found.force_evaluations, tight.method, tight.force_evaluations
                );
                assert_eq!(found.method == "rodas", implicit, "{base} {gamma}");
                for (reading, exact) in found.sensors.iter().zip(&tight.sensors) {
                    let (peak, true_peak) = (reading.first_peak, exact.first_peak);
                    let (Some(peak), Some(true_peak)) = (peak, true_peak) else {
                        assert_eq!(peak, true_peak, "{base} {gamma} {}", reading.name);
                        continue;
                    };
                    let off = [
                        peak.total_n / true_peak.total_n,
                        peak.time_s / true_peak.time_s,
                        reading.half_rise_s.expect("a rise") / exact.half_rise_s.expect("a rise"),
                    ]
                    .map(|ratio| (ratio - 1.0).abs());
                    println!("   {}: {off:?}", reading.name);
                    assert!(
                        off.iter().all(|d| *d <= 1e-6),
                        "{base} {gamma} {end} {}: {off:?}",
                        reading.name
                    );
                }
                // Each step may be off by what it tolerates.
                let (drift, bound) = (found.energy.drift.abs(), 0.25e-6 * found.steps as f64);
                assert!(drift < bound, "{base} {gamma}: {drift:e}");
                assert!(!implicit || found.force_evaluations < 10_000);
            }
        }
    }
}
