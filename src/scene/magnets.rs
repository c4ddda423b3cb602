//! Reads the files of `instruments/magnets`: a constant force, a ring with its sphere, or a
//! measured table.

use std::path::Path;

use super::library;
use super::problem::SceneError;
use super::problems::Problems;
use super::table::{Bound, TableReader, count, list_of, positive, quantity, table};
use crate::magnet::{ForceLaw, ForceTable, Magnet, RingMagnet, Sphere};
use crate::quantity::Dimension;

/// The required key of each kind of magnet.
const KINDS: [&str; 3] = ["force", "outer_diameter", "measured"];

table! {
    /// A ring magnet and the sphere that it attracts.
    pub struct RingKeys<'a> {
        outer_diameter: f64 = positive(Dimension::LENGTH).required(),
        inner_diameter: f64 = positive(Dimension::LENGTH).required(),
        length: f64 = positive(Dimension::LENGTH).required(),
        remanence: f64 = positive(Dimension::MAGNETIC_FLUX_DENSITY).required(),
        remanence_coefficient: f64 = quantity(Dimension::PER_TEMPERATURE, Bound::Any).required(),
        reference_temperature: f64 = positive(Dimension::TEMPERATURE).required(),
        curie_temperature: f64 = positive(Dimension::TEMPERATURE),
        sphere_diameter: f64 = positive(Dimension::LENGTH).required(),
        sphere_saturation: f64 = positive(Dimension::MAGNETIC_FLUX_DENSITY).required(),
    }
}

table! {
    /// A measured force over distance.
    pub struct TableKeys<'a> {
        measured: Vec<TableReader<'a>> = list_of(&[PointKeys::KEYS]),
    }
}

table! {
    /// One of `[[measured]]`.
    pub struct PointKeys<'a> {
        distance: f64 = quantity(Dimension::LENGTH, Bound::Any).required(),
        force: f64 = quantity(Dimension::FORCE, Bound::Any).required(),
    }
}

table! {
    /// A magnet's file beside the magnet itself.
    struct FileKeys<'a> {
        force: f64 = quantity(Dimension::FORCE, Bound::FORCE),
        // A suggestion: the scene decides.
        particle: u32 = count(1, 1_000_000),
    }
}

/// Names of the included magnets.
pub fn names() -> Vec<&'static str> {
    crate::data::instrument_names("magnets")
}

/// Loads an included magnet, by name, or a file, by path.
///
/// # Errors
/// [`SceneError`]: no such magnet, not readable, or every problem found in its file.
pub fn load(name: &str) -> Result<Magnet, SceneError> {
    const WHAT: &str = "the magnet's file";
    let node = library::open("magnets", Path::new(name)).map_err(|error| error.in_file(WHAT))?;
    let node = node.ok_or_else(|| library::no_instrument("magnets", name))?;
    let problems = Problems::default();
    let keys = &[FileKeys::KEYS, RingKeys::KEYS, TableKeys::KEYS];
    let magnet = TableReader::of(&node, "", keys, &problems).and_then(|table| read(name, &table));
    problems.finish(magnet).map_err(|problems| SceneError::InFile { what: WHAT, problems })
}

fn read(name: &str, table: &TableReader<'_>) -> Option<Magnet> {
    let file = FileKeys::read(table);
    let found: Vec<&str> = KINDS.into_iter().filter(|key| table.has(key)).collect();
    let law = match found.as_slice() {
        ["force"] => file.force.map(ForceLaw::Constant),
        ["outer_diameter" | "measured"] => law(table),
        _ => {
            let expected = "one of force, outer_diameter and measured";
            table.problem("", format!("{} of them", found.len()), expected);
            return None;
        }
    };
    let source = table.node("source").and_then(|node| node.as_text()).unwrap_or_default();
    Some(Magnet { name: name.to_owned(), source: source.to_owned(), law: law? })
}

/// A ring or a measured table.
pub(super) fn law(table: &TableReader<'_>) -> Option<ForceLaw> {
    if table.has("outer_diameter") { ring(table) } else { measured(table) }
}

fn ring(table: &TableReader<'_>) -> Option<ForceLaw> {
    let keys = RingKeys::read(table);
    if let (Some(outer), Some(inner)) = (keys.outer_diameter, keys.inner_diameter)
        && inner >= outer
    {
        table.problem("inner_diameter", format!("{inner} m"), format!("less than {outer} m"));
    }
    let ring = RingMagnet {
        inner_radius: 0.5 * keys.inner_diameter?,
        outer_radius: 0.5 * keys.outer_diameter?,
        length: keys.length?,
        remanence: keys.remanence?,
        temperature_coefficient: keys.remanence_coefficient?,
        reference_temperature: keys.reference_temperature?,
        curie_temperature: keys.curie_temperature.unwrap_or(f64::INFINITY),
    };
    let radius = 0.5 * keys.sphere_diameter?;
    Some(ForceLaw::Ring(ring, Sphere { radius, saturation: keys.sphere_saturation? }))
}

fn measured(table: &TableReader<'_>) -> Option<ForceLaw> {
    let rows = TableKeys::read(table).measured?;
    let mut points = Vec::new();
    for row in &rows {
        let point = PointKeys::read(row);
        points.extend(point.distance.zip(point.force));
    }
    if points.len() < rows.len() {
        return None;
    }
    match ForceTable::new(&points) {
        Ok(measured) => Some(ForceLaw::Measured(measured)),
        Err(error) => {
            table.problem("measured", error.to_string(), "points in the order of distance");
            None
        }
    }
}
