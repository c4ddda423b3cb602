//! A laboratory for momentum tests: strikers, heights, instruments, and their uncertainties.

use std::path::Path;

use super::{GRAVITY, GainKeys, SHARE, gain_of, uncertain};
use crate::quantity::{Dimension, Uncertain, parse};
use crate::scene::document::Node;
use crate::scene::library;
use crate::scene::problem::{MISSING, SceneError};
use crate::scene::problems::Problems;
use crate::scene::table::{Bound, NamedTables, Places, TableReader, quantity};
use crate::scene::table::{any, not_negative, positive, table, table_of, tables_of, text, texts};

/// The laboratory without a file: the annotated one with every key.
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

/// How a speed is measured, and its uncertainty.
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

table! {
    /// The file.
    pub struct LabKeys<'a> {
        gravity: f64 = quantity(Dimension::ACCELERATION, GRAVITY).required(),
        gravity_u: &'a Node = any(&[]),
        /// tests drop from each, half and a quarter of it
        heights: Places<'a> = texts(),
        /// or, if light gates measure the speed:
        height_u: f64 = not_negative(Dimension::LENGTH),
        speed_u: f64 = quantity(Dimension::NONE, SHARE),
        /// of the speed after the contact; or one of:
        rebound_u: f64 = quantity(Dimension::NONE, SHARE),
        rebound_height_u: f64 = not_negative(Dimension::LENGTH),
        /// until it lands again
        flight_time_u: f64 = not_negative(Dimension::TIME),
        scope: TableReader<'a> = table_of(&[ScopeKeys::KEYS, GainKeys::KEYS])
            .required()
            .needs("[scope] with model, and gain_u, gain_limit or in_chain"),
        strikers: NamedTables<'a> = tables_of(&[LabStrikerKeys::KEYS]),
    }
}

table! {
    /// `[scope]` beside its gain.
    pub struct ScopeKeys<'a> {
        /// as in a scene: a name that ships, or a file
        model: String =
            text().required().needs("an oscilloscope (`hertzscope list scopes`)"),
    }
}

table! {
    /// `[strikers.NAME]`.
    pub struct LabStrikerKeys<'a> {
        /// of what touches: a name as in scenes
        material: String =
            text().required().needs("a material, e.g. \"stainless_steel\""),
        /// of the sphere that touches
        diameter: f64 = positive(Dimension::LENGTH).required(),
        mass: f64 = quantity(Dimension::MASS, Bound::MASS).required(),
        mass_u: &'a Node = any(&[]),
    }
}

/// Loads the laboratory in `file`, or the included one.
///
/// # Errors
/// [`SceneError`]: not readable, or every problem found in it.
pub fn load(file: Option<&Path>) -> Result<Laboratory, SceneError> {
    const WHAT: &str = "the plan";
    let node = match file {
        Some(file) => library::open_file(file, "a laboratory, e.g. lab.toml"),
        None => library::open(DEFAULT.0, Path::new(DEFAULT.1))
            .and_then(|node| node.ok_or_else(|| library::no_instrument(DEFAULT.0, DEFAULT.1))),
    };
    let node = node.map_err(|error| error.in_file(WHAT))?;
    let problems = Problems::default();
    let lab = read(&node, &problems);
    problems.finish(lab).map_err(|problems| SceneError::InFile { what: WHAT, problems })
}

fn read(node: &Node, problems: &Problems) -> Option<Laboratory> {
    let keys = LabKeys::read(&TableReader::of(node, "", &[LabKeys::KEYS], problems)?);
    let root = &keys.table;
    let gravity = uncertain(root, LabKeys::KEYS, "gravity");
    let heights = heights(root, keys.heights.as_deref().unwrap_or_default());
    let incoming = reading(
        root,
        &[
            ("height_u", keys.height_u.map(SpeedReading::Height)),
            ("speed_u", keys.speed_u.map(SpeedReading::Speed)),
        ],
    );
    let rebound = reading(
        root,
        &[
            ("rebound_u", keys.rebound_u.map(SpeedReading::Speed)),
            ("rebound_height_u", keys.rebound_height_u.map(SpeedReading::Height)),
            ("flight_time_u", keys.flight_time_u.map(SpeedReading::FlightTime)),
        ],
    );
    let gain = keys.scope.as_ref().and_then(gain_of);
    let scope = keys.scope.as_ref().map(ScopeKeys::read);
    let striker = |(name, table): &(&str, TableReader<'_>)| {
        let keys = LabStrikerKeys::read(table);
        let mass = uncertain(table, LabStrikerKeys::KEYS, "mass");
        Some(LabStriker {
            name: (*name).to_owned(),
            material: keys.material?,
            diameter: keys.diameter?,
            mass: mass?,
        })
    };
    let strikers: Vec<LabStriker> = keys.strikers.iter().flatten().filter_map(striker).collect();
    if strikers.is_empty() && !root.has("strikers") {
        root.missing(
            "strikers",
            "at least one [strikers.NAME] with material, diameter, mass, mass_u",
        );
    }
    Some(Laboratory {
        gravity: gravity?,
        heights: heights?,
        incoming: incoming?,
        rebound: rebound?,
        scope: scope?.model?,
        gain,
        strikers,
    })
}

fn heights(
    root: &TableReader<'_>,
    texts: &[(&str, &crate::scene::document::SourceLocation)],
) -> Option<Vec<f64>> {
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

/// The one of several ways to measure a speed that is stated.
fn reading(root: &TableReader<'_>, ways: &[(&str, Option<SpeedReading>)]) -> Option<SpeedReading> {
    let stated: Vec<_> = ways.iter().filter(|(key, _)| root.has(key)).collect();
    let [(_, reading)] = stated.as_slice() else {
        let names: Vec<&str> = ways.iter().map(|(key, _)| *key).collect();
        let what = if stated.is_empty() {
            MISSING.to_owned()
        } else {
            format!("{} of them", stated.len())
        };
        root.problem(ways.first()?.0, what, format!("one of {}", names.join(", ")));
        return None;
    };
    *reading
}
