//! Materials, particles, chain and striker: the part of a scene that moves.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::library;
use super::reader::{Bound, Problems, TableReader};
use super::taper::sizes;
use crate::chain::{Body, Chain, ChainError, ChainSpec, Elasticity, End};
use crate::note::Note;
use crate::quantity::{Dimension, engineering};

/// Most particles a chain may have: a recording has a topic for each bead and each contact, and
/// room for 65535.
const MAX_PARTICLES: usize = 30_000;

/// A mass that differs from that of its shape and its material's density by more than this factor
/// is noted: holes and wrong diameters make less, wrong units A body wider than this has probably
/// the wrong unit (m).
const LARGE_BODY: f64 = 0.1;
/// and materials more (1).
const MAX_MASS_RATIO: f64 = 1.3;

/// Looks materials up, in the scene first and among the instruments then.
pub struct Materials<'a> {
    problems: &'a Problems,
    own: BTreeMap<String, Option<Material>>,
    /// Masses that do not go with density and shape.
    notes: RefCell<Vec<Note>>,
}

/// The material of a body.
#[derive(Clone, Copy)]
struct Material {
    elasticity: Elasticity,
    yield_strength: Option<f64>,
    /// (kg/m³)
    density: Option<f64>,
}

impl<'a> Materials<'a> {
    /// Reads `[materials.<name>]`.
    pub fn read(root: &TableReader<'_>, problems: &'a Problems) -> Self {
        let mut own = BTreeMap::new();
        for (name, table) in root.tables("materials") {
            own.insert(name.to_owned(), material(&table));
            table.finish();
        }
        Self { problems, own, notes: RefCell::default() }
    }

    /// Notes on masses that do not go with density and shape.
    pub fn into_notes(self) -> Vec<Note> {
        self.notes.into_inner()
    }

    /// The material that `table` names under `key`.
    fn named(&self, table: &TableReader<'_>, key: &'static str) -> Option<Material> {
        let name = table.required_text(key, "the name of a material")?;
        if let Some(own) = self.own.get(name) {
            return *own;
        }
        let path = table.path_of(key);
        match library::instrument("materials", name, table.place_of(key), &path) {
            Ok(node) => {
                let table = TableReader::of(&node, "", self.problems)?;
                let found = material(&table);
                table.finish();
                found
            }
            Err(problems) => {
                self.problems.extend(problems);
                None
            }
        }
    }
}

fn material(table: &TableReader<'_>) -> Option<Material> {
    let _ = table.text("source");
    let modulus = table.required("youngs_modulus", Dimension::PRESSURE, Bound::MODULUS);
    let ratio = table.required("poissons_ratio", Dimension::NONE, Bound::Between(-1.0, 0.5));
    let yield_strength = table.quantity("yield_strength", Dimension::PRESSURE, Bound::Positive);
    let density = table.quantity("density", Dimension::DENSITY, Bound::DENSITY);
    let elasticity = Elasticity { youngs_modulus: modulus?, poissons_ratio: ratio? };
    Some(Material { elasticity, yield_strength, density })
}

/// Reads a body: material, mass, and its shape. A diameter makes a sphere, a height in addition a
/// cylinder with flat faces; without either the faces are flat and the length is zero. Without a
/// mass it is that of the shape and the material's density.
fn body(
    table: &TableReader<'_>,
    name: &str,
    materials: &Materials<'_>,
    shaped: bool,
) -> Option<Body> {
    let _ = table.text("source");
    let material = materials.named(table, "material");
    let typed = table.quantity("mass", Dimension::MASS, Bound::MASS);
    let read = if shaped { TableReader::required } else { TableReader::quantity };
    let diameter = read(table, "diameter", Dimension::LENGTH, Bound::LENGTH);
    let height = table.quantity("height", Dimension::LENGTH, Bound::LENGTH);
    // Without its shape, a body would look flat or round where it is neither.
    let unread = |key, value: Option<f64>| value.is_none() && table.has(key);
    if unread("diameter", diameter) || unread("height", height) || (shaped && diameter.is_none()) {
        return None;
    }
    let (length, curvature) = match (diameter, height) {
        (_, Some(height)) => (height, 0.0),
        (Some(diameter), None) => (diameter, 2.0 / diameter),
        (None, None) => (0.0, 0.0),
    };
    let volume = match (diameter, height) {
        (Some(diameter), Some(height)) => Some(0.25 * PI * diameter * diameter * height),
        (Some(diameter), None) => Some(PI / 6.0 * diameter.powi(3)),
        (None, _) => None,
    };
    let solid = material.and_then(|material| Some(material.density? * volume?));
    let mass = match solid {
        _ if table.has("mass") => typed,
        Some(solid) => Some(solid),
        // A material that could not be read has left its problem.
        None if material.is_none() => None,
        None => table.required("mass", Dimension::MASS, Bound::MASS),
    };
    if let (Some(mass), Some(solid)) = (mass, solid)
        && !(1.0 / MAX_MASS_RATIO..=MAX_MASS_RATIO).contains(&(mass / solid))
    {
        let sentence = format!(
            "{name}: its mass of {} is {:.3} times that of its shape and its material's density ({}): check mass, diameter and material",
            engineering(1e3 * mass, "g", 3),
            mass / solid,
            engineering(1e3 * solid, "g", 3),
        );
        let note = Note::new("mass_not_of_its_material", sentence).with("body", name);
        let note = note.with("mass_kg", mass).with("solid_mass_kg", solid);
        materials.notes.borrow_mut().push(note);
    }
    if let Some(size) = diameter.filter(|size| *size > LARGE_BODY) {
        let sentence = format!(
            "{name} is {} across: check the unit of its diameter",
            engineering(size, "m", 3)
        );
        let note = Note::new("large_body", sentence).with("body", name).with("diameter_m", size);
        materials.notes.borrow_mut().push(note);
    }
    let Material { elasticity, yield_strength, .. } = material?;
    Some(Body { name: name.into(), mass: mass?, length, curvature, elasticity, yield_strength })
}

