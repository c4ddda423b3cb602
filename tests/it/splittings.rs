//! Fixed steps on the chain's own stepper: the same as the plain loops of `integrate`, whatever the length of the chain, the instructions,
//! and whether anybody looks.

use hertzscope::chain::Chain;
use hertzscope::chain::stepper::{ChainStepper, InstructionSet, Refinement};
use hertzscope::integrate::{Integrator, Method, Pair, Scheme, State};

use super::chains::diatomic;

/// Time that is simulated (s): a wave runs through a dozen cells.
const TIME: f64 = 0.3e-3;
/// Speed of the first body (m/s).
const SPEED: f64 = 0.1;

/// By their step (s).
pub const METHODS: [fn(f64) -> Method; 5] = [
    |step| Method::VelocityVerlet { step },
    |step| Method::Pefrl { step },
    |step| Method::BlanesMoan { step },
    |step| Method::ForceGradient { step },
    |step| Method::InnerForceGradient { step },
];

/// The first body at `speed` (m/s), all others at rest.
pub fn kick(chain: &Chain, speed: f64) -> Vec<f64> {
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = speed;
    velocities
}

/// What this machine has, for processors of both kinds.
pub fn all_sets() -> impl Iterator<Item = InstructionSet> {
    let both = |set: InstructionSet| [true, false].map(|slow| set.with_roots(slow));
    InstructionSet::available().into_iter().flat_map(both)
}

fn stepper(chain: &Chain, method: Method, set: InstructionSet) -> ChainStepper {
    let scheme = method.scheme().expect("a splitting");
    ChainStepper::new(chain, &kick(chain, SPEED), scheme, set)
}

/// Largest difference of velocities, relative to `speed` (m/s) (1).
pub fn distance(a: &State, b: &State, speed: f64) -> f64 {
    let pairs = a.velocity.iter().zip(&b.velocity);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / speed
}

/// Two of the same that go to `end` (s), one a step at a time with somebody who looks, the other at once, come to the same to the last bit.
pub fn is_the_same_unseen([seen, unseen]: [&mut ChainStepper; 2], bodies: usize, end: f64) {
    while seen.time() < end {
        seen.step(end).expect("a stable step");
        seen.prepare_interpolation();
    }
    unseen.advance(end).expect("a stable step");
    unseen.prepare_interpolation();
    assert_eq!(seen.state(), unseen.state());
    assert_eq!(seen.work(), unseen.work());
    assert_eq!(seen.events(), unseen.events());
    for body in 0..bodies {
        let (a, b) = (seen.interpolant(body), unseen.interpolant(body));
        assert_eq!(a.position(0.3).to_bits(), b.position(0.3).to_bits());
    }
}

/// Preloaded and without preload, in chains that fit into registers and in those that do not: 4 to 130 bodies. Contacts without preload
/// open; within this time that makes at most hundreds of what rounding has left.
#[test]
fn they_are_those_of_the_plain_loops() {
    for force in [2.38, 0.0] {
        for cells in [2, 4, 11, 15, 19, 20, 65] {
            let chain = diatomic(cells, force, false);
            for method in METHODS {
                let method = method(0.73e-6);
                let system = chain.system(&kick(&chain, SPEED));
                let mut plain = method.start(system, chain.initial_state(&kick(&chain, SPEED)));
                plain.advance(TIME).expect("a stable step");
                for set in all_sets() {
                    let mut stepper = stepper(&chain, method, set);
                    stepper.advance(TIME).expect("a stable step");
                    assert_eq!(stepper.work(), plain.work(), "{}", method.name());
                    let off = distance(&stepper.state(), &plain.state(), SPEED);
                    let what = format!("{} {force} N {cells} {}", method.name(), set.name());
                    println!("{what}: {off:.1e}");
                    assert!(off < 1e-11, "{what}: {off:e}");
                    // In the other form chains lie along the rows, however short they are.
                    let mut along =
                        self::stepper(&chain, method, set).without(Refinement::ForceForm, &chain);
                    along.advance(TIME).expect("a stable step");
                    stepper.prepare_interpolation();
                    along.prepare_interpolation();
                    for body in 0..chain.bodies().len() {
                        let [a, b] = [stepper.interpolant(body), along.interpolant(body)];
                        let off = (a.velocity(0.5) - b.velocity(0.5)).abs() / SPEED;
                        assert!(off < 1e-11, "{what}, body {body}: {off:e}");
                    }
                }
            }
        }
    }
}

