//! How a fit is done: settings and limits.

use std::ops::RangeInclusive;

use crate::analysis::gate::Gate;
use crate::analysis::least_squares::StopCriteria;

/// A step that lowers chi squared by less than this share of it moves no parameter by a thousandth
/// of its uncertainty (1).
pub(super) const STOP_CRITERIA: StopCriteria = StopCriteria { reduction: 1e-11, steps: 60 };

/// With the scene's other inputs, some of which are hardly determined. At a chi squared of 8,000
/// the rest is a tenth of a parameter's standard uncertainty; the errors of integration and of
/// difference quotients hide smaller gains (1).
pub(super) const INPUT_STOP_CRITERIA: StopCriteria = StopCriteria { reduction: 1e-6, steps: 30 };

/// Samples in a scene's duration: fewer show no pulse, more are another experiment (1).
pub(super) const SAMPLE_RANGE: RangeInclusive<f64> = 16.0..=200_000.0;

/// Steps that a fit takes, as far as its progress bar knows (1).
pub(super) const EXPECTED_STEPS: f64 = 10.0;

/// How a fit goes about it.
#[allow(clippy::struct_excessive_bools, reason = "each is a choice of its own")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitOptions {
    /// Whether each channel has a gain of its own about which nothing is known.
    pub gains: bool,
    /// Relative standard uncertainty of each channel's gain, 0 for exact ones; none takes the
    /// scope's and the sensor's files (1).
    pub gain_u: Option<f64>,
    /// Relative standard uncertainty of the record's times; none takes the scope's file (1).
    pub time_base_u: Option<f64>,
    /// Whether numbers of the scene that are not freed are exact, whatever it states of them.
    pub exact_inputs: bool,
    /// Whether each channel has an offset of its own.
    pub offsets: bool,
    /// Number of starting points, the scene's numbers first.
    pub starts: u32,
    /// How far the other starting points lie at most, relative (1).
    pub spread: f64,
    /// Seed of the starting points.
    pub seed: u64,
    /// Accuracy of the integration (1).
    pub accuracy: f64,
    /// The part of the records that counts.
    pub gate: Gate,
    /// Whether every number of the scene is profiled, not only the badly determined.
    pub profile: bool,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            gains: false,
            gain_u: None,
            time_base_u: None,
            exact_inputs: false,
            offsets: true,
            starts: 3,
            spread: 0.1,
            seed: 1,
            accuracy: 1e-7,
            gate: Gate::ALL,
            profile: false,
        }
    }
}

/// Longest records, in durations of the scene (1).
pub(super) const MAX_DURATIONS: f64 = 3.0;
