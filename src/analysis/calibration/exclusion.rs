//! Why an impact does not count.

/// Why an impact is left out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Exclusion {
    /// The converter was driven to its end.
    #[error("saturated: {samples} samples at the converter's ends")]
    Saturated {
        /// How many.
        samples: usize,
    },
    /// Nothing to take the baseline from.
    #[error(
        "no pre-trigger: {samples} samples before the contact are too few for a baseline, expected 20 % of the record"
    )]
    NoPreTrigger {
        /// How many there are.
        samples: usize,
    },
    /// The window or the record does not hold the whole pulse.
    #[error("the {what} cuts the pulse at {:.1} us", 1e6 * time)]
    Cut {
        /// `window` or `record`.
        what: &'static str,
        /// Where the cut is (s).
        time: f64,
    },
    /// Another pulse in the same record.
    #[error("two impacts in one record: a second pulse at {:.1} us", 1e6 * time)]
    TwoImpacts {
        /// Where the other one is (s).
        time: f64,
    },
    /// The sensor is not at rest before the contact.
    #[error(
        "not at rest before the contact: it varies by {times:.1} times its noise; begin the record earlier, or remove drift and hum"
    )]
    NotAtRest {
        /// Root mean square over the noise of neighbouring samples (1).
        times: f64,
    },
    /// Nothing above the noise.
    #[error("no pulse above the noise")]
    NoPulse,
    /// Values that are no numbers, or a time axis that does not go on.
    #[error("values or an interval that are no numbers")]
    NotFinite,
    /// It contradicts the others.
    #[error("outlier: {times:.1} standard uncertainties away from the other impacts")]
    Outlier {
        /// How many standard uncertainties (1).
        times: f64,
    },
}
