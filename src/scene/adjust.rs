//! A scene whose values can be set by path: `striker.speed`, `materials.ptfe.youngs_modulus`,
//! `sensors.*.sensitivity`. Fits, budgets and the screen change numbers, sweeps also names of
//! models, lists and whole tables.
//!
//! Paths lead to values of the scene, of its bases and of its instruments' files. The constants of
//! an included material and the sensitivity of a plate are copied into the scene first.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::document::{
    ANY, Node, Value, at, at_mut, expand, insert, is_in_tables, known, put, quoted, quoted_key,
};
use super::inputs::inputs;
use super::library::{self, LoadedScene};
use super::panel::CachedPanel;
use super::problem::{Problem, SceneError, one_of};
use super::problems::Problems;
use super::root::RootKeys;
use super::table::TableReader;
use super::table::{Kind, key_at};
use super::{Scene, Site, input_load, with_merged};
use crate::data;
use crate::quantity::{self, Difference, Dimension, Quantity};
use crate::sensor::Load;

/// A scene's tree, from which scenes with other numbers are made.
#[derive(Debug, Clone)]
pub struct Adjustable {
    loaded: LoadedScene,
    base: String,
    /// The scene's front panel, which scenes with other values mostly have, too.
    panel: Option<CachedPanel>,
}

/// A path and its new value.
#[derive(Debug, Clone)]
pub struct SceneOverride<'a> {
    /// Paths in the scene, `striker.speed`; a number is a place in a list, counted from 1.
    pub paths: &'a [String],
    /// The new value.
    pub node: Node,
}

/// A number of a scene that can be changed.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjustableNumber {
    /// Its path, `striker.speed`.
    pub path: String,
    /// Its value in the scene, in SI units (unit).
    pub value: f64,
    /// The unit as typed, `GPa`; empty for a plain number.
    pub unit: String,
    /// How many SI units that unit is (unit).
    pub scale: f64,
}

/// Why a path names nothing that can be changed.
#[derive(Debug, thiserror::Error)]
pub enum AdjustError {
    /// Nothing there.
    #[error("found nothing at `{path}` in the scene, expected a number: {}", next(.path, .known))]
    Nothing {
        /// The path as typed.
        path: String,
        /// The value at the end of the path.
        known: Vec<String>,
    },
    /// No number with a unit.
    #[error(
        "found {found} at `{path}`, expected a number that can be changed, such as \"0.44 m/s\""
    )]
    NoNumber {
        /// The path.
        path: String,
        /// The value there.
        found: String,
    },
    /// The scene itself is wrong.
    #[error(transparent)]
    Scene(#[from] SceneError),
}

fn next(path: &str, known: &[String]) -> String {
    if known.is_empty() {
        return "the path ends in a value already".to_owned();
    }
    let remedy = match path.split('.').collect::<Vec<_>>().as_slice() {
        ["effects", effect, _] if !known.contains(&(*effect).to_owned()) => {
            format!("; a scene with base = \"...\" and [effects.{effect}] can add it")
        }
        _ => String::new(),
    };
    format!("there are {}{remedy}", known.join(", "))
}

/// A scene's `base` as it is written into `file`: a file in the same folder or below is given from
/// there, so that the folder can be moved; a name and any other path stay as they are.
pub fn base_in(base: &str, file: &Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = std::fs::canonicalize(folder.unwrap_or(Path::new("."))).ok();
    let below = folder.and_then(|folder| Path::new(base).strip_prefix(folder).ok());
    below.map_or_else(|| base.to_owned(), |path| Path::new(".").join(path).display().to_string())
}

