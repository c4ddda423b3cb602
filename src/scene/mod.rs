//! From the file as typed to a bench that can run, or to the list of everything wrong with it.
//!
//! First half of the program's door: `cli` names a scene, `experiment` runs what comes out. [`document`] keeps places,
//! [`reader`] collects problems, `library` finds files and merges what they stand on, `bodies` and `bench` know the keys.

mod bench;
mod bodies;
pub mod document;
mod library;
pub mod magnets;
pub mod problem;
pub mod reader;

pub use bench::{PlacedSensor, Site, load as input_load};
pub use problem::{Problem, SceneError};

use crate::chain::{Chain, ChainSpec, End};
use crate::quantity::{Dimension, engineering};
use crate::scope::Setup;
use bodies::Materials;
use reader::{Bound, Problems, Table};

/// Accuracy of a scene that names none: relative error of first-peak forces and times (1).
pub const DEFAULT_ACCURACY: f64 = 1e-6;
/// Tightest accuracy that double precision supports over a whole run (1).
pub const TIGHTEST_ACCURACY: f64 = 1e-11;
/// Loosest accuracy that still deserves the name (1).
pub const LOOSEST_ACCURACY: f64 = 0.1;
/// A time base that puts fewer samples than this on the scene's duration shows nothing of it (1).
const FEWEST_SAMPLES: f64 = 20.0;

/// A checked scene: everything a run needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Embedded name or file stem.
    pub name: String,
    /// One line about it.
    pub title: String,
    /// The file as typed.
    pub text: String,
    /// SHA-256 over all files that went into it, in hexadecimal.
    pub hash: String,
    /// The description of the chain.
    pub spec: ChainSpec,
    /// The chain in static equilibrium.
    pub chain: Chain,
    /// Initial velocity of each body, the striker first (m/s).
    pub initial_velocities: Vec<f64>,
    /// Sensors from top to bottom.
    pub sensors: Vec<PlacedSensor>,
    /// The scope's front panel.
    pub scope: Setup,
    /// How long the bench is watched after the striker's first contact (s).
    pub duration: f64,
    /// Relative error tolerated in first-peak forces and times (1).
    pub accuracy: f64,
    /// Seed of everything random.
    pub seed: u64,
}

impl Scene {
    /// Loads a scene that ships with the program, by name, or a file, by path.
    ///
    /// # Errors
    /// [`SceneError`]: no such scene, not readable, or every problem found in it.
    pub fn load(name: &str) -> Result<Self, SceneError> {
        Self::checked(library::load(name)?)
    }

    /// Reads a scene that came as text, such as the one that travels with a recording, as `file`.
    ///
    /// # Errors
    /// As [`Scene::load`]; also where it stands on a file of another machine.
    pub fn from_text(name: &str, file: &str, text: &str) -> Result<Self, SceneError> {
        Self::checked(library::load_text(name, file, text)?)
    }

    fn checked(loaded: library::Loaded) -> Result<Self, SceneError> {
        let problems = Problems::default();
        let scene = read(loaded, &problems);
        let problems = problems.into_sorted();
        match scene {
            Some(scene) if problems.is_empty() => Ok(scene),
            _ => Err(SceneError::Problems(problems)),
        }
    }

    /// Names of the scenes that ship with the program.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        crate::data::instrument_names("scenes")
    }
}

fn read(loaded: library::Loaded, problems: &Problems) -> Option<Scene> {
    let library::Loaded { name, text, hash, root } = loaded;
    let root = Table::of(&root, "", problems)?;
    let _ = root.text("base");
    let title = root.text("title").unwrap_or(&name).to_owned();
    let duration = root.required("duration", Dimension::TIME, Bound::Positive);
    let accuracy = Bound::Within(TIGHTEST_ACCURACY, LOOSEST_ACCURACY);
    let accuracy = root.quantity("accuracy", Dimension::NONE, accuracy).unwrap_or(DEFAULT_ACCURACY);
    let seed = root.count("seed", 0, 1 << 53).unwrap_or(0);
    let moving = moving(&root, problems);
    let kinds: Vec<&str> = moving.kinds.iter().map(String::as_str).collect();
    let hosts = bench::Hosts { kinds: &kinds, wall: moving.wall };
    let sensors = bench::sensors(&root, &hosts, problems);
    let scope = scope(&root, &sensors, moving.noise, duration);
    root.finish();
    let (spec, chain) = moving.built?;
    Some(Scene {
        name,
        title,
        text,
        hash,
        spec,
        chain,
        initial_velocities: moving.initial_velocities,
        sensors,
        scope: scope?,
        duration: duration?,
        accuracy,
        seed,
    })
}

