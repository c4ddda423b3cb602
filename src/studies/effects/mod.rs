//! The effects ledger of a scene: what is on, why, what it costs, and what it changes.
//!
//! Cost and change are measured, by runs with and without the effect at the same accuracy, in turn;
//! a change is that of what the user reads: first peaks, arrivals and speeds of forces for effects
//! of the chain, first peaks and half-rises of the scope's signals for effects of sensors and
//! scope. An effect that is off is no part of the system that is integrated, and costs nothing.
//!
//! `tests/it/effects.rs` demands the same bytes from the same number of evaluations whether an
//! effect is off or absent.

mod chain;
mod electronics;
mod entry;
mod trial;

pub use entry::{EffectState, EffectVerdict, LedgerEntry};
pub use trial::{Change, RunTimes};

use crate::experiment::{Integration, RunError, auto_effects};
use crate::scene::Scene;
use entry::EffectFinding;
use trial::BaselineRun;

/// Effects of sensors and scope, which change records and not the motion.
const OF_RECORDS: [&str; 7] = [
    "sensor_droop",
    "sensor_tolerance",
    "bandwidth",
    "scope_offset",
    "scope_errors",
    "scope_noise",
    "quantisation",
];

/// Effects that are listed where a scene has them: they are none that it might have forgotten.
const WHERE_ON: [&str; 3] = ["contact_law", "drive", "yielding_wall"];

/// The ledger.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    /// Scene name.
    pub scene: String,
    /// Accuracy of all runs (1).
    pub accuracy: f64,
    /// One line an effect.
    pub entries: Vec<LedgerEntry>,
}

/// Makes the ledger of `scene`, with all runs held to `accuracy` (1); `progress` is called with the
/// share of the work done.
///
/// # Errors
/// [`RunError`] where the scene itself cannot be run.
pub fn ledger(
    scene: &Scene,
    accuracy: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<Ledger, RunError> {
    type Make = fn(&BaselineRun<'_>) -> LedgerEntry;
    const ENTRIES: [Make; 21] = [
        chain::striker_speed_spread,
        chain::gravity,
        chain::magnet_preload,
        chain::magnet_law,
        chain::dashpot,
        chain::kuwabara_kono,
        chain::power_law_loss,
        chain::contact_law,
        chain::linearised_contacts,
        chain::drive,
        chain::yielding_wall,
        chain::plasticity,
        chain::host_mass,
        electronics::sensor_offset,
        electronics::sensor_droop,
        electronics::sensor_tolerance,
        electronics::bandwidth,
        electronics::scope_offset,
        electronics::scope_errors,
        electronics::scope_noise,
        electronics::quantisation,
    ];
    let settled = auto_effects::resolve_auto_effects(scene, Integration::Accuracy(accuracy));
    let subject = BaselineRun::new(&settled, accuracy)?;
    let mut entries = Vec::with_capacity(ENTRIES.len());
    for (done, make) in ENTRIES.into_iter().enumerate() {
        progress(done as f64 / ENTRIES.len() as f64);
        entries.push(make(&subject));
    }
    entries.retain(|entry| entry.active || !WHERE_ON.contains(&entry.effect));
    for entry in &mut entries {
        state_decision(scene, accuracy, entry);
        let change = entry.change.as_ref();
        let of_records = OF_RECORDS.contains(&entry.effect);
        entry.verdict = EffectVerdict::of(entry.active, change, of_records, entry.value, accuracy);
    }
    Ok(Ledger { scene: scene.name.clone(), accuracy, entries })
}

/// Writes the decision on an effect with `state = "auto"` into its line of the ledger.
fn state_decision(scene: &Scene, accuracy: f64, entry: &mut LedgerEntry) {
    if scene.auto.contains(&entry.effect) {
        entry.state = EffectState::Auto;
        let decided = auto_effects::decision(scene, entry.effect, accuracy);
        // A reason why nothing could be measured stays.
        entry.reason = match entry.change {
            Some(_) => decided,
            None => format!("{decided}; {}", entry.reason),
        };
    }
}
