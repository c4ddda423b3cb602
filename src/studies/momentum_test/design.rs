//! Designs a momentum test: which striker, height, V/div and s/div leave the sensitivity least uncertain.
//!
//! Each candidate is a whole calibration of six impacts, two each from a height, half and a quarter of it, recorded by the virtual
//! scope and calibrated blind: it is handed records and stated values, which are off the true ones as their uncertainties say.

use super::simulation::BlindCalibration;
use crate::quantity::Uncertain;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::files::{self, Test};
use super::simulation::{
    DroppedStriker, ImpactTruth, TestError, bench, capture, room, setting, strike,
};
use crate::analysis::calibration::PlannedStrike;
use crate::analysis::calibration::model::{Common, SpeedSource, StrikerMotion};
use crate::measurement::calibration::record;
use crate::scene::Scene;
use crate::scope::Setup;
use crate::sensor::Circuit;

/// Free fall of the bench (m/s^2).
const GRAVITY: f64 = 9.81;
/// Its standard uncertainty: known from the laboratory's latitude and height (m/s^2).
const GRAVITY_U: f64 = 1e-4;
/// Density of the steel spheres (kg/m^3).
const STEEL_DENSITY: f64 = 7900.0;
/// Diameters of the steel spheres (m).
const SPHERES: [f64; 4] = [3e-3, 4e-3, 6e-3, 10e-3];
/// Masses of strikers whose face is a PTFE sphere of the paper's size, and its diameter (kg, m).
const CAPPED_STRIKERS: ([f64; 4], f64) = ([0.1226e-3, 0.61e-3, 1.22e-3, 2.75e-3], 4.76e-3);
/// Heights (m).
const HEIGHTS: [f64; 4] = [5e-3, 10e-3, 20e-3, 40e-3];
/// Shares of the height from which strikers drop, two impacts each.
const HEIGHT_SHARES: [f64; 3] = [1.0, 0.5, 0.25];
/// Impacts from each height.
const REPEATS: u32 = 2;
/// A pulse may fill this share of the screen above zero (1).
const SCREEN_FILL_SHARE: f64 = 0.9;
/// Fewer samples in a contact than this blur it.
const MIN_CONTACT_SAMPLES: f64 = 100.0;
/// Stream of what a lab's readings are off.
const READING_STREAM: u128 = 1 << 70;

/// Standard uncertainties of a lab's readings.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LabUncertainties {
    /// Of a mass (kg).
    pub mass_u: f64,
    /// Of a drop height (m).
    pub height_u: f64,
    /// Of a rebound speed, relative (1).
    pub rebound_u: f64,
    /// Of the scope's gain, relative; none where sensor and scope are calibrated as one (1).
    pub gain_u: Option<f64>,
}

impl Default for LabUncertainties {
    /// A balance good to half a milligram, a height gauge to 0.05 mm, a light gate to 1 %; sensor and scope as one chain.
    fn default() -> Self {
        Self { mass_u: 0.5e-6, height_u: 0.05e-3, rebound_u: 0.01, gain_u: None }
    }
}

/// One way to do it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TestDesign {
    /// The striker.
    pub striker: String,
    /// Its mass (kg).
    pub mass_kg: f64,
    /// Largest height it drops from (m).
    pub height_m: f64,
    /// Vertical scale (V/div).
    pub volts_per_div: f64,
    /// Time base (s/div).
    pub seconds_per_div: f64,
    /// Largest force (N).
    pub peak_force_n: f64,
    /// Its contact's duration (s).
    pub contact_s: f64,
    /// Expanded uncertainty (95 %), relative; none where the calibration failed (1).
    #[serde(rename = "U95_relative")]
    pub expanded: Option<f64>,
    /// Why it failed.
    pub failed: Option<String>,
}

/// The bench with a sensor, and what the lab can do.
pub struct Designer {
    bench: Scene,
    lab: LabUncertainties,
    seed: u64,
}

