//! Conditions on a pulse, and the errors where one fails.

use super::gate::Gate;

/// A peak counts when it exceeds this share of the trace's largest value (1).
pub const PEAK_SHARE: f64 = 0.25;

/// Conditions under which a trace was taken.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Conditions {
    /// Distance of the digitiser's levels; 0 for a trace that was never digitised (unit).
    pub level: f64,
    /// Time constant of the sensor's circuit, where known: then its droop is undone (s).
    pub time_constant: Option<f64>,
    /// Where nothing has arrived yet; by default two thirds of the time before the pulse.
    pub baseline: Option<Gate>,
}

/// Why a trace has no pulse to measure.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PulseError {
    /// Nothing before the pulse.
    #[error(
        "found {samples} samples of {trace} before the pulse, expected at least {MIN_BASELINE_SAMPLES} to take the baseline from"
    )]
    NoBaseline {
        /// The trace's name.
        trace: String,
        /// How many there are.
        samples: usize,
    },
    /// The record begins amid the pulse's foot.
    #[error(
        "{trace} begins so shortly before the pulse that its foot hides the zero, by about {:.0} % of the largest value; begin the record earlier (more pre-trigger)",
        100.0 * share
    )]
    NoZero {
        /// The trace's name.
        trace: String,
        /// Mean of the foot over the largest value (1).
        share: f64,
    },
    /// The record begins in motion.
    #[error(
        "{trace} is not at rest before the pulse: it varies by {rms:.2e}, its noise is {noise:.2e}; begin the record earlier (more pre-trigger), or remove drift and hum"
    )]
    NotAtRest {
        /// The trace's name.
        trace: String,
        /// Root mean square before the pulse (unit).
        rms: f64,
        /// Noise of one sample, from the differences of neighbours (unit).
        noise: f64,
    },
    /// The zero moves by less than a scope without noise shows.
    #[error(
        "{trace}: the zero moves before the pulse by a level or so, and the scope's noise is too small to show how: take fewer volts a division, earth the probe, trigger on line or let the scope warm up"
    )]
    Unresolved {
        /// The trace's name.
        trace: String,
    },
    /// Drift, hum or 1/f noise hides the zero under the pulse.
    #[error(
        "{trace}: {kinds} before the pulse leaves the zero under it uncertain by ±{:.0} % of its height: earth the probe, trigger on line, take more pre-trigger or a shorter time base",
        200.0 * share
    )]
    Disturbed {
        /// The trace's name.
        trace: String,
        /// What was found.
        kinds: String,
        /// Standard uncertainty of the zero over the height (1).
        share: f64,
    },
    /// The signal still rises at the record's end.
    #[error(
        "{trace} ends at {:.1} us, before the signal has fallen from its first peak: take a longer record (slower time base) or less pre-trigger",
        1e6 * end
    )]
    Cut {
        /// The trace's name.
        trace: String,
        /// End of the record (s).
        end: f64,
    },
    /// Nothing above the noise.
    #[error(
        "found a largest deviation of {largest:e} in {trace}, expected more than {MIN_PROMINENCE} times its noise of {noise:e}"
    )]
    NoPulse {
        /// The trace's name.
        trace: String,
        /// Largest deviation from the baseline (unit).
        largest: f64,
        /// Standard uncertainty of one sample (unit).
        noise: f64,
    },
    /// A value or interval is not a number.
    #[error(
        "found a value or interval of {trace} that is not finite or not above zero, expected numbers"
    )]
    NotFinite {
        /// The trace's name.
        trace: String,
    },
}

/// A maximum must stand out by this many standard deviations: two samples differ by 1.4 of one, and
/// a rise has many (1).
pub(super) const MIN_PROMINENCE: f64 = 6.0;

/// Fewest samples of a baseline.
pub(super) const MIN_BASELINE_SAMPLES: usize = 8;
