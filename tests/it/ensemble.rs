//! Many chains at once: the same results as one by one, whatever the company.

use hertzscope::Ensemble;
use hertzscope::chain::ForceProbe;
use hertzscope::chain::stepper::InstructionSet;
use hertzscope::experiment::Integration;
use hertzscope::experiment::ensemble::{Case, Readout};
use hertzscope::integrate::Method;
use hertzscope::scene::Scene;

/// What a person reads: peak (N), its time and the half-rise (s) at every probe.
fn reading(readout: &Readout) -> Vec<[f64; 3]> {
    let read = |pulse: &hertzscope::experiment::pulse::PulseRecorder| {
        let peak = pulse.first_peak().expect("a pulse");
        let rise = pulse.first_reach(0.5 * peak.dynamic_n).expect("a rise");
        [peak.dynamic_n, peak.time_s, rise]
    };
    readout.pulses.iter().map(read).collect()
}

/// Strikers of different speeds on `scene`, 19 of them: two full groups and a rest.
fn cases(scene: &str) -> Vec<Case> {
    let scene = Scene::load(scene).expect("a shipped scene");
    let chain = &scene.chain;
    let probes: Vec<ForceProbe> =
        [2, 14, 27].iter().filter_map(|p| ForceProbe::inside(chain, *p, 0.0)).collect();
    let case = |number: i32| {
        let mut velocities = scene.initial_velocities.clone();
        velocities[0] *= 1.0 + 0.05 * f64::from(number);
        let chain = chain.clone();
        Case { chain, velocities, probes: probes.clone(), duration: 1.2e-3 }
    };
    (0..19).map(case).collect()
}

fn run(ensemble: Ensemble, cases: &[Case]) -> Vec<Vec<[f64; 3]>> {
    let found = ensemble.run(cases, &|_| ());
    found.iter().map(|result| reading(result.as_ref().expect("a run"))).collect()
}

/// Threads, neighbours and order change nothing, to the last bit.
#[test]
fn company_changes_nothing() {
    let cases = cases("gravity-0.61g");
    let ensemble = Ensemble::new(1e-4);
    let together = run(ensemble.threads(1), &cases);
    assert_eq!(together, run(ensemble.threads(2), &cases));
    let mut reversed = run(ensemble, &cases.iter().rev().cloned().collect::<Vec<Case>>());
    reversed.reverse();
    assert_eq!(together, reversed);
    // Lengths of groups: 19 end on a group of three, 17 on one of one.
    assert_eq!(together[..17], run(ensemble, &cases[..17])[..]);
}

/// In fixed steps too, for chains that end at times of their own; one by one they come out the same but for rounding, which a bouncing
/// striker makes much of.
#[test]
fn fixed_steps_are_the_same_in_lanes() {
    let mut cases = cases("magnet-0.61g");
    for (index, case) in (0_u32..).zip(&mut cases) {
        case.duration *= 1.0 - 0.01 * f64::from(index);
    }
    for method in [Method::Pefrl { step: 0.5e-6 }, Method::ForceGradient { step: 0.7e-6 }] {
        let ensemble = Ensemble::by(Integration::Method(method));
        let together = run(ensemble.threads(1), &cases);
        assert_eq!(together[..17], run(ensemble, &cases[..17])[..]);
        let alone =
            |case: &Case| reading(&case.run_alone(Integration::Method(method)).expect("a run"));
        let exact: Vec<Vec<[f64; 3]>> = cases.iter().map(alone).collect();
        let pairs = together.iter().flatten().flatten().zip(exact.iter().flatten().flatten());
        let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{}: {worst:.1e}", method.name());
        assert!(worst < 1e-9, "{}: {worst:e}", method.name());
    }
}

/// Side by side and one by one, every instruction set: within the accuracy asked for.
#[test]
fn lanes_and_singles_agree() {
    for scene in ["magnet-0.61g", "gravity-2.75g"] {
        let cases = cases(scene);
        for accuracy in [1e-3, 1e-6] {
            let alone = |case: &Case| {
                reading(&case.run_alone(Integration::Accuracy(1e-10)).expect("a run"))
            };
            let exact: Vec<Vec<[f64; 3]>> = cases.iter().map(alone).collect();
            for set in InstructionSet::available() {
                let found = run(Ensemble::new(accuracy).instructions(set), &cases);
                let pairs = found.iter().flatten().flatten().zip(exact.iter().flatten().flatten());
                let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
                println!("{scene} {accuracy:e} {}: {worst:.1e}", set.name());
                assert!(worst < accuracy, "{scene} {accuracy:e} {}: {worst:e}", set.name());
            }
        }
    }
}
