//! Reads a scene file into a checked [`Scene`], or the list of all problems in it.
//!
//! [`document`] is a tree of values with their places, `library` finds files and merges them,
//! [`table`] declares keys and reads values, `bodies`, `effects`, `sensors`, `panel` and
//! `oscilloscope` declare their tables and make the domain's types of them. Everything that shows,
//! varies or checks a path uses the same declarations.

pub mod adjust;
mod bodies;
pub mod dcc;
mod distance;
#[doc(hidden)]
pub mod document;
mod drive;
mod effects;
#[doc(hidden)]
pub mod grid;
#[doc(hidden)]
pub mod help;
mod inputs;
mod library;
#[doc(hidden)]
pub mod magnets;
mod motion_sensors;
mod oscilloscope;
mod panel;
pub mod plan;
pub mod problem;
#[doc(hidden)]
pub mod problems;
#[doc(hidden)]
pub mod random_inputs;
#[doc(hidden)]
pub mod resolved;
mod root;
pub mod sensors;
mod shot;
#[doc(hidden)]
pub mod table;
mod uncertainty;
#[doc(hidden)]
pub mod vocabulary;

pub use distance::{PlatePlace, Site, distance};
pub use drive::OUTPUTS as GENERATOR_OUTPUTS;
pub use library::{Texts, hexadecimal, require};
pub use panel::load as input_load;
pub use problem::{Problem, SceneError};
pub use root::{DEFAULT_ACCURACY, FRAMES, LOOSEST_ACCURACY, TIGHTEST_ACCURACY};
pub use sensors::{PlacedSensor, gain_u};
pub use uncertainty::{InputDistribution, SpreadAmount, UncertainInput};

use std::path::Path;

use crate::chain::{Chain, ChainSpec, End, Indentations, Support};
use crate::note::Note;
use crate::quantity::engineering;
use crate::scope::{Deviation, Model, Setup};
use crate::sensor::{MotionSensor, SensorTolerance};
use bodies::{ChainKeys, Materials};
use effects::Effects;
use oscilloscope::ModelKeys;
use panel::{CachedPanel, PanelKeys};
use problems::Problems;
use root::RootKeys;
use sensors::PlaceKeys;
use table::TableReader;

/// Acceleration by which the weight of a chain without gravity is judged (m/s^2).
const FREE_FALL: f64 = 9.81;
/// A chain whose weight is more than this share of what presses its last contact is noted if
/// gravity is off (1).
const NOTED_WEIGHT_SHARE: f64 = 0.1;

/// A checked scene: everything a run needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Scene {
    /// Embedded name or file stem.
    pub name: String,
    /// One line about it.
    pub title: String,
    /// The file as typed.
    pub text: String,
    /// Its text, those of its bases and instruments, and those of constants.
    pub texts: Texts,
    /// The description of the chain.
    pub spec: ChainSpec,
    /// The chain in static equilibrium.
    pub chain: Chain,
    /// Length of each particle over that of its kind; 0 where a taper states it instead (1).
    pub length_scales: Vec<f64>,
    /// Initial velocity of each body, the striker first (m/s).
    pub initial_velocities: Vec<f64>,
    /// Standard deviation of the striker's speed from shot to shot, relative to its mean; none
    /// where every shot is alike (1).
    pub striker_speed_spread: Option<f64>,
    /// Sensors from top to bottom.
    pub sensors: Vec<PlacedSensor>,
    /// Sensors of motion: vibrometers, accelerometers, strain gauges.
    pub motion_sensors: Vec<MotionSensor>,
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
    /// Whether the chain lies across gravity.
    pub lies: bool,
    /// Notes: masses that do not go with density and shape, decisions on effects.
    pub notes: Vec<Note>,
    /// How far the sensors' plates may be from their data; drawn from the seed.
    pub sensor_tolerance: Option<SensorTolerance>,
    /// What is not known exactly.
    pub uncertainty: Vec<UncertainInput>,
}

impl Scene {
    /// Whether `[uncertainty]` states one of the number at `path` of a sensor.
    pub fn states_uncertainty_of(&self, path: &str) -> bool {
        self.stated_uncertainty_of(path).is_some()
    }

