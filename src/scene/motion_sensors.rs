//! Sensors of motion: `[vibrometers.NAME]`, `[accelerometers.NAME]` and `[strain_gauges.NAME]`.

use super::bodies::{Rod, particle_in, particle_number};
use super::document::Node;
use super::drive::ChainEnd;
use super::table::{Bound, NamedTables};
use super::table::{not_negative, positive, quantity, table, word};
use crate::quantity::{Dimension, engineering};
use crate::sensor::{MotionKind, MotionSensor};

table! {
    /// `[vibrometers.NAME]`.
    pub struct VibrometerKeys<'a> {
        /// whose velocity it shows
        particle: &'a Node = particle_number().required().needs("a particle, e.g. 5"),
        sensitivity: f64 = positive(Dimension::VOLTAGE_PER_SPEED).required(),
        /// largest speed
        range: f64 = positive(Dimension::SPEED).or("10 m/s"),
        bandwidth: f64 = positive(Dimension::FREQUENCY).or("2.5 MHz"),
    }
}

table! {
    /// `[accelerometers.NAME]`.
    pub struct AccelerometerKeys<'a> {
        /// whose acceleration it shows
        particle: &'a Node = particle_number().required().needs("a particle, e.g. 5"),
        sensitivity: f64 = positive(Dimension::VOLTAGE_PER_ACCELERATION).required(),
        resonance: f64 = positive(Dimension::FREQUENCY).required(),
        /// damping ratio
        damping: f64 = quantity(Dimension::NONE, Bound::Between(0.0, 1.0)).or("0.02"),
        /// of its IEPE supply; 0: none
        high_pass: f64 = not_negative(Dimension::FREQUENCY).or("0.7 Hz"),
    }
}

table! {
    /// `[strain_gauges.NAME]`.
    pub struct StrainGaugeKeys<'a> {
        /// the end with the rod, or "top"
        end: ChainEnd = word::<ChainEnd>().or("bottom"),
        /// from the rod's face
        distance: f64 = quantity(Dimension::LENGTH, Bound::UpTo(1e4)).required(),
        /// for a strain of 1, compression negative
        sensitivity: f64 = positive(Dimension::VOLTAGE).required(),
    }
}

/// Tables of the sensors of motion.
pub struct MotionTables<'a, 'b> {
    /// `[vibrometers.NAME]`.
    pub vibrometers: Option<&'b NamedTables<'a>>,
    /// `[accelerometers.NAME]`.
    pub accelerometers: Option<&'b NamedTables<'a>>,
    /// `[strain_gauges.NAME]`.
    pub strain_gauges: Option<&'b NamedTables<'a>>,
}

/// Reads the vibrometers, accelerometers and strain gauges of a scene. The number of particles (0
/// if the chain could not be read) and the rods at both ends limit where they can be.
pub fn motion_sensors(
    tables: &MotionTables<'_, '_>,
    particles: usize,
    rods: [Option<Rod>; 2],
) -> Vec<MotionSensor> {
    let mut sensors = Vec::new();
    let mut add = |name: &str, kind: Option<MotionKind>, sensitivity: Option<f64>| {
        let sensor = kind.zip(sensitivity);
        sensors.extend(sensor.map(|(kind, sensitivity)| MotionSensor {
            name: name.to_owned(),
            kind,
            sensitivity,
        }));
    };
    for (name, table) in tables.vibrometers.into_iter().flatten() {
        let keys = VibrometerKeys::read(table);
        let particle = particle_in(table, keys.particle, particles);
        let data = particle.zip(keys.range).zip(keys.bandwidth);
        let kind = data.map(|((particle, range), bandwidth)| MotionKind::Vibrometer {
            particle,
            range,
            bandwidth,
        });
        add(name, kind, keys.sensitivity);
    }
    for (name, table) in tables.accelerometers.into_iter().flatten() {
        let keys = AccelerometerKeys::read(table);
        let particle = particle_in(table, keys.particle, particles);
        let data = particle.zip(keys.resonance).zip(keys.damping).zip(keys.high_pass);
        let kind = data.map(|(((particle, resonance), damping), high_pass)| {
            MotionKind::Accelerometer { particle, resonance, damping, high_pass }
        });
        add(name, kind, keys.sensitivity);
    }
    for (name, table) in tables.strain_gauges.into_iter().flatten() {
        let keys = StrainGaugeKeys::read(table);
        let (Some(end), Some(distance)) = (keys.end, keys.distance) else { continue };
        let end = end as usize;
        let Some((speed, length)) = rods[end] else {
            let expected = "an end with { rod = \"<material>\", diameter = \"<length>\" }";
            table.problem("end", "an end without a rod", expected);
            continue;
        };
        if let Some(length) = length.filter(|length| distance > *length) {
            let expected = format!("at most the rod's length of {}", engineering(length, "m", 4));
            table.problem("distance", engineering(distance, "m", 4), expected);
        }
        add(name, Some(MotionKind::StrainGauge { end, distance, speed }), keys.sensitivity);
    }
    sensors
}
