//! Driven ends.

use std::f64::consts::{SQRT_2, TAU};

use hertzscope::chain::{
    Body, Carrier, Chain, ChainSpec, Drive, EffectsSpec, Elasticity, End, EndOfContact, ForceProbe,
    LinearisedContacts, LossKind, LossSpec, Signal, Support,
};
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::motion::Method;

use crate::chains::NEVER;

/// Stiffness of all contacts of the driven dimer (N/m).
const BETA: f64 = 4.856e5;
const LIGHT: f64 = 0.1226e-3;
const HEAVY: f64 = LIGHT / 0.2528;
const RADIUS: f64 = 2e-3;
const MODULUS: f64 = 1e9;

/// A body of a material without lateral contraction.
fn sphere(mass: f64) -> Body {
    Body {
        name: "sphere".into(),
        mass,
        length: 2.0 * RADIUS,
        curvature: 1.0 / RADIUS,
        elasticity: Elasticity { youngs_modulus: MODULUS, poissons_ratio: 0.0 },
        axis: None,
        yield_strength: None,
    }
}

/// A flat wall as stiff against a sphere as spheres are against each other:
/// `E* sqrt(R) = (E/2) sqrt(R/2)`, `1/E* = 1/E + 1/E_w`.
fn wall() -> End {
    let youngs_modulus = MODULUS / (2.0 * SQRT_2 - 1.0);
    End::Wall(Elasticity { youngs_modulus, poissons_ratio: 0.0 })
}

/// 38 light and heavy spheres in turn between a driven wall and a held one, all contacts of
/// stiffness [`BETA`].
fn dimer(drive: Drive, effects: EffectsSpec) -> Chain {
    let stiffness = 4.0 / 3.0 * 0.5 * MODULUS * (0.5 * RADIUS).sqrt();
    let preload = (BETA / 1.5).powi(3) / (stiffness * stiffness);
    let spec = ChainSpec {
        striker: None,
        particles: (0..38).map(|i| sphere(if i % 2 == 0 { LIGHT } else { HEAVY })).collect(),
        top: wall(),
        bottom: wall(),
        wall_preload: preload,
        effects: EffectsSpec { supports: [Support::Driven(drive), Support::Rigid], ..effects },
    };
    let chain = Chain::new(&spec).expect("a chain");
    for contact in chain.contacts() {
        assert!((contact.static_stiffness() / BETA - 1.0).abs() < 1e-12);
    }
    chain
}

fn sine(amplitude: f64, frequency: f64, edge: f64) -> Drive {
    let signal = Signal { carrier: Carrier::Sine { frequency }, length: f64::INFINITY, edge };
    Drive { amplitude, stiffness: None, signal }
}

/// Amplitude of `values`, one every `interval` (s), at `frequency` (Hz), under a Nuttall window.
fn amplitude(values: &[f64], interval: f64, frequency: f64) -> f64 {
    const WINDOW: [f64; 4] = [0.355768, -0.487396, 0.144232, -0.012604];
    let (mut cosine, mut sine, mut sum) = (0.0, 0.0, 0.0);
    for (i, value) in values.iter().enumerate() {
        let turn = TAU * (i as f64 + 0.5) / values.len() as f64;
        let weight: f64 = WINDOW.iter().enumerate().map(|(k, a)| a * (k as f64 * turn).cos()).sum();
        let phase = TAU * frequency * interval * i as f64;
        cosine += weight * value * phase.cos();
        sine += weight * value * phase.sin();
        sum += weight;
    }
    2.0 * cosine.hypot(sine) / sum
}

/// Ratio of the amplitudes of the forces in particles 14 and 2.
fn ratio(chain: &Chain, frequency: f64, rise: f64, tolerance: f64) -> f64 {
    let probes = [2, 14].map(|particle| ForceProbe::inside(chain, particle, 0.0).expect("a probe"));
    let interval = 1.0 / (40.0 * frequency);
    let grid = Grid { start: rise, interval };
    let method = Method::DormandPrince853 { tolerance };
    let rest = vec![0.0; 38];
    let mut bench = Bench::new(chain, &rest, method, &probes, grid, NEVER);
    bench.run_until(2.0 * rise, false, &mut |_| ()).expect("a run");
    let [near, far] =
        [0, 1].map(|probe| amplitude(&bench.watches()[probe].samples, interval, frequency));
    println!("{frequency} Hz: {:.9e}, {:?}", far / near, bench.work());
    far / near
}

