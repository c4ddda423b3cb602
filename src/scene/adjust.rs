//! A scene whose numbers can be turned: each by its path in the file, `striker.speed`,
//! `materials.ptfe.youngs_modulus`, `sensors.*.sensitivity`.
//!
//! Paths reach what the scene says itself, what it stands on, and what its instrument files say; a
//! material's constants although they stand in a file of their own, and a sensor's sensitivity
//! although it follows from plate and cable.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::bench::CachedPanel;
use super::distance::Site;
use super::document::{Node, Value};
use super::library::{self, LoadedScene};
use super::problem::SceneError;
use super::tree::{ANY, at, at_mut, expand, insert, is_in_tables, known};
use super::{Scene, input_load};
use crate::data;
use crate::quantity::{Dimension, parse_any};
use crate::sensor::Load;

/// A scene's tree, from which scenes with other numbers are made.
#[derive(Debug, Clone)]
pub struct Adjustable {
    pub(super) loaded: LoadedScene,
    base: String,
    /// The scene's front panel, which scenes with other values mostly have, too.
    panel: Option<CachedPanel>,
}

/// A number of a scene that can be turned.
#[derive(Debug, Clone, PartialEq)]
pub struct AdjustableNumber {
    /// Where it stands, `striker.speed`.
    pub path: String,
    /// Its value in the scene, in SI units (unit).
    pub value: f64,
    /// The unit as typed, `GPa`; empty for a plain number.
    pub unit: String,
    /// How many SI units that unit is (unit).
    pub scale: f64,
}

/// Why a path names nothing that can be turned.
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

impl Adjustable {
    /// The scene `name`, a shipped one or a file.
    ///
    /// # Errors
    /// As [`Scene::load`].
    pub fn load(name: &str) -> Result<Self, SceneError> {
        // A file is named by its whole path, so that what stands on it can lie anywhere.
        let whole = std::fs::canonicalize(name).ok().filter(|_| Path::new(name).is_file());
        let base = whole.map_or_else(|| name.to_owned(), |path| path.display().to_string());
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
        let panel = CachedPanel::of(&adjustable.loaded.root, duration);
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
        self.standing_on(root)
    }

    /// The scene of another tree.
    pub(super) fn standing_on(&self, root: Node) -> Result<Scene, SceneError> {
        let LoadedScene { name, text, texts, problems, .. } = &self.loaded;
        let loaded = LoadedScene {
            name: name.clone(),
            text: text.clone(),
            texts: texts.clone(),
            root,
            problems: problems.clone(),
        };
        Scene::checked(loaded, self.panel.as_ref())
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
        self.lay_open(&keys)?;
        let mut found = Vec::new();
        expand(&self.loaded.root, &keys, &mut Vec::new(), &mut found);
        // A scene that stands on this one can say other values in tables, but not a part of a list.
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

    /// Puts into the tree what a path may reach although the scene does not spell it out.
    pub(super) fn lay_open(&mut self, keys: &[&str]) -> Result<(), AdjustError> {
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

    /// A scene that stands on this one and has other values, as text; each with how many digits of
    /// it count.
    pub fn derived(&self, values: &[(&AdjustableNumber, f64, usize)], title: &str) -> String {
        let mut tables: BTreeMap<String, BTreeMap<String, String>> = BTreeMap::new();
        for (knob, value, decimals) in values {
            let (table, key) = knob.path.rsplit_once('.').unwrap_or(("", &knob.path));
            let words = format!("{:.decimals$} {}", value / knob.scale, knob.unit);
            let words = format!("\"{}\"", words.trim_end());
            tables.entry(table.to_owned()).or_default().insert(key.to_owned(), words);
            self.fill_material(table, &mut tables);
        }
        let mut text = format!("base = {:?}\ntitle = {title:?}\n", self.base);
        for (table, values) in &tables {
            if !table.is_empty() {
                let _ = write!(text, "\n[{table}]\n");
            }
            for (key, value) in values {
                let _ = writeln!(text, "{key} = {value}");
            }
        }
        text
    }

    /// A material's own table hides its file, so it has to say all of it.
    fn fill_material(&self, table: &str, tables: &mut BTreeMap<String, BTreeMap<String, String>>) {
        let keys: Vec<&str> = table.split('.').collect();
        let material = if keys.first() == Some(&"materials") { keys.as_slice() } else { &[] };
        let Some(Value::Table(all)) = at(&self.loaded.root, material).map(|node| &node.value)
        else {
            return;
        };
        let Some(said) = tables.get_mut(table).filter(|_| material.len() == 2) else { return };
        for (key, entry) in &**all {
            let value = match &entry.node.value {
                Value::Text(text) => format!("{text:?}"),
                Value::Number { typed, .. } => typed.to_string(),
                _ => continue,
            };
            said.entry(key.to_string()).or_insert(value);
        }
    }
}

impl AdjustableNumber {
    /// A value as the file would have it.
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
    match &node.value {
        Value::Number { value, .. } if value.is_finite() => {
            Ok(AdjustableNumber { path, value: *value, unit: String::new(), scale: 1.0 })
        }
        Value::Text(text) => {
            let Ok((value, dimension)) = parse_any(text) else {
                return Err(wrong(node.describe()));
            };
            let unit = unit_of(text.trim());
            let (unit, scale) = match parse_any(&format!("1 {unit}")) {
                // A unit with another zero, °C, is no factor.
                Ok((scale, same)) if same == dimension && has_zero(unit) => {
                    (unit.to_owned(), scale)
                }
                _ if dimension == Dimension::NONE => (String::new(), 1.0),
                _ => (dimension.base_units(), 1.0),
            };
            Ok(AdjustableNumber { path, value, unit, scale })
        }
        _ => Err(wrong(node.describe())),
    }
}

/// Whether zero of `unit` is zero in SI units.
fn has_zero(unit: &str) -> bool {
    parse_any(&format!("0 {unit}")).is_ok_and(|(value, _)| value == 0.0)
}

/// The rest of `text` behind its number.
fn unit_of(text: &str) -> &str {
    let number = |end: &usize| {
        let digits: Option<String> = text.get(..*end).map(|start| start.trim().replace('_', ""));
        digits.is_some_and(|digits| digits.parse::<f64>().is_ok())
    };
    let end = (0..=text.len()).rev().find(number).unwrap_or(0);
    text.get(end..).unwrap_or_default().trim()
}
