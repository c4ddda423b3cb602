//! The piezo sensor: force to charge to voltage.
//!
//! Input: the axial force in the host (the particle or wall that holds the plate), from `chain`.
//! Output: the voltage at the input of `scope`. A plate with piezoelectric coefficient `d33` turns
//! a force `F` into the charge `d33 F` on the capacitance `C` of plate, cable and scope input,
//! which leaks through the resistance `R` of plate and scope input: `V' + V/tau = (d33/C) F'`,
//! `tau = R C`. So a static force is invisible and every pulse droops. Source: the charge equation
//! of a thickness-poled plate (IEEE Std 176-1987), lumped circuit; valid far below the plate's own
//! resonance (MHz) and while the plate takes the host's whole axial force.
//!
//! Several plates on top of each other feel the same force. Wired in parallel they give `n d33` on
//! `n` times the capacitance, in series `d33` on one `n`-th of it. Measured values in
//! [`SensorMeasurement`] replace those computed from the plate.

mod motion;
mod tolerance;

use std::collections::BTreeMap;

use serde::Serialize;

use crate::trace::Trace;
pub use motion::{MotionKind, MotionSensor};
pub use tolerance::SensorTolerance;

/// Permittivity of vacuum, CODATA 2018 (F/m).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// How the plates of a stack are wired.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Wiring {
    /// All electrodes of one polarity together: the charges add.
    #[default]
    Parallel,
    /// One after the other: the voltages add.
    Series,
}

/// Sensitivity and circuit as measured, for example by a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct SensorMeasurement {
    /// Voltage per force before any droop (V/N).
    pub sensitivity: Option<f64>,
    /// Relative standard uncertainty of the sensitivity (1).
    pub sensitivity_u: Option<f64>,
    /// `R C` (s).
    pub time_constant: Option<f64>,
    /// Relative standard uncertainty of the time constant (1).
    pub time_constant_u: Option<f64>,
    /// The input it was measured with; without one it holds for any.
    pub load: Option<Load>,
    /// The scope channel whose gain is part of this sensitivity; none if the sensor alone was
    /// calibrated.
    pub chain: Option<InChain>,
}

/// A scope channel that a sensor was calibrated together with: its gain is in the sensitivity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct InChain {
    /// Number of the channel, from 1.
    pub channel: u8,
    /// Vertical scale at the probe's tip (V/div).
    pub range: f64,
}

impl InChain {
    /// Whether channel `number` at `scale` (V/div) is that channel at that range.
    pub fn is(self, number: u8, scale: f64) -> bool {
        self.channel == number && (self.range / scale - 1.0).abs() < 1e-9
    }

    /// Entries of a recording's metadata.
    pub fn facts(self) -> [(&'static str, String); 2] {
        [
            ("chain_channel", self.channel.to_string()),
            ("chain_range_v_per_div", self.range.to_string()),
        ]
    }

    /// The chain that a recording's metadata name.
    pub fn of_facts(facts: &BTreeMap<String, String>) -> Option<Self> {
        let channel = facts.get("chain_channel")?.parse().ok()?;
        let range = facts.get("chain_range_v_per_div")?.parse().ok()?;
        Some(Self { channel, range })
    }
}

/// A stack of equal piezo plates, mostly one, with its wiring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensor {
    /// Name of the instrument file.
    pub model: String,
    /// Charge per force along the poling axis (C/N).
    pub d33: f64,
    /// Relative permittivity of the ceramic (1).
    pub relative_permittivity: f64,
    /// Side of the square plate (m).
    pub side: f64,
    /// Thickness of the plate (m).
    pub thickness: f64,
    /// Plates on top of each other.
    pub plates: u32,
    /// How several plates are wired.
    pub wiring: Wiring,
    /// Capacitance of wires and cable (F).
    pub cable_capacitance: f64,
    /// Leakage of plate and wiring; infinite where none is stated (Ohm).
    pub leak_resistance: f64,
    /// Measured values, where there are some.
    pub measured: SensorMeasurement,
    /// Kind of body that it was calibrated in, where its file says so.
    pub calibrated_host: Option<String>,
}

/// The sensor's load: a scope input, seen through its probe.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Load {
    /// Input resistance (Ohm).
    pub resistance: f64,
    /// Input capacitance (F).
    pub capacitance: f64,
}

/// The first-order circuit of sensor and load.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Circuit {
    /// Voltage per force before any droop, `d33/C` (V/N).
    pub sensitivity: f64,
    /// `R C` (s).
    pub time_constant: f64,
}

impl Sensor {
    /// Capacitance of the bare plate, `eps0 eps_r side^2 / thickness` (F).
    pub fn plate_capacitance(&self) -> f64 {
        VACUUM_PERMITTIVITY * self.relative_permittivity * self.side * self.side / self.thickness
    }

    /// Capacitance of the stack at its terminals (F).
    pub fn stack_capacitance(&self) -> f64 {
        let plates = f64::from(self.plates);
        match self.wiring {
            Wiring::Parallel => plates * self.plate_capacitance(),
            Wiring::Series => self.plate_capacitance() / plates,
        }
    }

    /// Charge per force at the terminals of the stack (C/N).
    pub fn stack_charge(&self) -> f64 {
        match self.wiring {
            Wiring::Parallel => f64::from(self.plates) * self.d33,
            Wiring::Series => self.d33,
        }
    }

    /// The circuit that this sensor forms with `load`.
    ///
    /// Values measured with another input are converted: charge per force and capacitance of sensor
    /// and cable are kept, resistance and capacitance of the input are replaced.
    pub fn connect(&self, load: Load) -> Circuit {
        let with = self.measured.load.unwrap_or(load);
        let computed = self.stack_capacitance() + self.cable_capacitance + with.capacitance;
        let measured =
            self.measured.time_constant.map_or(computed, |tau| tau / self.parallel(with));
        let charge = self.measured.sensitivity.map_or(self.stack_charge(), |s| s * measured);
        let capacitance = measured + (load.capacitance - with.capacitance);
        Circuit {
            sensitivity: charge / capacitance,
            time_constant: self.parallel(load) * capacitance,
        }
    }

