//! Materials, particles, chain and striker: the part of a scene that moves.

use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::PI;

use super::document::{Node, Value};
use super::library;
use super::problem::one_of;
use super::table::{Bound, Key, Places, TableReader};
use super::table::{any, count, list_of, quantity, table, table_of, text, texts, word, words};
use crate::chain::hertz::YIELD_PRESSURE_FACTOR;
use crate::chain::{Backing, Body, Chain, ChainError, ChainSpec, Elasticity, End, Support};
use crate::note::Note;
use crate::quantity::{Dimension, engineering};

/// Most particles of a chain: a recording has a topic for each bead and each contact, and room for
/// 65535.
const MAX_PARTICLES: usize = 30_000;
/// A body wider than this is noted: it has probably the wrong unit (m).
const LARGE_BODY: f64 = 0.1;
/// A mass that differs from that of its shape and its material's density by more than this factor
/// is noted. Holes and wrong diameters make less, wrong units and materials more (1).
const MAX_MASS_RATIO: f64 = 1.3;
const END: &str = "\"free\", { wall = \"<material>\" }, { rod = \"<material>\", diameter = \"<length>\" }, { plate = \"<material>\", thickness = \"<length>\" } or { force = \"<force>\" }";
const A_MATERIAL: &str = "the name of a material";

table! {
    /// `[materials.NAME]`, and the files of `instruments/materials`.
    pub struct MaterialKeys<'a> {
        youngs_modulus: f64 = quantity(Dimension::PRESSURE, Bound::MODULUS).required(),
        poissons_ratio: f64 = quantity(Dimension::NONE, Bound::Between(-1.0, 0.5)).required(),
        /// needed for bodies without a mass
        density: f64 = quantity(Dimension::DENSITY, Bound::DENSITY),
        /// in slow uniaxial loading; default: unknown, contacts stay elastic
        yield_strength: f64 = quantity(Dimension::PRESSURE, Bound::Positive),
        /// instead: pressure in the middle of a contact that begins to yield, 1.6 times that
        yield_pressure: f64 = quantity(Dimension::PRESSURE, Bound::Positive),
    }
}

table! {
    /// A body: a diameter makes a sphere, a height in addition a cylinder with flat faces; without
    /// either the faces are flat and the length is zero.
    pub struct BodyKeys<'a> {
        /// `hertzscope list materials`, or [materials.NAME] below
        material: &'a str = text().required().needs(A_MATERIAL),
        /// makes a sphere; a striker without it has a flat face
        diameter: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        /// makes it a cylinder with flat faces
        height: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        /// of a cylinder that lies across the chain, around the chain's axis, in degrees
        axis_deg: f64 = quantity(Dimension::NONE, Bound::Within(-180.0, 180.0)),
        /// default: that of shape and density
        mass: f64 = quantity(Dimension::MASS, Bound::MASS),
    }
}

table! {
    /// `[striker]` beside its body.
    pub struct StrikerKeys<'a> {
        /// instead of these keys: `hertzscope list strikers`, or a file
        model: &'a str = text(),
        /// at the first contact
        speed: f64 = quantity(Dimension::SPEED, Bound::SPEED).required(),
    }
}

table! {
    /// `[chain]`.
    pub struct ChainKeys<'a> {
        /// a preload by a weight that follows; or "free", or a wall:
        top: &'a Node = any(&[EndKeys::KEYS]).required().needs(END),
        /// or "free", or { force = "1.2 N" }
        bottom: &'a Node = any(&[EndKeys::KEYS]).required().needs(END),
        /// or "lying": across gravity, which then has no part in it
        orientation: Orientation = word::<Orientation>().or("standing"),
        segments: Vec<TableReader<'a>> = list_of(&[SegmentKeys::KEYS]),
    }
}

/// How the chain is set up.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Orientation {
    /// Along gravity.
    Standing,
    /// Across it.
    Lying,
}

words! { Orientation { "standing" => Standing, "vertical" => Standing, "lying" => Lying, "horizontal" => Lying } }

table! {
    /// One end of the chain.
    pub struct EndKeys<'a> {
        wall: &'a str = text(),
        /// the flat end of a rod, which gives way by its impedance; or
        rod: &'a str = text(),
        /// a wide plate
        plate: &'a str = text(),
        /// of the rod
        diameter: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        /// of the rod, whose far end returns an echo; default: none returns
        length: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        /// of the rod: "free" or "held"; default: "free"
        far_end: FarEnd = word::<FarEnd>(),
        /// of the plate
        thickness: f64 = quantity(Dimension::LENGTH, Bound::LENGTH),
        force: f64 = quantity(Dimension::FORCE, Bound::FORCE),
        preload: f64 = quantity(Dimension::FORCE, Bound::FORCE),
    }
}

