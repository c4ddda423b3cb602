//! Records of a shot beside its traces.

use super::message;

/// Records of a shot beside its captures and truth.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShotNotes {
    /// The front panel as `SET?` would tell it.
    pub set_up: String,
    /// The energy ledger, of a simulation.
    pub energy: Option<message::EnergyMessage>,
    /// Lines for people; `true` marks a warning.
    pub log: Vec<(bool, String)>,
}
