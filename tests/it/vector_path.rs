//! The kernel for chains without losses: the same on every instruction set, against a method of
//! another family; its active window; and the accuracy of its two-length steps.

use hertzscope::chain::Chain;
use hertzscope::chain::State;
use hertzscope::experiment::Integration;
use hertzscope::experiment::bench::{Bench, start};
use hertzscope::experiment::ensemble::{Case, Ensemble, Readout, places};
use hertzscope::experiment::for_accuracy;
use hertzscope::experiment::pulse::{Peak, PulseRecorder};
use hertzscope::motion::kernel::{InstructionSet, VectorStepper};
use hertzscope::motion::{Integrator, Method, Scheme, Work};
use hertzscope::scene::Scene;

use super::chains::{NEVER, diatomic, pressed, ptfe_sphere};

/// Speed of the first body (m/s).
const SPEED: f64 = 0.1;

/// Largest difference of positions and of velocities, relative to the largest position and to the
/// first body's speed (1).
fn distance(a: &State, b: &State) -> f64 {
    let most =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let farthest = b.position.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    (most(&a.position, &b.position) / farthest).max(most(&a.velocity, &b.velocity) / SPEED)
}

fn kick(chain: &Chain, speed: f64) -> Vec<f64> {
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = speed;
    velocities
}

fn stepper(
    chain: &Chain,
    velocities: &[f64],
    method: Method,
    set: InstructionSet,
) -> VectorStepper {
    let Scheme::Lossless(scheme) = method.scheme() else { panic!("a method for losses") };
    VectorStepper::new(chain, &chain.initial_state(velocities), scheme, set)
}

/// Chains of one row to 113 rows of eight whose contacts stay closed: positions and velocities by
/// every instruction set are those of Dormand and Prince's pair of order 8, which runs on code of
/// its own.
#[test]
fn every_instruction_set_moves_a_chain_as_a_method_of_another_family() {
    for cells in [3, 4, 11, 15, 19, 20, 65, 450] {
        let chain = diatomic(cells, 2.38, false);
        let velocities = kick(&chain, SPEED);
        let exact = Method::DormandPrince853 { tolerance: 1e-14 };
        let mut exact = start(&chain, exact, chain.initial_state(&velocities));
        exact.advance(0.2e-3).expect("steps");
        for set in InstructionSet::available() {
            for (method, bound) in [(for_accuracy(1e-12), 1e-10), (for_accuracy(1e-6), 1e-5)] {
                let mut vectors = stepper(&chain, &velocities, method, set);
                vectors.advance(0.2e-3).expect("steps");
                let off = distance(&vectors.state(), &exact.state());
                assert!(off < bound, "{cells} cells, {method}, {}: {off:e}", set.name());
            }
        }
    }
}

/// All methods of the vector path.
fn methods() -> [Method; 4] {
    [
        Method::VelocityVerlet { step: 0.4e-6 },
        Method::ForceGradient { step: 0.4e-6 },
        Method::TwoStepForceGradient { tolerance: 1e-3 },
        Method::DormandElMikkawyPrince86 { tolerance: 1e-6 },
    ]
}

/// Where no motion can have come yet, nothing has moved at all: it spreads by a body an evaluation,
/// with gradients by two.
#[test]
fn bodies_ahead_of_the_wave_stay_at_rest_to_the_last_bit() {
    for method in methods() {
        for (cells, tenths) in
            [15, 19, 20, 65].into_iter().flat_map(|c| (1..=30).map(move |t| (c, t)))
        {
            let chain = diatomic(cells, 0.1 * f64::from(tenths), false);
            for set in InstructionSet::available() {
                let mut stepper = stepper(&chain, &kick(&chain, SPEED), method, set);
                loop {
                    stepper.step(0.3e-3).expect("a stable step");
                    let reached =
                        2 * usize::try_from(stepper.work().force_evaluations).expect("few");
                    if reached >= chain.bodies().len() {
                        break;
                    }
                    let State { position, velocity, .. } = stepper.state();
                    let still =
                        |values: &[f64]| values[reached..].iter().all(|value| *value == 0.0);
                    assert!(
                        still(&position) && still(&velocity),
                        "{method}, {cells} cells, {}",
                        set.name()
                    );
                }
            }
        }
    }
}

