//! The scores of a comparison as data.

use crate::quantity::Uncertain;
use serde::Serialize;

/// Scores of one channel.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChannelScore {
    /// The measured channel.
    pub name: String,
    /// The simulated channel.
    pub against: String,
    /// The sensor, where known.
    pub sensor: Option<String>,
    /// Where it is known from that the two belong together.
    pub mapped_by: &'static str,
    /// How much later the simulated trace was put (s).
    pub shift_s: f64,
    /// Measured over simulated, noise on both sides, its uncertainty from the residuals; not taken
    /// out.
    pub gain: Uncertain,
    /// Relative standard uncertainty of the measuring channel's gain, from its data sheet; 0 for an
    /// exact scope (1).
    pub gain_u: f64,
    /// Unit in which both sides are compared: the measurement's, or that of both.
    pub unit: String,
    /// Offset: the measured trace where the simulated one is zero; not removed (unit).
    pub offset: f64,
    /// First peak of the measured trace, in the unit of the channel.
    pub peak_measured: Option<Uncertain>,
    /// First peak of the simulated trace, in the unit of the channel.
    pub peak_simulated: Option<Uncertain>,
    /// Measured over simulated first peak, less one.
    pub peak_error: Option<Uncertain>,
    /// Arrival of the measured trace after its trigger, half-rise, seconds.
    pub arrival_measured_s: Option<Uncertain>,
    /// Arrival of the simulated trace after its own trigger, seconds.
    pub arrival_simulated_s: Option<Uncertain>,
    /// Measured minus simulated arrival, half-rise, after the shift, without the shift's
    /// uncertainty, seconds.
    pub arrival_error_s: Option<Uncertain>,
    /// Root mean square of measured minus simulated (unit).
    pub rms: f64,
    /// The same in levels of the measured trace (1).
    pub rms_lsb: f64,
    /// The same as a force, droop and baselines taken out; none without a calibrated sensor (N).
    pub rms_n: Option<f64>,
    /// Largest difference (unit).
    pub max: f64,
    /// The same in levels of the measured trace (1).
    pub max_lsb: f64,
    /// The same as a force (N).
    pub max_n: Option<f64>,
    /// One level of the measured trace (unit).
    pub lsb: f64,
    /// Pearson's coefficient (1).
    pub correlation: Option<f64>,
    /// Distance of the amplitude spectra over the simulated one's norm (1).
    pub spectrum_distance: Option<f64>,
    /// Samples in common.
    pub samples: usize,
    /// Measured samples at the converter's ends.
    pub clipped: usize,
}

/// The speed between two channels' sensors on both sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SpeedScore {
    /// Measured channel from which.
    pub from: String,
    /// Measured channel to which.
    pub to: String,
    /// The arrival's estimator.
    pub estimator: &'static str,
    /// Distance along the chain at rest, of each side's own scene where it has one (m).
    pub distance_m: f64,
    /// Standard uncertainty of the measured one (m).
    pub distance_u_m: f64,
    /// Measured, metres per second.
    pub measured_m_per_s: Uncertain,
    /// The same as if the distance were exact.
    #[serde(skip)]
    pub measured_over_exact_distance: Uncertain,
    /// Simulated, metres per second; the distance is exact.
    pub simulated_m_per_s: Uncertain,
    /// Measured over simulated, less one.
    pub error: Uncertain,
}