/// What moves, as far as it could be read.
struct Moving {
    kinds: Vec<String>,
    wall: bool,
    noise: f64,
    initial_velocities: Vec<f64>,
    built: Option<(ChainSpec, Chain)>,
}

fn moving(root: &Table<'_>, problems: &Problems) -> Moving {
    let materials = Materials::read(root, problems);
    let striker = bodies::striker(root, &materials);
    let Some(table) = root.table("chain") else {
        root.problem("chain", "no such table", "[chain] with top, bottom and segments");
        let velocities = bodies::initial_velocities(root, striker.as_ref(), 0);
        return Moving {
            kinds: Vec::new(),
            wall: false,
            noise: 0.0,
            initial_velocities: velocities,
            built: None,
        };
    };
    let particles = bodies::particles(root, &table, &materials);
    let count = particles.kinds.len();
    let top = bodies::end(&table, "top", &materials);
    let bottom = bodies::end(&table, "bottom", &materials);
    let effects = root.table("effects");
    let effects_spec = bodies::effects(effects.as_ref(), count);
    let noise = effects.as_ref().and_then(scope_noise).unwrap_or(0.0);
    if let Some(effects) = effects {
        effects.finish();
    }
    let initial_velocities = bodies::initial_velocities(root, striker.as_ref(), count);
    if initial_velocities.iter().all(|v| *v == 0.0) && !root.has("striker") {
        root.problem("striker", "nothing that moves", "[striker] or [[initial_velocities]]");
    }
    // A kind that could not be read has already left its problem; half a chain would only add echoes of it.
    let whole =
        particles.bodies.len() == count && count > 0 && (striker.is_some() || !root.has("striker"));
    let built = match (top, bottom) {
        (Some((top, preload)), Some((bottom, _))) if whole => {
            let spec = ChainSpec {
                striker: striker.map(|s| s.body),
                particles: particles.bodies,
                top,
                bottom,
                wall_preload: preload,
                effects: effects_spec,
            };
            bodies::assemble(&spec, &table).map(|chain| (spec, chain))
        }
        _ => None,
    };
    table.finish();
    let wall = matches!(bottom, Some((End::Wall(_), _)));
    Moving { kinds: particles.kinds, wall, noise, initial_velocities, built }
}

/// `[effects.scope_noise]` (div).
fn scope_noise(effects: &Table<'_>) -> Option<f64> {
    let table = bodies::effect(effects, "scope_noise")?;
    let rms = table.required("rms", Dimension::DIVISION, Bound::NotNegative);
    table.finish();
    rms
}

fn scope(
    root: &Table<'_>,
    sensors: &[PlacedSensor],
    noise: f64,
    duration: Option<f64>,
) -> Option<Setup> {
    let Some(table) = root.table("scope") else {
        root.problem(
            "scope",
            "no such table",
            "[scope] with model, time_base, trigger and channels",
        );
        return None;
    };
    let _ = table.text("source");
    let setup = bench::scope(&table, sensors).map(|setup| Setup { noise, ..setup });
    if let (Some(setup), Some(duration)) = (&setup, duration) {
        check_time_base(&table, setup, duration);
    }
    table.finish();
    setup
}

/// A time base that shows nothing of the scene is a mistake, not a setting.
fn check_time_base(table: &Table<'_>, setup: &Setup, duration: f64) {
    let samples = duration / setup.model.interval(setup.time_base);
    if samples < FEWEST_SAMPLES {
        let found = format!(
            "{}, which puts {samples:.1} samples on {}",
            engineering(setup.time_base, "s/div", 3),
            engineering(duration, "s", 3)
        );
        table.problem(
            "time_base",
            found,
            format!("at least {FEWEST_SAMPLES} samples: a faster time base"),
        );
    }
    let (start, end) = setup.record_span();
    if end <= 0.0 {
        let found = format!("a record that ends {} before the trigger", engineering(-end, "s", 3));
        table.problem("position", found, "a record that shows something after the trigger");
    }
    if start >= duration {
        let found =
            format!("a record that starts {} after the trigger", engineering(start, "s", 3));
        table.problem(
            "position",
            found,
            format!("a start within the scene's {}", engineering(duration, "s", 3)),
        );
    }
}
