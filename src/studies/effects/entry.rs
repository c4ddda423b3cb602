//! One line of the ledger.

use serde::Serialize;

use super::trial::{Change, EffectTrial, RunTimes};

/// Share of a digitiser level, or of a sample interval, below which a record does not show a change
/// (1).
const RECORD_SHARE: f64 = 0.1;

/// Effects whose change chance decides.
const DRAWN: [&str; 3] = ["sensor_tolerance", "scope_errors", "scope_noise"];

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

/// Whether a scene needs an effect, by the changes of peaks, arrivals and speeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum EffectVerdict {
    /// On, and without it readings differ by more than the accuracy.
    Needed,
    /// Off, and with it readings differ by more than the accuracy.
    LeftOut,
    /// Readings are the same within the accuracy.
    NoEffect,
    /// The scene gives no value that it could be tried with.
    NoValue,
    /// It could not be tried.
    NotTried,
}

impl EffectVerdict {
    /// The verdict on an effect that is `active` or not and makes this change, at `accuracy` (1).
    /// Effects `of_records`, of sensors and scope, count where they change a record by a tenth of a
    /// digitiser level or of a sample interval.
    pub(super) fn of(
        active: bool,
        change: Option<&Change>,
        of_records: bool,
        value: Option<f64>,
        accuracy: f64,
    ) -> Self {
        let Some(change) = change else {
            return if value.unwrap_or(0.0) == 0.0 { Self::NoValue } else { Self::NotTried };
        };
        let exceeds = |changes: [Option<f64>; 3], limit: f64| {
            changes.into_iter().flatten().any(|change| change.abs() > limit)
        };
        let matters = if of_records {
            exceeds([change.peak_lsb, change.arrival_samples, None], RECORD_SHARE)
        } else {
            exceeds([change.peak, change.arrival, change.speed], accuracy)
        };
        match (matters, active) {
            (false, _) => Self::NoEffect,
            (true, true) => Self::Needed,
            (true, false) => Self::LeftOut,
        }
    }

    /// As it is printed.
    pub fn word(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::LeftOut => "matters",
            Self::NoEffect => "no effect",
            Self::NoValue => "no value",
            Self::NotTried => "not tried",
        }
    }
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
    /// The dimensionless number that decides whether it matters.
    pub criterion: &'static str,
    /// Its value; none where the scene does not set what it needs (1).
    pub value: Option<f64>,
    /// Why it is on or off.
    pub reason: String,
    /// Times of whole runs with and without it; none where they were not measured.
    pub run_times: Option<RunTimes>,
    /// Whether chance decides what it changes: then changes are what 95 % of a hundred draws stay
    /// within, without a sign.
    pub is_drawn: bool,
    /// Its change, or the change if it were on; none where that was not measured.
    pub change: Option<Change>,
    /// What follows from that.
    pub verdict: EffectVerdict,
}

/// Findings on one effect, before they become an entry.
pub(super) struct EffectFinding {
    pub(super) state: EffectState,
    pub(super) value: Option<f64>,
    pub(super) reason: String,
    pub(super) trial: Option<EffectTrial>,
}

impl EffectFinding {
    /// The ledger's line.
    pub(super) fn entry(self, effect: &'static str, criterion: &'static str) -> LedgerEntry {
        LedgerEntry {
            effect,
            state: self.state,
            active: self.state == EffectState::On,
            criterion,
            value: self.value.filter(|value| value.is_finite()),
            reason: self.reason,
            is_drawn: DRAWN.contains(&effect),
            run_times: self.trial.as_ref().and_then(|(times, _)| *times),
            change: self.trial.map(|(_, change)| change),
            // Decided when the ledger is complete.
            verdict: EffectVerdict::NotTried,
        }
    }
}
