//! What the stepper does on its own account changes what it is to change, and nothing else.

use hertzscope::chain::Chain;
use hertzscope::chain::stepper::{ChainStepper, InstructionSet, Refinement};
use hertzscope::experiment::bench::Bench;
use hertzscope::experiment::for_accuracy;
use hertzscope::integrate::{Integrator, Method, Pair, Scheme, State, Work};
use hertzscope::scene::Scene;

use super::chains::{NEVER, diatomic};

/// A chain of 300 cells under `force` (N), its first bead kicked, after `time` (s).
fn after(force: f64, method: Method, without: Option<Refinement>, time: f64) -> (State, Work) {
    follow(&diatomic(300, force, false), method, without, time)
}

/// `chain`, its first bead kicked, after `time` (s).
fn follow(chain: &Chain, method: Method, without: Option<Refinement>, time: f64) -> (State, Work) {
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = 0.4;
    let mut bench = Bench::new(chain, &velocities, method, &[], (NEVER, NEVER));
    if let Some(refinement) = without {
        bench = bench.without(refinement);
    }
    bench.run_until(time, false, &mut |_| ()).expect("a run");
    (bench.state(), bench.work())
}

/// Beads ahead of the wave are left alone, and no bit changes where rounding hides what is ahead: of a wave on its way, and of one that has come
/// back.
#[test]
fn the_quiet_part_changes_no_bit() {
    for force in [0.0, 2.38] {
        for (method, time) in [
            (for_accuracy(1e-3), 1e-3),
            (for_accuracy(1e-6), 3e-3),
            (for_accuracy(1e-9), 30e-3),
            (Method::BlanesMoan { step: 5e-6 }, 2e-3),
            (Method::ForceGradient { step: 5e-6 }, 2e-3),
            (Method::VelocityVerlet { step: 1e-6 }, 30e-3),
        ] {
            let (with, work) = after(force, method, None, time);
            let (all, same_work) = after(force, method, Some(Refinement::QuietPart), time);
            let moved = all.velocity.iter().filter(|v| **v != 0.0).count();
            println!("{force} N, {method}, {time} s: {moved} of {} move", all.velocity.len());
            assert_eq!(work, same_work);
            assert_eq!(with, all, "{force} N, {method}");
            // Otherwise there would have been nothing to leave alone.
            assert_eq!(moved < all.velocity.len() / 2, time < 5e-3, "{moved}");
        }
    }
}

/// Linear contacts, and forces without cancellation, send something ahead of the wave however far: what is below 1e-30 of the first bead's
/// speed is left alone, and nothing else changes by more.
#[test]
fn what_nobody_could_see_ahead_of_the_wave_is_left_alone() {
    for (linear, accuracy) in [(true, 1e-3), (true, 1e-9), (false, 1e-14)] {
        let (chain, method) = (diatomic(300, 2.38, linear), for_accuracy(accuracy));
        let (with, work) = follow(&chain, method, None, 1e-3);
        let (all, same_work) = follow(&chain, method, Some(Refinement::QuietPart), 1e-3);
        let moved = |state: &State| state.velocity.iter().filter(|v| **v != 0.0).count();
        println!("{linear}, {accuracy:e}: {} of {} that move", moved(&with), moved(&all));
        assert_eq!(work, same_work);
        assert!(moved(&with) < moved(&all) / 2);
        for (a, b) in with.velocity.iter().zip(&all.velocity) {
            assert!((a - b).abs() <= 1e-29 * 0.4, "{a:e}, {b:e}");
        }
    }
}

/// Both forms are the same force; rounding tells them apart, and no more.
#[test]
fn the_form_of_the_forces_changes_rounding_alone() {
    let method = for_accuracy(1e-9);
    let (plain, _) = after(2.38, method, None, 2e-3);
    let (exact, _) = after(2.38, method, Some(Refinement::ForceForm), 2e-3);
    let most = plain.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    let pairs = plain.velocity.iter().zip(&exact.velocity);
    let off = pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs())) / most;
    println!("{off:.1e}");
    assert!(off > 0.0 && off < 1e-9, "{off:e}");
}

/// Without the correction, steps of the same tolerance go wrong by more where contacts open.
#[test]
fn kinks_that_are_left_alone_cost_accuracy() {
    let error = |without| {
        let (found, _) = after(0.0, for_accuracy(1e-7), without, 2e-3);
        let (exact, _) = after(0.0, Method::DormandPrince853 { tolerance: 1e-13 }, None, 2e-3);
        let pairs = found.velocity.iter().zip(&exact.velocity);
        pairs.fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()))
    };
    let (with, without) = (error(None), error(Some(Refinement::KinkCorrection)));
    println!("{with:.1e} with, {without:.1e} without");
    assert!(with < without, "{with:e}, {without:e}");
}

/// A striker that bounces hits a stiff contact every few steps: fewer than half as many steps are tried in vain where that is foreseen, and fewer
/// forces are asked for. Chains whose contacts are all alike are not looked at: nothing changes for them.
#[test]
fn foreseen_impacts_spare_steps_in_vain() {
    for name in ["magnet-17.81g", "gravity-17.81g"] {
        let scene = Scene::load(name).expect("a shipped scene");
        for tolerance in [1e-2, 1e-4] {
            let work = |without: Option<Refinement>| {
                let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
                let scheme = Scheme::Pair(Pair::DormandElMikkawyPrince86, tolerance);
                let mut stepper =
                    ChainStepper::new(chain, velocities, scheme, InstructionSet::best());
                if let Some(refinement) = without {
                    stepper = stepper.without(refinement, chain);
                }
                stepper.advance(2e-3).expect("a run");
                stepper.work()
            };
            let (with, without) = (work(None), work(Some(Refinement::Foresight)));
            println!("{name}, {tolerance:e}: {with:?}, without {without:?}");
            assert!(2 * with.rejected < without.rejected, "{name}, {tolerance:e}");
            assert!(with.force_evaluations < without.force_evaluations, "{name}, {tolerance:e}");
        }
    }
    let method = for_accuracy(1e-6);
    let (all, work) = after(0.0, method, None, 2e-3);
    let (same, same_work) = after(0.0, method, Some(Refinement::Foresight), 2e-3);
    assert_eq!((all, work), (same, same_work));
}
