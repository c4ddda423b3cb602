//! Closed forms that the chain must reproduce.

use hertzscope::analysis::dispersion::DiatomicChain;
use hertzscope::chain::{Chain, ChainSpec, EffectsSpec, End, ForceProbe, hertz};
use hertzscope::experiment::bench::Grid;
use hertzscope::motion::ChainSystem;
use hertzscope::motion::{Method, System};

use super::chains::{
    ALUMINA, NEVER, PTFE, STEEL, body, diatomic, kicked, pressed, ptfe_sphere, steel_cylinder,
};

/// Tight enough that what is left is rounding.
const TIGHT: Method = Method::DormandPrince853 { tolerance: 1e-14 };

/// `found` is `expected` to `digits` significant digits, as printed.
fn agrees(found: f64, expected: f64, digits: i32) {
    let tolerance = 0.51 * 10f64.powi(expected.abs().log10().floor() as i32 + 1 - digits);
    assert!((found - expected).abs() <= tolerance, "{found} is not {expected}");
}

fn bench_chain() -> DiatomicChain {
    let stiffness = hertz::stiffness((PTFE, 1.0 / 2.38e-3), (STEEL, 0.0));
    let overlap = hertz::overlap(stiffness, 2.38);
    DiatomicChain {
        exponent: 1.5,
        light_mass: 0.1226e-3,
        heavy_mass: 0.485e-3,
        stiffness: hertz::tangent_stiffness(stiffness, overlap),
        cell: 2.0 * (3.12e-3 / 2.0 + 2.38e-3 - overlap),
    }
}

#[test]
fn contact_and_dispersion_constants() {
    let stiffness = hertz::stiffness((PTFE, 1.0 / 2.38e-3), (STEEL, 0.0));
    agrees(stiffness, 1.194147186e8, 10);
    agrees(hertz::overlap(stiffness, 2.38), 7.350994e-6, 7);
    let chain = bench_chain();
    agrees(chain.stiffness, 485_648.611310, 12);
    agrees(chain.cell, 7.865298e-3, 7);
    agrees(chain.gap_bottom(), 7122.383, 7);
    agrees(chain.gap_top(), 14_166.122, 8);
    agrees(chain.cutoff(), 15_855.830, 8);
    agrees(chain.surface_mode(), 11_211.765, 8);
    agrees(chain.sound_speed(), 157.236, 6);
    agrees(chain.decay(10_000.0), 1.3022, 5);
    assert_eq!(chain.decay(7000.0), 0.0);
    // What the paper prints comes out with 2.376 N, rounded to 2.38 in print.
    agrees(hertz::overlap(stiffness, 2.376), 7.34e-6, 3);
}

/// The chain's own accelerations of a Bloch wave are `-omega^2 u` on both branches, away from the
/// ends.
#[test]
fn chain_obeys_the_dispersion_relation() {
    let chain = diatomic(40, 2.38, true);
    let mut system = ChainSystem::new(&chain, &[0.0; 80]);
    let expected = bench_chain();
    for phase in [0.1, 1.0, 2.0, 3.0_f64] {
        for (frequency, optical) in
            [(expected.acoustic(phase), false), (expected.optical(phase), true)]
        {
            let omega_squared = (std::f64::consts::TAU * frequency).powi(2);
            // Eq. (8): the ratio of heavy to light amplitude.
            let ratio = (2.0 * expected.stiffness - expected.light_mass * omega_squared)
                / (2.0 * expected.stiffness * (phase / 2.0).cos());
            assert_eq!(ratio < 0.0, optical, "branches differ by the sign of the ratio");
            let shape = |index: usize| {
                let amplitude = if index.is_multiple_of(2) { 1.0 } else { ratio };
                1e-9 * amplitude * (phase * index as f64 / 2.0 + 0.3).cos()
            };
            let position: Vec<f64> = (0..80).map(shape).collect();
            let mut acceleration = vec![0.0; 80];
            system.accelerations(&position, &[0.0; 80], &mut acceleration);
            for index in 1..79 {
                let residual = acceleration[index] + omega_squared * position[index];
                let scale = omega_squared * 1e-9 * ratio.abs().max(1.0);
                assert!(residual.abs() < 1e-11 * scale, "phase {phase}, body {index}");
            }
        }
    }
}

