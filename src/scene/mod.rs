//! From the file as typed to a bench that can run, or to the list of everything wrong with it.
//!
//! First half of the program's door: `cli` names a scene, `experiment` runs what comes out.
//! [`document`] keeps places, [`reader`] collects problems, `library` finds files and merges what
//! they stand on, `bodies`, `effects`, `sensors`, `bench` and `oscilloscope` know the keys.

pub mod adjust;
mod bench;
mod bodies;
mod bound;
mod distance;
pub mod document;
mod effects;
mod files;
pub mod grid;
mod library;
mod losses;
mod magnet_preload;
pub mod magnets;
mod model;
mod oscilloscope;
pub mod plan;
pub mod plates;
pub mod problem;
pub mod random_inputs;
pub mod reader;
pub mod resolved;
mod sensors;
mod shot;
mod taper;
mod tree;
mod uncertainty;
pub mod vary;

pub use bench::load as input_load;
pub use distance::{PlatePlace, Site, distance};
pub use files::{Texts, hexadecimal};
pub use library::require;
pub use problem::{Problem, SceneError};
pub use sensors::PlacedSensor;
pub use sensors::gain_u;
pub use uncertainty::{InputDistribution, SpreadAmount, UncertainInput};

use crate::chain::{Chain, ChainSpec, End};
use crate::note::Note;
use crate::quantity::{Dimension, engineering};
use crate::scope::{Model, Setup};
use crate::sensor::SensorTolerance;
use bench::CachedPanel;
use bodies::Materials;
use problem::MISSING;
use reader::{Bound, Problems, TableReader};

/// Accuracy of a scene that names none: relative error of first-peak forces and times (1).
pub const DEFAULT_ACCURACY: f64 = 1e-6;
/// Tightest accuracy that double precision supports over a whole run (1).
pub const TIGHTEST_ACCURACY: f64 = 1e-11;
/// Loosest accuracy that still deserves the name (1).
pub const LOOSEST_ACCURACY: f64 = 0.1;
/// Acceleration by which the weight of a chain without gravity is judged (m/s^2).
const FREE_FALL: f64 = 9.81;
/// A chain whose weight is more than this share of what presses its last contact is noted if
/// gravity is off (1).
const NOTED_WEIGHT_SHARE: f64 = 0.1;
/// Largest seed that a scene may name: whole numbers up to here are exact however a file is read.
const MAX_SEED: u64 = (1 << 53) - 1;
/// How many frames of a run may be kept, and how many are.
pub const FRAMES: std::ops::RangeInclusive<u32> = 2..=50_000;
const DEFAULT_FRAMES: u32 = 200;

/// A checked scene: everything a run needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Embedded name or file stem.
    pub name: String,
    /// One line about it.
    pub title: String,
    /// The file as typed.
    pub text: String,
    /// All texts that went into it.
    pub texts: Texts,
    /// The description of the chain.
    pub spec: ChainSpec,
    /// The chain in static equilibrium.
    pub chain: Chain,
    /// Initial velocity of each body, the striker first (m/s).
    pub initial_velocities: Vec<f64>,
    /// Standard deviation of the striker's speed from shot to shot, relative to its mean; none
    /// where every shot is alike (1).
    pub striker_speed_spread: Option<f64>,
    /// Sensors from top to bottom.
    pub sensors: Vec<PlacedSensor>,
    /// The scope's front panel.
    pub scope: Setup,
    /// How long the bench is watched after the striker's first contact (s).
    pub duration: f64,
    /// How often in that time the forces of all contacts and the displacements of all bodies are
    /// kept (1).
    pub frames: u32,
    /// Relative error tolerated in first-peak forces and times (1).
    pub accuracy: f64,
    /// Seed of everything random.
    pub seed: u64,
    /// Effects that are switched off where nothing would be seen of them (`state = "auto"`), as
    /// long as that is not decided.
    pub auto: Vec<&'static str>,
    /// Notes: masses that do not go with density and shape, decisions on effects.
    pub notes: Vec<Note>,
    /// How far the sensors' plates may be from their data; drawn from the seed.
    pub sensor_tolerance: Option<SensorTolerance>,
    /// What is not known exactly.
    pub uncertainty: Vec<UncertainInput>,
}

impl Scene {
    /// Loads a scene that ships with the program, by name, or a file, by path.
    ///
    /// # Errors
    /// [`SceneError`]: no such scene, not readable, or every problem found in it.
    pub fn load(name: &str) -> Result<Self, SceneError> {
        Self::checked(with_merged(library::load(name)?), None)
    }

