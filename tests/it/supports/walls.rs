//! Rods and plates behind a wall.

use hertzscope::chain::{
    Backing, Body, Chain, ChainSpec, Echo, EffectsSpec, End, ForceProbe, Support,
};
use hertzscope::experiment::bench::Bench;
use hertzscope::motion::Method;

use crate::chains::{NEVER, STEEL, body};

const SPEED: f64 = 0.44;

/// A steel sphere above a wall with this behind it.
fn above(support: Support) -> Chain {
    let sphere: Body = body("sphere", 0.45e-3, Some(2.38e-3), STEEL);
    let spec = ChainSpec {
        striker: None,
        particles: vec![sphere],
        top: End::Free,
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec { supports: [Support::Rigid, support], ..EffectsSpec::default() },
    };
    Chain::new(&spec).expect("a chain")
}

/// The bench with the sphere let go at [`SPEED`], the force on the wall watched.
fn falling(chain: &Chain) -> Bench<'_> {
    let method = Method::DormandPrince853 { tolerance: 1e-13 };
    let probe = ForceProbe::contact(chain, 1).expect("a contact");
    Bench::new(chain, &[SPEED], method, &[probe], NEVER, NEVER)
}

/// Restitution, duration of contact and largest force of a sphere on a wall of impedance `Z`, in
/// units of the collision, against the table of two independent codes, whose last digit is the
/// seventh decimal: `lambda = A^(2/5) m^(3/5) v^(1/5)/Z`.
#[test]
fn an_impact_on_an_impedance_is_that_of_the_table() {
    for (lambda, restitution, duration, peak) in [
        (0.05, 0.9177715, 3.2470875, 1.0867951),
        (0.1, 0.8433394, 3.2784950, 1.0355460),
        (0.2, 0.7140449, 3.3486576, 0.9460647),
        (0.5, 0.4368953, 3.6244415, 0.7502314),
        (1.0, 0.1841229, 4.3876120, 0.5561609),
        (2.0, 0.0206825, 8.4832242, 0.3646580),
    ] {
        let rigid = above(Support::Rigid);
        let (a, m) = (rigid.contacts()[1].stiffness, 0.45e-3_f64);
        let impedance = a.powf(0.4) * m.powf(0.6) * SPEED.powf(0.2) / lambda;
        let chain = above(Support::Yielding(Backing { impedance, echo: None }));
        let length = (m * SPEED * SPEED / a).powf(0.4);
        let (time, force) = (length / SPEED, a * length.powf(1.5));
        let mut bench = falling(&chain);
        let mut end = 0.0;
        // In small pieces: what a piece ends with is exact, whatever steps it took.
        let piece = 1e-3 * time;
        for number in 1..12_000 {
            let now = f64::from(number) * piece;
            bench.run_until(now, true, &mut |_| ()).expect("a run");
            let state = bench.state();
            let overlap = chain.overlap_change_in(&state, 1);
            if overlap < 0.0 {
                // The sphere and the wall part at even speeds, the wall at rest.
                end = now + overlap / (state.velocity[0]).abs();
                break;
            }
        }
        let speed = -bench.state().velocity[0] / SPEED;
        let largest = bench.watches()[0].pulse.first_peak().expect("a peak").dynamic_n;
        println!("{lambda}: e {speed:.8}, t {:.8}, F {:.8}", end / time, largest / force);
        assert!((speed - restitution).abs() < 1e-7, "{lambda}: e {speed}");
        assert!((end / time - duration).abs() < 1e-7, "{lambda}: t {}", end / time);
        assert!((largest / force - peak).abs() < 1e-7, "{lambda}: F {}", largest / force);
        let radiated = bench.dissipated().total();
        let kinetic = 0.5 * m * SPEED * SPEED;
        let balance = radiated / kinetic + speed * speed - 1.0;
        assert!(balance.abs() < 1e-10, "{lambda}: {balance:e}");
    }
}

/// Impedances near zero and near infinity: the sphere is not turned back, or as by a rigid wall.
#[test]
fn the_limits_of_an_impedance_are_a_free_and_a_rigid_wall() {
    let rebound = |impedance: f64| {
        let chain = above(Support::Yielding(Backing { impedance, echo: None }));
        let mut bench = falling(&chain);
        bench.run_until(200e-6, false, &mut |_| ()).expect("a run");
        -bench.state().velocity[0] / SPEED
    };
    // A wall that offers hardly any force slows the sphere by `m v' = -Z v`.
    let soft = rebound(1e-2);
    assert!((soft + (-1e-2 * 200e-6 / 0.45e-3_f64).exp()).abs() < 1e-5, "{soft}");
    let hard = rebound(1e12);
    assert!((hard - 1.0).abs() < 1e-8, "{hard}");
}

/// A striker bar on a Hopkinson bar: stress `rho c v/2` for the time `2 L/c`. Two rods of the same
/// section and material meet: the one that comes is a wall that moves, and its echo ends the pulse.
/// A modulus of 2e11 Pa and a density of 7850 kg/m^3 give `c` = 5047.5 m/s; 10 m/s and 0.3 m give
/// 1.981e8 Pa for 118.9 us.
#[test]
fn a_hopkinson_bar_is_loaded_by_half_the_impedance_for_two_transits() {
    let section = 1e-4;
    let rod = Backing::rod(section, 200e9, 7850.0, Some((0.3, 1.0)));
    let speed = rod.impedance / (section * 7850.0);
    assert!((speed - 5047.5).abs() < 0.05, "{speed}");
    let stress = 0.5 * rod.impedance * 10.0 / section;
    assert!((stress / 1e6 - 198.1).abs() < 0.05, "{stress:e}");
    let Some(Echo { delay, .. }) = rod.echo else { panic!("an echo") };
    assert!((delay * 1e6 - 118.9).abs() < 0.05, "{delay:e}");
}