/// The table of two independent codes (frequency domain; direct simulation), without losses. In the
/// gap the force falls by `e^(-6 kappa)` over the six cells.
#[test]
fn a_driven_linear_dimer_transmits_as_in_the_table() {
    let linear =
        EffectsSpec { linearised_contacts: Some(LinearisedContacts), ..EffectsSpec::default() };
    for (frequency, expected, tolerance) in [
        (5e3, 6.028494696e-1, 1e-6),
        (1e4, 4.045222730e-4, 1e-6),
        (1.1e4, 2.647039843e-4, 1e-6),
        (1.3e4, 1.014981142e-3, 1e-6),
        (1.8e4, 5.187539685e-7, 1e-6),
    ] {
        let chain = dimer(sine(1e-9, frequency, 40e-3), linear.clone());
        let found = ratio(&chain, frequency, 40e-3, 1e-12);
        assert!((found / expected - 1.0).abs() < tolerance, "{frequency} Hz: {found:e}");
        if frequency == 1e4 {
            let decay = (-6.0 * 1.30213396_f64).exp();
            println!("e^(-6 kappa): off by {:e}", found / decay - 1.0);
            assert!((found / decay - 1.0).abs() < 1e-8, "{found:e}, {decay:e}");
        }
    }
}

/// The same with dashpots of 0.8 N s/m in all contacts, and a drive so weak that the chain is
/// linear to twelve digits.
#[test]
fn a_driven_dimer_with_dashpots_transmits_as_in_the_table() {
    let loss = LossSpec::everywhere(0.8, EndOfContact::ZeroOverlap);
    let lossy = EffectsSpec::default().with_loss(LossKind::Dashpot, loss);
    for (frequency, expected) in
        [(5e3, 6.079339547e-1), (1e4, 3.856883598e-4), (1.5e4, 1.300442185e-3)]
    {
        let chain = dimer(sine(1e-13, frequency, 40e-3), lossy.clone());
        let found = ratio(&chain, frequency, 40e-3, 1e-11);
        assert!((found / expected - 1.0).abs() < 1e-6, "{frequency} Hz: {found:e}");
    }
}

/// A strong burst, under which contacts open, with and without dashpots, from either end, by
/// displacement and by a stack: what the drive put in is in the bodies, in the contacts, in the
/// stack, or lost.
#[test]
fn the_work_of_a_drive_is_the_change_of_energy_and_the_losses() {
    let loss = LossSpec::everywhere(0.8, EndOfContact::ZeroForce);
    let lossy = EffectsSpec::default().with_loss(LossKind::Dashpot, loss);
    for (effects, stiffness, end) in [
        (EffectsSpec::default(), None, 0),
        (EffectsSpec::default(), Some(3e6), 0),
        (EffectsSpec::default(), Some(3e6), 1),
        (lossy.clone(), None, 1),
        (lossy, Some(3e6), 0),
    ] {
        let frequency = 8e3;
        let signal = Signal {
            carrier: Carrier::Sine { frequency },
            length: 5.0 / frequency,
            edge: 2.5 / frequency,
        };
        let drive = Drive { amplitude: 20e-6, stiffness, signal };
        let mut supports = [Support::Rigid, Support::Rigid];
        supports[end] = Support::Driven(drive);
        let spec = ChainSpec {
            striker: None,
            particles: (0..12).map(|i| sphere(if i % 2 == 0 { LIGHT } else { HEAVY })).collect(),
            top: wall(),
            bottom: wall(),
            wall_preload: 2.0,
            effects: EffectsSpec { supports, ..effects },
        };
        let chain = Chain::new(&spec).expect("a chain");
        let method = Method::DormandPrince853 { tolerance: 1e-12 };
        let rest = vec![0.0; 12];
        let mut bench = Bench::new(&chain, &rest, method, &[], NEVER, NEVER);
        bench.run_until(1.5e-3, false, &mut |_| ()).expect("a run");
        let (before, after) = bench.energies();
        let taken = bench.dissipated();
        let work = taken.work_of_drive.expect("a drive");
        let missing = after.total() + taken.total() - before.total();
        println!("work {work:e} J, losses {:?}, missing {:e}", taken.losses, missing / work);
        assert!(work > 1e-6, "{work}");
        assert!(missing.abs() < 1e-9 * work, "{missing:e} of {work:e}");
    }
}

/// The second harmonic of a weak drive grows as the square of its amplitude.
#[test]
fn the_second_harmonic_of_a_weak_drive_grows_as_its_square() {
    let frequency = 3e3;
    let harmonic = |strength: f64| {
        let chain = dimer(sine(strength, frequency, 20e-3), EffectsSpec::default());
        let probe = ForceProbe::inside(&chain, 2, 0.0).expect("a probe");
        let interval = 1.0 / (40.0 * frequency);
        let grid = Grid { start: 20e-3, interval };
        let method = Method::DormandPrince853 { tolerance: 1e-11 };
        let rest = vec![0.0; 38];
        let mut bench = Bench::new(&chain, &rest, method, &[probe], grid, NEVER);
        bench.run_until(40e-3, false, &mut |_| ()).expect("a run");
        amplitude(&bench.watches()[0].samples, interval, 2.0 * frequency)
    };
    let found = [1e-8, 2e-8, 4e-8].map(harmonic);
    for pair in found.windows(2) {
        let exponent = (pair[1] / pair[0]).log2();
        println!("exponent {exponent:.5}");
        assert!((exponent - 2.0).abs() < 0.02, "{exponent}: {found:?}");
    }
}
