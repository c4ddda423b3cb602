//! Tolerances of piezo ceramics: constants that differ from the data sheet, and that move with temperature.
//!
//! For what-if runs: each plate's `d33` and permittivity are drawn evenly within the tolerance, apart from each other, and the
//! room's temperature, one for all plates, evenly within its own; constants follow it in proportion.
//! Source: manufacturers' data for PZT-5A and PZT-5H state +-20 % for both constants. Valid for plates of the same batch only
//! if their tolerance is taken that narrow: here each is drawn for itself.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::Sensor;

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
        Sensor {
            d33: sensor.d33 * factor(self.d33_coefficient),
            relative_permittivity: sensor.relative_permittivity
                * factor(self.permittivity_coefficient),
            ..sensor.clone()
        }
    }
}
