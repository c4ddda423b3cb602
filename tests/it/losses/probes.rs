//! What a probe feels of contacts with losses within a step: the force at its end by the chain's
//! own formula, and a rate of change that is the force's slope.

use hertzscope::chain::State;
use hertzscope::chain::{Chain, ForceProbe};
use hertzscope::motion::ChainSystem;
use hertzscope::motion::force_segment::over_step;
use hertzscope::motion::{Method, Scheme};
use hertzscope::scene::Scene;

use super::{dashpot, scene_with, viscoelastic};

/// Steps this tight leave interpolants off by far less than slopes by differences are.
const TOLERANCE: f64 = 1e-11;
/// Half the distance of the two forces that make a slope, in fractions of a step.
const APART: f64 = 1e-3;
/// Slopes by differences are off by this share of a third derivative, and steps are so short that a
/// force's is below the force itself.
const BOUND: f64 = APART * APART / 6.0;

#[test]
fn rates_are_slopes_and_forces_the_chains() {
    let both = scene_with(
        "magnet-2.75g",
        "[effects.magnet_preload]\nmodel = \"herbold-ring\"\n\
         [effects.power_law_loss]\nforce_at_1_m_per_s = \"2 N\"\nexponent = 1.81\nend_of_contact = \"zero_force\"\n\
         [effects.kuwabara_kono]\neta = \"1 us\"\nend_of_contact = \"zero_force\"\n",
    );
    for (name, scene) in [
        ("dashpot", dashpot("gravity-0.61g", 0.8, "zero_overlap")),
        ("dashpot that never pulls", dashpot("gravity-0.61g", 0.8, "zero_force")),
        ("viscoelastic", viscoelastic("magnet-2.75g", 1e-6, "zero_force")),
        ("two losses", both),
    ] {
        check(name, &scene);
    }
}

fn check(name: &str, scene: &Scene) {
    let Scene { chain, initial_velocities: velocities, .. } = scene;
    let bodies = chain.bodies().len();
    let mut velocity = velocities.clone();
    velocity.resize(bodies + hertzscope::chain::ACCOUNTS, 0.0);
    let start = State { time: 0.0, position: vec![0.0; velocity.len()], velocity };
    let system = ChainSystem::new(chain, velocities);
    let method = Method::DormandPrince853 { tolerance: TOLERANCE };
    let Scheme::General(scheme) = method.scheme() else { panic!("a lossless method") };
    let mut integrator = scheme.start(Box::new(system), start);
    let probes: Vec<(usize, ForceProbe)> = [1_usize, 2, 14]
        .into_iter()
        .filter_map(|particle| Some((particle, ForceProbe::inside(chain, particle, 0.1)?)))
        .collect();
    let (mut worst, mut largest, mut steps) = (0.0_f64, 0.0_f64, 0);
    while integrator.time() < 5e-4 {
        integrator.step(5e-4).expect("a step");
        integrator.prepare_interpolation();
        let state = integrator.state();
        steps += 1;
        for (particle, probe) in &probes {
            let segment = over_step(probe, &*integrator, bodies);
            for theta in [0.3, 0.8] {
                let [force, rate] = segment.force_and_rate(theta);
                assert_eq!(force.to_bits(), segment.force(theta).to_bits(), "{name}");
                let [before, after] = [theta - APART, theta + APART].map(|t| segment.force(t));
                let slope = (after - before) / (2.0 * APART);
                largest = largest.max(force.abs());
                worst = worst.max((rate * segment.length - slope).abs());
            }
            let end = segment.force(1.0);
            let exact = at_end(chain, *particle, &state, &|contact| integrator.was_on(contact));
            assert!((end - exact).abs() <= 1e-11 * largest, "{name}: {end} and {exact}");
        }
    }
    println!("{name}: {steps} steps, rates off by {:.1e} of the largest force", worst / largest);
    assert!(steps > 100 && largest > 0.1, "{name}: {steps} steps, {largest} N");
    assert!(worst < BOUND * largest, "{name}: {worst:e} of {largest}");
}

/// Dynamic force inside `particle` by the formula of its two contacts (N).
fn at_end(chain: &Chain, particle: usize, state: &State, closed: &dyn Fn(usize) -> bool) -> f64 {
    let body = chain.body_of(particle);
    let terms = [(body, 0.4), (body + 1, 0.6)].map(|(j, weight)| {
        let force = chain.contact_force(&state.position, &state.velocity, j, closed(j));
        weight * (force - chain.contacts()[j].static_force)
    });
    terms.iter().sum()
}
