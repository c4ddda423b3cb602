//! One line of the ledger.

use serde::Serialize;

use super::trial::{Change, Cost};

/// Whether an effect is part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum EffectState {
    /// It is.
    On,
    /// It is not.
    Off,
    /// The program decides; the reason says how.
    Auto,
}

/// One line of the ledger.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LedgerEntry {
    /// Name; that of its table in a scene, where it has one.
    pub effect: &'static str,
    /// On, off, or decided by the program.
    pub state: EffectState,
    /// Whether it is part of this run.
    pub active: bool,
    /// The dimensionless number that tells whether it matters.
    pub criterion: &'static str,
    /// Its value; none where the scene does not set what it needs (1).
    pub value: Option<f64>,
    /// Why it is on or off.
    pub reason: String,
    /// Wall time it adds to a step, the median of runs in turn; for effects of sensors and scope, what they add to the whole over the
    /// steps (ns).
    pub cost_ns_per_step: Option<f64>,
    /// Its standard uncertainty, from the scatter of the runs; a cost below twice this is not resolved (ns).
    pub cost_u_ns_per_step: Option<f64>,
    /// That time as a share of the run with it (1).
    pub cost_share: Option<f64>,
    /// Its change, or the change if it were on; none where that was not measured.
    pub change: Option<Change>,
}

/// Findings on one effect, before they become an entry.
pub(super) struct EffectFinding {
    pub(super) state: EffectState,
    pub(super) value: Option<f64>,
    pub(super) reason: String,
    pub(super) trial: Option<(Cost, Change)>,
}

impl EffectFinding {
    /// The ledger's line.
    pub(super) fn entry(self, effect: &'static str, criterion: &'static str) -> LedgerEntry {
        let cost = self.trial.as_ref().and_then(|(cost, _)| cost.measured);
        LedgerEntry {
            effect,
            state: self.state,
            active: self.state == EffectState::On,
            criterion,
            value: self.value.filter(|value| value.is_finite()),
            reason: self.reason,
            cost_ns_per_step: cost.map(|bill| bill.per_step),
            cost_u_ns_per_step: cost.map(|bill| bill.u),
            cost_share: cost.map(|bill| bill.share),
            change: self.trial.map(|(_, change)| change),
        }
    }
}
