//! A sweep that is ready to run: the scenes of its runs, and the columns of its results.

use std::path::Path;

use sha2::{Digest, Sha256};

use super::SweepError;
use super::row::ResultRow;
pub use super::row::{Column, ColumnKind};
use crate::experiment::ensemble::{Case, ProbeSite, Readout, places};
use crate::experiment::outcome::{Reading, Speed, speeds};
use crate::scene::adjust::Adjustable;
use crate::scene::adjust::SceneOverride;
use crate::scene::grid::{Design, PlannedRun, number, typed};
use crate::scene::{Problem, Scene, SceneError, hexadecimal};

/// Runs that are tried before a sweep begins: where none makes a scene, the sweep is mistaken.
const TRIAL_RUNS: u64 = 16;
/// Readings of each probe, with their units.
const READINGS: [(&str, &str); 6] = [
    ("static", "N"),
    ("peak", "N"),
    ("peak_time", "s"),
    ("half_rise", "s"),
    ("ten_percent", "s"),
    ("largest", "N"),
];
/// Arrivals that speeds are taken from.
const ESTIMATORS: [&str; 3] = ["half_rise", "peak", "ten_percent"];

/// A sweep that is ready to run.
#[derive(Debug)]
pub struct SweepPlan {
    design: Design,
    base: Adjustable,
    /// For each of the design's paths, those of the scene.
    paths: Vec<Vec<String>>,
    /// Which of them hold numbers.
    numeric: Vec<bool>,
    watched: Vec<ProbeSite>,
    columns: Vec<Column>,
    accuracy: Option<f64>,
    hash: String,
}

/// A run that can go: its chain, and what belongs to it.
#[derive(Debug)]
pub(super) struct PreparedRun {
    pub(super) case: Case,
    /// Accuracy (1).
    pub(super) accuracy: f64,
    places: Vec<ProbeSite>,
}

impl SweepPlan {
    /// The sweep in `file`, at another accuracy than its own if that is given (1).
    ///
    /// # Errors
    /// [`SweepError`] with everything that is wrong with it.
    pub fn load(file: &Path, accuracy: Option<f64>) -> Result<Self, SweepError> {
        let design = Design::load(file)?;
        let mut base = Adjustable::load(&design.scene)?;
        let paths = design.paths().map(|path| base.paths(path)).collect::<Result<Vec<_>, _>>()?;
        let scene = base.scene()?;
        let watched = probe_sites(&design, &scene)?;
        let accuracy = accuracy.or(design.accuracy);
        let units = design.units();
        let columns = columns(&design, &units, &watched);
        let numeric = units.iter().map(Option::is_some).collect();
        let hash = hash(&design, &scene, accuracy);
        let plan = Self { design, base, paths, numeric, watched, columns, accuracy, hash };
        plan.try_some()?;
        Ok(plan)
    }

    /// How many runs it has.
    pub fn count(&self) -> u64 {
        self.design.count()
    }

    /// Columns of the results.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Hash that identifies the sweep, in hexadecimal.
    pub fn hash(&self) -> &str {
        &self.hash
    }

    /// The scene that is varied.
    pub fn scene_name(&self) -> &str {
        self.base.name()
    }

    /// Accuracy of all runs; none where each scene says (1).
    pub fn accuracy(&self) -> Option<f64> {
        self.accuracy
    }

    /// The scene of run `index`.
    ///
    /// # Errors
    /// [`SceneError`] where its values make none.
    pub fn scene(&self, index: u64) -> Result<Scene, SceneError> {
        self.scene_of(&self.design.run(index))
    }

    fn scene_of(&self, run: &PlannedRun) -> Result<Scene, SceneError> {
        let settings = self.paths.iter().zip(&run.values);
        let settings: Vec<SceneOverride<'_>> =
            settings.map(|(paths, node)| SceneOverride { paths, node: node.clone() }).collect();
        self.base.varied(&settings, run.seed)
    }

    fn try_some(&self) -> Result<(), SweepError> {
        let count = self.count();
        let tried = count.min(TRIAL_RUNS);
        let mut first = None;
        for number in 0..tried {
            match self.scene(number * (count - 1) / (tried - 1).max(1)) {
                Ok(_) => return Ok(()),
                Err(error) => first = first.or(Some(error)),
            }
        }
        first.map_or(Ok(()), |first| Err(SweepError::AllRefused { tried, first }))
    }

    /// Prepares run `index`, or says why it cannot run.
    pub(super) fn prepare(&self, run: &PlannedRun) -> Result<PreparedRun, String> {
        let scene = self.scene_of(run).map_err(|error| reason(&error))?;
        let accuracy = self.accuracy.unwrap_or(scene.accuracy);
        let wanted = |place: &ProbeSite| self.watched.iter().any(|other| other.name == place.name);
        let places: Vec<ProbeSite> = places(&scene).into_iter().filter(wanted).collect();
        Ok(PreparedRun { case: Case::of(&scene, accuracy, &places), accuracy, places })
    }

    /// Run number `index` of the design.
    pub(super) fn run(&self, index: u64) -> PlannedRun {
        self.design.run(index)
    }

