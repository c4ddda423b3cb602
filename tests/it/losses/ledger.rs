//! Energy is accounted for: motion, contacts, loads, each loss by name, and what is left in
//! contacts that are held at zero force.

use hertzscope::chain::{Chain, ChainSpec, EffectsSpec, End, EndOfContact, LossKind, LossSpec};
use hertzscope::motion::Method;

use super::{dashpot, scene_with, simulate, viscoelastic};
use crate::chains::{NEVER, STEEL, body, kicked};

const ACCURACY: f64 = 1e-9;

#[test]
fn the_ledger_closes_with_each_loss() {
    for base in ["magnet-0.61g", "gravity-2.75g"] {
        for end in ["zero_overlap", "zero_force"] {
            let power = scene_with(
                base,
                &format!(
                    "[effects.power_law_loss]\nforce_at_1_m_per_s = \"2 N\"\nexponent = 1.81\nend_of_contact = \"{end}\"\n"
                ),
            );
            let all = scene_with(
                base,
                &format!(
                    "[effects.power_law_loss]\nforce_at_1_m_per_s = \"2 N\"\nexponent = 1.81\nend_of_contact = \"{end}\"\n\
                     [effects.dashpot]\ngamma = \"0.5 N*s/m\"\nend_of_contact = \"{end}\"\n\
                     [effects.kuwabara_kono]\neta = \"1 us\"\nend_of_contact = \"{end}\"\n"
                ),
            );
            for (scene, names) in [
                (dashpot(base, 0.8, end), &["dashpot"][..]),
                (viscoelastic(base, 2e-6, end), &["kuwabara_kono"]),
                (power, &["power_law_loss"]),
                (all, &["dashpot", "kuwabara_kono", "power_law_loss"]),
            ] {
                let summary = simulate(&scene, ACCURACY);
                let energy = &summary.energy;
                println!(
                    "{base} {end} {names:?}: {} {} evaluations, {:?}, drift {:.1e}",
                    summary.method,
                    summary.force_evaluations,
                    energy.dissipated_by_kind,
                    energy.drift
                );
                let entries = &energy.dissipated_by_kind.losses;
                let found: Vec<&str> = entries.iter().map(|entry| entry.loss).collect();
                assert_eq!(found, names, "{base} {end}");
                assert!(entries.iter().all(|entry| entry.energy > 0.0), "{entries:?}");
                let left = energy.dissipated_by_kind.left_in_contacts;
                assert_eq!(left > 0.0, end == "zero_force", "{base} {names:?}: {left:e}");
                // Each step may be off by what it tolerates, a quarter of the accuracy.
                let bound = 0.25 * ACCURACY * summary.steps as f64;
                assert!(energy.drift.abs() < bound, "{base} {end}: {:e}", energy.drift);
            }
        }
    }
}

/// A run that ends while the contact is held at zero force: its elastic energy is booked as left,
/// not as elastic.
#[test]
fn contacts_held_at_the_end_are_booked() {
    let dashpot = LossSpec::everywhere(20.0, EndOfContact::ZeroForce);
    let spec = ChainSpec {
        striker: Some(body("striker", 0.61e-3, None, STEEL)),
        particles: vec![body("sphere", 0.45e-3, Some(2.38e-3), STEEL)],
        top: End::Free,
        bottom: End::Free,
        wall_preload: 0.0,
        effects: EffectsSpec::default().with_loss(LossKind::Dashpot, dashpot),
    };
    let chain = Chain::new(&spec).expect("a chain");
    let method = Method::DormandPrince853 { tolerance: 1e-11 };
    let mut bench = kicked(&chain, (0, 0.44), method, &[], NEVER);
    let before = bench.energies().0.total();
    let mut held = 0;
    for step in 1..=200 {
        bench.run_until(f64::from(step) * 0.2e-6, false, &mut |_| ()).expect("a run");
        let (_, now) = bench.energies();
        let lost = bench.dissipated();
        let closing = now.total() + lost.total() - before;
        assert!(closing.abs() < 1e-9 * before, "step {step}: {closing:e}");
        let state = bench.state();
        let overlap = state.position[0] - state.position[1];
        if overlap > 0.0 && lost.left_in_contacts > 0.0 {
            held += 1;
            assert!(now.elastic.abs() < 1e-9 * before, "step {step}: {now:?}");
        }
    }
    // The contact stays overlapped for many of the looks after it has ended.
    assert!(held > 10, "{held}");
}
