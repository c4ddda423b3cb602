//! Tolerances of piezo ceramics: constants that differ from the data sheet, and that move with
//! temperature.
//!
//! For what-if runs: each plate's `d33` and permittivity are drawn evenly within the tolerance,
//! apart from each other, and the room's temperature, one for all plates, evenly within its own;
//! constants follow it in proportion. What was measured of a sensor is drawn normally with its own
//! standard uncertainty. Source: manufacturers' data for PZT-5A and PZT-5H state +-20 % for both
//! constants. Valid for plates of the same batch only if their tolerance is taken that narrow: here
//! each is drawn for itself.

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::{Sensor, SensorMeasurement};

/// Stream of the room's temperature; the plates come after it.
const TEMPERATURE_STREAM: u128 = 1 << 64;

/// How far the plates may be from their data.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SensorTolerance {
    /// Half width of what `d33` and permittivity may be off (1).
    pub spread: f64,
    /// Half width of what the temperature may be off the one that data are stated at (K).
    pub temperature: f64,
    /// Relative change of the permittivity (1/K).
    pub permittivity_coefficient: f64,
    /// Relative change of `d33` (1/K).
    pub d33_coefficient: f64,
}

impl SensorTolerance {
    /// The sensor that is really there, drawn from `seed`; plate `index` has a stream of its own.
    pub fn draw(&self, sensor: &Sensor, seed: u64, index: u32) -> Sensor {
        let even = |stream: &mut Pcg64| -> f64 {
            let share: f64 = StandardUniform.sample(stream);
            2.0 * share - 1.0
        };
        let mut room = Pcg64::new(u128::from(seed), TEMPERATURE_STREAM);
        let warmer = self.temperature * even(&mut room);
        let mut plate = Pcg64::new(u128::from(seed), TEMPERATURE_STREAM + 1 + u128::from(index));
        let mut factor = |coefficient: f64| {
            (1.0 + self.spread * even(&mut plate)) * (1.0 + coefficient * warmer)
        };
        let (d33, permittivity) =
            (factor(self.d33_coefficient), factor(self.permittivity_coefficient));
        // What was measured is known by its own uncertainty, not by the data sheet's tolerance.
        let mut measured = |value: Option<f64>, u: Option<f64>| {
            let deviate: f64 = StandardNormal.sample(&mut plate);
            value.map(|value| value * (1.0 + u.unwrap_or(0.0) * deviate))
        };
        let known = &sensor.measured;
        let sensitivity = measured(known.sensitivity, known.sensitivity_u);
        let time_constant = measured(known.time_constant, known.time_constant_u);
        Sensor {
            d33: sensor.d33 * d33,
            relative_permittivity: sensor.relative_permittivity * permittivity,
            measured: SensorMeasurement { sensitivity, time_constant, ..*known },
            ..sensor.clone()
        }
    }

    /// What a measured `sensor` lacks for its tolerance to be drawn; none where nothing is missing.
    pub fn missing(&self, sensor: &Sensor) -> Option<&'static str> {
        let known = &sensor.measured;
        if known.sensitivity.is_some() && known.sensitivity_u.is_none() {
            Some("sensitivity_u")
        } else if known.time_constant.is_some() && known.time_constant_u.is_none() {
            Some("tau_u")
        } else if self.temperature > 0.0 && *known != SensorMeasurement::default() {
            Some("d33 and permittivity, which temperature_change acts on")
        } else {
            None
        }
    }
}
