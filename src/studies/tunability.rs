//! What a chain lets pass, and how fast, over any of a scene's numbers.
//!
//! A number is named by its path, as in a sweep, and takes values in equal ratios; everything else
//! stays as the scene has it. Band edges and the speed of long waves are those of the linear chain
//! around the first sensor (Herbold et al. (2009), Eqs (9) and (10)); the speed of the pulse and
//! the spectrum at the last sensor are computed with all of the scene's physics. Edges hold for
//! dynamic forces far below the static one; where the pulse is stronger, the map shows how far it
//! breaks through them.

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::gate::Gate;
use crate::analysis::spectrum::{Analyser, Spectrum, SpectrumError, SpectrumSettings, Window};
use crate::chain::ForceProbe;
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::method_choice;
use crate::experiment::parallel::{in_parallel, processors};
use crate::experiment::pulse::{HALF_RISE_SHARE, PulseRecorder};
use crate::measurement::metadata::cell;
use crate::motion::IntegrateError;
use crate::quantity::Quantity;
use crate::scene::adjust::{AdjustError, Adjustable, AdjustableNumber};
use crate::scene::{Scene, SceneError, Site};

/// Accuracy of the simulations: far below what a shade or a curve shows (1).
const MAP_ACCURACY: f64 = 1e-5;
/// Sample interval of the forces (s).
const MAP_SAMPLE_INTERVAL: f64 = 2e-6;
/// Numbers that are varied if none is named, as far as the scene has them: preload, masses of all
/// kinds, striker; the moduli of the particles' materials are added.
const DEFAULT_PATHS: [&str; 5] = [
    "effects.magnet_preload.force",
    "chain.*.force",
    "particles.*.mass",
    "striker.mass",
    "striker.speed",
];

