//! Many chains at once: the same results as one by one, whatever the company.

use hertzscope::Ensemble;
use hertzscope::chain::{Chain, ForceProbe};
use hertzscope::experiment::Integration;
use hertzscope::experiment::ensemble::{Case, Readout};
use hertzscope::integrate::{Method, Work};
use hertzscope::scene::Scene;

use super::chains::{diatomic, pressed, ptfe_sphere, steel_cylinder};
use super::splittings::all_sets;

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
    // More than a thread sorts at a time; the last group is not full.
    let cases = strikers("gravity-0.61g", 83);
    let ensemble = Ensemble::new(1e-4);
    let together = run(ensemble.threads(1), &cases);
    assert_eq!(together, run(ensemble.threads(2), &cases));
    let mut reversed = run(ensemble, &cases.iter().rev().cloned().collect::<Vec<Case>>());
    reversed.reverse();
    assert_eq!(together, reversed);
    // Lengths of groups: 83 end on a group of three, 17 on one of one.
    assert_eq!(together[..17], run(ensemble, &cases[..17])[..]);
}

/// Chains of different sorts find their own groups, and every result its place.
#[test]
fn sorts_of_chains_are_told_apart() {
    let [one, other] = [strikers("magnet-0.61g", 10), strikers("monatomic-vacuum", 10)];
    let ensemble = Ensemble::new(1e-4);
    let mixed: Vec<Case> =
        one.iter().zip(&other).flat_map(|(a, b)| [a.clone(), b.clone()]).collect();
    let found = run(ensemble, &mixed);
    let [one, other] = [one, other].map(|cases| run(ensemble, &cases));
    for (index, (a, b)) in one.into_iter().zip(other).enumerate() {
        assert_eq!(found[2 * index..2 * index + 2], [a, b], "{index}");
    }
}

/// Steps far too long fail as they do alone: by the same body, at the same time.
#[test]
fn a_lane_names_the_body_that_it_has_lost() {
    let method = Integration::Method(Method::VelocityVerlet { step: 5e-5 });
    let cases = cases("magnet-0.61g");
    let found = Ensemble::by(method).run(&cases, &|_| ());
    for (case, found) in cases.iter().zip(found) {
        let alone = case.run_alone(method).expect_err("too long a step");
        assert_eq!(found.expect_err("too long a step"), alone);
    }
}

/// In fixed steps too, for chains some of which end at times of their own; one by one they come out the same but for rounding, which a bouncing
/// striker makes much of.
#[test]
fn fixed_steps_are_the_same_in_lanes() {
    let mut cases = cases("magnet-0.61g");
    for (index, case) in (0_u32..).zip(&mut cases) {
        if index % 5 == 0 {
            case.duration *= 1.0 - 0.01 * f64::from(index);
        }
    }
    for method in [
        Method::Pefrl { step: 0.5e-6 },
        Method::ForceGradient { step: 0.7e-6 },
        Method::PacedForceGradient { tolerance: 1e-3 },
    ] {
        let ensemble = Ensemble::by(Integration::Method(method));
        let together = run(ensemble.threads(1), &cases);
        assert_eq!(together[..17], run(ensemble, &cases[..17])[..]);
        each_is_as_alone(ensemble, &cases, &together);
        let alone =
            |case: &Case| reading(&case.run_alone(Integration::Method(method)).expect("a run"));
        let exact: Vec<Vec<[f64; 3]>> = cases.iter().map(alone).collect();
        let pairs = together.iter().flatten().flatten().zip(exact.iter().flatten().flatten());
        let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{}: {worst:.1e}", method.name());
        assert!(worst < 1e-9, "{}: {worst:e}", method.name());
    }
}

/// Lanes whose steps change their length at times of their own take those that they would take alone, as many of them, and end in the same places.
#[test]
fn paced_lanes_take_steps_of_their_own() {
    let method = Method::PacedForceGradient { tolerance: 1e-3 };
    let ensemble = Ensemble::by(Integration::Method(method));
    for scene in ["gravity-2.75g", "magnet-0.61g", "magnet-17.81g"] {
        let cases = strikers(scene, 11);
        let found = ensemble.run(&cases, &|_| ());
        let works: Vec<Work> = found.into_iter().map(|run| run.expect("a run").work).collect();
        let alone = |case: &Case| case.run_alone(Integration::Method(method)).expect("a run").work;
        assert_eq!(works, cases.iter().map(alone).collect::<Vec<Work>>(), "{scene}");
        assert!(works[1..].iter().any(|work| *work != works[0]), "{scene}");
        each_is_as_alone(ensemble, &cases, &run(ensemble, &cases));
    }
}