    /// What `[uncertainty]` states of the number at `path` of a sensor or a kind of particle.
    pub fn stated_uncertainty_of(&self, path: &str) -> Option<&UncertainInput> {
        uncertainty::stated(&self.uncertainty, path)
    }

    /// Loads an included scene, by name, or a file, by path.
    ///
    /// # Errors
    /// [`SceneError`]: no such scene, not readable, or every problem found in it.
    pub fn load(name: impl AsRef<Path>) -> Result<Self, SceneError> {
        Self::checked(with_merged(library::load(name.as_ref())?), None)
    }

    /// The text of scene `name`, an included one or a path, with its base and every default.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn resolved(name: impl AsRef<Path>) -> Result<String, SceneError> {
        Self::load(name.as_ref())?;
        resolved::resolved(name.as_ref())
    }

    /// Reads a scene that came as text, such as the one in a recording, as `file`.
    ///
    /// # Errors
    /// As [`Scene::load`]; also if it is based on a file of another machine.
    pub fn from_text(name: &str, file: &str, text: &str) -> Result<Self, SceneError> {
        Self::checked(with_merged(library::load_text(name, file, text)?), None)
    }

    /// Checks a loaded scene; the front panel is `panel` if nothing that it depends on has changed.
    fn checked(
        mut loaded: library::LoadedScene,
        panel: Option<&CachedPanel>,
    ) -> Result<Self, SceneError> {
        let problems = Problems::default();
        problems.extend(std::mem::take(&mut loaded.problems));
        let above = loaded.root.text("base").map(|_| loaded.root.place.file().to_owned());
        let scene = read(loaded, &problems, panel);
        problems.finish(scene).map_err(|mut problems| {
            if let Some(file) = above {
                for problem in &mut problems {
                    problem.mention_base(&file);
                }
            }
            SceneError::Problems(problems)
        })
    }

    /// The same bench with noise of the band `from` to `to` (Hz) as the signal of its drive, as
    /// long as the scene and drawn from `seed`.
    ///
    /// # Errors
    /// What is missing, in words.
    pub fn with_noise(&self, band: (f64, f64), seed: u64) -> Result<Self, String> {
        let mut scene = Self { seed, ..self.clone() };
        let length = scene.duration;
        let drive = scene.spec.effects.supports.iter_mut().find_map(|support| match support {
            Support::Driven(drive) => Some(drive),
            Support::Rigid | Support::Yielding(_) => None,
        });
        let Some(drive) = drive else {
            let name = &self.name;
            return Err(format!("found no [drive] in {name}, expected one that plays the noise"));
        };
        drive.signal = drive::noise_signal(band, length, seed)
            .map_err(|expected| format!("found a duration of {length} s, expected {expected}"))?;
        scene.chain = Chain::new(&scene.spec).map_err(|error| error.to_string())?;
        Ok(scene)
    }

    /// Indents the contacts by what a shot has left, if `[effects.plasticity]` keeps indentations.
    pub fn keep_indentations(&mut self, left: &Indentations) {
        if self.spec.effects.plasticity.is_some_and(|effect| effect.keeps_indentations) {
            self.chain = self.chain.with_indentations(left);
        }
    }

    /// Names of the included scenes.
    pub fn names() -> Vec<&'static str> {
        crate::data::instrument_names("scenes")
    }
}

