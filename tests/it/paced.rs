//! Paced steps: on the chain's own stepper the same as in the plain loops of `integrate`, whatever the instructions, the length of the chain, and
//! whether anybody looks; and as accurate as they are said to be.

use hertzscope::chain::Chain;
use hertzscope::chain::stepper::{ChainStepper, InstructionSet, Refinement};
use hertzscope::experiment::Integration;
use hertzscope::experiment::ensemble::{Case, Ensemble, Readout, places};
use hertzscope::experiment::pulse::{Peak, PulseRecorder};
use hertzscope::integrate::{Integrator, Method};
use hertzscope::scene::Scene;

use super::chains::{STEEL, body, diatomic, pressed, ptfe_sphere, steel_cylinder};
use super::splittings::{all_sets, distance, is_the_same_unseen, kick};

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

fn start(chain: &Chain, tolerance: f64, set: InstructionSet) -> ChainStepper {
    let scheme = Method::PacedForceGradient { tolerance }.scheme().expect("a splitting");
    ChainStepper::new(chain, &kick(chain, SPEED), scheme, set)
}

/// A chain, and what becomes of it.
struct Sort {
    name: String,
    chain: Chain,
    /// Whether contacts open and close.
    opens: bool,
    /// Whether they are pressed before anything moves: otherwise what is ahead of the wave touches or does not by what rounding leaves.
    pressed: bool,
}

/// Chains of the shipped scenes, and ones that fit into registers and that do not, with a stiff contact and without.
fn sorts() -> Vec<Sort> {
    let scene = |name: &str| {
        let chain = Scene::load(name).expect("a shipped scene").chain;
        Sort { name: name.to_owned(), chain, opens: true, pressed: true }
    };
    let mut sorts = vec![scene("magnet-17.81g"), scene("gravity-2.75g")];
    for cells in [2, 6, 19, 65] {
        let name = format!("{cells} cells, struck");
        sorts.push(Sort { name, chain: struck(cells), opens: true, pressed: false });
        // By more than the wave takes.
        let (name, chain) = (format!("{cells} cells"), diatomic(cells, 50.0, false));
        sorts.push(Sort { name, chain, opens: false, pressed: true });
    }
    sorts
}

/// Contacts open and close: what rounding has left is made more of.
#[test]
fn they_are_those_of_the_plain_loops() {
    for Sort { name, chain, .. } in sorts() {
        let velocities = kick(&chain, SPEED);
        let method = Method::PacedForceGradient { tolerance: TOLERANCE };
        let mut plain = method.start(chain.system(&velocities), chain.initial_state(&velocities));
        plain.advance(TIME).expect("stable steps");
        for set in all_sets() {
            let mut stepper = start(&chain, TOLERANCE, set);
            stepper.advance(TIME).expect("stable steps");
            assert_eq!(stepper.work(), plain.work(), "{name}");
            let off = distance(&stepper.state(), &plain.state(), SPEED);
            println!("{name}, {}: {off:.1e}, {:?}", set.name(), stepper.work());
            assert!(off < 1e-9, "{name}, {}: {off:e}", set.name());
        }
    }
}

/// Many steps at once are the same as one after the other, to the last bit.
#[test]
fn a_look_changes_nothing() {
    for Sort { chain, .. } in sorts() {
        for set in all_sets() {
            let [mut seen, mut unseen] = std::array::from_fn(|_| start(&chain, TOLERANCE, set));
            for end in [0.4 * TIME, TIME] {
                is_the_same_unseen([&mut seen, &mut unseen], chain.bodies().len(), end);
            }
        }
    }
}

/// In the other form chains lie along the rows, however short they are: the same but for rounding, down to how often contacts change sides.
#[test]
fn contacts_that_change_sides_are_counted() {
    for Sort { name, chain, opens, pressed } in sorts() {
        let mut stepper = start(&chain, TOLERANCE, InstructionSet::best());
        let mut along =
            start(&chain, TOLERANCE, InstructionSet::best()).without(Refinement::ForceForm, &chain);
        stepper.advance(TIME).expect("stable steps");
        along.advance(TIME).expect("stable steps");
        let (changes, off) = (stepper.events(), distance(&stepper.state(), &along.state(), SPEED));
        println!("{name}: {changes:?}, {off:.1e}");
        assert!(off < 1e-9, "{name}: {off:e}");
        assert!(changes == along.events() || !pressed, "{name}");
        assert_eq!(changes != Some(0), opens, "{name}");
    }
}

/// On a chain whose contacts stay closed errors go as the tolerance, over four decades.
#[test]
fn errors_go_as_the_tolerance() {
    let chain = diatomic(19, 50.0, false);
    let velocities = kick(&chain, SPEED);
    let exact = Method::DormandPrince853 { tolerance: 1e-16 };
    let mut exact = exact.start(chain.system(&velocities), chain.initial_state(&velocities));
    exact.advance(TIME).expect("steps");
    let error = |tolerance: f64| {
        let mut stepper = start(&chain, tolerance, InstructionSet::best());
        stepper.advance(TIME).expect("stable steps");
        distance(&stepper.state(), &exact.state(), SPEED)
    };
    let errors = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7].map(error);
    println!("{errors:?}");
    for pair in errors.windows(2) {
        let ratio = pair[0] / pair[1];
        assert!(ratio > 7.0 && ratio < 20.0, "{ratio}");
    }
}

/// The paper's eight scenes with strikers a quarter as fast to four times as fast, with nobody to hold them to it: first peaks and their times in
/// all places are off by less than the longest steps are made for, and by less than twice what shorter ones are, which `--accuracy` and ensembles count on.
#[test]
fn first_peaks_are_within_the_tolerance() {
    let tolerances = [1e-3, 5e-4, 2e-4];
    let mut worst = [0.0_f64; 3];
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
        let by = |method| -> Vec<Vec<Peak>> {
            let found = Ensemble::by(Integration::Method(method)).run(&cases, &|_| ());
            let peak = |pulse: &PulseRecorder| pulse.first_peak().expect("a peak");
            let peaks = |readout: Readout| readout.pulses.iter().map(peak).collect();
            found.into_iter().map(|readout| peaks(readout.expect("a run"))).collect()
        };
        let exact = by(Method::DormandElMikkawyPrince86 { tolerance: 1e-10 });
        let off = tolerances.map(|tolerance| {
            let found = by(Method::PacedForceGradient { tolerance });
            let pairs = found.iter().flatten().zip(exact.iter().flatten());
            let off = |(a, b): (&Peak, &Peak)| {
                let force = (a.dynamic_n / b.dynamic_n - 1.0).abs();
                force.max((a.time_s / b.time_s - 1.0).abs())
            };
            pairs.map(off).fold(0.0, f64::max)
        });
        println!("{name}: {off:?}");
        for (worst, off) in worst.iter_mut().zip(off) {
            *worst = worst.max(off);
        }
    }
    println!("worst {worst:?}");
    assert!(worst[0] < tolerances[0], "{worst:?}");
    assert!(worst.iter().zip(tolerances).all(|(worst, made_for)| *worst < 2.0 * made_for));
}
