//! Runge-Kutta-Nystrom pairs on the chain's own stepper: step by step the same as the plain loops of `integrate`, whatever the length of the
//! chain and the instructions.

use hertzscope::chain::stepper::{ChainStepper, InstructionSet};
use hertzscope::integrate::{Integrator, Method, State};

use super::chains::diatomic;

/// Speed of the first body (m/s).
const SPEED: f64 = 0.1;
/// Nothing is ever rejected, and steps are as long as they are asked to be (1).
const ANY: f64 = 1.0;
/// Steps in terms of the first body's overlap over its speed: the first below what either stepper would begin with, each twice the one before,
/// so that both take it, up to the last (1).
const STEPS: [f64; 2] = [5e-4, 0.2];
const COUNT: usize = 40;

const PAIRS: [Method; 2] = [
    Method::DormandElMikkawyPrince64 { tolerance: ANY },
    Method::DormandElMikkawyPrince86 { tolerance: ANY },
];

/// Largest difference of positions and of velocities, relative to the largest position and to the first body's speed (1).
fn distance(a: &State, b: &State) -> f64 {
    let most =
        |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let farthest = b.position.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    (most(&a.position, &b.position) / farthest).max(most(&a.velocity, &b.velocity) / SPEED)
}

/// In one to seventeen rows of eight; five of them are a short chain's most. Contacts stay closed, so that nothing is put right.
#[test]
fn they_are_those_of_the_plain_loops() {
    for cells in [3, 4, 11, 15, 19, 20, 65] {
        let chain = diatomic(cells, 2.38, false);
        let mut velocities = vec![0.0; chain.bodies().len()];
        velocities[0] = SPEED;
        let unit = chain.impact_overlap(&velocities) / SPEED;
        for method in PAIRS {
            for set in InstructionSet::available() {
                let scheme = method.scheme().expect("a pair");
                let mut stepper = ChainStepper::new(&chain, &velocities, scheme, set);
                let state = chain.initial_state(&velocities);
                let mut plain = method.start(chain.system(&velocities), state);
                let (mut end, mut step) = (0.0, STEPS[0]);
                for _ in 0..COUNT {
                    end += step * unit;
                    step = (2.0 * step).min(STEPS[1]);
                    stepper.step(end).expect("a step");
                    plain.step(end).expect("a step");
                    assert!(stepper.time() == end && plain.time() == end, "whole steps");
                }
                assert_eq!(stepper.events(), Some(0), "all contacts closed");
                let off = distance(&stepper.state(), &plain.state());
                let what = format!("{} {cells} {}", method.name(), set.name());
                println!("{what}: {off:.1e}");
                // Rounding of as many steps.
                assert!(off < 1e-13, "{what}: {off:e}");
            }
        }
    }
}