/// A striker of 0.61 g on a free sphere of 0.45 g at 0.44 m/s: Hertz's collision.
#[test]
fn two_body_collision() {
    let (mass, other, speed) = (0.61e-3, 0.45e-3, 0.44);
    let spec = ChainSpec {
        striker: Some(body("striker", mass, None, ALUMINA)),
        particles: vec![body("sphere", other, Some(2.38e-3), STEEL)],
        top: End::Free,
        bottom: End::Free,
        wall_preload: 0.0,
        effects: EffectsSpec::default(),
    };
    let chain = Chain::new(&spec).expect("a chain");
    let stiffness = chain.contacts()[1].stiffness;
    agrees(stiffness, 9_169_263_323.248, 13);
    let reduced = mass * other / (mass + other);
    let overlap = hertz::collision_overlap(stiffness, reduced, speed);
    agrees(overlap, 2.157182864375912e-6, 15);
    let probe = ForceProbe::contact(&chain, 1).expect("the contact");
    let mut bench = kicked(&chain, (0, speed), TIGHT, &[probe], NEVER);
    bench.run_until(20e-6, true, &mut |_| ()).expect("a run");
    let pulse = &bench.watches()[0].pulse;
    let peak = pulse.first_peak().expect("a peak");
    let largest = stiffness.powf(0.4) * (1.25 * reduced * speed * speed).powf(0.6);
    assert!((peak.dynamic_n / largest - 1.0).abs() < 1e-12);
    // Half of the contact's duration, 2.943275184324705 overlap/speed.
    let half = 0.5 * 2.943_275_184_324_705 * overlap / speed;
    assert!((peak.time_s / half - 1.0).abs() < 1e-11);
    let velocity = &bench.state().velocity;
    let expected = [(mass - other) / (mass + other) * speed, 2.0 * mass / (mass + other) * speed];
    for (found, expected) in velocity.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12 * speed);
    }
}

/// Equal spheres that merely touch: the discrete solitary wave. Constants to the digits that an
/// independent fixed-point solution gives.
#[test]
fn solitary_wave_constants() {
    let particles: Vec<_> = (0..120).map(|_| ptfe_sphere()).collect();
    let chain = Chain::new(&pressed(particles, 0.0, false)).expect("a chain");
    let stiffness = chain.contacts()[50].stiffness;
    let mass = chain.bodies()[0].mass;
    let contact = |j: usize| ForceProbe::contact(&chain, j).expect("a contact");
    let inside = ForceProbe::inside(&chain, 61, 0.0).expect("a particle");
    // Settled long before contact 50: the kicked end's trains separate algebraically.
    let grid = Grid { start: 0.0, interval: 20e-9 };
    let mut bench = kicked(&chain, (0, 0.44), TIGHT, &[contact(50), contact(90), inside], grid);
    bench.run_until(3.5e-3, true, &mut |_| ()).expect("a run");
    let peaks: Vec<_> =
        bench.watches().iter().map(|watch| watch.pulse.first_peak().expect("a pulse")).collect();
    let speed = 40.0 / (peaks[1].time_s - peaks[0].time_s);
    let force = peaks[1].dynamic_n;
    let constant = speed * mass.sqrt() / (stiffness.cbrt() * force.powf(1.0 / 6.0));
    assert!((constant - 0.905_515_776_419).abs() < 1e-10, "{constant}");
    agrees(peaks[2].dynamic_n / peaks[0].dynamic_n, 0.707_324, 6);
    let width = |watch: usize| {
        let half = 0.5 * peaks[watch].dynamic_n;
        let above = bench.watches()[watch].samples.iter().filter(|f| **f > half).count();
        above as f64 * grid.interval * speed
    };
    // A sample more or less is 20 ns, 6e-4 spacings.
    assert!((width(0) - 1.41193).abs() < 1.2e-3, "{}", width(0));
    assert!((width(2) - 2.06870).abs() < 1.2e-3, "{}", width(2));
}

/// Where nothing but `A overlap^1.5` acts, striking `s` times as fast is the same motion:
/// `t s^(-1/5)`, `F s^(6/5)`.
#[test]
fn sonic_vacuum_scales() {
    let arrival = |speed: f64| {
        let particles: Vec<_> = (0..20).flat_map(|_| [ptfe_sphere(), steel_cylinder()]).collect();
        let chain = Chain::new(&pressed(particles, 0.0, false)).expect("a chain");
        let probe = ForceProbe::inside(&chain, 20, 0.0).expect("a particle");
        let mut bench = kicked(&chain, (0, speed), TIGHT, &[probe], NEVER);
        bench.run_until(2e-3 * speed.powf(-0.2), true, &mut |_| ()).expect("a run");
        bench.watches()[0].pulse.first_peak().expect("a pulse")
    };
    let (slow, fast) = (arrival(0.3), arrival(0.9));
    assert!((fast.time_s / slow.time_s / 3f64.powf(-0.2) - 1.0).abs() < 1e-11);
    assert!((fast.dynamic_n / slow.dynamic_n / 3f64.powf(1.2) - 1.0).abs() < 1e-11);
}

