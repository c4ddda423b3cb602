//! A blind calibration: stated values, records, and the truth that the calibration does not see.

use crate::analysis::calibration::model::Common;
use crate::analysis::calibration::{
    Calibration, CalibrationError, Draws, PlannedStrike, calibrate,
};
use crate::recording::Capture;
use crate::sensor::Circuit;

/// One blind calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct BlindCalibration {
    /// The plan and recordings given to the calibration.
    pub strikes: Vec<PlannedStrike>,
    /// And what its inputs share.
    pub common: Common,
    /// The captures that records were taken from.
    pub captures: Vec<Capture>,
    /// The hidden values.
    pub circuit: Circuit,
}

impl BlindCalibration {
    /// Calibrates with what it is told, without the Monte-Carlo part.
    ///
    /// # Errors
    /// As [`calibrate`].
    pub fn calibrate(&self) -> Result<Calibration, CalibrationError> {
        calibrate(&self.strikes, &self.common, Draws { seed: 0, count: 0 })
    }
}
