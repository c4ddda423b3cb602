//! Lines of what the integrator does on its own account.

use super::{BaselineRun, EffectFinding, EffectState, LedgerEntry, trial};
use crate::chain::simd::Refinement;

/// Contacts that open or close within a step.
pub fn kink_correction(subject: &BaselineRun<'_>) -> LedgerEntry {
    let chain = &subject.scene.chain;
    let films = chain.contacts().iter().zip(&subject.bench.film().contact_forces);
    let touching = films.filter(|(contact, _)| contact.stiffness > 0.0);
    let (mut all, mut open) = (0_u32, 0_u32);
    for (_, forces) in touching {
        all += 1;
        open += u32::from(forces.iter().skip(1).any(|force| *force <= 0.0));
    }
    let reason = if chain.is_dissipative() {
        "off with losses: their forces jump, and steps end where a contact changes sides"
    } else if !chain.runs_on_vectors() {
        "off where the magnet's force follows its particle: steps get shorter at contacts that open or close"
    } else {
        "steps in which a contact opens or closes are put right; the others do nothing of the kind"
    };
    let state = if chain.runs_on_vectors() { EffectState::Auto } else { EffectState::Off };
    let value = Some(f64::from(open) / f64::from(all.max(1)));
    let trial = measured(subject, Refinement::OpeningCorrection, state == EffectState::Auto);
    let active = subject.bench.contact_changes().is_some_and(|changes| changes > 0);
    let found = EffectFinding { state, value, reason: reason.to_owned(), trial };
    LedgerEntry { active, ..found.entry("kink_correction", "contacts that open / all contacts") }
}

/// Beads ahead of the wave.
pub fn active_window(subject: &BaselineRun<'_>) -> LedgerEntry {
    let scene = subject.scene;
    let on = scene.chain.runs_on_vectors();
    let reason = if on {
        "rows of eight contacts in which nothing has moved yet by 1e-30 of the impact are left alone"
    } else {
        "off: all contacts are evaluated in every step"
    };
    let mut speeds = scene.initial_velocities.iter();
    let last = speeds.rposition(|v| *v != 0.0).unwrap_or(0);
    let count = scene.initial_velocities.len().max(1);
    #[allow(clippy::cast_precision_loss, reason = "counts of beads")]
    let value = Some((count - last) as f64 / count as f64);
    let trial = measured(subject, Refinement::ActiveWindow, on);
    let state = if on { EffectState::Auto } else { EffectState::Off };
    let found = EffectFinding { state, value, reason: reason.to_owned(), trial };
    LedgerEntry {
        active: on,
        ..found.entry("quiet_part", "beads at rest ahead of the impact / all beads")
    }
}

/// Cost and change of a refinement.
fn measured(
    subject: &BaselineRun<'_>,
    refinement: Refinement,
    there: bool,
) -> Option<(trial::Cost, trial::Change)> {
    if !there {
        return None;
    }
    trial::of_refinement(subject, refinement).ok()
}