/// Bessel function of the first kind by its integral, `1/pi int cos(n s - x sin s) ds` over half a
/// turn; the trapezoidal rule converges exponentially for a periodic integrand.
fn bessel(order: usize, x: f64) -> f64 {
    let points = 1024;
    let term = |i: usize| {
        let s = std::f64::consts::TAU * i as f64 / points as f64;
        (order as f64 * s - x * s.sin()).cos()
    };
    (0..points).map(term).sum::<f64>() / points as f64
}

/// A linear chain kicked at its free end: `v_n(t) = v0 [J_2n(2wt) + J_2n+2(2wt)]`.
#[test]
fn linear_chain_with_free_end() {
    let particles: Vec<_> = (0..200).map(|_| ptfe_sphere()).collect();
    let chain = Chain::new(&pressed(particles, 2.38, true)).expect("a chain");
    let omega = (chain.contacts()[1].static_stiffness() / chain.bodies()[0].mass).sqrt();
    let speed = 0.01;
    let mut bench = kicked(&chain, (0, speed), TIGHT, &[], NEVER);
    let time = 100.0 / (2.0 * omega);
    bench.run_until(time, false, &mut |_| ()).expect("a run");
    for n in 0..100 {
        let exact = speed * (bessel(2 * n, 100.0) + bessel(2 * n + 2, 100.0));
        let found = bench.state().velocity[n];
        assert!((found - exact).abs() < 1e-12 * speed, "mass {n}: {found} is not {exact}");
    }
}

/// An end force presses on the outermost face: plates in the end particles feel all of it, as those
/// inside do.
#[test]
fn end_forces_are_felt_at_the_ends() {
    let particles: Vec<_> = (0..6).map(|_| ptfe_sphere()).collect();
    let chain = Chain::new(&pressed(particles, 5.0, false)).expect("a chain");
    for particle in 1..=6 {
        for offset in [-0.5, 0.0, 0.5] {
            let probe = ForceProbe::inside(&chain, particle, offset).expect("a particle");
            assert!((probe.static_force() - 5.0).abs() < 1e-14, "{particle} {offset}");
        }
    }
    // And the energy still closes while the ends move against it.
    let mut bench = kicked(&chain, (0, 0.2), TIGHT, &[], NEVER);
    bench.run_until(2e-3, false, &mut |_| ()).expect("a run");
    let (before, now) = bench.energies();
    assert!((now.total() / before.total() - 1.0).abs() < 1e-11);
}

/// Two beads that meet at 1 m/s each are, seen from one of them, a bead at rest that is hit at 2
/// m/s: the same steps are stable.
#[test]
fn stability_depends_on_the_speed_of_approach_alone() {
    let spec = pressed(vec![ptfe_sphere(), ptfe_sphere()], 0.0, false);
    let chain = Chain::new(&spec).expect("a chain");
    let limit =
        |velocities: [f64; 2]| chain.stability_limit(&velocities, 2.0).expect("a limit").step;
    let (both, one) = (limit([1.0, -1.0]), limit([2.0, 0.0]));
    assert!((both / one - 1.0).abs() < 1e-12, "{both:e} and {one:e}");
}

/// A column between two walls, kicked in its middle particle: by symmetry the top wall bears what
/// the bottom wall bears, with the opposite sign; gravity is off.
#[test]
fn a_probe_at_the_top_wall_is_the_mirror_image_of_one_at_the_bottom() {
    let mut spec = pressed(vec![ptfe_sphere(); 5], 0.0, false);
    (spec.top, spec.bottom, spec.wall_preload) = (End::Wall(STEEL), End::Wall(STEEL), 5.0);
    let chain = Chain::new(&spec).expect("a chain");
    let probes = [0, 5].map(|contact| ForceProbe::contact(&chain, contact).expect("a probe"));
    assert!(probes.iter().all(|probe| (probe.static_force() - 5.0).abs() < 1e-12));
    for method in [TIGHT, Method::DormandElMikkawyPrince86 { tolerance: 1e-12 }] {
        let forces = |speed: f64| {
            let samples = Grid { start: 0.0, interval: 1e-6 };
            let mut bench = kicked(&chain, (2, speed), method, &probes, samples);
            bench.run_until(0.3e-3, true, &mut |_| ()).expect("a run");
            bench.watches().iter().map(|watch| watch.samples.clone()).collect::<Vec<_>>()
        };
        let (down, up) = (forces(0.2), forces(-0.2));
        let largest = down[0].iter().fold(0.0_f64, |most, force| most.max(force.abs()));
        assert!(largest > 1.0, "{largest}");
        for (top, bottom) in down[0].iter().zip(&up[1]) {
            assert!((top - bottom).abs() < 1e-9 * largest, "{method}: {top} and {bottom}");
        }
    }
}
