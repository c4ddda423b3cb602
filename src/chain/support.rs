//! What is behind the walls at the ends of a chain: nothing that gives, a drive, or a rod or plate.
//!
//! A wall's face moves by `x_w` along the chain, downward positive, against the static state; the
//! overlap of the contact beside it changes by `x_w - x_1` at the top and `x_n - x_w` at the
//! bottom.
//!
//! - A drive prescribes it: `x_w = X u(t)`, `u` the generator's signal. A piezo stack of stiffness
//!   `k` is a spring between the drive and the face: the force is that of contact and spring in
//!   series, at most the blocked force `k X`. Losses of that contact follow the closing speed of
//!   the stack's base.
//! - A rod or a wide plate gives way by its mechanical impedance: `x_w' = F/Z`, `F` the dynamic
//!   force of its contact. For a thin rod of section `A`, `Z = A rho c` with `c = sqrt(E/rho)`; for
//!   a plate of thickness `h`, `Z = 8 sqrt(D rho h)` with `D = E h^3/(12 (1 - nu^2))`. A rod of
//!   length `L` returns what it was given after `T = 2 L/c`: with `g` the returning and
//!   `f = F/Z + g` the departing velocity, `x_w' = f + g` and `g(t) = r f(t - T)`, `r = 1` at a
//!   free and -1 at a held far end. Static forces are borne by what holds the wall.
//!
//! Sources: C. Zener, Phys. Rev. 59, 669 (1941), for the plate; K. F. Graff, Wave Motion in Elastic
//! Solids (1975), chapter 2, for the rod. Valid while the contact is small against rod or plate and
//! its duration long against the time that a wave takes across them (one-dimensional theory; no
//! dispersion of the rod's waves).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use crate::quantity::engineering;

/// Steps take at most this share of a drive's shortest period (1).
const STEP_SHARE: f64 = 0.125;

/// What is behind a wall at an end of the chain.
#[derive(Debug, Clone, PartialEq, Default)]
pub enum Support {
    /// Nothing that moves.
    #[default]
    Rigid,
    /// A drive that moves the wall.
    Driven(Drive),
    /// A rod or a plate that gives way.
    Yielding(Backing),
}

/// A drive, and the signal of its generator.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// Displacement at a signal of 1, into the chain (m).
    pub amplitude: f64,
    /// Stiffness of a piezo stack; none for a drive that moves the wall whatever its force (N/m).
    pub stiffness: Option<f64>,
    /// The generator's signal.
    pub signal: Signal,
}

/// A generator's signal: a carrier between smooth edges, zero before the time 0.
#[derive(Debug, Clone, PartialEq)]
pub struct Signal {
    /// The carrier.
    pub carrier: Carrier,
    /// Its length; infinite for a continuous one (s).
    pub length: f64,
    /// How long it rises at the start, by half a cosine, and falls at the end (s).
    pub edge: f64,
}

/// A carrier.
#[derive(Debug, Clone, PartialEq)]
pub enum Carrier {
    /// A sine.
    Sine {
        /// Its frequency (Hz).
        frequency: f64,
    },
    /// A sine whose frequency rises evenly.
    Chirp {
        /// Frequency at the start (Hz).
        from: f64,
        /// Rate at which it rises (Hz/s).
        rate: f64,
        /// Frequency at the end (Hz).
        to: f64,
    },
    /// Noise of a band: a sum of sines, each with its angular frequency (1/s) and phase (rad).
    Noise(
        Arc<[[f64; 2]]>,
        /// Amplitude of each (1).
        f64,
    ),
    /// A generator's samples, joined by cubics with continuous slopes.
    Samples(
        Arc<[f64]>,
        /// From one to the next (s).
        f64,
    ),
}

/// A rod or plate behind a wall.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Backing {
    /// Mechanical impedance `Z` (N s/m).
    pub impedance: f64,
    /// Its far end; none where it is too far away to matter.
    pub echo: Option<Echo>,
}

/// What a rod's far end returns.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Echo {
    /// Time after which it returns, `2 L/c` (s).
    pub delay: f64,
    /// Share of the departing velocity that returns: 1 from a free end, -1 from a held one (1).
    pub reflection: f64,
}

impl Support {
    /// Whether the wall may move.
    pub fn moves(&self) -> bool {
        *self != Self::Rigid
    }

    /// The drive, if it is one.
    pub fn drive(&self) -> Option<&Drive> {
        if let Self::Driven(drive) = self { Some(drive) } else { None }
    }

    /// The rod or plate, if it is one.
    pub fn backing(&self) -> Option<&Backing> {
        if let Self::Yielding(backing) = self { Some(backing) } else { None }
    }

