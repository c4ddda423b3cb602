//! Sensors in their places: `[sensors.<name>]`.

use super::bodies::last_particle;
use super::document::Node;
use super::library;
use super::reader::{Bound, Problems, Table};
use crate::quantity::Dimension;
use crate::sensor::Sensor;

/// Where a sensor sits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Site {
    /// Embedded in a particle, counted from 1.
    Particle(usize),
    /// Between the last particle and the wall.
    Wall,
}

/// A sensor in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSensor {
    /// Name in the scene.
    pub name: String,
    /// Where it sits.
    pub site: Site,
    /// Distance from the particle's centre in particle lengths, downward positive; 0.5 feels the contact below alone (1).
    pub offset: f64,
    /// The sensor itself.
    pub sensor: Sensor,
}

/// What the checks need to know of the chain.
pub struct Hosts<'a> {
    /// Kind of each particle, from the top; empty where that is not known.
    pub kinds: &'a [&'a str],
    /// Whether a wall stands at the bottom.
    pub wall: bool,
}

/// Reads `[sensors.<name>]`, in the order of where they sit.
pub fn sensors(root: &Table<'_>, hosts: &Hosts<'_>, problems: &Problems) -> Vec<PlacedSensor> {
    let mut sensors: Vec<PlacedSensor> = root
        .tables("sensors")
        .into_iter()
        .filter_map(|(name, table)| {
            let placed = sensor(name, &table, hosts, problems);
            table.finish();
            placed
        })
        .collect();
    let order = |sensor: &PlacedSensor| match sensor.site {
        Site::Particle(particle) => (particle, sensor.name.clone()),
        Site::Wall => (usize::MAX, sensor.name.clone()),
    };
    sensors.sort_by_key(order);
    sensors
}

fn sensor(
    name: &str,
    table: &Table<'_>,
    hosts: &Hosts<'_>,
    problems: &Problems,
) -> Option<PlacedSensor> {
    let place = site(table, hosts);
    let offset = table.quantity("offset", Dimension::NONE, Bound::Within(-0.5, 0.5)).unwrap_or(0.0);
    let model = table.text("model").unwrap_or(name).to_owned();
    let _ = table.text("source");
    let ceramic = ceramic(table, problems);
    let side = table.required("side", Dimension::LENGTH, Bound::Positive);
    let thickness = table.required("thickness", Dimension::LENGTH, Bound::Positive);
    let cable = table.required("cable_capacitance", Dimension::CAPACITANCE, Bound::NotNegative);
    let leak = table.quantity("leak_resistance", Dimension::RESISTANCE, Bound::Positive);
    let (relative_permittivity, d33) = ceramic?;
    let sensor = Sensor {
        model,
        d33,
        relative_permittivity,
        side: side?,
        thickness: thickness?,
        cable_capacitance: cable?,
        leak_resistance: leak.unwrap_or(f64::INFINITY),
    };
    Some(PlacedSensor { name: name.to_owned(), site: place?, offset, sensor })
}

fn site(table: &Table<'_>, hosts: &Hosts<'_>) -> Option<Site> {
    let wall = table.flag("wall").unwrap_or(false);
    let last = hosts.kinds.len();
    let host = table.text("host");
    if wall {
        if table.node("particle").is_some() || table.has("offset") {
            table.problem(
                "wall",
                "both `wall` and `particle` or `offset`",
                "one place for a sensor",
            );
        }
        if !hosts.wall {
            table.problem("wall", "a sensor at the wall", "a chain whose bottom is a wall");
            return None;
        }
        return Some(Site::Wall);
    }
    if !table.has("particle") {
        let _ = table.node("particle");
        table.problem(
            "particle",
            "no such key",
            format!("a particle from 1 to {last}, or wall = true"),
        );
        return None;
    }
    let particle = usize::try_from(table.count("particle", 1, last_particle(last))?).ok()?;
    let kind = hosts.kinds.get(particle - 1).copied();
    if let Some((host, kind)) = host.zip(kind).filter(|(host, kind)| host != kind) {
        table.problem(
            "host",
            format!("\"{host}\""),
            format!("\"{kind}\", which particle {particle} is"),
        );
    }
    Some(Site::Particle(particle))
}

/// Relative permittivity and d33, from the named ceramic or typed directly.
fn ceramic(table: &Table<'_>, problems: &Problems) -> Option<(f64, f64)> {
    let named = table.text("ceramic").and_then(|name| {
        let place = table.place_of("ceramic");
        match library::instrument("piezoceramics", name, place, &table.path_of("ceramic")) {
            Ok(node) => Some(node),
            Err(found) => {
                problems.extend(found);
                None
            }
        }
    });
    if table.has("ceramic") && named.is_none() {
        return None;
    }
    let from_file = named.as_ref().and_then(|node| constants_of(node, problems));
    let bound = Bound::Positive;
    if let Some((permittivity, d33)) = from_file {
        let typed = table.quantity("relative_permittivity", Dimension::NONE, bound);
        let typed_d33 = table.quantity("d33", Dimension::CHARGE_PER_FORCE, bound);
        return Some((typed.unwrap_or(permittivity), typed_d33.unwrap_or(d33)));
    }
    let permittivity = table.required("relative_permittivity", Dimension::NONE, bound);
    let d33 = table.required("d33", Dimension::CHARGE_PER_FORCE, bound);
    Some((permittivity?, d33?))
}

fn constants_of(node: &Node, problems: &Problems) -> Option<(f64, f64)> {
    let table = Table::of(node, "", problems)?;
    let _ = table.text("source");
    let permittivity = table.required("relative_permittivity", Dimension::NONE, Bound::Positive);
    let d33 = table.required("d33", Dimension::CHARGE_PER_FORCE, Bound::Positive);
    table.finish();
    Some((permittivity?, d33?))
}

/// Names of the sensors as typed, those included that could not be read.
pub fn sensor_names<'a>(root: &Table<'a>) -> Vec<&'a str> {
    root.tables("sensors").into_iter().map(|(name, _)| name).collect()
}
