//! Sensors of motion beside the plates: laser vibrometer, accelerometer, strain gauge on a rod.
//!
//! Input: velocity (m/s), acceleration (m/s²) or strain (1), evenly sampled, from `experiment`.
//! Output: volts at the scope's input. A vibrometer is a first-order low pass of its bandwidth and
//! stops at its range. An accelerometer is a mass on a spring, `y'' + 2 zeta w y' + w^2 y = w^2 a`,
//! behind the high pass of its supply (IEPE). A strain gauge shows the strain where it is. Filters
//! are exact for input that runs straight between samples.
//!
//! Sources: ISO 16063-41:2011 (vibrometers), ISO 5347-22 and C. M. Harris, Harris' Shock and
//! Vibration Handbook, chapter 10 (accelerometers). Limits: no noise of the sensors' own, no
//! transverse sensitivity, a laser spot and a gauge without extent.

use std::f64::consts::TAU;

/// A sensor of motion in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct MotionSensor {
    /// Name in the scene.
    pub name: String,
    /// What it is.
    pub kind: MotionKind,
    /// Volts per unit of what it measures (unit).
    pub sensitivity: f64,
}

/// What a sensor of motion measures, and how well.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionKind {
    /// The velocity of a particle, counted from 1.
    Vibrometer {
        /// The particle.
        particle: usize,
        /// Largest speed that it shows (m/s).
        range: f64,
        /// Corner frequency of its low pass (Hz).
        bandwidth: f64,
    },
    /// The acceleration of a particle, counted from 1.
    Accelerometer {
        /// The particle.
        particle: usize,
        /// Resonance (Hz).
        resonance: f64,
        /// Damping ratio, below 1 (1).
        damping: f64,
        /// Corner frequency of its supply's high pass; 0 for a static one (Hz).
        high_pass: f64,
    },
    /// The axial strain of the rod at an end of the chain, compression negative.
    StrainGauge {
        /// The end: 0 is the top, 1 the bottom.
        end: usize,
        /// Distance from the rod's face (m).
        distance: f64,
        /// Speed of sound in the rod (m/s).
        speed: f64,
    },
}

impl MotionKind {
    /// Its name.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Vibrometer { .. } => "vibrometer",
            Self::Accelerometer { .. } => "accelerometer",
            Self::StrainGauge { .. } => "strain gauge",
        }
    }

    /// Unit of what it measures.
    pub fn unit(&self) -> &'static str {
        match self {
            Self::Vibrometer { .. } => "m/s",
            Self::Accelerometer { .. } => "m/s^2",
            Self::StrainGauge { .. } => "1",
        }
    }
}

impl MotionSensor {
    /// Voltage for what it measures, one sample every `interval` (s) (V).
    pub fn respond(&self, samples: &[f64], interval: f64) -> Vec<f64> {
        let shown = match self.kind {
            MotionKind::Vibrometer { range, bandwidth, .. } => {
                let mut shown = low_pass(samples, interval * TAU * bandwidth);
                for value in &mut shown {
                    *value = value.clamp(-range, range);
                }
                shown
            }
            MotionKind::Accelerometer { resonance, damping, high_pass, .. } => {
                let shown = resonator(samples, interval * TAU * resonance, damping);
                let slow = low_pass(&shown, interval * TAU * high_pass);
                if high_pass > 0.0 {
                    shown.iter().zip(slow).map(|(value, slow)| value - slow).collect()
                } else {
                    shown
                }
            }
            MotionKind::StrainGauge { .. } => samples.to_vec(),
        };
        shown.into_iter().map(|value| self.sensitivity * value).collect()
    }
}

/// First-order low pass, `rate` its angular corner frequency times the interval (1). It starts
/// settled on the first sample.
fn low_pass(samples: &[f64], rate: f64) -> Vec<f64> {
    let Some(first) = samples.first() else { return Vec::new() };
    let decay = (-rate).exp();
    let (mut before, mut value) = (*first, *first);
    let step = |sample: &f64| {
        let lag = if rate > 0.0 { (sample - before) / rate } else { 0.0 };
        value = if rate > 0.0 { sample - lag + (value - before + lag) * decay } else { value };
        before = *sample;
        value
    };
    samples.iter().map(step).collect()
}

