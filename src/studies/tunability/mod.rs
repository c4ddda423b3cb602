//! The paper's title as a map: what a chain lets pass, and how fast, over its preload, its masses,
//! its modulus and what strikes it.
//!
//! Each knob is turned by itself over equal ratios, everything else stays as the scene has it. Band
//! edges and the speed of long waves are those of the linear chain around the first sensor (Herbold
//! et al. (2009), Eqs (9) and (10)); the speed of the pulse and the spectrum that arrives are
//! computed with all of the scene's physics. Edges hold for dynamic forces far below the static
//! one; where the pulse is stronger, the map shows how far it breaks through them.

mod knob;

pub use knob::TuningParameter;

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::gate::Gate;
use crate::analysis::spectrum::Window;
use crate::analysis::spectrum::{Analyser, Spectrum, SpectrumError, SpectrumSettings};
use crate::chain::{ChainError, ForceProbe};
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::method_choice;
use crate::experiment::parallel::{in_parallel, processors};
use crate::experiment::pulse::{HALF_RISE_SHARE, PulseRecorder};
use crate::measurement::metadata::cell;
use crate::motion::IntegrateError;
use crate::scene::{Scene, Site};
use knob::sensed;

/// Accuracy of the simulations: far below what a shade or a curve shows (1).
const MAP_ACCURACY: f64 = 1e-5;
/// Sample interval of the forces (s).
const MAP_SAMPLE_INTERVAL: f64 = 2e-6;

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// Nothing whose arrival could be told.
    #[error("found {found} sensors in particles of {scene}, expected at least two")]
    Sensors {
        /// The scene.
        scene: String,
        /// How many.
        found: usize,
    },
    /// A knob that the scene does not have.
    #[error("found no {} in {scene}, expected one of {known}", knob.name())]
    NoKnob {
        /// The scene.
        scene: String,
        /// The knob.
        knob: TuningParameter,
        /// The knobs that it has.
        known: String,
    },
    /// A value that no chain can have.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// A run that could not go on.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
    /// A force without a spectrum.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// A scene with one knob at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedPoint {
    /// The knob's value (unit).
    pub value: f64,
    /// The linear chain around the first sensor; none without preload.
    pub chain: Option<DiatomicChain>,
    /// Speed of the pulse between the first and the last sensor, by its half-rise; none where none
    /// arrives (m/s).
    pub pulse_speed: Option<f64>,
    /// First peak at the last sensor over that at the first (1).
    pub transmission: Option<f64>,
    /// The spectrum at the last sensor through a Hann window: motion goes on when the record ends,
    /// and cut off it would blur the gap.
    pub transmitted: Spectrum,
}

/// One knob over its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuning {
    /// The knob.
    pub knob: TuningParameter,
    /// Where the scene has it (unit).
    pub now: f64,
    /// From lowest to highest.
    pub points: Vec<TunedPoint>,
}

/// Turns each of `knobs` from its value divided by `span` to `span` times it, in `points` equal
/// ratios; `progress` is called with the share of the work done, 0 to 1.
///
/// # Errors
/// [`TuneError`] for a scene without two sensors in particles or without the knob.
pub fn tune(
    scene: &Scene,
    knobs: &[TuningParameter],
    points: u32,
    span: f64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Tuning>, TuneError> {
    let found = sensed(scene).len();
    if found < 2 {
        return Err(TuneError::Sensors { scene: scene.name.clone(), found });
    }
    let mut turned = Vec::new();
    let mut jobs = Vec::new();
    for knob in knobs {
        let now = knob.value(scene).ok_or_else(|| TuneError::NoKnob {
            scene: scene.name.clone(),
            knob: *knob,
            known: TuningParameter::of(scene)
                .iter()
                .map(|k| k.name())
                .collect::<Vec<_>>()
                .join(", "),
        })?;
        turned.push((*knob, now));
        let steps = f64::from(points.saturating_sub(1).max(1));
        for index in 0..points {
            let value = now * span.powf(2.0 * f64::from(index) / steps - 1.0);
            jobs.push((*knob, value));
        }
    }
    let work = |(knob, value): &(TuningParameter, f64)| point(scene, *knob, *value);
    let done = |finished: usize| progress(finished as f64 / jobs.len() as f64);
    let mut results = in_parallel(processors(), &jobs, &work, &done).into_iter();
    let mut tunings = Vec::new();
    for (knob, now) in turned {
        let points: Result<Vec<_>, _> = results.by_ref().take(points as usize).collect();
        tunings.push(Tuning { knob, now, points: points? });
    }
    Ok(tunings)
}

fn point(scene: &Scene, knob: TuningParameter, value: f64) -> Result<TunedPoint, TuneError> {
    let turned = knob.turn(scene, value)?;
    let chain = &turned.chain;
    let sensed = sensed(scene);
    let ends = [sensed.first(), sensed.last()].map(|particle| particle.copied().unwrap_or(1));
    let probes: Vec<ForceProbe> =
        ends.iter().filter_map(|particle| ForceProbe::inside(chain, *particle, 0.0)).collect();
    let velocities = &turned.initial_velocities;
    let method = method_choice::method_for(chain, velocities, MAP_ACCURACY);
    let grid = Grid { start: 0.0, interval: MAP_SAMPLE_INTERVAL };
    let mut bench = Bench::new(chain, velocities, method, &probes, grid, Grid::NEVER);
    bench.run_until(turned.duration, true, &mut |_| ())?;
    let [first, last] = bench.watches() else {
        return Err(TuneError::Sensors { scene: scene.name.clone(), found: bench.watches().len() });
    };
    let half_rise =
        |pulse: &PulseRecorder| pulse.first_reach(HALF_RISE_SHARE * pulse.first_peak()?.dynamic_n);
    let times = half_rise(&first.pulse).zip(half_rise(&last.pulse));
    let distance = chain.distance(ends[0], ends[1]);
    let peaks = first.pulse.first_peak().zip(last.pulse.first_peak());
    let trace = grid.trace(knob.name(), "N", last.samples.clone());
    let gate = Gate { from: 0.0, to: turned.duration };
    let settings = SpectrumSettings { gate, window: Window::Hann, ..SpectrumSettings::default() };
    Ok(TunedPoint {
        value,
        chain: cell(&turned, Site::Particle(ends[0])),
        pulse_speed: times
            .map(|(from, to)| distance / (to - from))
            .filter(|v| v.is_finite() && *v > 0.0),
        transmission: peaks.map(|(first, last)| last.dynamic_n / first.dynamic_n),
        transmitted: Analyser::new().spectrum(&trace, &settings)?,
    })
}
