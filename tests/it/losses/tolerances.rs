//! Errors over many accuracies asked for, with losses and under a magnet that follows its particle,
//! of runs that nobody checks, as in a sweep: none may miss, however its steps happen to fall on
//! the openings of contacts.

use hertzscope::experiment::Integration;
use hertzscope::experiment::ensemble::{Case, places};
use hertzscope::experiment::pulse::{Peak, PulseRecorder};
use hertzscope::motion::Method;
use hertzscope::motion::kernel::InstructionSet;

use super::{dashpot, scene_with, viscoelastic};

/// Accuracies asked for, from 1e-2 to 1e-9.
const ACCURACIES: u32 = 40;

/// First peaks of a scene's first shot in all its places.
fn peaks(case: &Case, integration: Integration) -> Vec<Peak> {
    let readout = case.run(integration, InstructionSet::best()).expect("a run");
    let peak = |pulse: &PulseRecorder| pulse.first_peak().expect("a peak");
    readout.pulses.iter().map(peak).collect()
}

/// Largest relative error of forces and times (1).
fn off(found: &[Peak], exact: &[Peak]) -> f64 {
    let off = |(a, b): (&Peak, &Peak)| {
        let force = (a.dynamic_n / b.dynamic_n - 1.0).abs();
        let time = (a.time_s / b.time_s - 1.0).abs();
        // What is not a number would pass for no error at all.
        assert!(force.is_finite() && time.is_finite(), "{a:?}, {b:?}");
        force.max(time)
    };
    assert_eq!(found.len(), exact.len());
    found.iter().zip(exact).map(off).fold(0.0, f64::max)
}

fn each(base: &str) {
    let dashpots = [0.1, 0.5, 1.0, 2.0, 4.0, 5.0, 5.5, 6.0, 7.0, 8.0, 12.0];
    let free = |gamma: f64| (format!("{gamma} N s/m"), dashpot(base, gamma, "zero_overlap"));
    let mut scenes: Vec<_> = dashpots.into_iter().map(free).collect();
    for eta in [0.1e-6, 0.5e-6, 2e-6] {
        scenes.push((format!("eta {eta:e} s"), viscoelastic(base, eta, "zero_overlap")));
    }
    let law = "[effects.power_law_loss]\nforce_at_1_m_per_s = \"2 N\"\nexponent = 1.81\n";
    let power = scene_with(base, &format!("{law}end_of_contact = \"zero_overlap\"\n"));
    scenes.push(("power law".to_owned(), power));
    scenes.push(("1 N s/m that never pulls".to_owned(), dashpot(base, 1.0, "zero_force")));
    if base.starts_with("magnet") {
        let magnet = "model = \"ring-15-6-6\"\nparticle = 1\nforce = \"2.38 N\"\n";
        let scene = scene_with(base, &format!("[effects.magnet_preload]\n{magnet}"));
        assert!(!scene.chain.is_plain() && !scene.chain.is_dissipative());
        scenes.push(("a magnet that follows".to_owned(), scene));
    }
    for (name, scene) in scenes {
        let case = Case::of(&scene, 1e-6, &places(&scene));
        let exact = Method::DormandPrince853 { tolerance: 1e-15 };
        let exact = peaks(&case, Integration::Method(exact));
        let mut worst = (0.0, 0.0);
        for number in 0..=ACCURACIES {
            let accuracy = 10f64.powf(-2.0 - 7.0 * f64::from(number) / f64::from(ACCURACIES));
            let off = off(&peaks(&case, Integration::Accuracy(accuracy)), &exact) / accuracy;
            worst = if off > worst.0 { (off, accuracy) } else { worst };
        }
        let (off, accuracy) = worst;
        println!("{base}, {name}: {off:.2} of what is asked for, at {accuracy:.2e}");
        assert!(off <= 1.0, "{base}, {name}: {off:.2} at {accuracy:e}");
    }
}

#[test]
fn under_gravity() {
    each("gravity-0.61g");
}

#[test]
fn under_the_magnet() {
    each("magnet-0.61g");
}

#[test]
fn behind_a_heavy_striker() {
    each("magnet-17.81g");
}