/// A damped mass on a spring, `rate` its angular frequency times the interval (1), `damping` its
/// damping ratio (1). It starts settled on the first sample.
fn resonator(samples: &[f64], rate: f64, damping: f64) -> Vec<f64> {
    let Some(first) = samples.first() else { return Vec::new() };
    // In units of the interval: `y'' + 2 zeta w y' + w^2 y = w^2 u`, `u` straight: the particular
    // solution is `u - 2 zeta u'/w`.
    let turn = rate * (1.0 - damping * damping).sqrt();
    let (decay, (sine, cosine)) = ((-damping * rate).exp(), turn.sin_cos());
    let lean = damping * rate / turn;
    let (mut before, mut value, mut speed) = (*first, *first, 0.0);
    let step = |sample: &f64| {
        let slope = sample - before;
        let lag = 2.0 * damping * slope / rate;
        let (rest, rest_speed) = (value - before + lag, speed - slope);
        let moved = decay * (rest * (cosine + lean * sine) + rest_speed / turn * sine);
        let moved_speed =
            decay * (rest_speed * (cosine - lean * sine) - rest * rate * rate / turn * sine);
        (value, speed, before) = (sample - lag + moved, slope + moved_speed, *sample);
        value
    };
    samples.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A half sine `sin(W t)` on a resonator at rest, `y` in closed form: the particular solution
    /// `P sin + Q cos`, and a decaying oscillation that makes value and speed zero at the start.
    #[test]
    fn an_accelerometer_shows_a_half_sine_as_in_closed_form() {
        let (natural, damping, drive) = (TAU * 50e3, 0.05, TAU * 8e3_f64);
        let kind =
            MotionKind::Accelerometer { particle: 1, resonance: 50e3, damping, high_pass: 0.0 };
        let sensor = MotionSensor { name: "a".to_owned(), kind, sensitivity: 2.0 };
        let interval = 1e-9;
        let times: Vec<f64> = (0..60_000).map(|i| f64::from(i) * interval).collect();
        let input: Vec<f64> = times.iter().map(|t| (drive * t).sin()).collect();
        let found = sensor.respond(&input, interval);
        let r = drive / natural;
        let norm = (1.0 - r * r).powi(2) + (2.0 * damping * r).powi(2);
        let (p, q) = ((1.0 - r * r) / norm, -2.0 * damping * r / norm);
        let turn = natural * (1.0 - damping * damping).sqrt();
        // y = P sin Wt + Q cos Wt + e^(-zeta w t)(a cos wd t + b sin wd t), y(0) = y'(0) = 0.
        let a = -q;
        let b = (damping * natural * a - p * drive) / turn;
        for (t, found) in times.iter().zip(found) {
            let exact = p * (drive * t).sin()
                + q * (drive * t).cos()
                + (-damping * natural * t).exp() * (a * (turn * t).cos() + b * (turn * t).sin());
            assert!((found / 2.0 - exact).abs() < 1e-7, "{t:e}: {found} {exact}");
        }
    }

    /// A ramp behind a first-order low pass lags by its time constant, and a vibrometer stops at
    /// its range.
    #[test]
    fn a_vibrometer_lags_and_stops_at_its_range() {
        let kind = MotionKind::Vibrometer { particle: 1, range: 0.5, bandwidth: 1e5 };
        let sensor = MotionSensor { name: "v".to_owned(), kind, sensitivity: 5.0 };
        let interval = 1e-7;
        let input: Vec<f64> = (0..1000).map(|i| 1e4 * f64::from(i) * interval).collect();
        let found = sensor.respond(&input, interval);
        let constant = 1.0 / (TAU * 1e5);
        assert!((found[300] / 5.0 - (input[300] - 1e4 * constant)).abs() < 1e-9);
        assert!((found[999] - 2.5).abs() < 1e-12);
    }

    /// A step of acceleration behind a high pass decays.
    #[test]
    fn an_iepe_supply_lets_a_constant_acceleration_decay() {
        let kind =
            MotionKind::Accelerometer { particle: 1, resonance: 1e6, damping: 0.5, high_pass: 1e3 };
        let sensor = MotionSensor { name: "a".to_owned(), kind, sensitivity: 1.0 };
        let mut input = vec![1.0; 2000];
        input[0] = 0.0;
        let found = sensor.respond(&input, 1e-6);
        let expected = (-TAU * 1e3 * 1e-6 * 500.0_f64).exp();
        assert!((found[500] / expected - 1.0).abs() < 0.01, "{} {expected}", found[500]);
    }
}