    /// Resistance of the leak and `load` side by side (Ohm).
    fn parallel(&self, load: Load) -> f64 {
        1.0 / (1.0 / self.leak_resistance + 1.0 / load.resistance)
    }
}

impl Circuit {
    /// Voltage at the sample times of `force`, exact for a force that is linear between samples.
    ///
    /// `V[n] = a V[n-1] + S (1-a) tau/dt (F[n] - F[n-1])`, `a = exp(-dt/tau)`; the circuit starts
    /// discharged.
    pub fn respond(&self, force: &Trace) -> Trace {
        let ratio = force.interval / self.time_constant;
        let kept = (-ratio).exp();
        let gained = -(-ratio).exp_m1() / ratio * self.sensitivity;
        let mut voltage = 0.0;
        let mut before = force.values.first().copied().unwrap_or(0.0);
        let mut follow = |now: &f64| {
            voltage = kept * voltage + gained * (now - before);
            before = *now;
            voltage
        };
        Trace {
            name: force.name.clone(),
            unit: "V".to_owned(),
            start: force.start,
            interval: force.interval,
            values: force.values.iter().map(&mut follow).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the closed form for a ramp and a hold: `V = S r tau (1 - exp(-t/tau))`, then `exp`
    /// decay.
    #[test]
    fn filter_is_exact_for_piecewise_linear_force() {
        let circuit = Circuit { sensitivity: 0.4, time_constant: 1e-3 };
        let (interval, ramp, hold) = (1e-6, 250_u32, 4000_u32);
        let slope = 3.0e4;
        let force = |i: u32| slope * interval * f64::from(i.min(ramp));
        let trace = Trace {
            name: "ramp".into(),
            unit: "N".into(),
            start: 0.0,
            interval,
            values: (0..=hold).map(force).collect(),
        };
        let voltage = circuit.respond(&trace);
        let rising = |t: f64| 0.4 * slope * 1e-3 * -(-t / 1e-3).exp_m1();
        for i in 0..=hold {
            let (t, top) = (interval * f64::from(i), interval * f64::from(ramp));
            let exact = if i <= ramp { rising(t) } else { rising(top) * (-(t - top) / 1e-3).exp() };
            assert!((voltage.values[i as usize] - exact).abs() < 1e-12 * rising(top), "sample {i}");
        }
    }

    #[test]
    fn plate_and_cable_make_the_papers_time_constant() {
        let mut sensor = Sensor {
            model: "test".into(),
            d33: 400e-12,
            relative_permittivity: 1800.0,
            side: 3e-3,
            thickness: 0.5e-3,
            plates: 1,
            wiring: Wiring::Parallel,
            cable_capacitance: 710e-12,
            leak_resistance: f64::INFINITY,
            measured: SensorMeasurement::default(),
            calibrated_host: None,
        };
        // 0.15938 pF times the relative permittivity.
        assert!((sensor.plate_capacitance() / 1800.0 - 0.15938e-12).abs() < 1e-17);
        let load = Load { resistance: 1e6, capacitance: 20e-12 };
        let circuit = sensor.connect(load);
        assert!((circuit.time_constant - 1e-3).abs() < 0.03e-3);
        // S tau = d33 R whatever the cable.
        let product = circuit.sensitivity * circuit.time_constant;
        sensor.cable_capacitance = 3e-9;
        let other = sensor.connect(load);
        assert!((other.sensitivity * other.time_constant / product - 1.0).abs() < 1e-15);
        // Two plates: twice the charge on twice the plate's capacitance, or the same on half of it.
        sensor.plates = 2;
        let plate = sensor.plate_capacitance();
        let expected = |charge: f64, stack: f64| charge / (stack + 3e-9 + 20e-12);
        let parallel = sensor.connect(load);
        sensor.wiring = Wiring::Series;
        let series = sensor.connect(load);
        assert!((parallel.sensitivity / expected(800e-12, 2.0 * plate) - 1.0).abs() < 1e-15);
        assert!((series.sensitivity / expected(400e-12, 0.5 * plate) - 1.0).abs() < 1e-15);
    }

    /// A circuit measured at one input gives what the plate's own data give at another.
    #[test]
    fn a_measured_circuit_is_taken_over_to_another_input() {
        let plate = Sensor {
            model: "test".into(),
            d33: 600e-12,
            relative_permittivity: 3400.0,
            side: 3e-3,
            thickness: 0.5e-3,
            plates: 1,
            wiring: Wiring::Parallel,
            cable_capacitance: 440e-12,
            leak_resistance: 50e6,
            measured: SensorMeasurement::default(),
            calibrated_host: None,
        };
        let (input, probe) = (
            Load { resistance: 1e6, capacitance: 20e-12 },
            Load { resistance: 10e6, capacitance: 16e-12 },
        );
        let found = plate.connect(input);
        let measured = SensorMeasurement {
            sensitivity: Some(found.sensitivity),
            time_constant: Some(found.time_constant),
            load: Some(input),
            ..SensorMeasurement::default()
        };
        let calibrated = Sensor { d33: 1.0, cable_capacitance: 0.0, measured, ..plate.clone() };
        for load in [input, probe] {
            let (a, b) = (plate.connect(load), calibrated.connect(load));
            assert!((a.sensitivity / b.sensitivity - 1.0).abs() < 1e-14);
            assert!((a.time_constant / b.time_constant - 1.0).abs() < 1e-14);
        }
    }
}
