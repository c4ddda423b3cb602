//! The study's results as data.

use serde::Serialize;

/// The reference solution.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Reference {
    /// Its method and setting.
    pub method: String,
    /// The method and setting of a second tight solution.
    pub second: String,
    /// Their distance: largest relative difference of peaks and arrivals (1).
    pub error: f64,
    /// The same of traces, relative to the largest force in each (1).
    pub error_trace: f64,
}

/// One method at one setting.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Point {
    /// Method name.
    pub method: &'static str,
    /// Publication that defines the method.
    #[serde(skip)]
    pub source: &'static str,
    /// Order on smooth problems.
    #[serde(skip)]
    pub order: u8,
    /// Step (s) of a fixed-step method, tolerance (1) of an adaptive one (unit).
    pub setting: f64,
    /// Whether the run stopped, lost its first peaks, or was more than 100 % off in them or in
    /// arrivals, or its step cannot be stable: `run` refuses it.
    pub failed: bool,
    /// Whether it was given up, for it took too many evaluations, or a looser tolerance did.
    pub given_up: bool,
    /// Largest relative error of first-peak dynamic forces (1).
    pub error_peak: Option<f64>,
    /// Largest relative error of first-peak times, half-rises and tenths (1).
    pub error_arrival: Option<f64>,
    /// Largest deviation of any sensor's force at the scope's sample times, relative to its largest
    /// (1).
    pub error_trace: Option<f64>,
    /// Energy drift relative to the energy in motion (1).
    pub error_energy: Option<f64>,
    /// Evaluations of all contact forces. Of a run that stopped, how many its fixed steps would
    /// have taken, or none; of one that was given up, after how many.
    pub force_evaluations: u64,
    /// Median wall time; null in JSON where no run came to its end (s).
    #[serde(serialize_with = "measured")]
    pub wall_s_median: f64,
    /// Shortest wall time; null in JSON where no run came to its end (s).
    #[serde(serialize_with = "measured")]
    pub wall_s_min: f64,
}

/// A time; none if not finite.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde calls it so")]
pub(super) fn measured<S: serde::Serializer>(
    seconds: &f64,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    Some(*seconds).filter(|seconds| *seconds > 0.0).serialize(serializer)
}

/// Observed order of convergence.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Order {
    /// Method name.
    pub method: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order on smooth problems.
    pub nominal: u8,
    /// Exponent of peak error against force evaluations, by least squares; none with fewer than
    /// three points, or where the work hardly differs (1).
    pub observed: Option<f64>,
    /// Its standard error, by how far points stand from the straight line: errors that change their
    /// sign, and few points, leave little (1).
    pub observed_u: Option<f64>,
    /// Its expanded uncertainty for 95 %, by Student's t (1).
    #[serde(rename = "observed_U95")]
    pub expanded: Option<f64>,
}

/// Method, cost and error of an accuracy.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ChosenMethod {
    /// Accuracy asked for (1).
    pub accuracy: f64,
    /// Method that was chosen.
    pub method: &'static str,
    /// Its setting (unit).
    pub setting: f64,
    /// Largest relative error of peaks and arrivals (1).
    pub error: Option<f64>,
    /// Of first-peak dynamic forces alone (1).
    pub error_peak: Option<f64>,
    /// Of first-peak times, half-rises and tenths alone (1).
    pub error_arrival: Option<f64>,
    /// Of traces, which are held to half of its digits, unless a run tells from when on they are
    /// not (1).
    pub error_trace: Option<f64>,
    /// Energy drift relative to the energy in motion, which no accuracy is asked for (1).
    pub error_energy: Option<f64>,
    /// Evaluations of all contact forces.
    pub force_evaluations: u64,
    /// Median wall time (s).
    pub wall_s_median: f64,
    /// Shortest wall time (s).
    pub wall_s_min: f64,
    /// Median wall time with the check runs that estimate the error (s).
    pub wall_held_s_median: f64,
    /// Simulated time over the median wall time (1).
    pub simulated_over_wall: f64,
}