/// Why there is no map.
#[derive(Debug, thiserror::Error)]
pub enum TuneError {
    /// Too few sensors for an arrival and a speed.
    #[error("found {found} sensors in particles of {scene}, expected at least two")]
    Sensors {
        /// The scene.
        scene: String,
        /// How many.
        found: usize,
    },
    /// A path that names no number.
    #[error(transparent)]
    Path(#[from] AdjustError),
    /// A number that has no ratio to others.
    #[error("found {value} at `{path}`, expected a number above zero, which can be multiplied")]
    NotPositive {
        /// The path.
        path: String,
        /// The number (unit).
        value: f64,
    },
    /// A value that the scene cannot have.
    #[error("{path} = {value} {unit}: {error}")]
    Scene {
        /// The path.
        path: String,
        /// The value, in `unit` (unit).
        value: f64,
        /// The unit.
        unit: String,
        /// The problem.
        error: SceneError,
    },
    /// A run that could not go on.
    #[error(transparent)]
    Integrate(#[from] IntegrateError),
    /// A force without a spectrum.
    #[error(transparent)]
    Spectrum(#[from] SpectrumError),
}

/// Numbers of a scene that are varied together, by one ratio.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedNumber {
    /// The path as typed; `*` stands for every name.
    pub path: String,
    /// Unit without a prefix, `Pa`.
    pub unit: String,
    /// SI units in that unit (unit).
    pub scale: f64,
    numbers: Vec<AdjustableNumber>,
}

impl TunedNumber {
    /// The number that `path` names in `scene`.
    ///
    /// # Errors
    /// [`TuneError`] if nothing is there, or no number above zero.
    pub fn at(scene: &mut Adjustable, path: &str) -> Result<Self, TuneError> {
        let numbers = scene.knobs(path)?;
        if let Some(found) = numbers.iter().find(|number| number.value <= 0.0) {
            return Err(TuneError::NotPositive { path: found.path.clone(), value: found.value });
        }
        let typed = numbers.first().map_or("", |number| number.unit.as_str());
        let (unit, scale) = without_prefix(typed);
        Ok(Self { path: path.to_owned(), unit, scale, numbers })
    }

    /// The numbers that [`tune`] varies if none is named, as far as `scene` has them.
    ///
    /// # Errors
    /// [`SceneError`] for a scene that cannot be.
    pub fn defaults(scene: &mut Adjustable) -> Result<Vec<Self>, SceneError> {
        let mut paths: Vec<String> = DEFAULT_PATHS.map(str::to_owned).to_vec();
        let mut materials = scene.materials();
        materials.sort();
        paths.extend(materials.iter().map(|name| format!("materials.{name}.youngs_modulus")));
        // Kinds of particles are varied one by one.
        let each = |path: String| match scene.knobs(&path) {
            Ok(numbers) if path.starts_with("particles.") => {
                numbers.into_iter().map(|number| number.path).collect()
            }
            _ => vec![path],
        };
        let paths: Vec<String> = paths.into_iter().flat_map(each).collect();
        Ok(paths.iter().filter_map(|path| Self::at(scene, path).ok()).collect())
    }

    /// `scene` with the numbers multiplied by `ratio` (1).
    fn times(&self, scene: &Adjustable, ratio: f64) -> Result<Scene, TuneError> {
        let values: Vec<_> = self.numbers.iter().map(|n| (n, ratio * n.value)).collect();
        scene.with(&values).map_err(|error| TuneError::Scene {
            path: self.path.clone(),
            value: ratio * self.now() / self.scale,
            unit: self.unit.clone(),
            error,
        })
    }

    /// Where the scene has the first of the numbers (unit).
    pub fn now(&self) -> f64 {
        self.numbers.first().map_or(f64::NAN, |number| number.value)
    }
}

/// `unit` without its prefix, `Pa` for `GPa`, and how many SI units it is (unit).
fn without_prefix(unit: &str) -> (String, f64) {
    let of = |unit: &str| {
        let one = format!("1 {unit}").parse::<Quantity>().ok();
        one.map(|one| (one.value, one.dimension))
    };
    let whole = of(unit);
    let rest: String = unit.chars().skip(1).collect();
    match (whole, of(&rest)) {
        (Some((_, dimension)), Some((scale, same))) if dimension == same && !rest.is_empty() => {
            (rest, scale)
        }
        (whole, _) => (unit.to_owned(), whole.map_or(1.0, |(scale, _)| scale)),
    }
}

/// A scene with one number at one value.
#[derive(Debug, Clone, PartialEq)]
pub struct TunedPoint {
    /// The number's value, in SI units (unit).
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

/// One number over its range.
#[derive(Debug, Clone, PartialEq)]
pub struct Tuning {
    /// The number.
    pub number: TunedNumber,
    /// From lowest to highest.
    pub points: Vec<TunedPoint>,
}

/// Varies each of `numbers` from its value divided by `span` to `span` times it, in `points` equal
/// ratios; `progress` is called with the share of the work done, 0 to 1.
///
/// # Errors
/// [`TuneError`] for a scene without two sensors in particles, or values that it cannot have.
pub fn tune(
    scene: &Adjustable,
    numbers: Vec<TunedNumber>,
    points: u32,
    span: f64,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Vec<Tuning>, TuneError> {
    let steps = f64::from(points.saturating_sub(1).max(1));
    let ratios: Vec<f64> =
        (0..points).map(|index| span.powf(2.0 * f64::from(index) / steps - 1.0)).collect();
    let mut jobs = Vec::new();
    for number in &numbers {
        for ratio in &ratios {
            jobs.push((number.path.as_str(), ratio * number.now(), number.times(scene, *ratio)?));
        }
    }
    let work = |(path, value, scene): &(&str, f64, Scene)| point(path, *value, scene);
    let done = |finished: usize| progress(finished as f64 / jobs.len() as f64);
    let results: Result<Vec<_>, _> =
        in_parallel(processors(), &jobs, &work, &done).into_iter().collect();
    let mut results = results?.into_iter();
    let tuning = |number: TunedNumber| {
        let points = results.by_ref().take(points as usize).collect();
        Tuning { number, points }
    };
    Ok(numbers.into_iter().map(tuning).collect())
}

fn point(path: &str, value: f64, scene: &Scene) -> Result<TunedPoint, TuneError> {
    let sensed = sensors_in_particles(scene);
    let ([first_particle, .., last_particle], chain) = (sensed.as_slice(), &scene.chain) else {
        return Err(TuneError::Sensors { scene: scene.name.clone(), found: sensed.len() });
    };
    let ends = [*first_particle, *last_particle];
    let probes: Vec<ForceProbe> =
        ends.iter().filter_map(|particle| ForceProbe::inside(chain, *particle, 0.0)).collect();
    let velocities = &scene.initial_velocities;
    let method = method_choice::method_for(chain, velocities, MAP_ACCURACY);
    let grid = Grid { start: 0.0, interval: MAP_SAMPLE_INTERVAL };
    let mut bench = Bench::new(chain, velocities, method, &probes, grid, Grid::NEVER);
    bench.run_until(scene.duration, true, &mut |_| ())?;
    let [first, last] = bench.watches() else {
        return Err(TuneError::Sensors { scene: scene.name.clone(), found: bench.watches().len() });
    };
    let half_rise =
        |pulse: &PulseRecorder| pulse.first_reach(HALF_RISE_SHARE * pulse.first_peak()?.dynamic_n);
    let times = half_rise(&first.pulse).zip(half_rise(&last.pulse));
    let distance = chain.distance(ends[0], ends[1]);
    let peaks = first.pulse.first_peak().zip(last.pulse.first_peak());
    let trace = grid.trace(path, "N", last.samples.clone());
    let gate = Gate { from: 0.0, to: scene.duration };
    let settings = SpectrumSettings { gate, window: Window::Hann, ..SpectrumSettings::default() };
    Ok(TunedPoint {
        value,
        chain: cell(scene, Site::Particle(ends[0])),
        pulse_speed: times
            .map(|(from, to)| distance / (to - from))
            .filter(|v| v.is_finite() && *v > 0.0),
        transmission: peaks.map(|(first, last)| last.dynamic_n / first.dynamic_n),
        transmitted: Analyser::new().spectrum(&trace, &settings)?,
    })
}

/// The particles with sensors, from top to bottom.
fn sensors_in_particles(scene: &Scene) -> Vec<usize> {
    let particle = |site: Site| match site {
        Site::Particle(particle) => Some(particle),
        Site::Wall => None,
    };
    scene.sensors.iter().filter_map(|sensor| particle(sensor.site)).collect()
}