    /// The line of results of a run, or of the reason why there are none.
    pub(super) fn line(
        &self,
        (index, run): (u64, &PlannedRun),
        found: Result<(&PreparedRun, &Readout), &str>,
    ) -> String {
        let mut row = ResultRow::default();
        row.count(index);
        row.count(run.seed);
        if self.design.repeat > 1 {
            row.count(run.repeat);
        }
        let values = self.design.paths().zip(&run.values);
        for ((path, value), numeric) in values.zip(&self.numeric) {
            if *numeric {
                row.number(number(path, value).map(|(value, _)| value));
            } else {
                row.text(&typed(value));
            }
        }
        row.text(found.err().unwrap_or_default());
        if let Ok((prepared, readout)) = found {
            row.count(readout.work.force_evaluations);
            let readings = prepared.readings(readout);
            let speeds = speeds(&prepared.case.chain, &readings);
            self.readings(&mut row, &readings, &speeds);
        } else {
            row.number(None);
            self.readings(&mut row, &[], &[]);
        }
        row.into_line()
    }

    fn readings(&self, row: &mut ResultRow, readings: &[Reading], speeds: &[Speed]) {
        for place in &self.watched {
            let reading = readings.iter().find(|reading| reading.name == place.name);
            let peak = reading.and_then(|reading| reading.first_peak);
            row.number(reading.map(|reading| reading.static_n));
            row.number(peak.map(|peak| peak.dynamic_n));
            row.number(peak.map(|peak| peak.time_s));
            row.number(reading.and_then(|reading| reading.half_rise_s));
            row.number(reading.and_then(|reading| reading.ten_percent_s));
            row.number(reading.map(|reading| reading.largest_n));
        }
        for (from, to) in pairs(&self.watched) {
            for estimator in ESTIMATORS {
                let of = |speed: &&Speed| {
                    (&speed.from_sensor, &speed.to_sensor) == (&from.name, &to.name)
                        && speed.estimator == estimator
                };
                row.number(speeds.iter().find(of).map(|speed| speed.m_per_s));
            }
        }
    }
}

impl PreparedRun {
    fn readings(&self, readout: &Readout) -> Vec<Reading> {
        let places = self.places.iter().zip(&readout.pulses);
        places.map(|(p, pulse)| Reading::of(&p.name, p.particle, p.offset, pulse)).collect()
    }
}

/// The places that the design wants, of those that the scene has.
fn probe_sites(design: &Design, scene: &Scene) -> Result<Vec<ProbeSite>, SweepError> {
    let all = places(scene);
    let Some(names) = &design.watch else { return Ok(all) };
    if let Some(name) = names.iter().find(|name| all.iter().all(|place| place.name != **name)) {
        let known = all.into_iter().map(|place| place.name).collect();
        return Err(SweepError::Watch { name: name.clone(), known });
    }
    Ok(all.into_iter().filter(|place| names.contains(&place.name)).collect())
}

/// Places between which a speed is given: particles, each with every one below it.
fn pairs(watched: &[ProbeSite]) -> Vec<(&ProbeSite, &ProbeSite)> {
    let particles: Vec<&ProbeSite> = watched.iter().filter(|p| p.particle.is_some()).collect();
    let below = |upper: usize| particles.iter().skip(upper + 1).map(move |lower| (upper, *lower));
    let pairs = (0..particles.len()).flat_map(below);
    pairs.map(|(upper, lower)| (particles[upper], lower)).collect()
}

fn columns(design: &Design, units: &[Option<String>], watched: &[ProbeSite]) -> Vec<Column> {
    let mut columns = vec![Column::count("run"), Column::count("seed")];
    if design.repeat > 1 {
        columns.push(Column::count("repeat"));
    }
    for (path, unit) in design.paths().zip(units) {
        columns.push(match unit {
            Some(unit) => number_column(path, unit),
            None => Column::text(path),
        });
    }
    columns.push(Column::text("error"));
    columns.push(Column::count("force_evaluations"));
    for place in watched {
        let reading = |(what, unit)| number_column(&format!("{}.{what}", place.name), unit);
        columns.extend(READINGS.map(reading));
    }
    for (from, to) in pairs(watched) {
        let speed = |what| number_column(&format!("{}-{}.{what}", from.name, to.name), "m/s");
        columns.extend(ESTIMATORS.map(speed));
    }
    columns
}

/// A column of numbers, its unit in brackets.
fn number_column(name: &str, unit: &str) -> Column {
    Column::number(format!("{name} ({unit})"))
}

/// Everything that results follow from, but for the processor.
fn hash(design: &Design, scene: &Scene, accuracy: Option<f64>) -> String {
    let mut hash = Sha256::new();
    hash.update(env!("CARGO_PKG_VERSION"));
    hash.update(scene.texts.hash());
    hash.update(format!("{accuracy:?}\n"));
    hash.update(&design.text);
    hexadecimal(&hash.finalize())
}

/// A scene's problem, on one line. Files are named without their folders, which may differ from
/// process to process.
fn reason(error: &SceneError) -> String {
    let SceneError::Problems(problems) = error else { return error.to_string() };
    let short = |problem: &Problem| {
        let name = Path::new(&problem.file).file_name().map(|name| name.to_string_lossy());
        let file = name.map_or_else(|| problem.file.clone(), std::borrow::Cow::into_owned);
        Problem { file, ..problem.clone() }.to_string()
    };
    problems.iter().map(short).collect::<Vec<_>>().join("; ")
}