    /// The text of scene `name`, an included one or a path, with its base and every default.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn resolved(name: &str) -> Result<String, SceneError> {
        Self::load(name)?;
        resolved::resolved(name)
    }

    /// Reads a scene that came as text, such as the one that travels with a recording, as `file`.
    ///
    /// # Errors
    /// As [`Scene::load`]; also where it stands on a file of another machine.
    pub fn from_text(name: &str, file: &str, text: &str) -> Result<Self, SceneError> {
        Self::checked(with_merged(library::load_text(name, file, text)?), None)
    }

    /// Checks what was loaded; the front panel is `panel` where nothing has changed that it depends
    /// on.
    fn checked(
        mut loaded: library::LoadedScene,
        panel: Option<&CachedPanel>,
    ) -> Result<Self, SceneError> {
        let problems = Problems::default();
        problems.extend(std::mem::take(&mut loaded.problems));
        let above = loaded.root.text("base").map(|_| loaded.root.place.file().to_owned());
        let scene = read(loaded, &problems, panel);
        let mut problems = problems.into_sorted();
        if let Some(file) = above {
            for problem in &mut problems {
                problem.stands_below(&file);
            }
        }
        match scene {
            Some(scene) if problems.is_empty() => Ok(scene),
            _ => Err(SceneError::Problems(problems)),
        }
    }

    /// Names of the scenes that ship with the program.
    pub fn names() -> Vec<&'static str> {
        crate::data::instrument_names("scenes")
    }
}

/// The oscilloscope of the data file `name`, an embedded one or a path.
///
/// # Errors
/// [`SceneError`]: no such file, or every problem found in it.
pub fn oscilloscope(name: &str) -> Result<Model, SceneError> {
    library::require("", name)?;
    let text = format!("[scope]\nmodel = {name:?}\n");
    let mut loaded = library::load_text(name, name, &text)?;
    let problems = Problems::default();
    problems.extend(std::mem::take(&mut loaded.problems));
    let scope = TableReader::of(&loaded.root, "", &problems).and_then(|root| root.table("scope"));
    let model = scope.as_ref().and_then(oscilloscope::model);
    let problems = problems.into_sorted();
    match model {
        Some(model) if problems.is_empty() => Ok(model),
        _ => Err(SceneError::Problems(problems)),
    }
}

/// Adds the merged scene, which travels with recordings.
fn with_merged(mut loaded: library::LoadedScene) -> library::LoadedScene {
    let merged = resolved::merged(&loaded);
    loaded.texts.set_merged(merged.as_deref());
    loaded
}

fn read(
    loaded: library::LoadedScene,
    problems: &Problems,
    panel: Option<&CachedPanel>,
) -> Option<Scene> {
    let library::LoadedScene { name, text, texts, root, .. } = loaded;
    let root = TableReader::of(&root, "", problems)?;
    let _ = root.text("base");
    let title = root.text("title").unwrap_or(&name).to_owned();
    let duration = root.required("duration", Dimension::TIME, Bound::Positive);
    let frames = root.count("frames", u64::from(*FRAMES.start()), u64::from(*FRAMES.end()));
    let accuracy = accuracy(&root);
    let seed = root.count("seed", 0, MAX_SEED).unwrap_or(0);
    let moving = moving(&root, problems);
    let uncertainty = uncertainty::uncertainty(&root, problems);
    let hosts = sensors::SensorHosts { kinds: &moving.kinds, wall: moving.wall };
    let mut sensors = sensors::sensors(&root, &hosts, problems);
    for sensor in sensors.iter_mut().filter(|sensor| sensor.site != Site::Wall) {
        sensor.offset_u = uncertainty::of_offset(&uncertainty, &sensor.name, sensor.offset);
    }
    if let Some(tolerance) = &moving.sensor_tolerance {
        for placed in &sensors {
            if let Some(missing) = tolerance.missing(&placed.sensor) {
                let found = format!("a tolerance for {}, which is measured", placed.name);
                root.problem("effects", found, format!("its {missing}, or no sensor_tolerance"));
            }
        }
    }
    let errors_of = moving.scope_errors.then_some(seed);
    let scope = bench::drawn(&root, (moving.noise, errors_of), duration, panel);
    let averages = scope.as_ref().is_some_and(|scope| scope.acquisition.depth() > 1);
    if let (true, Some(table)) = (averages && moving.spread.is_some(), root.table("scope")) {
        let found = "\"average\" of impacts whose speeds differ";
        table.problem("acquisition", found, "\"sample\", or no effects.striker_speed_spread");
    }
    root.finish();
    let (spec, chain) = moving.built?;
    Some(Scene {
        name,
        title,
        text,
        texts,
        spec,
        chain,
        initial_velocities: moving.initial_velocities,
        striker_speed_spread: moving.spread,
        sensors,
        scope: scope?,
        duration: duration?,
        frames: frames.map_or(DEFAULT_FRAMES, |frames| frames as u32),
        accuracy,
        seed,
        auto: moving.auto,
        notes: moving.notes,
        sensor_tolerance: moving.sensor_tolerance,
        uncertainty,
    })
}

/// The accuracy, or else [`DEFAULT_ACCURACY`] (1).
fn accuracy(root: &TableReader<'_>) -> f64 {
    let bound = Bound::Within(TIGHTEST_ACCURACY, LOOSEST_ACCURACY);
    root.quantity("accuracy", Dimension::NONE, bound).unwrap_or(DEFAULT_ACCURACY)
}

