//! The piezo sensor: force to charge to voltage.
//!
//! Stands between `chain`, which tells the force inside the host, and `scope`, which sees a voltage. A plate with
//! piezoelectric coefficient `d33` turns a force change `N` into the charge `d33 N` on the capacitance `C` of plate,
//! cable and scope input, which leaks through the resistance `R` of plate and scope input:
//! `V' + V/tau = (d33/C) N'`, `tau = R C`. So a static force is invisible and every pulse droops.
//! Source: the charge equation of a thickness-poled plate (IEEE Std 176-1987), lumped circuit; valid far below the
//! plate's own resonance (MHz) and while the plate takes the host's whole axial force.

use serde::Serialize;

use crate::trace::Trace;

/// Permittivity of vacuum, CODATA 2018 (F/m).
pub const VACUUM_PERMITTIVITY: f64 = 8.854_187_812_8e-12;

/// A piezo plate with its wiring.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Sensor {
    /// What the instrument file calls it.
    pub model: String,
    /// Charge per force along the poling axis (C/N).
    pub d33: f64,
    /// Relative permittivity of the ceramic (1).
    pub relative_permittivity: f64,
    /// Side of the square plate (m).
    pub side: f64,
    /// Thickness of the plate (m).
    pub thickness: f64,
    /// Capacitance of wires and cable (F).
    pub cable_capacitance: f64,
    /// Leakage of plate and wiring; infinite where none is stated (Ohm).
    pub leak_resistance: f64,
}

/// What the sensor is connected to: a scope input, seen through its probe.
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
    #[must_use]
    pub fn plate_capacitance(&self) -> f64 {
        VACUUM_PERMITTIVITY * self.relative_permittivity * self.side * self.side / self.thickness
    }

    /// The circuit that this sensor forms with `load`.
    #[must_use]
    pub fn connect(&self, load: Load) -> Circuit {
        let capacitance = self.plate_capacitance() + self.cable_capacitance + load.capacitance;
        let resistance = 1.0 / (1.0 / self.leak_resistance + 1.0 / load.resistance);
        Circuit { sensitivity: self.d33 / capacitance, time_constant: resistance * capacitance }
    }
}

impl Circuit {
    /// Voltage at the sample times of `force`, exact where the force runs straight between samples.
    ///
    /// `V[n] = a V[n-1] + S (1-a) tau/dt (N[n] - N[n-1])`, `a = exp(-dt/tau)`; the circuit starts discharged.
    #[must_use]
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

    /// Against the closed form for a ramp and a hold: `V = S r tau (1 - exp(-t/tau))`, then `exp` decay.
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
            cable_capacitance: 710e-12,
            leak_resistance: f64::INFINITY,
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
    }
}
