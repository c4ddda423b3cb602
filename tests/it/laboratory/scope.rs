//! Sensor circuit, digitiser, and the CSV file that a TDS 2000 saves.

use super::{Disturbance, Random};
use std::fmt::Write as _;
use std::path::Path;

/// Points of a record.
pub const POINTS: usize = 2500;
/// Levels of a division.
const LEVELS: f64 = 25.0;

/// Horizontal settings of a record.
#[derive(Clone, Copy, Debug)]
pub struct Timing {
    /// Seconds for each of the ten divisions (s)
    pub time_base: f64,
    /// Points before the trigger
    pub before: usize,
}

impl Timing {
    /// Time between two points (s).
    pub fn interval(&self) -> f64 {
        self.time_base / 250.0
    }
}

/// Vertical settings of a channel and what disturbs it.
#[derive(Clone, Copy, Debug)]
pub struct Channel {
    /// Volts for each division (V)
    pub scale: f64,
    /// Position of zero volts above the middle of the screen (div)
    pub position: f64,
    /// What is added to the signal
    pub disturbance: Disturbance,
}

/// Voltage of a sensor of sensitivity `s` (V/N) and time constant `tau` (s) under forces (N) that
/// are `interval` (s) apart and linear in between: `V' = S F' - V / tau`, solved exactly.
pub fn respond(forces: &[f64], interval: f64, s: f64, tau: f64) -> Vec<f64> {
    let decay = (-interval / tau).exp();
    let gain = s * tau / interval * (1.0 - decay);
    let (mut force, mut voltage) = (0.0, 0.0);
    let step = |next: &f64| {
        voltage = decay * voltage + gain * (next - force);
        force = *next;
        voltage
    };
    forces.iter().map(step).collect()
}

impl Channel {
    /// Codes of a record of the voltage `at(t)` (V), `t` (s) from the trigger: the trigger lies
    /// `phase` (0 to 1) of an interval before the point of number `before`.
    pub fn digitise(
        &self,
        timing: Timing,
        phase: f64,
        random: &mut Random,
        at: impl Fn(f64) -> f64,
    ) -> Vec<f64> {
        let interval = timing.interval();
        let mut samples: Vec<f64> = (0..POINTS)
            .map(|index| at((index as f64 - timing.before as f64 + phase) * interval) / self.scale)
            .collect();
        self.disturbance.add(&mut samples, interval, random);
        let zero = (self.position * LEVELS).round();
        samples
            .iter()
            .map(|sample| (sample * LEVELS + zero).round().clamp(-127.0, 127.0) - zero)
            .collect()
    }

    /// Saves a shot as "Save All" does: a folder with a file for each channel, by its number and
    /// codes counted from zero volts, and the settings of the front panel.
    pub fn save(&self, folder: &Path, channels: &[(usize, Vec<f64>)], timing: Timing) {
        std::fs::create_dir_all(folder).expect("a folder");
        let coupling = if self.disturbance.high_pass > 0.0 { "AC" } else { "DC" };
        let mut settings = String::new();
        for (number, codes) in channels {
            self.write(&folder.join(format!("F0000CH{number}.CSV")), *number, timing, codes);
            write!(settings, ":CH{number}:COUPLING {coupling};").expect("memory");
        }
        std::fs::write(folder.join("F0000TEK.SET"), settings + "\n").expect("written");
    }

    fn write(&self, path: &Path, number: usize, timing: Timing, codes: &[f64]) {
        let header = [
            ("Record Length", format!("{:.6e}", POINTS as f64)),
            ("Sample Interval", format!("{:.6e}", timing.interval())),
            ("Trigger Point", format!("{:.12e}", timing.before as f64)),
            ("", String::new()),
            ("", String::new()),
            ("", String::new()),
            ("Source", format!("CH{number}")),
            ("Vertical Units", "V".to_owned()),
            ("Vertical Scale", format!("{:.6e}", self.scale)),
            ("Vertical Offset", format!("{:.6e}", self.position * self.scale)),
            ("Horizontal Units", "s".to_owned()),
            ("Horizontal Scale", format!("{:.6e}", timing.time_base)),
            ("Pt Fmt", "Y".to_owned()),
            ("Yzero", format!("{:.6e}", 0.0)),
            ("Probe Atten", format!("{:.6e}", 1.0)),
            ("Model Number", "TDS2014".to_owned()),
            ("Serial Number", "0".to_owned()),
            ("Firmware Version", "FV:v4.12".to_owned()),
        ];
        let mut text = String::new();
        for (index, code) in codes.iter().enumerate() {
            let time = (index as f64 - timing.before as f64) * timing.interval();
            let volts = code * self.scale / LEVELS;
            let (name, value) = header.get(index).map_or(("", ""), |(name, value)| (name, value));
            writeln!(text, "{name},{value},,{time:018.12},{volts:10.5},").expect("memory");
        }
        std::fs::write(path, exponents(&text)).expect("written");
    }
}

/// Exponents as C prints them: a sign and two digits at least.
fn exponents(text: &str) -> String {
    let mut written = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(place) = rest.find('e') {
        let (head, tail) = rest.split_at(place + 1);
        written.push_str(head);
        rest = tail;
        let is_number = head[..head.len() - 1].ends_with(|c: char| c.is_ascii_digit());
        let digits = tail.strip_prefix('-').unwrap_or(tail);
        let length = digits.find(|c: char| !c.is_ascii_digit()).unwrap_or(digits.len());
        if is_number && length > 0 {
            let sign = if tail.starts_with('-') { '-' } else { '+' };
            write!(written, "{sign}{:0>2}", &digits[..length]).expect("memory");
            rest = &digits[length..];
        }
    }
    written + rest
}

#[test]
fn exponents_have_a_sign_and_two_digits() {
    assert_eq!(exponents("Record Length,2.5e3,\n"), "Record Length,2.5e+03,\n");
    assert_eq!(exponents("Sample,4.000e-7,,-1.0e12"), "Sample,4.000e-07,,-1.0e+12");
}

#[test]
fn a_ramp_of_force_saturates_at_its_rate() {
    // V -> S F' tau for a ramp that lasts much longer than tau.
    let forces: Vec<f64> = (0..20_000).map(|index| f64::from(index) * 1e-3).collect();
    let voltage = respond(&forces, 1e-6, 0.4, 1e-3);
    assert!((voltage[19_999] - 0.4 * 1e3 * 1e-3).abs() < 1e-8, "{}", voltage[19_999]);
}