/// The striker and its speed (m/s).
pub struct Striker {
    /// The body.
    pub body: Body,
    /// Speed at first contact (m/s).
    pub speed: f64,
}

/// Reads `[striker]`.
pub fn striker(root: &TableReader<'_>, materials: &Materials<'_>) -> Option<Striker> {
    let table = root.table("striker")?;
    let _ = table.text("model");
    let body = body(&table, "striker", materials, false);
    let speed = table.required("speed", Dimension::SPEED, Bound::SPEED);
    table.finish();
    Some(Striker { body: body?, speed: speed? })
}

/// The particles in order, each with its kind.
pub struct Particles<'a> {
    /// Bodies from the top; a kind that could not be read is missing.
    pub bodies: Vec<Body>,
    /// Kind of each place, from the top; empty where a segment could not be read.
    pub kinds: Vec<&'a str>,
}

/// Largest number that a particle may have in a chain of `particles`, 0 where that is not known.
pub fn last_particle(particles: usize) -> u64 {
    if particles == 0 { MAX_PARTICLES as u64 } else { particles as u64 }
}

/// Reads `[particles.<kind>]` and `[chain]` with its segments.
pub fn particles<'a>(
    root: &TableReader<'_>,
    chain: Option<&TableReader<'a>>,
    materials: &Materials<'_>,
) -> Particles<'a> {
    let mut kinds = BTreeMap::new();
    for (name, table) in root.tables("particles") {
        let kind = body(&table, name, materials, true);
        let diameter = || table.quantity("diameter", Dimension::LENGTH, Bound::LENGTH);
        let diameter = kind.as_ref().and_then(|_| diameter());
        kinds.insert(name, kind.zip(diameter));
        table.finish();
    }
    let mut particles = Particles { bodies: Vec::new(), kinds: Vec::new() };
    let mut complete = true;
    let Some(chain) = chain else { return particles };
    for segment in chain.list("segments") {
        let repeat = segment.count("repeat", 1, MAX_PARTICLES as u64);
        let names = segment.texts("particles");
        complete &= (repeat.is_some() || !segment.has("repeat")) && !names.is_empty();
        let repeat = repeat.and_then(|repeat| usize::try_from(repeat).ok()).unwrap_or(1);
        for (name, place) in &names {
            if !kinds.contains_key(name) {
                let known: Vec<&str> = kinds.keys().copied().collect();
                let expected = format!("a kind of particle: one of {}", known.join(", "));
                segment.problem_at(place, "particles", format!("\"{name}\""), expected);
            }
        }
        let diameters: Vec<Option<f64>> = names
            .iter()
            .map(|(name, _)| kinds.get(name)?.as_ref().map(|(_, diameter)| *diameter))
            .collect();
        let sizes = sizes(&segment, repeat.min(MAX_PARTICLES), &diameters);
        complete &= sizes.is_some();
        let sizes = sizes.unwrap_or_default();
        if particles.kinds.len() + repeat.saturating_mul(names.len()) > MAX_PARTICLES {
            let expected = format!("at most {MAX_PARTICLES} particles");
            segment.problem("repeat", "a longer chain", expected);
            complete = false;
        } else {
            for size in (0..repeat).map(|row| sizes.get(row).copied().unwrap_or(1.0)) {
                for (name, _) in &names {
                    particles.kinds.push(name);
                    let kind = kinds.get(name).and_then(Option::as_ref);
                    particles.bodies.extend(kind.map(|(body, _)| body.scaled(size)));
                }
            }
        }
        if !segment.has("particles") || segment.is_empty_list("particles") {
            segment.problem("particles", "no particles", "a list of kinds of particles");
        }
        segment.finish();
    }
    if !chain.has("segments") || chain.is_empty_list("segments") {
        chain.problem("segments", "no particles", "at least one [[chain.segments]]");
    }
    if !complete {
        // How long the chain was meant to be is not known, so nothing can be said against a
        // particle's number.
        particles.kinds.clear();
    }
    particles
}