table! {
    /// One of `[[chain.segments]]`.
    pub struct SegmentKeys<'a> {
        /// kinds, in order
        particles: Places<'a> = texts(),
        /// how often this row comes
        repeat: usize = count(1, MAX_PARTICLES as u64).or("1"),
        /// in even steps, for a row of one kind; mass goes with the cube of the diameter
        diameter: TaperKeys<'a> = table_of(&[TaperKeys::KEYS])
            .needs("{ from = \"10 mm\", to = \"5 mm\" }"),
        /// instead: each repetition is so many times as large as the one before
        factor: f64 = quantity(Dimension::NONE, Bound::Positive),
    }
}

table! {
    /// Diameters of the first and last repetition of a row.
    pub struct TaperKeys<'a> {
        from: f64 = quantity(Dimension::LENGTH, Bound::LENGTH).required(),
        to: f64 = quantity(Dimension::LENGTH, Bound::LENGTH).required(),
    }
}

table! {
    /// One of `[[initial_velocities]]`.
    pub struct VelocityKeys<'a> {
        particle: &'a Node =
            particle_number().required().needs("a particle, counted from 1 at the top"),
        /// downward positive
        velocity: f64 = quantity(Dimension::SPEED, Bound::VELOCITY).required(),
    }
}

/// Looks materials up, in the scene first and among the instruments then.
pub struct Materials {
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

impl Materials {
    /// Reads `[materials.NAME]`.
    pub fn read(tables: &[(&str, TableReader<'_>)]) -> Self {
        let own = tables.iter().map(|(name, table)| ((*name).to_owned(), material(table)));
        Self { own: own.collect(), notes: RefCell::default() }
    }

    /// Notes on masses that do not go with density and shape.
    pub fn into_notes(self) -> Vec<Note> {
        self.notes.into_inner()
    }

    /// The material `name`, which `table` has under `key`.
    fn named(&self, table: &TableReader<'_>, key: &str, name: Option<&str>) -> Option<Material> {
        let name = name?;
        if let Some(own) = self.own.get(name) {
            return *own;
        }
        // Looking for thousands of files that do not exist takes minutes.
        if table.problems().is_full() {
            return None;
        }
        match library::instrument("materials", name, table.place_of(key), &table.path_of(key)) {
            Ok(node) => {
                material(&TableReader::of(&node, "", &[MaterialKeys::KEYS], table.problems())?)
            }
            Err(problems) => {
                table.problems().extend(problems);
                None
            }
        }
    }
}

fn material(table: &TableReader<'_>) -> Option<Material> {
    let keys = MaterialKeys::read(table);
    let elasticity =
        Elasticity { youngs_modulus: keys.youngs_modulus?, poissons_ratio: keys.poissons_ratio? };
    if table.has("yield_strength") && table.has("yield_pressure") {
        table.problem("yield_pressure", "both yield_strength and yield_pressure", "one of them");
    }
    let by_pressure = keys.yield_pressure.map(|pressure| pressure / YIELD_PRESSURE_FACTOR);
    let yield_strength = keys.yield_strength.or(by_pressure);
    Some(Material { elasticity, yield_strength, density: keys.density })
}

/// Reads a body, and its diameter if it has one (m); without a mass it has that of the shape and
/// the material's density. `is_round` if it needs a diameter.
fn body(
    table: &TableReader<'_>,
    name: &str,
    materials: &Materials,
    is_round: bool,
) -> Option<(Body, Option<f64>)> {
    let keys = BodyKeys::read(table);
    if is_round {
        table.require(BodyKeys::KEYS, "diameter");
    }
    let material = materials.named(table, "material", keys.material);
    let (diameter, height) = (keys.diameter, keys.height);
    // Without its shape, a body would look flat or round where it is neither.
    let unread = |key, value: Option<f64>| value.is_none() && table.has(key);
    if unread("diameter", diameter) || unread("height", height) || (is_round && diameter.is_none())
    {
        return None;
    }
    let axis = keys.axis_deg.map(f64::to_radians);
    if axis.is_some() && (diameter.is_none() || height.is_none()) {
        let expected = "diameter and height, which make it a cylinder";
        table.problem("axis_deg", "the axis of a body that is no cylinder", expected);
        return None;
    }
    let (length, curvature) = match (diameter, height) {
        (Some(diameter), Some(_)) if axis.is_some() => (diameter, 2.0 / diameter),
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
    let mass = if table.has("mass") { keys.mass } else { solid };
    // A material that could not be read has left its problem.
    if solid.is_none() && material.is_some() {
        table.require(BodyKeys::KEYS, "mass");
    }
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
    let body = Body {
        name: name.into(),
        mass: mass?,
        length,
        curvature,
        axis,
        elasticity,
        yield_strength,
    };
    Some((body, diameter))
}

/// The striker and its speed (m/s).
pub struct Striker {
    /// The body.
    pub body: Body,
    /// Speed at first contact (m/s).
    pub speed: f64,
}

/// Reads `[striker]`.
pub fn striker(table: &TableReader<'_>, materials: &Materials) -> Option<Striker> {
    let keys = StrikerKeys::read(table);
    let body = body(table, "striker", materials, false);
    Some(Striker { body: body?.0, speed: keys.speed? })
}

/// The particles in order, each with its kind.
#[derive(Default)]
pub struct Particles<'a> {
    /// Bodies from the top; a kind that could not be read is missing.
    pub bodies: Vec<Body>,
    /// Length of each body over that of its kind; 0 where a taper states it instead (1).
    pub scales: Vec<f64>,
    /// Kind of each place, from the top; empty if a segment could not be read.
    pub kinds: Vec<&'a str>,
}

/// The number of a particle, which [`particle_in`] checks.
pub const fn particle_number() -> Key {
    count(1, MAX_PARTICLES as u64)
}

/// Number of the particle that the key `particle` names with the value `node`. `particles` is the
/// length of the chain, 0 if it is not known.
pub fn particle_in(
    table: &TableReader<'_>,
    node: Option<&Node>,
    particles: usize,
) -> Option<usize> {
    let last = if particles == 0 { MAX_PARTICLES } else { particles };
    match node?.value {
        Value::Number { value, whole: true, .. } if (1.0..=last as f64).contains(&value) => {
            Some(value as usize)
        }
        _ => {
            let expected = format!("a whole number from 1 to {last}");
            table.problem("particle", node?.describe(), expected);
            None
        }
    }
}

/// Reads `[particles.KIND]` and the segments of the chain.
pub fn particles<'a>(
    kinds: &[(&str, TableReader<'_>)],
    chain: Option<&ChainKeys<'a>>,
    materials: &Materials,
) -> Particles<'a> {
    let mut known = BTreeMap::new();
    for (name, table) in kinds {
        let kind = body(table, name, materials, true);
        known.insert(*name, kind.and_then(|(body, diameter)| Some((body, diameter?))));
    }
    let mut particles = Particles::default();
    let Some(chain) = chain else { return particles };
    let mut complete = true;
    for table in chain.segments.iter().flatten() {
        let segment = SegmentKeys::read(table);
        let names = segment.particles.as_deref().unwrap_or_default();
        complete &= segment.repeat.is_some() && !names.is_empty();
        for (name, place) in names.iter().filter(|(name, _)| !known.contains_key(name)) {
            if !table.problems().takes_more() {
                continue;
            }
            let expected = format!("a kind of particle: {}", one_of(known.keys()));
            table.problem_at(place, "particles", format!("\"{name}\""), expected);
        }
        let sizes = sizes(&segment, names, &known);
        complete &= sizes.is_some();
        let sizes = sizes.unwrap_or_default();
        let repeat = segment.repeat.unwrap_or(1);
        if particles.kinds.len() + repeat.saturating_mul(names.len()) > MAX_PARTICLES {
            let expected = format!("at most {MAX_PARTICLES} particles");
            table.problem("repeat", "a longer chain", expected);
            complete = false;
        } else {
            for size in (0..repeat).map(|row| sizes.get(row).copied().unwrap_or(1.0)) {
                for (name, _) in names {
                    particles.kinds.push(name);
                    let kind = known.get(name).and_then(Option::as_ref);
                    let Some((body, _)) = kind else { continue };
                    particles.bodies.push(body.scaled(size));
                    particles.scales.push(if segment.diameter.is_some() { 0.0 } else { size });
                }
            }
        }
        if !table.has("particles") || table.is_empty_list("particles") {
            table.problem("particles", "no particles", "a list of kinds of particles");
        }
    }
    if !chain.table.has("segments") || chain.table.is_empty_list("segments") {
        chain.table.problem("segments", "no particles", "at least one [[chain.segments]]");
    }
    if !complete {
        // How long the chain was meant to be is not known, so nothing can be said against a
        // particle's number.
        particles.kinds.clear();
    }
    particles
}

/// Size of each repetition of a row relative to its kinds; empty if all are alike, `None` if it is
/// wrong. `diameter = { from, to }` changes it in even steps, `factor` by that factor each time. A
/// body scales as a whole: its length with the size, its mass with the cube.
fn sizes(
    segment: &SegmentKeys<'_>,
    names: &[(&str, &super::document::SourceLocation)],
    kinds: &BTreeMap<&str, Option<(Body, f64)>>,
) -> Option<Vec<f64>> {
    let table = &segment.table;
    let diameters: Vec<Option<f64>> = names
        .iter()
        .map(|(name, _)| kinds.get(name)?.as_ref().map(|(_, diameter)| *diameter))
        .collect();
    let repeat = segment.repeat.unwrap_or(1);
    let rows = (0..repeat).map(|row| row as f64);
    match (table.has("diameter"), table.has("factor")) {
        (false, false) => Some(Vec::new()),
        (true, true) => {
            table.problem("factor", "both `diameter` and `factor`", "one of them");
            None
        }
        (false, true) => {
            let factor = segment.factor?;
            let sizes: Vec<f64> = rows.map(|row| factor.powf(row)).collect();
            for size in sizes.last().into_iter().chain(sizes.first()) {
                size_fits(table, *size, &diameters)?;
            }
            Some(sizes)
        }
        (true, false) => {
            let taper = segment.diameter.as_ref()?;
            let (from, to) = (taper.from?, taper.to?);
            let [diameter] = diameters.as_slice() else {
                let found = format!("a taper of {} kinds", diameters.len());
                table.problem("diameter", found, "one kind in `particles`, or `factor`");
                return None;
            };
            if repeat < 2 {
                table.problem("diameter", "a taper of a single row", "`repeat` of 2 or more");
                return None;
            }
            let steps = (repeat - 1) as f64;
            // A kind that could not be read has left its problem.
            let own = diameter.unwrap_or(from);
            Some(rows.map(|row| (from + (to - from) * row / steps) / own).collect())
        }
    }
}

/// Refuses particles that would be too small or too large.
fn size_fits(table: &TableReader<'_>, size: f64, diameters: &[Option<f64>]) -> Option<()> {
    for diameter in diameters.iter().flatten().map(|diameter| size * diameter) {
        if !Bound::LENGTH.holds(diameter) {
            let found = format!("particles of {diameter:.3e} m");
            let expected = format!("a length{}", Bound::LENGTH.broken_by(diameter));
            table.problem("factor", found, expected);
            return None;
        }
    }
    Some(())
}

/// The far end of a rod.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FarEnd {
    /// Free: what returns has the sign of what departed.
    Free,
    /// Held: it has the other sign.
    Held,
}

words! { FarEnd { "free" => Free, "held" => Held } }

/// A rod behind a wall: its speed of sound (m/s), and its length where its far end counts (m).
pub type Rod = (f64, Option<f64>);

/// An end of the chain as read.
pub struct ReadEnd {
    /// What stands there.
    pub end: End,
    /// Force by which a wall presses (N).
    pub preload: f64,
    /// What is behind a wall.
    pub support: Support,
    /// A rod behind it.
    pub rod: Option<Rod>,
}

/// An end of the chain, `"free"`, `{ wall = "steel" }`, `{ rod = "steel", diameter = "5 mm" }`,
/// `{ plate = "steel", thickness = "3 mm" }` or `{ force = "2 N" }`.
pub fn end(
    chain: &TableReader<'_>,
    key: &str,
    node: Option<&Node>,
    materials: &Materials,
) -> Option<ReadEnd> {
    let node = node?;
    let rigid = |end, preload| Some(ReadEnd { end, preload, support: Support::Rigid, rod: None });
    if matches!(&node.value, Value::Text(text) if &**text == "free") {
        return rigid(End::Free, 0.0);
    }
    let wrong = || {
        chain.problem(key, node.describe(), END);
        None
    };
    if !matches!(&node.value, Value::Table(_)) {
        return wrong();
    }
    let table = TableReader::of(node, &chain.path_of(key), &[EndKeys::KEYS], chain.problems())?;
    let end = EndKeys::read(&table);
    let given: Vec<&str> =
        ["wall", "rod", "plate", "force"].into_iter().filter(|key| table.has(key)).collect();
    let [kind] = given.as_slice() else { return wrong() };
    let takes: &[&str] = match *kind {
        "wall" => &["preload"],
        "rod" => &["diameter", "length", "far_end", "preload"],
        "plate" => &["thickness", "preload"],
        _ => &[],
    };
    for key in ["diameter", "length", "far_end", "thickness", "preload"] {
        if table.has(key) && !takes.contains(&key) {
            table.problem(key, format!("`{key}` beside `{kind}`"), END);
        }
    }
    let preload = end.preload.unwrap_or(0.0);
    match *kind {
        "wall" => {
            let wall = materials.named(&table, "wall", end.wall)?;
            rigid(End::Wall(wall.elasticity), preload)
        }
        "force" => end.force.and_then(|force| rigid(End::Force(force), 0.0)),
        _ => {
            let material = materials.named(&table, kind, end.rod.or(end.plate))?;
            let Elasticity { youngs_modulus, poissons_ratio } = material.elasticity;
            let Some(density) = material.density else {
                let found = "a material without a density";
                table.problem(kind, found, "one with a density, for its impedance");
                return None;
            };
            let backing = if *kind == "rod" {
                table.require(EndKeys::KEYS, "diameter");
                let section = 0.25 * PI * end.diameter?.powi(2);
                let reflection = if end.far_end == Some(FarEnd::Held) { -1.0 } else { 1.0 };
                let far_end = end.length.map(|length| (length, reflection));
                Backing::rod(section, youngs_modulus, density, far_end)
            } else {
                table.require(EndKeys::KEYS, "thickness");
                Backing::plate(end.thickness?, youngs_modulus, poissons_ratio, density)
            };
            let length = end.length;
            let end = End::Wall(material.elasticity);
            let speed = (youngs_modulus / density).sqrt();
            let rod = (*kind == "rod").then_some((speed, length));
            Some(ReadEnd { end, preload, support: Support::Yielding(backing), rod })
        }
    }
}

/// Refuses a preload at the bottom: there the loads above decide what the wall bears.
pub fn no_preload_at_the_bottom(chain: &ChainKeys<'_>) {
    let Some(Value::Table(table)) = chain.bottom.map(|node| &node.value) else { return };
    if let Some(entry) = table.get("preload") {
        let found = "a preload of the wall at the bottom".to_owned();
        let expected = "a preload of a wall at the top, or { force = \"<force>\" } there";
        let place = &entry.node.place;
        chain.table.problem_at(place, "bottom.preload", found, expected.to_owned());
    }
}

/// Initial velocity of each body: the striker's, and `[[initial_velocities]]` (m/s).
pub fn initial_velocities(
    root: &TableReader<'_>,
    tables: &[TableReader<'_>],
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
    for table in tables {
        let keys = VelocityKeys::read(table);
        let particle = particle_in(table, keys.particle, particles);
        if let Some(number) = particle.filter(|number| !given.insert(*number)) {
            let found = format!("a second velocity of particle {number}");
            table.problem("particle", found, "one velocity for each particle");
        }
        let place = particle.map(|particle| particle - 1 + first);
        match (keys.velocity, place.and_then(|place| velocities.get_mut(place))) {
            (Some(velocity), Some(slot)) => *slot = velocity,
            _ => all_read = false,
        }
    }
    let still = velocities.iter().all(|v| *v == 0.0) && !root.has("striker") && !root.has("drive");
    if still && (all_read || !root.has("initial_velocities")) {
        let found = "nothing moves: add a [striker], a [drive] or [[initial_velocities]]";
        root.problem("", found, "");
    }
    velocities
}

/// Puts the chain together; a body that does not fit is a problem of `[chain]`, or of the magnet.
pub fn assemble(
    spec: &ChainSpec,
    chain: &TableReader<'_>,
    magnet: Option<&TableReader<'_>>,
) -> Option<Chain> {
    match Chain::new(spec) {
        Ok(built) if built.contacts().iter().all(|contact| contact.stiffness == 0.0) => {
            let expected = "a striker, a wall or a second particle for it to touch";
            chain.problem("segments", "a single particle that touches nothing", expected);
            None
        }
        Ok(built) => Some(built),
        Err(error) => {
            let (text, concerns_magnet) = (error.to_string(), error.concerns_magnet());
            let key = match error {
                ChainError::StrikerBehindWall => "top",
                ChainError::Unbalanced { .. } => "bottom",
                _ => "segments",
            };
            match magnet.filter(|_| concerns_magnet) {
                Some(magnet) => magnet.problem("distance", text, ""),
                None => chain.problem(key, text, ""),
            }
            None
        }
    }
}

/// Names of the bodies that touch, from the top; none if the chain could not be read.
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
