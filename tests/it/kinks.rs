//! Contacts that open and close: what they do to the order of a method, and that the stepper puts it right.

use hertzscope::chain::stepper::{ChainStepper, InstructionSet};
use hertzscope::integrate::{Integrator, Method, Pair, Scheme, State};
use hertzscope::scene::Scene;

const PAIRS: [Pair; 2] = [Pair::DormandElMikkawyPrince64, Pair::DormandElMikkawyPrince86];

/// Largest difference of velocities, relative to the largest (1).
fn distance(a: &State, b: &State) -> f64 {
    let scale = b.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let pairs = a.velocity.iter().zip(&b.velocity);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / scale
}

fn run(integrator: &mut dyn Integrator, end: f64) -> (State, u64) {
    while integrator.time() < end {
        integrator.step(end).expect("a step");
    }
    (integrator.state(), integrator.work().force_evaluations)
}

/// A striker that bounces makes much of little: what a state is off by at 0.2 ms, after the striker has let go, is tens of times as much
/// at 0.4 ms, after it has come back. That is the chain's doing and not the stepper's: followed exactly, the stepper's own state at
/// 0.2 ms ends up as far off.
#[test]
fn a_bouncing_striker_amplifies_what_is_off() {
    let scene = Scene::load("magnet-0.61g").expect("a shipped scene");
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let exactly = |state: State, end: f64| {
        let method = Method::DormandPrince853 { tolerance: 1e-14 };
        run(method.start(chain.system(velocities), state).as_mut(), end).0
    };
    let let_go = exactly(chain.initial_state(velocities), 2e-4);
    let exact = exactly(let_go.clone(), 4e-4);
    for pair in PAIRS {
        for tolerance in [1e-3, 1e-5, 1e-7] {
            let set = InstructionSet::best();
            let mut stepper =
                ChainStepper::new(chain, velocities, Scheme::Pair(pair, tolerance), set);
            let (early, _) = run(&mut stepper, 2e-4);
            let bound = tolerance * (stepper.work().steps as f64).sqrt();
            let off = distance(&early, &let_go);
            assert!(
                off < bound,
                "{} {tolerance:e}: {off:e}, at most {bound:e}",
                pair.coefficients().name
            );
            let growth = distance(&exactly(early, 4e-4), &exact) / off;
            let (late, _) = run(&mut stepper, 4e-4);
            let error = distance(&late, &exact);
            println!(
                "{} {tolerance:e}: {off:.1e}, then {error:.1e}; grows {growth:.0} times",
                pair.coefficients().name
            );
            assert!(
                error < growth * bound,
                "{} {tolerance:e}: {error:e}",
                pair.coefficients().name
            );
        }
    }
}

/// Gravity alone: hundreds of openings. Against Dormand and Prince's pair of order 8, which
/// knows nothing of contacts, errors of single steps add up like random ones, and tight tolerances take fewer evaluations than the
/// same pair needs without its corrections.
#[test]
fn corrections_keep_the_tolerance_and_save_evaluations() {
    let end = 1e-3;
    let scene = Scene::load("gravity-0.61g").expect("a shipped scene");
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let general = |method: Method| {
        let state = chain.initial_state(velocities);
        run(method.start(chain.system(velocities), state).as_mut(), end)
    };
    let (exact, _) = general(Method::DormandPrince853 { tolerance: 1e-14 });
    for pair in PAIRS {
        for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
            let bare = match pair {
                Pair::DormandElMikkawyPrince64 => Method::DormandElMikkawyPrince64 { tolerance },
                Pair::DormandElMikkawyPrince86 => Method::DormandElMikkawyPrince86 { tolerance },
            };
            let (_, without) = general(bare);
            for set in InstructionSet::available() {
                let mut stepper =
                    ChainStepper::new(chain, velocities, Scheme::Pair(pair, tolerance), set);
                let (state, with) = run(&mut stepper, end);
                let error = distance(&state, &exact);
                println!(
                    "{} {tolerance:e} {}: error {error:.1e}, {with} evaluations, {without} without",
                    pair.coefficients().name,
                    set.name()
                );
                let bound = tolerance * (stepper.work().steps as f64).sqrt();
                assert!(error < bound, "{tolerance:e}: {error:e}, at most {bound:e}");
                assert!(tolerance > 1e-6 || 5 * with < 4 * without, "{with} of {without}");
            }
        }
    }
}