/// The strikers that are tried.
pub fn strikers() -> Vec<DroppedStriker> {
    let sphere = |diameter: &f64| DroppedStriker {
        name: format!("steel-{:.0}mm", 1e3 * diameter),
        material: "stainless_steel".to_owned(),
        diameter: *diameter,
        mass: STEEL_DENSITY * std::f64::consts::PI / 6.0 * diameter.powi(3),
    };
    let capped = |mass: &f64| DroppedStriker {
        name: format!("ptfe-capped-{:.2}g", 1e3 * mass),
        material: "ptfe".to_owned(),
        diameter: CAPPED_STRIKERS.1,
        mass: *mass,
    };
    SPHERES.iter().map(sphere).chain(CAPPED_STRIKERS.0.iter().map(capped)).collect()
}

impl Designer {
    /// Puts `sensor`, a name or a file, on the bench.
    ///
    /// # Errors
    /// [`TestError`]: no such sensor, or problems in its file.
    pub fn new(sensor: &str, lab: LabUncertainties, seed: u64) -> Result<Self, TestError> {
        Ok(Self { bench: bench(sensor)?, lab, seed })
    }

    /// The circuit of the sensor's data (V/N, s).
    pub fn circuit(&self) -> Option<Circuit> {
        self.bench.circuit(0, self.bench.scope.channels.first()?.as_ref()?)
    }

