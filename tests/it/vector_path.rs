//! The vector path: step by step the same as the general one, on every instruction set; what it
//! does beside its methods; and how accurate its two-length steps are.

use hertzscope::chain::simd::{InstructionSet, Refinement, VectorStepper};
use hertzscope::chain::{Chain, ChainSystem};
use hertzscope::experiment::Integration;
use hertzscope::experiment::bench::Bench;
use hertzscope::experiment::ensemble::{Case, Ensemble, Readout, places};
use hertzscope::experiment::for_accuracy;
use hertzscope::experiment::pulse::{Peak, PulseRecorder};
use hertzscope::integrate::{Integrator, Method, State, Work};
use hertzscope::scene::Scene;

use super::chains::{NEVER, STEEL, body, diatomic, pressed, ptfe_sphere, steel_cylinder};

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
    let scheme = method.scheme().expect("a method of the vector path");
    VectorStepper::new(chain, &chain.initial_state(velocities), scheme, set)
}

/// Both from the same state over a list of ends, which are steps' ends for either.
fn compare(chain: &Chain, velocities: &[f64], method: Method, ends: &[f64], bound: f64) {
    for set in InstructionSet::available() {
        let mut vectors = stepper(chain, velocities, method, set);
        let state = chain.initial_state(velocities);
        let mut general = method.start(Box::new(ChainSystem::new(chain, velocities)), state);
        for end in ends {
            while vectors.time() < *end {
                vectors.step(*end).expect("a step");
            }
            general.advance(*end).expect("a step");
        }
        let off = distance(&vectors.state(), &general.state());
        let what = format!("{} bodies, {}, {}", chain.bodies().len(), method.name(), set.name());
        assert!(off < bound, "{what}: {off:e}");
        assert_eq!(vectors.work().steps, general.work().steps, "{what}");
    }
}

/// In one row to 113 rows of eight; contacts stay closed, so that nothing is corrected. Bounds are
/// the rounding of as many steps.
#[test]
fn steps_are_those_of_the_general_path() {
    for cells in [3, 4, 11, 15, 19, 20, 65, 450] {
        let chain = diatomic(cells, 2.38, false);
        let velocities = kick(&chain, SPEED);
        let unit = chain.impact_overlap(&velocities) / SPEED;
        // Nothing is rejected, and steps are as long as they are asked to be: each twice the one
        // before, up to the last.
        let steps = (0..40).map(|i| unit * (5e-4 * 2_f64.powi(i)).min(0.2));
        let ends: Vec<f64> = steps
            .scan(0.0, |end, step| {
                *end += step;
                Some(*end)
            })
            .collect();
        let pair = Method::DormandElMikkawyPrince86 { tolerance: 1.0 };
        compare(&chain, &velocities, pair, &ends, 1e-13);
        for method in
            [Method::VelocityVerlet { step: 0.4e-6 }, Method::ForceGradient { step: 0.7e-6 }]
        {
            compare(&chain, &velocities, method, &[0.1e-3, 0.2e-3], 1e-11);
        }
    }
}

/// So many cells hit by a small steel sphere, whose contact is far stiffer than theirs.
fn struck(cells: usize) -> Chain {
    let particles = (0..cells).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    let mut spec = pressed(particles, 0.0, false);
    spec.striker = Some(body("striker", 0.03e-3, Some(1e-3), STEEL));
    Chain::new(&spec).expect("a chain")
}

/// Contacts open and close, which amplifies rounding.
#[test]
fn two_length_steps_are_those_of_the_general_path() {
    let scene = |name: &str| Scene::load(name).expect("a shipped scene").chain;
    let chains = [
        scene("magnet-17.81g"),
        scene("gravity-2.75g"),
        struck(2),
        struck(19),
        diatomic(6, 50.0, false),
    ];
    for chain in chains {
        let method = Method::TwoStepForceGradient { tolerance: 1e-3 };
        compare(&chain, &kick(&chain, 0.5), method, &[0.5e-3], 1e-8);
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
                let mut stepper = stepper(&chain, &kick(&chain, SPEED), method, set)
                    .without(Refinement::ActiveWindow);
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

/// `chain`, its first bead kicked, after `time` (s).
fn after(chain: &Chain, method: Method, without: Option<Refinement>, time: f64) -> (State, Work) {
    let velocities = kick(chain, 0.4);
    let mut bench = Bench::new(chain, &velocities, method, &[], NEVER, NEVER);
    if let Some(refinement) = without {
        bench = bench.without(refinement);
    }
    bench.run_until(time, false, &mut |_| ()).expect("a run");
    (bench.state(), bench.work())
}

/// Rows ahead of the wave are left out: what moves there is below 1e-30 of the first bead's speed,
/// and nothing else changes by more than that and a few roundings.
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
            let (with, work) = after(&chain, method, None, time);
            let (all, same_work) = after(&chain, method, Some(Refinement::ActiveWindow), time);
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

/// Without the correction, steps of the same tolerance are off by more where contacts open.
#[test]
fn the_correction_at_openings_gains_accuracy() {
    let chain = diatomic(300, 0.0, false);
    let (exact, _) = after(&chain, Method::DormandPrince853 { tolerance: 1e-13 }, None, 2e-3);
    let error = |without| {
        let (found, _) = after(&chain, for_accuracy(1e-7), without, 2e-3);
        distance(&found, &exact)
    };
    let (with, without) = (error(None), error(Some(Refinement::OpeningCorrection)));
    assert!(with < without, "{with:e}, {without:e}");
}

/// Gravity alone: hundreds of openings. Against Dormand and Prince's pair of order 8, which does
/// not correct them, errors of single steps add up like random ones, and tight tolerances take
/// fewer evaluations than the same pair without corrections.
#[test]
fn corrections_keep_the_tolerance_and_save_evaluations() {
    let (end, scene) = (1e-3, Scene::load("gravity-0.61g").expect("a shipped scene"));
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let general = |method: Method| {
        let mut integrator = method
            .start(Box::new(ChainSystem::new(chain, velocities)), chain.initial_state(velocities));
        integrator.advance(end).expect("a run");
        (integrator.state(), integrator.work().force_evaluations)
    };
    let velocity_error = |a: &State, b: &State| {
        let largest = b.velocity.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let pairs = a.velocity.iter().zip(&b.velocity);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest
    };
    let (exact, _) = general(Method::DormandPrince853 { tolerance: 1e-14 });
    for tolerance in [1e-3, 1e-5, 1e-7, 1e-9] {
        let method = Method::DormandElMikkawyPrince86 { tolerance };
        let (_, without) = general(method);
        for set in InstructionSet::available() {
            let mut stepper = stepper(chain, velocities, method, set);
            stepper.advance(end).expect("a run");
            let error = velocity_error(&stepper.state(), &exact);
            let with = stepper.work();
            let bound = tolerance * (with.steps as f64).sqrt();
            assert!(error < bound, "{tolerance:e}: {error:e}, at most {bound:e}");
            let evaluations = with.force_evaluations;
            assert!(
                tolerance > 1e-6 || 5 * evaluations < 4 * without,
                "{evaluations} of {without}"
            );
        }
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
        let mut general = method.start(
            Box::new(ChainSystem::new(&chain, &velocities)),
            chain.initial_state(&velocities),
        );
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
    let mut exact = exact
        .start(Box::new(ChainSystem::new(&chain, &velocities)), chain.initial_state(&velocities));
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