/// The oscilloscope of the data file `name`, an included one or a path.
///
/// # Errors
/// [`SceneError`]: no such file, or every problem found in it.
pub fn oscilloscope(name: &str) -> Result<Model, SceneError> {
    let node = library::open("", Path::new(name))?;
    let node = node.ok_or_else(|| library::no_instrument("", name))?;
    let problems = Problems::default();
    let table = TableReader::of(&node, "", &[PanelKeys::KEYS, ModelKeys::KEYS], &problems);
    let model = table.and_then(|table| oscilloscope::model(&table));
    problems.finish(model).map_err(SceneError::Problems)
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
    let keys = RootKeys::read(&TableReader::of(&root, "", &[RootKeys::KEYS], problems)?);
    let root = &keys.table;
    let title = keys.title.unwrap_or(&name).to_owned();
    let uncertainty = uncertainty::uncertainty(root, keys.uncertainty);
    let tables = keys.sensors.as_deref().unwrap_or_default();
    let places: Vec<_> =
        tables.iter().map(|(name, table)| (*name, PlaceKeys::read(table))).collect();
    let moving = moving(&keys, &places);
    let effects = moving.effects;
    let hosts = sensors::SensorHosts { kinds: &moving.kinds, wall: moving.wall };
    let mut sensors = sensors::sensors(root, &places, &hosts);
    let particles = moving.kinds.len();
    inputs::refuse_twins(&keys);
    let tables = motion_sensors::MotionTables {
        vibrometers: keys.vibrometers.as_ref(),
        accelerometers: keys.accelerometers.as_ref(),
        strain_gauges: keys.strain_gauges.as_ref(),
    };
    let motion_sensors = motion_sensors::motion_sensors(&tables, particles, moving.rods);
    for sensor in sensors.iter_mut().filter(|sensor| sensor.site != Site::Wall) {
        let stated = uncertainty::stated(&uncertainty, &format!("sensors.{}.offset", sensor.name));
        sensor.offset_u = stated.map_or(0.0, |input| input.distribution.standard(sensor.offset));
    }
    if let Some(tolerance) = &effects.sensor_tolerance {
        for placed in &sensors {
            if let Some(missing) = tolerance.missing(&placed.sensor) {
                let found = format!("a tolerance for {}, which is measured", placed.name);
                root.problem("effects", found, format!("its {missing}, or no sensor_tolerance"));
            }
        }
    }
    let scope = keys.scope.as_ref().and_then(|table| {
        let setup = panel::setup(table, &inputs::inputs(&keys), keys.duration, panel)?;
        if setup.acquisition.depth() > 1 && effects.spread.is_some() {
            let found = "\"average\" of impacts whose speeds differ";
            let expected = "\"sample\", or no effects.striker_speed_spread";
            table.problem("acquisition", found, expected);
        }
        Some(setup)
    });
    let mut scope = Setup { noise: effects.noise, ..scope? };
    for (number, channel) in (1..).zip(&mut scope.channels) {
        if let (true, Some(channel)) = (effects.scope_errors, channel) {
            channel.deviation = Deviation::drawn(keys.seed?, number);
        }
    }
    let (spec, chain) = moving.built?;
    Some(Scene {
        name,
        title,
        text,
        texts,
        spec,
        chain,
        length_scales: moving.length_scales,
        initial_velocities: moving.initial_velocities,
        striker_speed_spread: effects.spread,
        sensors,
        motion_sensors,
        scope,
        duration: keys.duration?,
        frames: keys.frames?,
        accuracy: keys.accuracy?,
        seed: keys.seed?,
        auto: effects.auto,
        lies: moving.lies,
        notes: moving.notes,
        sensor_tolerance: effects.sensor_tolerance,
        uncertainty,
    })
}

/// The bodies, as far as they could be read.
struct Moving<'a> {
    kinds: Vec<&'a str>,
    wall: bool,
    /// Rods behind the walls at the top and at the bottom.
    rods: [Option<bodies::Rod>; 2],
    effects: Effects,
    lies: bool,
    initial_velocities: Vec<f64>,
    built: Option<(ChainSpec, Chain)>,
    length_scales: Vec<f64>,
    notes: Vec<Note>,
}

