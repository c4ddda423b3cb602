//! What a laboratory has for a momentum test: strikers, heights, instruments, and how well each is
//! known.

use std::path::Path;

use super::impact::uncertain;
use super::{PlanError, SHARE, gain_of};
use crate::quantity::{Dimension, Uncertain, parse};
use crate::scene::document::Node;
use crate::scene::library;
use crate::scene::problem::{MISSING, SceneError};
use crate::scene::reader::{Bound, Problems, TableReader};

/// Where the laboratory without a file stands: the annotated one with every key.
const DEFAULT: (&str, &str) = ("help", "lab");

/// A striker of a laboratory.
#[derive(Debug, Clone, PartialEq)]
pub struct LabStriker {
    /// Its name.
    pub name: String,
    /// Material of what touches.
    pub material: String,
    /// Diameter of the sphere that touches (m).
    pub diameter: f64,
    /// Mass (kg).
    pub mass: Uncertain,
}

/// How well a speed is measured, by what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpeedReading {
    /// As a speed: its standard uncertainty, relative (1).
    Speed(f64),
    /// As a height: its standard uncertainty (m).
    Height(f64),
    /// As a time of flight: its standard uncertainty (s).
    FlightTime(f64),
}

/// A checked laboratory.
#[derive(Debug, Clone, PartialEq)]
pub struct Laboratory {
    /// Acceleration of free fall (m/s^2).
    pub gravity: Uncertain,
    /// Heights from which strikers may drop (m).
    pub heights: Vec<f64>,
    /// How the speed before the contact is measured.
    pub incoming: SpeedReading,
    /// How the speed after it is measured.
    pub rebound: SpeedReading,
    /// The oscilloscope, as scenes name it.
    pub scope: String,
    /// The scope's gain, true over shown; none where sensor and scope are calibrated as one chain.
    pub gain: Option<Uncertain>,
    /// The strikers.
    pub strikers: Vec<LabStriker>,
}

/// Loads the laboratory in `file`, or the one that ships.
///
/// # Errors
/// [`PlanError`]: not readable, or every problem found in it.
pub fn load(file: Option<&Path>) -> Result<Laboratory, PlanError> {
    let (kind, name) = match file {
        Some(file) if !file.is_file() => {
            return Err(PlanError::Unknown(file.display().to_string()));
        }
        // A bare name is a file here.
        Some(file) => (
            "labs",
            std::path::absolute(file)
                .map_or_else(|_| file.display().to_string(), |f| f.display().to_string()),
        ),
        None => (DEFAULT.0, DEFAULT.1.to_owned()),
    };
    let node = match library::open(kind, &name) {
        Ok(Some(node)) => node,
        Ok(None) => return Err(PlanError::Unknown(name)),
        Err(SceneError::Problems(problems)) => return Err(PlanError::Problems(problems)),
        Err(error) => return Err(PlanError::Read(error)),
    };
    let problems = Problems::default();
    let lab = read(&node, &problems);
    let problems = problems.into_sorted();
    match lab {
        Some(lab) if problems.is_empty() => Ok(lab),
        _ => Err(PlanError::Problems(problems)),
    }
}

fn read(node: &Node, problems: &Problems) -> Option<Laboratory> {
    let root = TableReader::of(node, "", problems)?;
    let gravity = uncertain(&root, ("gravity", "gravity_u"), Dimension::ACCELERATION);
    let heights = heights(&root);
    let incoming =
        reading(&root, "height_u", [("height_u", Dimension::LENGTH), ("speed_u", Dimension::NONE)]);
    let rebound = reading(
        &root,
        "rebound_u",
        [
            ("rebound_u", Dimension::NONE),
            ("rebound_height_u", Dimension::LENGTH),
            ("flight_time_u", Dimension::TIME),
        ],
    );
    let (mut scope, mut gain) = (None, None);
    if let Some(table) = root.table("scope") {
        scope = table
            .required_text("model", "an oscilloscope (`hertzscope list scopes`)")
            .map(str::to_owned);
        gain = gain_of(&table);
        table.finish();
    } else if !root.has("scope") {
        root.problem("scope", MISSING, "[scope] with model, and gain_u, gain_limit or in_chain");
    }
    let mut strikers = Vec::new();
    for (name, table) in root.tables("strikers") {
        let material = table.required_text("material", "a material, e.g. \"stainless_steel\"");
        let diameter = table.required("diameter", Dimension::LENGTH, Bound::Positive);
        let mass = uncertain(&table, ("mass", "mass_u"), Dimension::MASS);
        table.finish();
        if let (Some(material), Some(diameter), Some(mass)) = (material, diameter, mass) {
            strikers.push(LabStriker {
                name: name.to_owned(),
                material: material.to_owned(),
                diameter,
                mass,
            });
        }
    }
    if strikers.is_empty() && !root.has("strikers") {
        root.problem(
            "strikers",
            MISSING,
            "at least one [strikers.NAME] with material, diameter, mass, mass_u",
        );
    }
    root.finish();
    Some(Laboratory {
        gravity: gravity?,
        heights: heights?,
        incoming: incoming?,
        rebound: rebound?,
        scope: scope?,
        gain,
        strikers,
    })
}

fn heights(root: &TableReader<'_>) -> Option<Vec<f64>> {
    let texts = root.texts("heights");
    let found: Vec<f64> = texts
        .iter()
        .filter_map(|(text, _)| parse(text, Dimension::LENGTH).ok().filter(|height| *height > 0.0))
        .collect();
    if found.is_empty() || found.len() < texts.len() {
        let texts: Vec<&str> = texts.iter().map(|(text, _)| *text).collect();
        root.problem(
            "heights",
            format!("[{}]", texts.join(", ")),
            "heights above zero, e.g. [\"5 mm\", \"20 mm\"]",
        );
        return None;
    }
    Some(found)
}

/// The one of `ways` to measure a speed that is stated: a standard uncertainty in its unit.
fn reading<const N: usize>(
    root: &TableReader<'_>,
    first: &str,
    ways: [(&'static str, Dimension); N],
) -> Option<SpeedReading> {
    let stated: Vec<_> = ways.iter().filter(|(key, _)| root.has(key)).collect();
    let found: Vec<Option<f64>> = ways
        .iter()
        .map(|(key, dimension)| {
            let bound = if *dimension == Dimension::NONE { SHARE } else { Bound::NotNegative };
            root.quantity(key, *dimension, bound)
        })
        .collect();
    let [(_, dimension)] = stated.as_slice() else {
        let names: Vec<&str> = ways.iter().map(|(key, _)| *key).collect();
        let what = if stated.is_empty() {
            MISSING.to_owned()
        } else {
            format!("{} of them", stated.len())
        };
        root.problem(first, what, format!("one of {}", names.join(", ")));
        return None;
    };
    let u = found.into_iter().flatten().next()?;
    Some(match *dimension {
        Dimension::LENGTH => SpeedReading::Height(u),
        Dimension::TIME => SpeedReading::FlightTime(u),
        _ => SpeedReading::Speed(u),
    })
}
