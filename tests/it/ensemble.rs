//! Many chains at once: the same results whatever the threads and the order.

use hertzscope::Ensemble;
use hertzscope::chain::ForceProbe;
use hertzscope::experiment::ensemble::{Case, Readout};
use hertzscope::motion::kernel::InstructionSet;
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

/// Strikers of different speeds on `scene`, 19 of them.
fn cases(scene: &str) -> Vec<Case> {
    strikers(scene, 19)
}

/// So many strikers, of speeds up to twice the scene's.
fn strikers(scene: &str, count: u32) -> Vec<Case> {
    let scene = Scene::load(scene).expect("a shipped scene");
    let chain = &scene.chain;
    let probes: Vec<ForceProbe> =
        [2, 14, 27].iter().filter_map(|p| ForceProbe::inside(chain, *p, 0.0)).collect();
    let case = |number: u32| {
        let mut velocities = scene.initial_velocities.clone();
        velocities[0] *= 1.0 + f64::from(number) / f64::from(count);
        let chain = chain.clone();
        Case { chain, velocities, probes: probes.clone(), duration: 1.2e-3 }
    };
    (0..count).map(case).collect()
}

fn run(ensemble: Ensemble, cases: &[Case]) -> Vec<Vec<[f64; 3]>> {
    let found = ensemble.run(cases, &|_| ());
    found.iter().map(|result| reading(result.as_ref().expect("a run"))).collect()
}

/// Threads, neighbours and order change nothing, to the last bit.
#[test]
fn company_changes_nothing() {
    let cases = strikers("gravity-0.61g", 83);
    let ensemble = Ensemble::new(1e-4);
    let together = run(ensemble.threads(1), &cases);
    assert_eq!(together, run(ensemble.threads(2), &cases));
    let mut reversed = run(ensemble, &cases.iter().rev().cloned().collect::<Vec<Case>>());
    reversed.reverse();
    assert_eq!(together, reversed);
    assert_eq!(together[..17], run(ensemble, &cases[..17])[..]);
}

/// Every instruction set: within the accuracy asked for.
#[test]
fn every_instruction_set_is_as_accurate() {
    for scene in ["magnet-0.61g", "gravity-2.75g"] {
        let cases = cases(scene);
        for accuracy in [1e-3, 1e-6] {
            let exact = run(Ensemble::new(1e-10), &cases);
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