/// A chain that nothing moves: no bit changes, and no step is too small.
#[test]
fn a_chain_at_rest_stays_at_rest() {
    let preloaded = Scene::load("magnet-0.61g").expect("a shipped scene");
    let particles = preloaded.chain.bodies().len();
    for chain in [diatomic(19, 2.38, false), diatomic(1, 0.7, false), diatomic(5, 0.0, false)] {
        for method in methods() {
            for set in InstructionSet::available() {
                let velocities = vec![0.0; chain.bodies().len()];
                let mut stepper = stepper(&chain, &velocities, method, set);
                stepper.advance(1e-3).unwrap_or_else(|error| panic!("{method}: {error}"));
                let State { position, velocity, .. } = stepper.state();
                assert!(position.iter().chain(&velocity).all(|v| v.to_bits() == 0), "{method}");
            }
        }
    }
    assert!(particles > 30);
}

/// `chain`, its first bead kicked and its last by `last` (m/s), after `time` (s).
fn after(chain: &Chain, method: Method, last: f64, time: f64) -> (State, Work) {
    let mut velocities = kick(chain, 0.4);
    velocities[chain.bodies().len() - 1] = last;
    let mut bench = Bench::new(chain, &velocities, method, &[], NEVER, NEVER);
    bench.run_until(time, false, &mut |_| ()).expect("a run");
    (bench.state(), bench.work())
}

/// Rows ahead of the wave are left out of the sweep: what moves there is below 1e-30 of the first
/// bead's speed. A last bead that moves at 1e-200 m/s has all rows swept, and nothing else changes
/// by more than that and a few roundings.
#[test]
fn the_active_window_changes_nothing_that_could_be_seen() {
    for force in [0.0, 2.38] {
        let chain = diatomic(300, force, false);
        for (method, time) in [
            (for_accuracy(1e-3), 1e-3),
            (for_accuracy(1e-6), 3e-3),
            (Method::ForceGradient { step: 5e-6 }, 2e-3),
            (Method::VelocityVerlet { step: 1e-6 }, 2e-3),
        ] {
            let (with, work) = after(&chain, method, 0.0, time);
            let (all, same_work) = after(&chain, method, 1e-200, time);
            assert_eq!(work, same_work);
            for (a, b) in with.velocity.iter().zip(&all.velocity) {
                let rounding = 8.0 * f64::EPSILON * b.abs();
                assert!(
                    (a - b).abs() <= 1e-29 * 0.4 + rounding,
                    "{force} N, {method}: {a:e}, {b:e}"
                );
            }
        }
    }
}

/// Gravity alone: hundreds of openings. Against Dormand and Prince's pair of order 8, which does
/// not correct them, errors of single steps add up like random ones.
#[test]
fn corrections_at_openings_keep_the_tolerance() {
    let (end, scene) = (1e-3, Scene::load("gravity-0.61g").expect("a shipped scene"));
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let velocity_error = |a: &State, b: &State| {
        let largest = b.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let pairs = a.velocity.iter().zip(&b.velocity);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
    };
    let exact = Method::DormandPrince853 { tolerance: 1e-14 };
    let mut exact = start(chain, exact, chain.initial_state(velocities));
    exact.advance(end).expect("a run");
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
        let method = Method::DormandElMikkawyPrince86 { tolerance };
        for set in InstructionSet::available() {
            let mut stepper = stepper(chain, velocities, method, set);
            stepper.advance(end).expect("a run");
            let error = velocity_error(&stepper.state(), &exact.state());
            let bound = tolerance * (stepper.work().steps as f64).sqrt();
            assert!(error < bound, "{tolerance:e}: {error:e}, at most {bound:e}");
        }
    }
}

/// A bead flies away from its neighbour at constant speed, in a hundred thousand steps: the sum of
/// as many increments is off by no more than a few roundings, where a plain sum is off by hundreds.
#[test]
fn sums_of_many_steps_are_compensated() {
    let chain = diatomic(1, 0.0, false);
    for set in InstructionSet::available() {
        let mut stepper = stepper(&chain, &[-0.1, 0.0], for_accuracy(1e-6), set);
        for step in 1..=100_000_u32 {
            let end = 1e-7 * f64::from(step);
            while stepper.time() < end {
                stepper.step(end).expect("a step");
            }
        }
        let (found, expected) = (stepper.state().position[0], -0.1 * stepper.time());
        let roundings = (found / expected - 1.0).abs() / f64::EPSILON;
        assert!(roundings < 4.0, "{}: {roundings} roundings", set.name());
    }
}