/// The end of a chain: `"free"`, `{ wall = "steel" }` or `{ force = "2 N" }`; a wall may press with
/// a `preload`.
pub fn end(
    chain: &TableReader<'_>,
    key: &'static str,
    materials: &Materials<'_>,
) -> Option<(End, f64)> {
    const EXPECTED: &str = "\"free\", { wall = \"<material>\" } or { force = \"<force>\" }";
    let Some(node) = chain.node(key) else {
        chain.problem(key, "no such key", EXPECTED);
        return None;
    };
    if matches!(&node.value, super::document::Value::Text(text) if &**text == "free") {
        return Some((End::Free, 0.0));
    }
    if !matches!(&node.value, super::document::Value::Table(_)) {
        chain.problem(key, node.describe(), EXPECTED);
        return None;
    }
    let table = chain.table(key)?;
    let found = match (table.has("wall"), table.has("force")) {
        (true, false) => {
            let wall = materials.named(&table, "wall");
            let preload = table.quantity("preload", Dimension::FORCE, Bound::NotNegative);
            wall.map(|wall| (End::Wall(wall.elasticity), preload.unwrap_or(0.0)))
        }
        (false, true) => table
            .quantity("force", Dimension::FORCE, Bound::NotNegative)
            .map(|force| (End::Force(force), 0.0)),
        _ => {
            chain.problem(key, node.describe(), EXPECTED);
            return None;
        }
    };
    table.finish();
    found
}

/// Refuses a preload at the bottom: there the loads above decide what the wall bears.
pub fn no_preload_at_the_bottom(chain: &TableReader<'_>) {
    let bottom = chain.node("bottom").map(|node| &node.value);
    let Some(super::document::Value::Table(table)) = bottom else { return };
    if let Some(entry) = table.get("preload") {
        let found = "a preload of the wall at the bottom".to_owned();
        let expected = "a preload of a wall at the top, or { force = \"<force>\" } there";
        chain.problem_at(&entry.node.place, "bottom.preload", found, expected.to_owned());
    }
}

/// Initial velocity of each body: the striker's, and `[[initial_velocities]]` (m/s).
pub fn initial_velocities(
    root: &TableReader<'_>,
    striker: Option<&Striker>,
    particles: usize,
) -> Vec<f64> {
    let first = usize::from(striker.is_some());
    let mut velocities = vec![0.0; particles + first];
    if let (Some(striker), Some(velocity)) = (striker, velocities.first_mut()) {
        *velocity = striker.speed;
    }
    let mut given = BTreeSet::new();
    let mut all_read = particles > 0;
    for table in root.list("initial_velocities") {
        if !table.has("particle") {
            table.problem("particle", "no such key", "a particle, counted from 1 at the top");
        }
        let particle = table.count("particle", 1, last_particle(particles));
        if let Some(number) = particle.filter(|number| !given.insert(*number)) {
            let found = format!("a second velocity of particle {number}");
            table.problem("particle", found, "one velocity for each particle");
        }
        let velocity = table.required("velocity", Dimension::SPEED, Bound::VELOCITY);
        let place = particle.and_then(|p| usize::try_from(p).ok()).map(|p| p - 1 + first);
        match (velocity, place.and_then(|p| velocities.get_mut(p))) {
            (Some(velocity), Some(slot)) => *slot = velocity,
            _ => all_read = false,
        }
        table.finish();
    }
    let still = velocities.iter().all(|v| *v == 0.0) && !root.has("striker");
    if still && (all_read || !root.has("initial_velocities")) {
        root.problem("", "nothing moves: add a [striker] or [[initial_velocities]]", "");
    }
    velocities
}

/// Puts the chain together; what does not fit is a problem of `[chain]`, or of the magnet among the
/// `effects`.
pub fn assemble(
    spec: &ChainSpec,
    chain: &TableReader<'_>,
    effects: Option<&TableReader<'_>>,
) -> Option<Chain> {
    match Chain::new(spec) {
        Ok(built) if built.contacts().iter().all(|contact| contact.stiffness == 0.0) => {
            let expected = "a striker, a wall or a second particle for it to touch";
            chain.problem("segments", "a single particle that touches nothing", expected);
            None
        }
        Ok(built) => Some(built),
        Err(error) => {
            let text = error.to_string();
            let key = match error {
                ChainError::StrikerBehindWall => "top",
                ChainError::Unbalanced { .. } => "bottom",
                _ => "segments",
            };
            let magnet = effects.filter(|_| error.concerns_magnet());
            match magnet.and_then(|effects| effects.table("magnet_preload")) {
                Some(magnet) => magnet.problem("distance", text, ""),
                None => chain.problem(key, text, ""),
            }
            None
        }
    }
}

/// Names of the bodies that touch, from the top; none where the chain could not be read.
pub fn pairs<'a>(kinds: &[&'a str], striker: bool, ends: [bool; 2]) -> Vec<(&'a str, &'a str)> {
    let [top, bottom] = ends;
    if kinds.is_empty() {
        return Vec::new();
    }
    let above = if striker { Some("striker") } else { top.then_some("wall") };
    let below = bottom.then_some("wall");
    let names = above.into_iter().chain(kinds.iter().copied()).chain(below);
    let names: Vec<&str> = names.collect();
    names.windows(2).map(|pair| (pair[0], pair[1])).collect()
}
