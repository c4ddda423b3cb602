//! Chains at rest stay at rest, to the last bit, by every method: static forces balance exactly.

use hertzscope::chain::End;
use hertzscope::chain::{
    Chain, ChainSpec, EffectsSpec, EndOfContact, Gravity, LossKind, LossSpec, MagnetForce,
    MagnetPreload,
};
use hertzscope::experiment::bench::Bench;
use hertzscope::motion::{IntegrateError, Method};

use crate::chains::{NEVER, STEEL, body, pressed, ptfe_sphere, steel_cylinder};

/// How long the chains are followed (s).
const DURATION: f64 = 1e-4;
/// Fixed steps, short enough for all of the chains (s).
const STEP: f64 = 1e-7;
/// Tolerated error of a step (1).
const TOLERANCE: f64 = 1e-6;

/// Methods of fixed step, and the splitting with two step sizes.
const FIXED: [Method; 4] = [
    Method::VelocityVerlet { step: STEP },
    Method::RungeKutta4 { step: STEP },
    Method::ForceGradient { step: STEP },
    Method::TwoStepForceGradient { tolerance: TOLERANCE },
];
/// Methods under error control.
const ADAPTIVE: [Method; 3] = [
    Method::DormandPrince54 { tolerance: TOLERANCE },
    Method::DormandPrince853 { tolerance: TOLERANCE },
    Method::DormandElMikkawyPrince86 { tolerance: TOLERANCE },
];

fn standing(particles: usize, gravity: f64, magnet: Option<(usize, f64)>) -> ChainSpec {
    let bead = |i: usize| if i.is_multiple_of(2) { ptfe_sphere() } else { steel_cylinder() };
    let effects = EffectsSpec {
        gravity: (gravity != 0.0).then_some(Gravity { acceleration: gravity }),
        magnet_preload: magnet.map(|(particle, force)| MagnetPreload {
            particle,
            force: MagnetForce::Constant(force),
        }),
        ..EffectsSpec::default()
    };
    let particles = (0..particles).map(bead).collect();
    ChainSpec { bottom: End::Wall(STEEL), effects, ..pressed(particles, 0.0, false) }
}

/// Chains with names: preloaded or not, on a wall, squeezed, between walls, of one bead and of
/// many.
fn chains() -> Vec<(&'static str, ChainSpec)> {
    let odd = |count| {
        (0..count)
            .map(|i| {
                body("b", 1e-4 * (1.0 + f64::from(i)), Some(2e-3 + 1e-4 * f64::from(i)), STEEL)
            })
            .collect()
    };
    let walls = |preload| ChainSpec {
        top: End::Wall(STEEL),
        bottom: End::Wall(STEEL),
        wall_preload: preload,
        ..pressed(odd(7), 0.0, false)
    };
    vec![
        ("one bead under gravity", standing(1, 9.81, None)),
        ("gravity", standing(21, 9.81, None)),
        ("magnet", standing(21, 0.0, Some((1, 2.0)))),
        ("gravity and a magnet in the middle", standing(9, 9.81, Some((5, 0.7)))),
        ("squeezed", pressed(odd(12), 33.0, false)),
        ("squeezed, linearised", pressed(odd(12), 33.0, true)),
        ("merely touching", pressed(odd(6), 0.0, false)),
        ("between preloaded walls", walls(5.0)),
        ("between walls without preload", walls(0.0)),
        ("a hundred beads under gravity", standing(101, 9.81, None)),
    ]
}

/// Runs the chain at rest; its displacements and velocities must all be zero in the end.
fn rests(name: &str, chain: &Chain, method: Method) -> Result<(), IntegrateError> {
    let velocities = vec![0.0; chain.bodies().len()];
    let mut bench = Bench::new(chain, &velocities, method, &[], NEVER, NEVER);
    bench.run_until(DURATION, false, &mut |_| ())?;
    let state = bench.state();
    let moved = state.position.iter().chain(&state.velocity).any(|value| *value != 0.0);
    assert!(!moved, "{name} by {method}: {state:?}");
    Ok(())
}

/// Failures of all chains by all methods, one line each.
fn failures(chains: &[(&str, ChainSpec)], methods: &[Method]) -> Vec<String> {
    let mut failures = Vec::new();
    for (name, spec) in chains {
        let chain = Chain::new(spec).expect("a chain");
        for method in methods {
            if let Err(error) = rests(name, &chain, *method) {
                failures.push(format!("{name} by {method}: {error}"));
            }
        }
    }
    failures
}

#[test]
fn chains_at_rest_stay_at_rest_in_fixed_steps() {
    let failures = failures(&chains(), &FIXED);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn chains_at_rest_stay_at_rest_under_error_control() {
    let failures = failures(&chains(), &ADAPTIVE);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The chains with a dashpot and Kuwabara and Kono's loss, for both ends of a contact.
fn lossy_chains() -> Vec<(&'static str, ChainSpec)> {
    let mut all = Vec::new();
    for end in [EndOfContact::ZeroOverlap, EndOfContact::ZeroForce] {
        for (name, mut spec) in chains() {
            if spec.effects.linearised_contacts.is_none() {
                let loss = |value| LossSpec::everywhere(value, end);
                spec.effects = spec.effects.with_loss(LossKind::Dashpot, loss(0.5));
                spec.effects = spec.effects.with_loss(LossKind::KuwabaraKono, loss(1e-6));
                all.push((name, spec));
            }
        }
    }
    all
}

#[test]
fn chains_with_losses_at_rest_stay_at_rest_in_fixed_steps() {
    let failures = failures(&lossy_chains(), &[Method::RungeKutta4 { step: STEP }]);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

#[test]
fn chains_with_losses_at_rest_stay_at_rest_under_error_control() {
    let methods = [ADAPTIVE[0], ADAPTIVE[1], Method::Rodas { tolerance: TOLERANCE }];
    let failures = failures(&lossy_chains(), &methods);
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