fn moving<'a>(keys: &RootKeys<'a>, places: &[(&str, PlaceKeys<'_>)]) -> Moving<'a> {
    let root = &keys.table;
    let materials = Materials::read(keys.materials.as_deref().unwrap_or_default());
    let striker = keys.striker.as_ref().and_then(|table| bodies::striker(table, &materials));
    let chain = keys.chain.as_ref().map(ChainKeys::read);
    let kinds = keys.particles.as_deref().unwrap_or_default();
    let mut particles = bodies::particles(kinds, chain.as_ref(), &materials);
    let count = particles.kinds.len();
    for (particle, mass) in sensors::host_masses(places, count) {
        if let Some(body) = particles.bodies.get_mut(particle - 1) {
            body.mass = mass;
        }
    }
    let end = |key, node| bodies::end(&chain.as_ref()?.table, key, node, &materials);
    let top = end("top", chain.as_ref().and_then(|chain| chain.top));
    let bottom = end("bottom", chain.as_ref().and_then(|chain| chain.bottom));
    if let Some(chain) = &chain {
        bodies::no_preload_at_the_bottom(chain);
    }
    let rods = [&top, &bottom].map(|end| end.as_ref().and_then(|end| end.rod));
    // An end that could not be read may be a wall.
    let walls = [&top, &bottom].map(|e| e.as_ref().is_none_or(|e| matches!(e.end, End::Wall(_))));
    let pairs = bodies::pairs(&particles.kinds, striker.is_some(), walls);
    let read = |table| effects::effects(table, root.has("striker"), count, &pairs);
    let mut effects = keys.effects.as_ref().map(read).unwrap_or_default();
    let behind = |end: &Option<bodies::ReadEnd>| end.as_ref().map(|e| e.support.clone());
    effects.spec.supports = [&top, &bottom].map(|end| behind(end).unwrap_or_default());
    if let Some(table) = &keys.drive {
        let supports = effects.spec.supports.clone();
        if let Some(driven) = drive::driven(table, keys.seed, supports) {
            effects.spec.supports = driven;
        }
    }
    let orientation = chain.as_ref().and_then(|chain| chain.orientation);
    let lies = orientation == Some(bodies::Orientation::Lying);
    if lies {
        effects.spec.gravity = None;
        effects.auto.retain(|effect| *effect != "gravity");
    }
    let velocities = keys.initial_velocities.as_deref().unwrap_or_default();
    let initial_velocities = bodies::initial_velocities(root, velocities, striker.as_ref(), count);
    // A kind that could not be read has already left its problem; half a chain would only add
    // echoes of it.
    let whole =
        particles.bodies.len() == count && count > 0 && (striker.is_some() || !root.has("striker"));
    // An end that could not be read is a problem already; a sensor at it adds no other.
    let wall = bottom.as_ref().is_none_or(|bottom| matches!(bottom.end, End::Wall(_)));
    let built = match (&chain, top, bottom) {
        (Some(chain), Some(top), Some(bottom)) if whole => {
            let spec = ChainSpec {
                striker: striker.map(|s| s.body),
                particles: particles.bodies,
                top: top.end,
                bottom: bottom.end,
                wall_preload: top.preload,
                effects: effects.spec.clone(),
            };
            let magnet = keys.effects.as_ref().and_then(effects::magnet_table);
            bodies::assemble(&spec, &chain.table, magnet.as_ref()).map(|chain| (spec, chain))
        }
        _ => None,
    };
    let mut notes = materials.into_notes();
    if !lies && keys.effects.as_ref().is_none_or(|effects| !effects.has("gravity")) {
        notes.extend(built.as_ref().and_then(|(_, chain)| weightless(chain)));
    }
    let (kinds, length_scales) = (particles.kinds, particles.scales);
    Moving { kinds, wall, rods, effects, lies, initial_velocities, built, length_scales, notes }
}

/// The note on a chain on a wall without gravity, if its weight would matter to its last contact.
fn weightless(chain: &Chain) -> Option<Note> {
    let contact = chain.contacts().get(chain.wall_contact()?)?;
    let particles = chain.bodies().iter().skip(usize::from(chain.has_striker()));
    let weight = FREE_FALL * particles.map(|body| body.mass).sum::<f64>();
    (weight > NOTED_WEIGHT_SHARE * contact.static_force).then(|| {
        let sentence = format!(
            "gravity is off: upright, the chain weighs {}, and {} presses its last contact now; [effects.gravity] acceleration = \"9.81 m/s^2\" switches it on, chain.orientation = \"lying\" says that it lies",
            engineering(weight, "N", 3),
            engineering(contact.static_force, "N", 3)
        );
        let note = Note::new("gravity_off", sentence).with("weight_n", weight);
        note.with("static_force_n", contact.static_force)
    })
}
