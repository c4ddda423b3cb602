//! Simulated momentum tests: a striker drops on a sensor on a heavy anvil, and the scope records
//! what the sensor makes of it.
//!
//! The bench is the shipped scene `momentum-test`: contact and free flight come from the chain, so
//! the momentum handed over is known to the integrator's accuracy. Records of one impact that
//! differ in phase, noise and circuit need it once only. Valid for elastic strikers: the rebound is
//! as fast as the contact law makes it.

use rand_distr::{Distribution, StandardUniform};
use rand_pcg::Pcg64;

use super::equation::Common;
use super::error::CalibrationError;
use super::result::{Calibration, PlannedStrike};
use super::{Draws, calibrate};
use crate::experiment::{Integration, RunError, run};
use crate::recording::{Capture, InstrumentIdentity, TrueSignal};
use crate::scene::document::quoted;
use crate::scene::plan::lab::LabStriker;
use crate::scene::{Scene, SceneError, require};
use crate::scope::acquire::{before_trigger, digitise, find_trigger};
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::waveform::levels_per_division;
use crate::scope::{ChannelSetup, Model, Setup, Source, Trigger};
use crate::sensor::Circuit;
use crate::trace::Trace;

/// The bench.
const SCENE: &str = "momentum-test";
/// Time base at which the force is kept: 10 ns between samples, a thousandth of the shortest
/// contacts.
const FORCE_TIME_BASE: &str = "2.5 us/div";
/// Mass of the anvil, which floats (kg).
const ANVIL_MASS: f64 = 10.0;
/// Samples before the record's earliest, for interpolation (1).
const SPARE_SAMPLES: f64 = 20.0;
/// Divisions from the centre to zero volts, downward: a positive pulse has the screen (div).
const ZERO_POSITION: f64 = -3.0;
/// Divisions from zero volts to the trigger level (div).
const TRIGGER_LEVEL: f64 = 0.5;
/// Share of the record before the trigger (1).
const PRE_TRIGGER: f64 = 0.25;

/// Ground truth of one impact.
#[derive(Debug, Clone, PartialEq)]
pub struct ImpactTruth {
    /// Force on the sensor.
    pub force: Trace,
    /// Speed before the contact (m/s).
    pub incoming: f64,
    /// Speed after it, the other way (m/s).
    pub rebound: f64,
    /// Duration of the contact (s).
    pub duration: f64,
}

