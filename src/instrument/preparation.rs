//! Records made of signals away from the instrument: on long records that takes a second, in which
//! the instrument has to answer.

use super::outcome::TriggerInstant;
use super::record::{AcquisitionSettings, Signals};
use crate::scope::{Panel, Setup, Waveform};

/// What records are made with: settings, and the time (s).
#[derive(Debug, Clone, PartialEq)]
pub struct Preparation {
    pub(super) panel: Panel,
    pub(super) setup: Setup,
    pub(super) seed: u64,
    pub(super) now: f64,
}

/// Records of signals under some settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Prepared {
    pub(super) by: Preparation,
    pub(super) taken: Option<(Vec<Waveform>, TriggerInstant)>,
}

impl Preparation {
    /// Conditions and digitises `signals`, and looks for the trigger. Signals of another sample
    /// interval have no records.
    pub fn take(self, signals: &Signals) -> Prepared {
        let settings =
            AcquisitionSettings { panel: &self.panel, setup: &self.setup, seed: self.seed };
        let taken = if settings.fits(signals) { settings.take(signals, self.now) } else { None };
        Prepared { by: self, taken }
    }

    /// Whether the same signals have the same records with this front panel and set-up.
    pub(super) fn is_like(&self, panel: &Panel, setup: &Setup) -> bool {
        let records = |number: &u8| self.panel.records(*number) == panel.records(*number);
        self.setup == *setup
            && self.panel.trigger_type == panel.trigger_type
            && self.panel.pulse == panel.pulse
            && (1..=setup.model.channels).all(|number| records(&number))
    }
}
