//! Designs a momentum test: which striker, height, V/div and s/div leave the sensitivity least
//! uncertain.
//!
//! Strikers, heights and instruments are the laboratory's ([`Laboratory`]). Each candidate is a
//! whole calibration of six impacts, two each from a height, half and a quarter of it, recorded by
//! the virtual scope and calibrated blind: it is handed records and stated values, which are off
//! the true ones as their uncertainties say.

use super::simulation::BlindCalibration;
use crate::quantity::Uncertain;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use super::equation::{Common, SpeedSource, StrikerMotion};
use super::files::{self, Test};
use super::plan_run::record;
use super::result::PlannedStrike;
use super::simulation::{ImpactTruth, TestError, bench, capture, room, setting, strike};
use crate::scene::Scene;
use crate::scene::plan::lab::{LabStriker, Laboratory, SpeedReading};
use crate::scope::Setup;
use crate::sensor::Circuit;

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

/// The bench with a sensor, and what the laboratory has.
pub struct Designer {
    bench: Scene,
    lab: Laboratory,
    seed: u64,
}

impl Designer {
    /// Puts `sensor`, a name or a file, on the bench, and the laboratory's scope beside it.
    ///
    /// # Errors
    /// [`TestError`]: no such sensor, or problems in its file.
    pub fn new(sensor: &str, lab: Laboratory, seed: u64) -> Result<Self, TestError> {
        Ok(Self { bench: bench(sensor, &lab.scope)?, lab, seed })
    }

    /// What the laboratory has.
    pub fn lab(&self) -> &Laboratory {
        &self.lab
    }

    /// The circuit of the sensor's data (V/N, s).
    pub fn circuit(&self) -> Option<Circuit> {
        self.bench.circuit(0, self.bench.scope.channels.first()?.as_ref()?)
    }

    /// Attempts all strikers, heights, scales and time bases; the best first.
    ///
    /// # Errors
    /// [`TestError`] for impacts that cannot be simulated.
    pub fn search(&self, progress: &mut dyn FnMut(f64)) -> Result<Vec<TestDesign>, TestError> {
        let mut found = Vec::new();
        let all = (self.lab.strikers.len() * self.lab.heights.len()) as f64;
        let mut done = 0.0;
        for striker in &self.lab.strikers {
            for height in &self.lab.heights {
                found.extend(self.try_height(striker, *height)?);
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
    fn try_height(&self, striker: &LabStriker, height: f64) -> Result<Vec<TestDesign>, TestError> {
        let Some(circuit) = self.circuit() else { return Ok(Vec::new()) };
        let truths = self.impacts(striker, height)?;
        let Some(highest) = truths.first() else { return Ok(Vec::new()) };
        let peak = highest.force.values.iter().copied().fold(0.0, f64::max);
        let model = &self.bench.scope.model;
        let needed = circuit.sensitivity * peak / (SCREEN_FILL_SHARE * room(model));
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
                mass_kg: striker.mass.value,
                height_m: height,
                volts_per_div: scale,
                seconds_per_div: *time_base,
                peak_force_n: peak,
                contact_s: highest.duration,
                expanded: result.as_ref().ok().map(|c| c.expanded_relative),
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
        striker: &LabStriker,
        height: f64,
    ) -> Result<Vec<ImpactTruth>, TestError> {
        let gravity = self.lab.gravity.value;
        HEIGHT_SHARES
            .iter()
            .map(|share| strike(striker, (2.0 * gravity * share * height).sqrt(), gravity))
            .collect()
    }

    /// Records `truths` through `circuit`, and reads the laboratory's instruments: everything drawn
    /// from the seed and `repeat`.
    pub fn blind(
        &self,
        striker: &LabStriker,
        truths: &[ImpactTruth],
        circuit: Circuit,
        (setup, repeat): (&Setup, u32),
    ) -> BlindCalibration {
        let mut readings = Pcg64::new(u128::from(self.seed), READING_STREAM + u128::from(repeat));
        let stated = self.lab.gain.unwrap_or(Uncertain::normal(1.0, 0.0));
        // The scope's gain is off by what its own specification leaves open.
        let gain: f64 = if stated.half_width > 0.0 {
            let share: f64 = StandardUniform.sample(&mut readings);
            1.0 + stated.half_width * (2.0 * share - 1.0)
        } else {
            let deviate: f64 = StandardNormal.sample(&mut readings);
            1.0 + stated.u * deviate
        };
        let mut read = |truth: f64, u: f64| {
            let deviate: f64 = StandardNormal.sample(&mut readings);
            Uncertain::normal(truth + u * deviate, u)
        };
        let common = Common {
            strikers: vec![(striker.name.clone(), read(striker.mass.value, striker.mass.u))],
            gain: stated,
            speed_scale: Uncertain::normal(1.0, 0.0),
            gate_distance: None,
            gravity: self.lab.gravity,
            tau: None,
            above: Uncertain::normal(0.0, 0.0),
        };
        let shown = Circuit { sensitivity: circuit.sensitivity / gain, ..circuit };
        let mut blind =
            BlindCalibration { strikes: Vec::new(), common, captures: Vec::new(), circuit };
        let gravity = self.lab.gravity.value;
        let each = truths.iter().flat_map(|truth| (0..REPEATS).map(move |_| truth));
        for (number, truth) in (1..).zip(each) {
            let mut measure = |speed: f64, how: SpeedReading| match how {
                SpeedReading::Speed(u) => SpeedSource::Speed(read(speed, u * speed)),
                SpeedReading::Height(u) => {
                    SpeedSource::Height(read(0.5 * speed * speed / gravity, u))
                }
                SpeedReading::FlightTime(u) => {
                    SpeedSource::FlightTime(read(2.0 * speed / gravity, u))
                }
            };
            let motion = StrikerMotion {
                striker: 0,
                incoming: measure(truth.incoming, self.lab.incoming),
                rebound: measure(truth.rebound, self.lab.rebound),
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
    ) -> Result<(LabStriker, Vec<ImpactTruth>, Setup), TestError> {
        let strikers = &self.lab.strikers;
        let striker = strikers.iter().find(|s| s.name == candidate.striker).or(strikers.first());
        let unknown = || TestError::Striker { striker: candidate.striker.clone() };
        let striker = striker.ok_or_else(unknown)?.clone();
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
        Ok(files::write(&blind, sensor, self.lab.gain, &setup))
    }
}