/// The bodies, as far as they could be read.
struct Moving<'a> {
    kinds: Vec<&'a str>,
    wall: bool,
    noise: f64,
    scope_errors: bool,
    sensor_tolerance: Option<SensorTolerance>,
    spread: Option<f64>,
    auto: Vec<&'static str>,
    initial_velocities: Vec<f64>,
    built: Option<(ChainSpec, Chain)>,
    notes: Vec<Note>,
}

fn moving<'a>(root: &TableReader<'a>, problems: &Problems) -> Moving<'a> {
    let materials = Materials::read(root, problems);
    let striker = bodies::striker(root, &materials);
    if !root.has("chain") {
        root.problem("chain", MISSING, "[chain] with top, bottom and segments");
    }
    let table = root.table("chain");
    let mut particles = bodies::particles(root, table.as_ref(), &materials);
    let count = particles.kinds.len();
    for (particle, mass) in sensors::host_masses(root, count) {
        if let Some(body) = particles.bodies.get_mut(particle - 1) {
            body.mass = mass;
        }
    }
    let end = |key| table.as_ref().and_then(|table| bodies::end(table, key, &materials));
    let (top, bottom) = (end("top"), end("bottom"));
    if let Some(table) = &table {
        bodies::no_preload_at_the_bottom(table);
    }
    let effects = root.table("effects");
    // An end that could not be read may be a wall.
    let walls = [&top, &bottom].map(|e| e.is_none_or(|(end, _)| matches!(end, End::Wall(_))));
    let pairs = bodies::pairs(&particles.kinds, striker.is_some(), walls);
    let mut effects_spec = effects::effects(effects.as_ref(), count, &pairs);
    let switches = effects.as_ref().map(effects::switches).unwrap_or_default();
    effects::switch(&mut effects_spec, &switches);
    let on = |name| !effects::is_off(&switches, name);
    let noise = effects.as_ref().and_then(effects::scope_noise);
    let noise = noise.filter(|_| on("scope_noise")).unwrap_or(0.0);
    let scope_errors = effects.as_ref().is_some_and(effects::scope_errors) && on("scope_errors");
    let tolerance = effects.as_ref().and_then(effects::sensor_tolerance);
    let sensor_tolerance = tolerance.filter(|_| on("sensor_tolerance"));
    let spread = effects.as_ref().and_then(|e| effects::striker_speed_spread(e, root));
    let spread = spread.filter(|_| on("striker_speed_spread"));
    let initial_velocities = bodies::initial_velocities(root, striker.as_ref(), count);
    // A kind that could not be read has already left its problem; half a chain would only add
    // echoes of it.
    let whole =
        particles.bodies.len() == count && count > 0 && (striker.is_some() || !root.has("striker"));
    let built = match (&table, top, bottom) {
        (Some(table), Some((top, preload)), Some((bottom, _))) if whole => {
            let spec = ChainSpec {
                striker: striker.map(|s| s.body),
                particles: particles.bodies,
                top,
                bottom,
                wall_preload: preload,
                effects: effects_spec,
            };
            bodies::assemble(&spec, table, effects.as_ref()).map(|chain| (spec, chain))
        }
        _ => None,
    };
    let mut notes = materials.into_notes();
    if effects.as_ref().is_none_or(|effects| !effects.has("gravity")) {
        notes.extend(built.as_ref().and_then(|(_, chain)| weightless(chain)));
    }
    for table in table.into_iter().chain(effects) {
        table.finish();
    }
    // An end that could not be read is a problem already; a sensor at it adds no other.
    let wall = bottom.is_none_or(|(bottom, _)| matches!(bottom, End::Wall(_)));
    Moving {
        kinds: particles.kinds,
        wall,
        noise,
        scope_errors,
        sensor_tolerance,
        spread,
        auto: effects::left_to_accuracy(&switches),
        initial_velocities,
        built,
        notes,
    }
}

/// The note on a chain that stands on a wall without gravity, though its weight would add to what
/// presses it.
fn weightless(chain: &Chain) -> Option<Note> {
    let contact = chain.contacts().get(chain.wall_contact()?)?;
    let particles = chain.bodies().iter().skip(usize::from(chain.has_striker()));
    let weight = FREE_FALL * particles.map(|body| body.mass).sum::<f64>();
    (weight > NOTED_WEIGHT_SHARE * contact.static_force).then(|| {
        let sentence = format!(
            "gravity is off: upright, the chain weighs {}, and {} presses its last contact now; [effects.gravity] acceleration = \"9.81 m/s^2\" switches it on, state = \"off\" there says that it lies",
            engineering(weight, "N", 3),
            engineering(contact.static_force, "N", 3)
        );
        let note = Note::new("gravity_off", sentence).with("weight_n", weight);
        note.with("static_force_n", contact.static_force)
    })
}