/// What bodies bear at rest is balanced as the loops compute it: where no news can have come yet, nothing has moved at all, under splittings as
/// under pairs, in chains that fit into registers and in those that do not. News travel a body an evaluation, and with gradients two.
#[test]
fn rest_is_rest_to_the_last_bit() {
    let pair = |pair| Scheme::Pair(pair, 1e-6);
    let pairs = [Pair::DormandElMikkawyPrince64, Pair::DormandElMikkawyPrince86].map(pair);
    let paced = Method::PacedForceGradient { tolerance: 1e-3 }.scheme();
    let splittings = METHODS.map(|method| method(0.4e-6).scheme());
    let schemes = splittings.into_iter().chain([paced]).map(|scheme| scheme.expect("a splitting"));
    for scheme in schemes.chain(pairs) {
        // Which forces two rows round to different bits is luck.
        let preloads = (1..=30).map(|tenths| 0.1 * f64::from(tenths));
        let chains =
            [15, 19, 20, 65].map(|cells| preloads.clone().map(move |force| (cells, force)));
        for (cells, force) in chains.into_iter().flatten() {
            let chain = diatomic(cells, force, false);
            let count = chain.bodies().len();
            for set in all_sets() {
                let mut stepper = ChainStepper::new(&chain, &kick(&chain, SPEED), scheme, set);
                stepper = stepper.without(Refinement::QuietPart, &chain);
                let reached =
                    |stepper: &ChainStepper| 2 * stepper.work().force_evaluations as usize;
                while reached(&stepper) < count {
                    stepper.step(TIME).expect("a stable step");
                    let first = reached(&stepper);
                    let State { position, velocity, .. } = stepper.state();
                    let still =
                        |values: &[f64]| values.iter().skip(first).all(|value| *value == 0.0);
                    let what = format!("{scheme:?}, {cells} cells, {force} N, {}", set.name());
                    assert!(still(&position) && still(&velocity), "{what}: {velocity:?}");
                }
            }
        }
    }
}

/// The same from the middle of a motion on, where forces are not balanced and gradients are not zero.
#[test]
fn a_start_in_motion_is_that_of_the_plain_loops() {
    for cells in [19, 65] {
        let chain = diatomic(cells, 2.38, false);
        for method in METHODS {
            let method = method(4e-6);
            let system = || chain.system(&kick(&chain, SPEED));
            let mut first = method.start(system(), chain.initial_state(&kick(&chain, SPEED)));
            first.advance(0.5 * TIME).expect("a stable step");
            let mut plain = method.start(system(), first.state());
            plain.advance(TIME).expect("a stable step");
            for set in InstructionSet::available() {
                let scheme = method.scheme().expect("a splitting");
                let mut stepper = ChainStepper::from_state(&chain, &first.state(), scheme, set);
                stepper.advance(TIME).expect("a stable step");
                let off = distance(&stepper.state(), &plain.state(), SPEED);
                let what = format!("{} {cells} {}", method.name(), set.name());
                println!("{what}: {off:.1e}");
                assert!(off < 1e-11, "{what}: {off:e}");
            }
        }
    }
}

/// Many steps at once are the same as one after the other, to the last bit, and so is the last one, which can be looked at.
#[test]
fn a_look_changes_nothing() {
    for cells in [4, 19, 65] {
        let chain = diatomic(cells, 2.38, false);
        for method in METHODS {
            let method = method(0.73e-6);
            for set in InstructionSet::available() {
                let [mut seen, mut unseen] = std::array::from_fn(|_| stepper(&chain, method, set));
                for end in [0.4 * TIME, TIME] {
                    is_the_same_unseen([&mut seen, &mut unseen], chain.bodies().len(), end);
                }
            }
        }
    }
}

/// Chains so long that a step goes through them stretch by stretch: all bodies in motion, so that every border between stretches is tried, and
/// the same to the last bit one step after the other.
#[test]
fn long_chains_are_those_of_the_plain_loops() {
    for cells in [450, 471, 800] {
        let chain = diatomic(cells, 2.38, false);
        let mut bits = 1_u32;
        let mut random = || {
            bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(bits) / f64::from(u32::MAX) - 0.5
        };
        let velocities: Vec<f64> = chain.bodies().iter().map(|_| SPEED * random()).collect();
        for method in METHODS {
            let method = method(0.73e-6);
            let scheme = method.scheme().expect("a splitting");
            let system = chain.system(&velocities);
            let mut plain = method.start(system, chain.initial_state(&velocities));
            plain.advance(0.1 * TIME).expect("a stable step");
            for set in InstructionSet::available() {
                let start = || ChainStepper::new(&chain, &velocities, scheme, set);
                let [mut at_once, mut singly] = [start(), start()];
                let mut exact = start().without(Refinement::ForceForm, &chain);
                at_once.advance(0.1 * TIME).expect("a stable step");
                exact.advance(0.1 * TIME).expect("a stable step");
                while singly.time() < 0.1 * TIME {
                    singly.step(0.1 * TIME).expect("a stable step");
                }
                assert_eq!(at_once.state(), singly.state());
                for stepper in [&at_once, &exact] {
                    let off = distance(&stepper.state(), &plain.state(), SPEED);
                    let what = format!("{} {cells} {}", method.name(), set.name());
                    println!("{what}: {off:.1e}");
                    assert!(off < 1e-12, "{what}: {off:e}");
                }
            }
        }
    }
}