/// Why there is no simulated test.
#[derive(Debug, thiserror::Error)]
pub enum TestError {
    /// The sensor or the scope cannot be put on the bench.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The impact cannot be simulated.
    #[error(transparent)]
    Run(#[from] RunError),
    /// A design names a striker that the laboratory lacks.
    #[error("found no striker `{striker}` in the laboratory, expected one of its own")]
    Striker {
        /// The striker.
        striker: String,
    },
    /// The striker does not come back.
    #[error("found {striker} on the sensor still after {time:e} s, expected a contact that ends")]
    NoRebound {
        /// The striker.
        striker: String,
        /// How long was waited (s).
        time: f64,
    },
}

/// The bench with `sensor`, a name or a file, on it, and an oscilloscope, likewise.
///
/// # Errors
/// [`SceneError`]: no such sensor, or every problem found in it.
pub fn bench(sensor: &str, scope: &str) -> Result<Scene, SceneError> {
    require("sensors", sensor)?;
    require("", scope)?;
    let text = format!(
        "base = \"{SCENE}\"\n[sensors.item]\nmodel = {}\n[scope]\nmodel = {}\n",
        quoted(sensor),
        quoted(scope)
    );
    Scene::from_text(SCENE, "momentum test", &text)
}

/// Drops `striker` with `speed` (m/s) at the first contact, under `gravity` (m/s^2).
///
/// # Errors
/// [`TestError`]: the bench cannot be built or run, or the striker stays.
pub fn strike(striker: &LabStriker, speed: f64, gravity: f64) -> Result<ImpactTruth, TestError> {
    // Hertz's contact lasts 2.94 overlaps over the speed; a hundredth of a second is more than any
    // of these takes.
    let mut duration = 200e-6;
    loop {
        let text = format!(
            "base = \"{SCENE}\"\nduration = \"{duration} s\"\n[striker]\nmaterial = {}\ndiameter = \"{} m\"\n\
             mass = \"{} kg\"\nspeed = \"{speed} m/s\"\n[scope]\ntime_base = \"{FORCE_TIME_BASE}\"\nposition = \"0 s\"\n\
             [effects.gravity]\nacceleration = \"{gravity} m/s^2\"\n[chain]\nbottom = {{ force = \"{} N\" }}\n",
            quoted(&striker.material),
            striker.diameter,
            striker.mass.value,
            ANVIL_MASS * gravity
        );
        let scene = Scene::from_text(SCENE, "momentum test", &text)?;
        let outcome = run(&scene, Integration::Accuracy(scene.accuracy), 1, &mut |_| ())?;
        let force = outcome.shot.true_signal(&TrueSignal::Force("item".to_owned()));
        let path = outcome.shot.true_signal(&TrueSignal::Displacement(0));
        if let (Some(force), Some(path)) = (force, path)
            && let Some(truth) = freed(force, path, gravity, speed)
        {
            return Ok(truth);
        }
        if duration > 10e-3 {
            return Err(TestError::NoRebound { striker: striker.name.clone(), time: duration });
        }
        duration *= 2.0;
    }
}

/// The impact, if the contact is over a twentieth of the run before its end.
fn freed(force: &Trace, path: &Trace, gravity: f64, incoming: f64) -> Option<ImpactTruth> {
    let first = force.values.iter().position(|f| *f > 0.0)?;
    let last = force.values.iter().rposition(|f| *f > 0.0)?;
    if last + force.values.len() / 20 > force.values.len() {
        return None;
    }
    // In free flight the mean speed of a stretch is the speed at its middle.
    let (end, before) = (path.values.len().checked_sub(1)?, path.values.len().checked_sub(3)?);
    let middle = 0.5 * (path.time(end) + path.time(before));
    let mean =
        (path.values.get(end)? - path.values.get(before)?) / (path.time(end) - path.time(before));
    let over = force.time(last + 1);
    let start = force.time(first.saturating_sub(1));
    Some(ImpactTruth {
        force: force.clone(),
        incoming,
        rebound: gravity * (middle - over) - mean,
        duration: over - start.max(0.0),
    })
}

/// How the scope is set for a test: vertical scale (V/div) and time base (s/div).
pub fn setting(bench: &Scene, scale: f64, time_base: f64) -> Setup {
    let mut setup = bench.scope.clone();
    setup.time_base = time_base;
    setup.horizontal_position = (0.5 - PRE_TRIGGER) * setup.model.horizontal_divisions * time_base;
    setup.trigger = Trigger { level: TRIGGER_LEVEL * scale, ..setup.trigger };
    for channel in setup.channels.iter_mut().flatten() {
        channel.vertical.scale = scale;
        channel.vertical.position = ZERO_POSITION;
    }
    setup
}

/// Share of the screen above zero volts that the converter has (div).
pub fn room(model: &Model) -> f64 {
    f64::from(*model.codes().end()) / levels_per_division(model.bits) - ZERO_POSITION
}

/// The scope's record of `truth` through `circuit`; phase of its clock and noise come from `seed`
/// and `shot`. None where it is not triggered.
pub fn capture(
    truth: &ImpactTruth,
    circuit: Circuit,
    setup: &Setup,
    (seed, shot): (u64, u32),
) -> Option<Capture> {
    let channel: &ChannelSetup = setup.channels.first()?.as_ref()?;
    let interval = setup.signal_interval();
    let (start, end) = setup.record_span();
    let mut clock: Pcg64 = noise_stream(seed, shot, 0);
    let phase: f64 = StandardUniform.sample(&mut clock);
    // Triggered within the contact, wherever in it.
    let before = (-start / interval).ceil() + SPARE_SAMPLES;
    let samples = (before + (truth.duration + end) / interval + SPARE_SAMPLES) as usize;
    let mut force = Trace {
        start: (phase - before) * interval,
        interval,
        values: Vec::new(),
        ..truth.force.clone()
    };
    force.values = (0..samples).map(|i| between(&truth.force, force.time(i))).collect();
    let volts = circuit.respond(&force).values;
    let mut noise = noise_stream(seed, shot, 1);
    let signal = condition(setup, channel, interval, &volts, &mut noise);
    let scale = channel.vertical.scale;
    let found = find_trigger(setup, scale, &signal, 0, before_trigger(setup))?;
    let model = &setup.model;
    Some(Capture {
        waveform: digitise(setup, Source::Channel(1), channel, &signal, found.index),
        instrument: Some(InstrumentIdentity {
            model: model.name.replace(' ', ""),
            serial: model.serial.clone(),
            firmware: model.firmware.clone(),
        }),
        notes: vec!["simulated momentum test".to_owned()],
    })
}

/// `trace` at `time` (s) on straight lines between its samples; nothing outside.
fn between(trace: &Trace, time: f64) -> f64 {
    let place = (time - trace.start) / trace.interval;
    if place < 0.0 {
        return 0.0;
    }
    let index = place.floor() as usize;
    let at = |i: usize| trace.values.get(i).copied().unwrap_or(0.0);
    at(index) + (place - index as f64) * (at(index + 1) - at(index))
}

/// One blind calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct BlindCalibration {
    /// The plan and recordings given to the calibration.
    pub strikes: Vec<PlannedStrike>,
    /// And what its inputs share.
    pub common: Common,
    /// The captures that records were taken from.
    pub captures: Vec<Capture>,
    /// The hidden values.
    pub circuit: Circuit,
}

impl BlindCalibration {
    /// Calibrates with the stated values, without Monte Carlo.
    ///
    /// # Errors
    /// As [`calibrate`].
    pub fn calibrate(&self) -> Result<Calibration, CalibrationError> {
        calibrate(&self.strikes, &self.common, Draws { seed: 0, count: 0 })
    }
}
