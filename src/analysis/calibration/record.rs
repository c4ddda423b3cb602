//! The record of one impact.

use crate::analysis::gate::Gate;
use crate::trace::Trace;

/// Safety factor on the noise: thousands of samples, none of which may pass by chance (1).
pub(super) const NOISE_TIMES: f64 = 4.0;

/// A record as it came from the scope.
#[derive(Debug, Clone, PartialEq)]
pub struct RawRecord {
    /// Voltage over time.
    pub trace: Trace,
    /// Distance of the digitiser's levels; 0 for what was never digitised (V).
    pub level: f64,
    /// Samples at the converter's ends.
    pub clipped: usize,
    /// Where to integrate; by default the contact and a little on either side.
    pub window: Option<Gate>,
}