/// The same of chains so long that steps go through them stretch by stretch, struck at both ends and in the middle.
#[test]
fn long_chains_are_the_same_in_lanes() {
    let chain = diatomic(471, 2.38, false);
    let probes: Vec<ForceProbe> =
        [2, 470, 939].iter().filter_map(|p| ForceProbe::inside(&chain, *p, 0.0)).collect();
    let case = |number: u32| {
        let mut velocities = vec![0.0; chain.bodies().len()];
        for body in [0, 468, 937] {
            velocities[body] = 0.2 + 0.01 * f64::from(number);
        }
        Case { chain: chain.clone(), velocities, probes: probes.clone(), duration: 0.1e-3 }
    };
    let cases: Vec<Case> = (0..9).map(case).collect();
    for method in [
        Method::VelocityVerlet { step: 0.5e-6 },
        Method::ForceGradient { step: 0.7e-6 },
        Method::PacedForceGradient { tolerance: 1e-3 },
    ] {
        let together = run(Ensemble::by(Integration::Method(method)), &cases);
        let alone =
            |case: &Case| reading(&case.run_alone(Integration::Method(method)).expect("a run"));
        let singly: Vec<Vec<[f64; 3]>> = cases.iter().map(alone).collect();
        assert_eq!(singly.iter().map(Vec::len).sum::<usize>(), 27);
        let pairs = together.iter().flatten().flatten().zip(singly.iter().flatten().flatten());
        let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{}: {worst:.1e}", method.name());
        assert!(worst < 1e-9, "{}: {worst:e}", method.name());
    }
}

/// Each of `cases` comes out of an ensemble of its own as it came out `together`, to the last bit.
fn each_is_as_alone(ensemble: Ensemble, cases: &[Case], together: &[Vec<[f64; 3]>]) {
    for (index, case) in cases.iter().enumerate() {
        let alone = run(ensemble, std::slice::from_ref(case));
        assert_eq!(together[index..=index], alone[..], "{index}");
    }
}

/// Lanes may watch different places, ends of the chain among them, more or fewer of them, or none.
#[test]
fn lanes_watch_places_of_their_own() {
    let mut cases = strikers("magnet-0.61g", 11);
    for (number, case) in cases.iter_mut().enumerate() {
        let (chain, last) = (&case.chain, case.chain.bodies().len() - 1);
        let inside = |particle| ForceProbe::inside(chain, particle, 0.2);
        let wall = chain.wall_contact().and_then(|contact| ForceProbe::contact(chain, contact));
        let probes = match number % 4 {
            0 => vec![inside(1)],
            1 => vec![inside(last), inside(14)],
            2 => vec![wall, inside(3), inside(1)],
            _ => Vec::new(),
        };
        case.probes = probes.into_iter().map(|probe| probe.expect("a place")).collect();
        case.duration = 2e-3;
    }
    let fixed = Integration::Method(Method::BlanesMoan { step: 2e-6 });
    for ensemble in [Ensemble::new(1e-3), Ensemble::new(1e-4), Ensemble::by(fixed)] {
        let together = run(ensemble, &cases);
        assert_eq!(
            together.iter().map(Vec::len).collect::<Vec<_>>(),
            [1, 2, 3, 0, 1, 2, 3, 0, 1, 2, 3]
        );
        each_is_as_alone(ensemble, &cases, &together);
    }
}

/// Chains whose contacts are all alike have loops of their own in fixed steps, whatever others are among them.
#[test]
fn chains_of_contacts_alike_are_the_same_among_others() {
    let case = |number: u32| {
        let force = if number.is_multiple_of(2) { 2.38 } else { 1.19 };
        let mut spec = pressed(
            (0..20).map(|i| if i % 2 == 0 { ptfe_sphere() } else { steel_cylinder() }).collect(),
            force,
            false,
        );
        if number.is_multiple_of(3) {
            spec.particles[8].curvature *= 1.01;
        }
        let chain = Chain::new(&spec).expect("a chain");
        let mut velocities = vec![0.0; chain.bodies().len()];
        velocities[0] = 0.2 + 0.01 * f64::from(number);
        let probes = [2, 9].iter().filter_map(|p| ForceProbe::inside(&chain, *p, 0.0)).collect();
        Case { probes, chain, velocities, duration: 1e-3 }
    };
    let cases: Vec<Case> = (0..19).map(case).collect();
    for method in [Method::VelocityVerlet { step: 0.5e-6 }, Method::ForceGradient { step: 2e-6 }] {
        let ensemble = Ensemble::by(Integration::Method(method));
        let together = run(ensemble, &cases);
        each_is_as_alone(ensemble, &cases, &together);
        let accurate = run(Ensemble::new(1e-8), &cases);
        let pairs = together.iter().flatten().flatten().zip(accurate.iter().flatten().flatten());
        let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        println!("{}: {worst:.1e}", method.name());
        assert!(worst < 1e-3, "{}: {worst:e}", method.name());
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
            for set in all_sets() {
                let found = run(Ensemble::new(accuracy).instructions(set), &cases);
                let pairs = found.iter().flatten().flatten().zip(exact.iter().flatten().flatten());
                let worst = pairs.map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
                println!("{scene} {accuracy:e} {}: {worst:.1e}", set.name());
                assert!(worst < accuracy, "{scene} {accuracy:e} {}: {worst:e}", set.name());
            }
        }
    }
}
