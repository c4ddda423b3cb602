//! Paced steps: on the chain's own stepper the same as in the plain loops of `integrate`, whatever the instructions, the length of the chain, and
//! whether anybody looks; and as accurate as they are said to be.

use hertzscope::chain::Chain;
use hertzscope::chain::stepper::{ChainStepper, InstructionSet, Refinement};
use hertzscope::experiment::Integration;
use hertzscope::experiment::ensemble::{Case, Ensemble, places};
use hertzscope::integrate::{Integrator, Method, State};
use hertzscope::scene::Scene;

use super::chains::{STEEL, body, diatomic, pressed, ptfe_sphere, steel_cylinder};

/// Tolerance that most steps here are made for (1).
const TOLERANCE: f64 = 1e-3;
/// Time in which a striker hits more than once (s).
const TIME: f64 = 0.5e-3;
/// Speed of the first body (m/s).
const SPEED: f64 = 0.5;

/// So many cells hit by a small steel sphere, whose contact is far stiffer than theirs.
fn struck(cells: usize) -> Chain {
    let particles = (0..cells).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
    let mut spec = pressed(particles, 0.0, false);
    spec.striker = Some(body("striker", 0.03e-3, Some(1e-3), STEEL));
    Chain::new(&spec).expect("a chain")
}

fn velocities(chain: &Chain) -> Vec<f64> {
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = SPEED;
    velocities
}

fn start(chain: &Chain, tolerance: f64, set: InstructionSet) -> ChainStepper {
    let scheme = Method::PacedForceGradient { tolerance }.scheme().expect("a splitting");
    ChainStepper::new(chain, &velocities(chain), scheme, set)
}

/// Largest difference of velocities, relative to the first body's (1).
fn distance(a: &State, b: &State) -> f64 {
    let pairs = a.velocity.iter().zip(&b.velocity);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / SPEED
}

/// Chains of the shipped scenes, with and without preload, and ones that fit into registers and that do not, with a stiff contact and without.
fn chains() -> Vec<(String, Chain)> {
    let scene = |name: &str| {
        let scene = Scene::load(name).expect("a shipped scene");
        (name.to_owned(), scene.chain)
    };
    let mut chains = vec![scene("magnet-17.81g"), scene("gravity-2.75g")];
    for cells in [2, 6, 19, 65] {
        chains.push((format!("{cells} cells, struck"), struck(cells)));
        chains.push((format!("{cells} cells"), diatomic(cells, 50.0, false)));
    }
    chains
}

/// Contacts open and close: what rounding has left is made more of.
#[test]
fn they_are_those_of_the_plain_loops() {
    for (name, chain) in chains() {
        let velocities = velocities(&chain);
        let method = Method::PacedForceGradient { tolerance: TOLERANCE };
        let mut plain = method.start(chain.system(&velocities), chain.initial_state(&velocities));
        plain.advance(TIME).expect("stable steps");
        for set in InstructionSet::available() {
            let mut stepper = start(&chain, TOLERANCE, set);
            stepper.advance(TIME).expect("stable steps");
            assert_eq!(stepper.work(), plain.work(), "{name}");
            let off = distance(&stepper.state(), &plain.state());
            println!("{name}, {}: {off:.1e}, {:?}", set.name(), stepper.work());
            assert!(off < 1e-9, "{name}, {}: {off:e}", set.name());
        }
    }
}

/// Many steps at once are the same as one after the other, to the last bit.
#[test]
fn a_look_changes_nothing() {
    for (name, chain) in chains() {
        for set in InstructionSet::available() {
            let [mut seen, mut unseen] = std::array::from_fn(|_| start(&chain, TOLERANCE, set));
            for end in [0.4 * TIME, TIME] {
                while seen.time() < end {
                    seen.step(end).expect("a stable step");
                    seen.prepare_interpolation();
                }
                unseen.advance(end).expect("stable steps");
                unseen.prepare_interpolation();
                assert_eq!(seen.state(), unseen.state(), "{name}");
                assert_eq!(seen.work(), unseen.work(), "{name}");
                assert_eq!(seen.events(), unseen.events(), "{name}");
                let [a, b] = [seen.interpolant(1), unseen.interpolant(1)];
                assert_eq!(a.position(0.3).to_bits(), b.position(0.3).to_bits(), "{name}");
            }
        }
    }
}