    /// Attempts all strikers whose name contains `striker`, heights, scales and time bases; the best first.
    ///
    /// # Errors
    /// [`TestError`] for impacts that cannot be simulated.
    pub fn search(
        &self,
        striker: &str,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Vec<TestDesign>, TestError> {
        let strikers: Vec<DroppedStriker> =
            strikers().into_iter().filter(|s| s.name.contains(striker)).collect();
        let mut found = Vec::new();
        let all = (strikers.len() * HEIGHTS.len()) as f64;
        let mut done = 0.0;
        for striker in &strikers {
            for height in HEIGHTS {
                found.extend(self.try_height(striker, height)?);
                done += 1.0;
                progress(done / all);
            }
        }
        found.sort_by(|a, b| {
            let u = |c: &TestDesign| c.expanded.unwrap_or(f64::INFINITY);
            u(a).total_cmp(&u(b))
        });
        Ok(found)
    }

    /// All settings of the scope that show impacts from `height` (m) well.
    fn try_height(
        &self,
        striker: &DroppedStriker,
        height: f64,
    ) -> Result<Vec<TestDesign>, TestError> {
        let Some(circuit) = self.circuit() else { return Ok(Vec::new()) };
        let truths = self.impacts(striker, height)?;
        let Some(highest) = truths.first() else { return Ok(Vec::new()) };
        let peak = highest.force.values.iter().copied().fold(0.0, f64::max);
        let model = &self.bench.scope.model;
        let needed = circuit.sensitivity * peak / (SCREEN_FILL_SHARE * room());
        let Some(scale) = model.vertical_scales.iter().copied().find(|scale| *scale >= needed)
        else {
            return Ok(Vec::new());
        };
        let longest = truths.iter().map(|truth| truth.duration).fold(0.0, f64::max);
        let shown = |time_base: &&f64| {
            let record = model.horizontal_divisions * **time_base;
            0.5 * record > longest
                && highest.duration > MIN_CONTACT_SAMPLES * model.interval(**time_base)
        };
        let mut candidates = Vec::new();
        for time_base in model.time_bases.iter().filter(shown) {
            let setup = setting(&self.bench, scale, *time_base);
            let result = self.blind(striker, &truths, circuit, (&setup, 0)).calibrate();
            candidates.push(TestDesign {
                striker: striker.name.clone(),
                mass_kg: striker.mass,
                height_m: height,
                volts_per_div: scale,
                seconds_per_div: *time_base,
                peak_force_n: peak,
                contact_s: highest.duration,
                expanded: result.as_ref().ok().map(|c| c.expanded() / c.sensitivity),
                failed: result.err().map(|error| error.to_string()),
            });
        }
        Ok(candidates)
    }

    /// The true impacts of a test from `height` (m) and its shares.
    ///
    /// # Errors
    /// [`TestError`] for impacts that cannot be simulated.
    pub fn impacts(
        &self,
        striker: &DroppedStriker,
        height: f64,
    ) -> Result<Vec<ImpactTruth>, TestError> {
        HEIGHT_SHARES
            .iter()
            .map(|share| strike(striker, (2.0 * GRAVITY * share * height).sqrt()))
            .collect()
    }

    /// Records `truths` through `circuit`, and reads the lab's instruments: everything drawn from the seed and `repeat`.
    pub fn blind(
        &self,
        striker: &DroppedStriker,
        truths: &[ImpactTruth],
        circuit: Circuit,
        (setup, repeat): (&Setup, u32),
    ) -> BlindCalibration {
        let mut readings = Pcg64::new(u128::from(self.seed), READING_STREAM + u128::from(repeat));
        let mut read = |truth: f64, u: f64| {
            let deviate: f64 = StandardNormal.sample(&mut readings);
            Uncertain::normal(truth + u * deviate, u)
        };
        let gain_u = self.lab.gain_u.unwrap_or(0.0);
        // The scope's gain is off by what its own specification leaves open.
        let gain = read(1.0, gain_u).value;
        let common = Common {
            strikers: vec![(striker.name.clone(), read(striker.mass, self.lab.mass_u))],
            gain: Uncertain::normal(1.0, gain_u),
            speed_scale: Uncertain::normal(1.0, 0.0),
            gate_distance: None,
            gravity: Uncertain::normal(GRAVITY, GRAVITY_U),
            tau: None,
        };
        let shown = Circuit { sensitivity: circuit.sensitivity / gain, ..circuit };
        let mut blind =
            BlindCalibration { strikes: Vec::new(), common, captures: Vec::new(), circuit };
        let each = truths.iter().flat_map(|truth| (0..REPEATS).map(move |_| truth));
        for (number, truth) in (1..).zip(each) {
            let height = truth.incoming * truth.incoming / (2.0 * GRAVITY);
            let motion = StrikerMotion {
                striker: 0,
                incoming: SpeedSource::Height(read(height, self.lab.height_u)),
                rebound: SpeedSource::Speed(read(
                    truth.rebound,
                    self.lab.rebound_u * truth.rebound,
                )),
            };
            let shot = repeat.wrapping_mul(100) + number;
            let Some(capture) = capture(truth, shown, setup, (self.seed, shot)) else { continue };
            let Some(record) = record(&capture, None) else { continue };
            blind.strikes.push(PlannedStrike { record, motion });
            blind.captures.push(capture);
        }
        blind
    }

    /// The true impacts and the scope's setting of `candidate`.
    ///
    /// # Errors
    /// [`TestError`] for impacts that cannot be simulated.
    pub fn prepare(
        &self,
        candidate: &TestDesign,
    ) -> Result<(DroppedStriker, Vec<ImpactTruth>, Setup), TestError> {
        let striker = strikers().into_iter().find(|s| s.name == candidate.striker);
        let striker = striker.unwrap_or_else(|| strikers().swap_remove(0));
        let truths = self.impacts(&striker, candidate.height_m)?;
        let setup = setting(&self.bench, candidate.volts_per_div, candidate.seconds_per_div);
        Ok((striker, truths, setup))
    }

    /// `candidate` as a lab would bring it: a plan and recordings.
    ///
    /// # Errors
    /// [`TestError`] for impacts that cannot be simulated.
    pub fn test(&self, candidate: &TestDesign) -> Result<Test, TestError> {
        let (striker, truths, setup) = self.prepare(candidate)?;
        let Some(circuit) = self.circuit() else {
            return Ok(Test { plan: String::new(), recordings: Vec::new() });
        };
        let blind = self.blind(&striker, &truths, circuit, (&setup, 0));
        let sensor = self.bench.sensors.first().map_or("sensor", |placed| &placed.sensor.model);
        Ok(files::write(&blind, sensor, self.lab.gain_u, &setup))
    }
}