    /// Its name in lists of effects and its settings in words; none where nothing moves.
    pub(super) fn summary(&self, end: &str) -> Option<(&'static str, String)> {
        let text = |value: f64, unit: &str| engineering(value, unit, 4);
        match self {
            Self::Rigid => None,
            Self::Driven(Drive { amplitude, stiffness, signal }) => {
                let stack = stiffness.map_or_else(String::new, |stiffness| {
                    format!(" by a stack of {}", text(stiffness, "N/m"))
                });
                let words =
                    format!("{} at the {end}{stack}, {}", text(*amplitude, "m"), signal.summary());
                Some(("drive", words))
            }
            Self::Yielding(Backing { impedance, echo }) => {
                let far = echo.map_or_else(
                    || "no echo".to_owned(),
                    |echo| format!("echoes every {}", text(echo.delay, "s")),
                );
                let words = format!("at the {end}, impedance {}, {far}", text(*impedance, "N*s/m"));
                Some(("yielding_wall", words))
            }
        }
    }

    /// The longest step over which its motion is smooth enough to interpolate (s).
    pub fn longest_step(&self) -> f64 {
        match self {
            Self::Rigid => f64::INFINITY,
            Self::Driven(drive) => STEP_SHARE / drive.signal.highest_frequency(),
            Self::Yielding(backing) => backing.echo.map_or(f64::INFINITY, |echo| echo.delay),
        }
    }
}

impl Drive {
    /// Displacement into the chain (m) and its rate (m/s) at `time` (s).
    pub fn at(&self, time: f64) -> [f64; 2] {
        self.signal.at(time).map(|value| self.amplitude * value)
    }

    /// The largest speed of the wall, estimated by the highest frequency (m/s).
    pub fn speed(&self) -> f64 {
        TAU * self.signal.highest_frequency() * self.amplitude
    }
}

impl Signal {
    /// The signal (1) and its rate (1/s) at `time` (s).
    pub fn at(&self, time: f64) -> [f64; 2] {
        if time < 0.0 || time > self.length {
            return [0.0; 2];
        }
        let [value, rate] = self.carrier.at(time);
        let [rise, rising] = edge(time, self.edge);
        let [fall, falling] = edge(self.length - time, self.edge);
        [value * rise * fall, rate * rise * fall + value * (rising * fall - rise * falling)]
    }

    /// The signal in words.
    fn summary(&self) -> String {
        let (hertz, seconds) =
            (|value: f64| engineering(value, "Hz", 4), |value: f64| engineering(value, "s", 4));
        let carrier = match &self.carrier {
            Carrier::Sine { frequency } => format!("sine of {}", hertz(*frequency)),
            Carrier::Chirp { from, to, .. } => {
                format!("chirp from {} to {}", hertz(*from), hertz(*to))
            }
            Carrier::Noise(tones, _) => format!("noise of {} tones", tones.len()),
            Carrier::Samples(values, interval) => {
                format!("{} samples, one every {}", values.len(), seconds(*interval))
            }
        };
        if self.length.is_finite() {
            format!("{carrier}, {} long", seconds(self.length))
        } else {
            carrier
        }
    }

    /// The highest frequency in it, edges not counted (Hz).
    pub fn highest_frequency(&self) -> f64 {
        match &self.carrier {
            Carrier::Sine { frequency } => *frequency,
            Carrier::Chirp { from, to, .. } => from.max(*to),
            Carrier::Noise(tones, _) => {
                tones.iter().fold(0.0_f64, |most, [angular, _]| most.max(angular / TAU))
            }
            Carrier::Samples(_, interval) => 0.25 / interval,
        }
    }

    /// Times at which its rate may jump or bend: the ends of the signal and of its edges (s).
    pub fn breaks(&self) -> [f64; 4] {
        [0.0, self.edge, self.length - self.edge, self.length]
    }
}

/// Half a cosine from 0 to 1 over `length` (s), and its rate (1/s), at `time` (s) after its start.
fn edge(time: f64, length: f64) -> [f64; 2] {
    if time >= length {
        return [1.0, 0.0];
    }
    let phase = PI * time / length;
    [0.5 * (1.0 - phase.cos()), 0.5 * PI / length * phase.sin()]
}