/// A fast body far from a light one that passes through its contact within any step that grows
/// freely: it must not be missed.
#[test]
fn a_contact_within_one_step_is_not_missed() {
    let mut spec = pressed(vec![ptfe_sphere(), ptfe_sphere(), ptfe_sphere()], 0.0, false);
    spec.particles[1].mass *= 1e-3;
    let chain = Chain::new(&spec).expect("a chain");
    let velocities = [1.0, 0.0, 0.0];
    let exact = {
        let method = Method::DormandPrince853 { tolerance: 1e-13 };
        let mut general = start(&chain, method, chain.initial_state(&velocities));
        general.advance(1e-3).expect("a run");
        general.state()
    };
    for set in InstructionSet::available() {
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let method = Method::DormandElMikkawyPrince86 { tolerance };
            let mut stepper = stepper(&chain, &velocities, method, set);
            stepper.advance(1e-3).expect("a run");
            let state = stepper.state();
            let off = state.velocity.iter().zip(&exact.velocity);
            let off = off.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // The light body bounces to and fro between the others some twenty times, each of which
            // passes an error on.
            assert!(off < 100.0 * tolerance, "{tolerance:e}, {}: {off:e}", set.name());
        }
    }
}

/// On a chain whose contacts stay closed errors of two-length steps go as the tolerance, over four
/// decades.
#[test]
fn errors_of_two_length_steps_go_as_the_tolerance() {
    let chain = diatomic(19, 50.0, false);
    let velocities = kick(&chain, 0.5);
    let exact = Method::DormandPrince853 { tolerance: 1e-16 };
    let mut exact = start(&chain, exact, chain.initial_state(&velocities));
    exact.advance(0.5e-3).expect("steps");
    let error = |tolerance: f64| {
        let method = Method::TwoStepForceGradient { tolerance };
        let mut stepper = stepper(&chain, &velocities, method, InstructionSet::best());
        stepper.advance(0.5e-3).expect("stable steps");
        distance(&stepper.state(), &exact.state())
    };
    let errors = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7].map(error);
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!(ratio > 7.0 && ratio < 20.0, "{errors:?}");
    }
}

/// The paper's eight scenes with strikers a quarter as fast to four times as fast, without a check
/// run: first peaks and their times in all places are off by less than the longest steps are made
/// for, and by less than twice what shorter ones are, which `--accuracy` and ensembles rely on.
#[test]
fn first_peaks_by_two_length_steps_are_within_the_tolerance() {
    let tolerances = [1e-3, 5e-4, 2e-4];
    let mut worst = [0.0_f64; 3];
    for name in ["magnet", "gravity"].iter().flat_map(|preload| {
        ["0.61g", "1.22g", "2.75g", "17.81g"].map(|striker| format!("{preload}-{striker}"))
    }) {
        let scene = Scene::load(&name).expect("a shipped scene");
        let case = Case::of(&scene, 1e-3, &places(&scene));
        let times_as_fast = |number: u32| {
            let factor = 0.25 * 16f64.powf(f64::from(number) / 31.0);
            let velocities = case.velocities.iter().map(|v| factor * v).collect();
            Case { velocities, duration: 2e-3, ..case.clone() }
        };
        let cases: Vec<Case> = (0..32).map(times_as_fast).collect();
        let by = |method| -> Vec<Vec<Peak>> {
            let found = Ensemble::by(Integration::Method(method)).run(&cases, &|_| ());
            let peak = |pulse: &PulseRecorder| pulse.first_peak().expect("a peak");
            let peaks = |readout: Readout| readout.pulses.iter().map(peak).collect();
            found.into_iter().map(|readout| peaks(readout.expect("a run"))).collect()
        };
        let exact = by(Method::DormandElMikkawyPrince86 { tolerance: 1e-10 });
        for (worst, tolerance) in worst.iter_mut().zip(tolerances) {
            let found = by(Method::TwoStepForceGradient { tolerance });
            let pairs = found.iter().flatten().zip(exact.iter().flatten());
            let off = |(a, b): (&Peak, &Peak)| {
                let force = (a.dynamic_n / b.dynamic_n - 1.0).abs();
                force.max((a.time_s / b.time_s - 1.0).abs())
            };
            *worst = pairs.map(off).fold(*worst, f64::max);
        }
    }
    println!("worst {worst:?}");
    assert!(worst[0] < tolerances[0], "{worst:?}");
    assert!(
        worst.iter().zip(tolerances).all(|(worst, made_for)| *worst < 2.0 * made_for),
        "{worst:?}"
    );
}