/// In the other form chains lie along the rows, however short they are: the same but for rounding, down to how often contacts change sides.
#[test]
fn contacts_that_change_sides_are_counted() {
    for (name, chain) in chains() {
        let mut stepper = start(&chain, TOLERANCE, InstructionSet::best());
        let mut along =
            start(&chain, TOLERANCE, InstructionSet::best()).without(Refinement::ForceForm, &chain);
        stepper.advance(TIME).expect("stable steps");
        along.advance(TIME).expect("stable steps");
        let (changes, off) = (stepper.events(), distance(&stepper.state(), &along.state()));
        println!("{name}: {changes:?}, {off:.1e}");
        assert!(off < 1e-9, "{name}: {off:e}");
        // Without preload what is ahead of the wave touches or does not by what rounding leaves.
        assert!(changes == along.events() || name.contains("struck"), "{name}");
        // Held together by more than the wave takes, or struck.
        assert_eq!(changes == Some(0), !name.contains('g') && !name.contains("struck"), "{name}");
    }
}

/// On a chain whose contacts stay closed errors go as the tolerance, over four decades.
#[test]
fn errors_go_as_the_tolerance() {
    let chain = diatomic(19, 50.0, false);
    let velocities = velocities(&chain);
    let exact = Method::DormandPrince853 { tolerance: 1e-16 };
    let mut exact = exact.start(chain.system(&velocities), chain.initial_state(&velocities));
    exact.advance(TIME).expect("steps");
    let error = |tolerance: f64| {
        let mut stepper = start(&chain, tolerance, InstructionSet::best());
        stepper.advance(TIME).expect("stable steps");
        distance(&stepper.state(), &exact.state())
    };
    let errors = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7].map(error);

    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!(ratio > 7.0 && ratio < 20.0, "{ratio}");
    }
}

/// The paper's eight scenes with strikers a quarter as fast to four times as fast: first peaks and their times in all places are off by less
/// than the tolerance, with nobody to hold them to it.
#[test]
fn first_peaks_are_within_the_tolerance() {
    let mut worst: f64 = 0.0;
    for name in ["magnet", "gravity"].iter().flat_map(|preload| {
        ["0.61g", "1.22g", "2.75g", "17.81g"].map(|striker| format!("{preload}-{striker}"))
    }) {
        let scene = Scene::load(&name).expect("a shipped scene");
        let case = Case::of(&scene, TOLERANCE, &places(&scene));
        let times_as_fast = |number: u32| {
            let factor = 0.25 * 16f64.powf(f64::from(number) / 31.0);
            let velocities = case.velocities.iter().map(|v| factor * v).collect();
            Case { velocities, duration: 2e-3, ..case.clone() }
        };
        let cases: Vec<Case> = (0..32).map(times_as_fast).collect();
        let by = |method| Ensemble::by(Integration::Method(method)).run(&cases, &|_| ());
        let found = by(Method::PacedForceGradient { tolerance: TOLERANCE });
        let exact = by(Method::DormandElMikkawyPrince86 { tolerance: 1e-10 });
        let mut off: f64 = 0.0;
        for (found, exact) in found.iter().zip(&exact) {
            let [found, exact] =
                [found, exact].map(|readout| &readout.as_ref().expect("a run").pulses);
            for (found, exact) in found.iter().zip(exact) {
                let [found, exact] =
                    [found, exact].map(|pulse| pulse.first_peak().expect("a peak"));
                off = off.max((found.dynamic_n / exact.dynamic_n - 1.0).abs());
                off = off.max((found.time_s / exact.time_s - 1.0).abs());
            }
        }
        println!("{name}: {off:.1e}");
        worst = worst.max(off);
    }
    assert!(worst < TOLERANCE, "{worst:e}");
}