impl Adjustable {
    /// The scene `name`, a shipped one or a file.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load(name: impl AsRef<Path>) -> Result<Self, SceneError> {
        let name = name.as_ref();
        // A file is named by its whole path, so that scenes based on it can be in any folder.
        let whole = std::fs::canonicalize(name).ok().filter(|_| name.is_file());
        let base = whole.as_deref().unwrap_or(name).display().to_string();
        Self::of(library::load(name)?, base)
    }

    /// A scene that came as text, as `file`.
    ///
    /// # Errors
    /// As [`Scene::from_text`].
    pub fn from_text(name: &str, file: &str, text: &str) -> Result<Self, SceneError> {
        Self::of(library::load_text(name, file, text)?, name.to_owned())
    }

    fn of(loaded: LoadedScene, base: String) -> Result<Self, SceneError> {
        let adjustable = Self { loaded, base, panel: None };
        let duration = adjustable.scene()?.duration;
        let problems = Problems::default();
        let root = &adjustable.loaded.root;
        let keys = TableReader::of(root, "", &[RootKeys::KEYS], &problems);
        let keys = keys.map(|root| RootKeys::read(&root));
        let panel =
            keys.and_then(|keys| CachedPanel::of(keys.scope.as_ref()?, inputs(&keys), duration));
        Ok(Self { panel, ..adjustable })
    }

    /// The scene's short name.
    pub fn name(&self) -> &str {
        &self.loaded.name
    }

    /// The scene as it stands.
    ///
    /// # Errors
    /// [`SceneError`] with every problem.
    pub fn scene(&self) -> Result<Scene, SceneError> {
        self.with(&[])
    }

    /// The scene with other values of some knobs, in SI units.
    ///
    /// # Errors
    /// [`SceneError`] where a value is out of its range.
    pub fn with(&self, values: &[(&AdjustableNumber, f64)]) -> Result<Scene, SceneError> {
        let mut root = self.loaded.root.clone();
        for (knob, value) in values {
            let keys: Vec<&str> = knob.path.split('.').collect();
            if let Some(node) = at_mut(&mut root, &keys) {
                node.value = knob.typed(*value);
            }
        }
        self.with_tree(root)
    }

    /// The scene of another tree.
    fn with_tree(&self, root: Node) -> Result<Scene, SceneError> {
        Scene::checked(self.loaded_with(root), self.panel.as_ref())
    }

    fn loaded_with(&self, root: Node) -> LoadedScene {
        let LoadedScene { name, text, texts, problems, .. } = &self.loaded;
        LoadedScene {
            name: name.clone(),
            text: text.clone(),
            texts: texts.clone(),
            root,
            problems: problems.clone(),
        }
    }

    /// The knobs that `path` names; `*` stands for every name.
    ///
    /// # Errors
    /// [`AdjustError`] where nothing is there, or no number.
    pub fn knobs(&mut self, path: &str) -> Result<Vec<AdjustableNumber>, AdjustError> {
        let mut keys: Vec<&str> = path.split('.').map(str::trim).collect();
        // One of the sensors is a sensor.
        if let Some(first @ &mut "sensor") = keys.first_mut() {
            *first = "sensors";
        }
        self.copy_into_scene(&keys)?;
        let mut found = Vec::new();
        expand(&self.loaded.root, &keys, &mut Vec::new(), &mut found);
        // A scene based on this one can have other values in tables, but not of a part of a list.
        found.retain(|(path, _)| is_in_tables(&self.loaded.root, path));
        if found.is_empty() {
            let known = known(&self.loaded.root, &keys);
            return Err(AdjustError::Nothing { path: path.to_owned(), known });
        }
        found.into_iter().map(|(path, node)| knob(path, node)).collect()
    }

    /// Names of the materials of the scene's particles, each once.
    pub fn materials(&self) -> Vec<String> {
        let mut found = Vec::new();
        let keys = ["particles", ANY, "material"];
        let mut texts = Vec::new();
        expand(&self.loaded.root, &keys, &mut Vec::new(), &mut texts);
        for (_, node) in texts {
            if let Value::Text(text) = &node.value
                && !found.contains(&text.to_string())
            {
                found.push(text.to_string());
            }
        }
        found
    }

    /// Copies into the tree what a path may lead to although the scene does not have it.
    fn copy_into_scene(&mut self, keys: &[&str]) -> Result<(), AdjustError> {
        match keys {
            ["materials", name, _] => {
                let own = |root: &Node| at(root, &["materials", name]).is_some();
                if *name != ANY && !own(&self.loaded.root) {
                    let place = self.loaded.root.place.clone();
                    let Ok(file) = library::instrument("materials", name, &place, "") else {
                        let known = data::instrument_names("materials");
                        let known = known.into_iter().map(str::to_owned).collect();
                        return Err(AdjustError::Nothing { path: keys.join("."), known });
                    };
                    insert(&mut self.loaded.root, &["materials", name], file.value.clone());
                }
            }
            ["sensors", name, key @ ("offset" | "host_mass")] => {
                let scene = self.scene()?;
                for placed in &scene.sensors {
                    let path = ["sensors", placed.name.as_str(), *key];
                    let Site::Particle(particle) = placed.site else { continue };
                    if (*name != ANY && *name != placed.name)
                        || at(&self.loaded.root, &path).is_some()
                    {
                        continue;
                    }
                    let body = scene.chain.bodies().get(scene.chain.body_of(particle));
                    let mass = body.map_or(f64::NAN, |body| body.mass);
                    let text =
                        if *key == "offset" { "0".to_owned() } else { format!("{mass:e} kg") };
                    insert(&mut self.loaded.root, &path, Value::Text(text.into()));
                }
            }
            ["sensors", name, "sensitivity"] => {
                let scene = self.scene()?;
                for (index, placed) in scene.sensors.iter().enumerate() {
                    let path = ["sensors", placed.name.as_str(), "sensitivity"];
                    let meant = *name == ANY || *name == placed.name;
                    if meant && at(&self.loaded.root, &path).is_none() {
                        let text = format!("{:e} V/N", sensitivity(&scene, index));
                        insert(&mut self.loaded.root, &path, Value::Text(text.into()));
                    }
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether `path` leads through a table that a derived scene has switched off
    /// (`magnet_preload = false`).
    pub fn is_switched_off(&self, path: &str) -> bool {
        let keys: Vec<&str> = path.split('.').collect();
        let is_off = |end| at(&self.loaded.root, &keys[..end]).map(|node| &node.value);
        (1..keys.len()).any(|end| matches!(is_off(end), Some(Value::Flag(false))))
    }

    /// A scene based on this one with other values, as text; each with its number of decimals.
    /// It is meant for the file `file`.
    pub fn derived(
        &self,
        values: &[(&AdjustableNumber, f64, usize)],
        title: &str,
        file: &Path,
    ) -> String {
        let mut tables: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
        for (knob, value, decimals) in values {
            let (table, key) = knob.path.rsplit_once('.').unwrap_or(("", &knob.path));
            let words = format!("{:.decimals$} {}", value / knob.scale, knob.unit);
            let words = quoted(words.trim_end());
            tables.entry(table.to_owned()).or_default().insert(key.to_owned(), words);
            self.fill_material(table, &mut tables);
        }
        let mut text =
            format!("base = {}\ntitle = {}\n", quoted(&base_in(&self.base, file)), quoted(title));
        for (table, values) in &tables {
            if !table.is_empty() {
                let _ = write!(text, "\n[{}]\n", quoted_path(table));
            }
            for (key, value) in values {
                let _ = writeln!(text, "{} = {value}", quoted_key(key));
            }
        }
        text
    }

    /// A material's own table replaces its file, so it needs all of its keys.
    fn fill_material(&self, table: &str, tables: &mut BTreeMap<String, BTreeMap<String, String>>) {
        let keys: Vec<&str> = table.split('.').collect();
        let material = if keys.first() == Some(&"materials") { keys.as_slice() } else { &[] };
        let Some(Value::Table(all)) = at(&self.loaded.root, material).map(|node| &node.value)
        else {
            return;
        };
        let Some(said) = tables.get_mut(table).filter(|_| material.len() == 2) else { return };
        // The source states the file's numbers, not those that take their place.
        for (key, entry) in all.iter().filter(|(key, _)| &***key != "source") {
            let value = match &entry.node.value {
                Value::Text(text) => quoted(text),
                Value::Number { typed, .. } => typed.to_string(),
                _ => continue,
            };
            said.entry(key.to_string()).or_insert(value);
        }
    }
}

impl Adjustable {
    /// The paths that `path` means: `*` is every name there is. A path without it may lead to a key
    /// that the scene does not have.
    ///
    /// # Errors
    /// [`AdjustError::Nothing`] if `*` finds no name, and [`AdjustError::Scene`] if the
    /// scene itself
    /// is wrong.
    pub fn paths(&mut self, path: &str) -> Result<Vec<String>, AdjustError> {
        let keys: Vec<&str> = path.split('.').map(str::trim).collect();
        self.copy_into_scene(&keys)?;
        if !keys.contains(&ANY) {
            return Ok(vec![keys.join(".")]);
        }
        let mut found = Vec::new();
        expand(&self.loaded.root, &keys, &mut Vec::new(), &mut found);
        if found.is_empty() {
            let known = known(&self.loaded.root, &keys);
            return Err(AdjustError::Nothing { path: path.to_owned(), known });
        }
        Ok(found.into_iter().map(|(path, _)| path).collect())
    }

    /// The scene with other values: paths as for [`paths`](Self::paths), each value as TOML has
    /// it, `"0.5 m/s"` with its quotes. `file` is the name of what they come from.
    ///
    /// # Errors
    /// [`AdjustError`] with everything that is wrong.
    pub fn overridden(
        &mut self,
        file: &str,
        values: &[(String, String)],
    ) -> Result<Scene, AdjustError> {
        let paths: Result<Vec<_>, _> = values.iter().map(|(path, _)| self.paths(path)).collect();
        let mut root = self.loaded.root.clone();
        for (paths, (_, value)) in paths?.iter().zip(values) {
            let given = Node::parse(file, &format!("value = {value}"));
            let given = given.map_err(SceneError::Problems)?;
            let Some(node) = at(&given, &["value"]) else { continue };
            for path in paths {
                let keys: Vec<&str> = path.split('.').collect();
                change(&mut root, &keys, node.clone()).map_err(SceneError::Problems)?;
            }
        }
        // Few are made this way: each carries its merged scene into recordings.
        Ok(Scene::checked(with_merged(self.loaded_with(root)), self.panel.as_ref())?)
    }

    /// The scene with `settings` and this seed.
    ///
    /// # Errors
    /// [`SceneError`] with everything that is wrong with it, each problem where it was typed.
    pub fn varied(&self, settings: &[SceneOverride<'_>], seed: u64) -> Result<Scene, SceneError> {
        let mut root = self.loaded.root.clone();
        for SceneOverride { paths, node } in settings {
            for path in *paths {
                let keys: Vec<&str> = path.split('.').collect();
                change(&mut root, &keys, node.clone()).map_err(SceneError::Problems)?;
            }
        }
        let mut scene = self.with_tree(root)?;
        scene.seed = seed;
        Ok(scene)
    }
}

fn change(root: &mut Node, keys: &[&str], node: Node) -> Result<(), Vec<Problem>> {
    let place = node.place.clone();
    library::replace_model(root, keys, &node)?;
    if put(root, keys, node) {
        return Ok(());
    }
    let expected = one_of(known(root, keys));
    Err(vec![place.problem(&keys.join("."), "nothing there in the scene".to_owned(), expected)])
}

impl AdjustableNumber {
    /// A value as a file has it.
    fn typed(&self, value: f64) -> Value {
        Value::Text(format!("{:e} {}", value / self.scale, self.unit).into())
    }
}

/// Voltage per force that sensor `index` has at the input it is wired to, from its data alone
/// (V/N).
fn sensitivity(scene: &Scene, index: usize) -> f64 {
    let Some(placed) = scene.sensors.get(index) else { return f64::NAN };
    let model = &scene.scope.model;
    let open = Load { resistance: model.input_resistance, capacitance: model.input_capacitance };
    let wired =
        scene.scope.channels.iter().flatten().find(|c| c.input.as_ref() == Some(&placed.name));
    let load = wired.map_or(open, |channel| input_load(model, channel));
    placed.sensor.connect(placed.sensor.measured.load.unwrap_or(load)).sensitivity
}

fn knob(path: String, node: &Node) -> Result<AdjustableNumber, AdjustError> {
    let wrong = |found: String| AdjustError::NoNumber { path: path.clone(), found };
    let (value, dimension) = match (&node.value, number(&path, node)) {
        (Value::Number { .. }, Some((value, _))) => {
            return Ok(AdjustableNumber { path, value, unit: String::new(), scale: 1.0 });
        }
        (Value::Text(_), Some(number)) => number,
        _ => return Err(wrong(node.describe())),
    };
    let (_, unit) = quantity::split(node.as_text().unwrap_or_default());
    let one = |number: u8| format!("{number} {unit}").parse::<Quantity>().map(|one| one.value);
    let scale = format!("1 {unit}").parse::<Difference>().map_or(1.0, |one| one.value);
    // A unit with another zero, °C, is no factor of an absolute value.
    let has_zero = is_difference(&path) || one(0).is_ok_and(|value| value == 0.0);
    let (unit, scale) = match dimension {
        _ if has_zero => (unit.to_owned(), scale),
        Dimension::NONE => (String::new(), 1.0),
        _ => (dimension.base_units(), 1.0),
    };
    Ok(AdjustableNumber { path, value, unit, scale })
}

/// Whether the value at `path` is a difference: `5 °C` is 5 K there.
fn is_difference(path: &str) -> bool {
    let keys: Vec<&str> = path.split('.').collect();
    let key = key_at(&[RootKeys::KEYS], &keys);
    key.is_some_and(|key| matches!(key.kind, Kind::Difference(..)))
}

/// Whether the value at `path` is a whole number.
pub(super) fn is_whole(path: &str) -> bool {
    let keys: Vec<&str> = path.split('.').collect();
    key_at(&[RootKeys::KEYS], &keys).is_some_and(|key| matches!(key.kind, Kind::Count(..)))
}

/// The number that `node` is at `path` of a scene, in SI units, with its dimension; `None` if it is
/// no number.
pub fn number(path: &str, node: &Node) -> Option<(f64, Dimension)> {
    match &node.value {
        Value::Number { value, .. } if value.is_finite() => Some((*value, Dimension::NONE)),
        Value::Text(text) if is_difference(path) => {
            let Difference { value, dimension } = text.parse().ok()?;
            Some((value, dimension))
        }
        Value::Text(text) => {
            let Quantity { value, dimension } = text.parse().ok()?;
            Some((value, dimension))
        }
        _ => None,
    }
}

fn quoted_path(path: &str) -> String {
    path.split('.').map(quoted_key).collect::<Vec<_>>().join(".")
}
