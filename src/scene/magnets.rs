//! Reads the files of `instruments/magnets`: a constant force, a ring with its sphere, or a
//! measured table.

use super::document::Node;
use super::library;
use super::problem::{Problem, SceneError, did_you_mean, listed};
use super::reader::{Bound, Problems, TableReader};
use crate::magnet::{ForceLaw, ForceTable, Magnet, RingMagnet, Sphere};
use crate::quantity::Dimension;

/// The required key of each kind of magnet.
const KINDS: [&str; 3] = ["force", "outer_diameter", "measured"];

/// Why there is no magnet.
#[derive(Debug, thiserror::Error)]
pub enum MagnetError {
    /// Neither a shipped magnet nor a file.
    #[error("no magnet or file `{name}`{}; the shipped ones are {}", did_you_mean(name, shipped), shipped.join(", "))]
    Unknown {
        /// The requested name.
        name: String,
        /// The magnets there are.
        shipped: Vec<&'static str>,
    },
    /// The file could not be read.
    #[error(transparent)]
    Read(SceneError),
    /// The file is wrong in at least one place.
    #[error("{}", listed(.0, "the magnet's file"))]
    Problems(Vec<Problem>),
}

/// Names of the magnets that ship with the program.
pub fn names() -> Vec<&'static str> {
    crate::data::instrument_names("magnets")
}

/// Loads a magnet that ships with the program, by name, or a file, by path.
///
/// # Errors
/// [`MagnetError`]: no such magnet, not readable, or every problem found in its file.
pub fn load(name: &str) -> Result<Magnet, MagnetError> {
    let node = match library::open("magnets", name) {
        Ok(Some(node)) => node,
        Ok(None) => return Err(MagnetError::Unknown { name: name.to_owned(), shipped: names() }),
        Err(SceneError::Problems(problems)) => return Err(MagnetError::Problems(problems)),
        Err(error) => return Err(MagnetError::Read(error)),
    };
    let problems = Problems::default();
    let magnet = read(name, &node, &problems);
    let problems = problems.into_sorted();
    match magnet {
        Some(magnet) if problems.is_empty() => Ok(magnet),
        _ => Err(MagnetError::Problems(problems)),
    }
}

fn read(name: &str, node: &Node, problems: &Problems) -> Option<Magnet> {
    let table = TableReader::of(node, "", problems)?;
    let source = table.text("source").unwrap_or_default().to_owned();
    // Which particle it pulls is the scene's business; a file may suggest one.
    let _ = table.count("particle", 1, 1_000_000);
    let found: Vec<&str> = KINDS.into_iter().filter(|key| table.has(key)).collect();
    let law = match found.as_slice() {
        ["force"] => {
            let force = table.required("force", Dimension::FORCE, Bound::NotNegative);
            force.map(ForceLaw::Constant)
        }
        ["outer_diameter" | "measured"] => law(&table),
        _ => {
            for key in KINDS {
                let _ = table.node(key);
            }
            let expected = "one of force, outer_diameter and measured";
            table.problem("", format!("{} of them", found.len()), expected);
            return None;
        }
    };
    table.finish();
    Some(Magnet { name: name.to_owned(), source, law: law? })
}

/// A ring or a measured table.
pub(super) fn law(table: &TableReader<'_>) -> Option<ForceLaw> {
    if table.has("outer_diameter") { ring(table) } else { measured(table) }
}

fn ring(table: &TableReader<'_>) -> Option<ForceLaw> {
    let positive = Bound::Positive;
    let length = |key| table.required(key, Dimension::LENGTH, positive);
    let (outer, inner) = (length("outer_diameter"), length("inner_diameter"));
    if let (Some(outer), Some(inner)) = (outer, inner)
        && inner >= outer
    {
        table.problem("inner_diameter", format!("{inner} m"), format!("less than {outer} m"));
    }
    let (along, sphere) = (length("length"), length("sphere_diameter"));
    let flux = |key| table.required(key, Dimension::MAGNETIC_FLUX_DENSITY, positive);
    let (remanence, saturation) = (flux("remanence"), flux("sphere_saturation"));
    let coefficient =
        table.required("remanence_coefficient", Dimension::PER_TEMPERATURE, Bound::Any);
    let reference = table.required("reference_temperature", Dimension::TEMPERATURE, positive);
    let ring = RingMagnet {
        inner_radius: 0.5 * inner?,
        outer_radius: 0.5 * outer?,
        length: along?,
        remanence: remanence?,
        temperature_coefficient: coefficient?,
        reference_temperature: reference?,
    };
    Some(ForceLaw::Ring(ring, Sphere { radius: 0.5 * sphere?, saturation: saturation? }))
}

fn measured(table: &TableReader<'_>) -> Option<ForceLaw> {
    let rows = table.list("measured");
    let count = rows.len();
    let mut points = Vec::new();
    for row in rows {
        let distance = row.required("distance", Dimension::LENGTH, Bound::Any);
        let force = row.required("force", Dimension::FORCE, Bound::Any);
        row.finish();
        points.extend(distance.zip(force));
    }
    if points.len() < count {
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