impl Carrier {
    /// Its value (1) and rate (1/s) at `time` (s).
    fn at(&self, time: f64) -> [f64; 2] {
        let sine = |phase: f64, angular: f64| [phase.sin(), angular * phase.cos()];
        match self {
            Self::Sine { frequency } => sine(TAU * frequency * time, TAU * frequency),
            Self::Chirp { from, rate, .. } => {
                let cycles = time * (from + 0.5 * rate * time);
                sine(TAU * cycles, TAU * (from + rate * time))
            }
            Self::Noise(tones, amplitude) => {
                let tone = |sum: [f64; 2], [angular, phase]: &[f64; 2]| {
                    let [value, rate] = sine(angular * time + phase, *angular);
                    [sum[0] + amplitude * value, sum[1] + amplitude * rate]
                };
                tones.iter().fold([0.0; 2], tone)
            }
            Self::Samples(values, interval) => samples(values, time / interval, *interval),
        }
    }
}

/// The cubic through the samples beside the place `at`, counted in intervals (s), whose slopes at
/// the samples are those of their neighbours' secants; the signal is 0 beyond its samples.
fn samples(values: &[f64], at: f64, interval: f64) -> [f64; 2] {
    let place = at.floor();
    let sample = |offset: f64| {
        let index = place + offset;
        let known = index >= 0.0 && index < values.len() as f64;
        if known { values[index as usize] } else { 0.0 }
    };
    let (t, [before, from, to, after]) = (at - place, [-1.0, 0.0, 1.0, 2.0].map(sample));
    let (start, end) = (0.5 * (to - before), 0.5 * (after - from));
    let (square, cube) = (3.0 * (to - from) - 2.0 * start - end, start + end - 2.0 * (to - from));
    let value = from + t * (start + t * (square + t * cube));
    [value, (start + t * (2.0 * square + t * 3.0 * cube)) / interval]
}

impl Backing {
    /// A long thin rod of this section (m²), Young's modulus (Pa), density (kg/m³) and, where an
    /// echo counts, length (m) and reflection at the far end (1).
    pub fn rod(section: f64, modulus: f64, density: f64, far_end: Option<(f64, f64)>) -> Self {
        let speed = (modulus / density).sqrt();
        let echo =
            far_end.map(|(length, reflection)| Echo { delay: 2.0 * length / speed, reflection });
        Self { impedance: section * density * speed, echo }
    }

    /// A wide thin plate of this thickness (m), Young's modulus (Pa), Poisson's ratio (1) and
    /// density (kg/m³).
    pub fn plate(thickness: f64, modulus: f64, ratio: f64, density: f64) -> Self {
        let rigidity = modulus * thickness.powi(3) / (12.0 * (1.0 - ratio * ratio));
        Self { impedance: 8.0 * (rigidity * density * thickness).sqrt(), echo: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rates against differences of values, for every carrier, inside edges and between them.
    #[test]
    fn rates_are_the_derivatives_of_the_values() {
        let values: Arc<[f64]> = (0..40).map(|i| f64::from(i * i % 7)).collect();
        let tones: Arc<[[f64; 2]]> = [[3e4, 0.3], [5e4, 2.0]].into();
        for carrier in [
            Carrier::Sine { frequency: 1e4 },
            Carrier::Chirp { from: 1e3, rate: 1e7, to: 1.1e4 },
            Carrier::Noise(tones, 0.7),
            Carrier::Samples(values, 2.7e-5),
        ] {
            let signal = Signal { carrier, length: 1e-3, edge: 2e-4 };
            for time in [1e-5, 1.3e-4, 4.1e-4, 8.7e-4, 9.9e-4] {
                let step = 1e-9;
                let [after, before] = [time + step, time - step].map(|t| signal.at(t)[0]);
                let slope = (after - before) / (2.0 * step);
                assert!((signal.at(time)[1] - slope).abs() < 1e-6 * 1e5, "{signal:?} at {time}");
            }
            for outside in [-1e-9, 1.1e-3] {
                assert!(signal.at(outside).iter().all(|value| *value == 0.0));
            }
        }
    }

    /// By hand: steel, 4.76 mm rod: `c = sqrt(193e9/7900) = 4942.7 m/s`, `Z = A rho c = 694.86`.
    #[test]
    fn impedances_are_those_of_the_formulas() {
        let section = 0.25 * PI * 4.76e-3 * 4.76e-3;
        let rod = Backing::rod(section, 193e9, 7900.0, Some((1.0, 1.0)));
        assert!((rod.impedance - 694.858).abs() < 0.01, "{}", rod.impedance);
        assert!(rod.echo.is_some_and(|echo| (echo.delay - 404.636e-6).abs() < 1e-8));
        // D = 193e9 * 27e-9/(12 * 0.91) = 477.198 N m; Z = 8 sqrt(477.198 * 7900 * 0.003).
        let plate = Backing::plate(3e-3, 193e9, 0.3, 7900.0);
        assert!((plate.impedance - 850.77).abs() < 0.05, "{}", plate.impedance);
    }
}
