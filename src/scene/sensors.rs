//! Sensors in their places: `[sensors.<name>]`.

use super::bodies::last_particle;
use super::document::Node;
use super::library;
use super::reader::{Bound, Problems, Table};
use crate::quantity::Dimension;
use crate::sensor::{Load, Measured, Sensor, Tolerance, Wiring};

/// Most plates of a stack.
const MOST_PLATES: u64 = 1000;

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
    // Read where the host's body is made.
    let _ = table.node("host_mass");
    let sensor = plate(name, table, problems);
    Some(PlacedSensor { name: name.to_owned(), site: place?, offset, sensor: sensor? })
}

/// The sensor itself, without its place: the keys of the files in `instruments/sensors`.
pub fn plate(name: &str, table: &Table<'_>, problems: &Problems) -> Option<Sensor> {
    let model = table.text("model").unwrap_or(name).to_owned();
    let _ = (table.text("source"), table.text("certificate"));
    let measured = measured(table)?;
    let known = measured.time_constant.is_some() && measured.sensitivity.is_some();
    // A circuit that is known whole needs no plate.
    let ceramic = if known && !table.has("ceramic") && !table.has("d33") {
        Some((1.0, 0.0))
    } else {
        ceramic(table, problems)
    };
    let needed = if known { Table::quantity } else { Table::required };
    let side = needed(table, "side", Dimension::LENGTH, Bound::Positive);
    let thickness = needed(table, "thickness", Dimension::LENGTH, Bound::Positive);
    let plates = table.count("plates", 1, MOST_PLATES).unwrap_or(1);
    let wiring = [("parallel", Wiring::Parallel), ("series", Wiring::Series)];
    let wiring = table.choice("wiring", &wiring).unwrap_or_default();
    let leak = table.quantity("leak_resistance", Dimension::RESISTANCE, Bound::Positive);
    let cable = if measured.time_constant.is_some() {
        if table.has("cable_capacitance") {
            let expected =
                "one of the two: the measured time constant holds the cable's capacitance";
            table.problem("cable_capacitance", "both `cable_capacitance` and `tau`", expected);
            let _ = table.node("cable_capacitance");
        }
        Some(0.0)
    } else {
        table.required("cable_capacitance", Dimension::CAPACITANCE, Bound::NotNegative)
    };
    let (relative_permittivity, d33) = ceramic?;
    let (side, thickness) =
        if known { (side.or(Some(1.0)), thickness.or(Some(1.0))) } else { (side, thickness) };
    Some(Sensor {
        model,
        d33,
        relative_permittivity,
        side: side?,
        thickness: thickness?,
        plates: u32::try_from(plates).ok()?,
        wiring,
        cable_capacitance: cable?,
        leak_resistance: leak.unwrap_or(f64::INFINITY),
        measured,
    })
}

/// What is known of the circuit from measurement; none where that is wrong.
fn measured(table: &Table<'_>) -> Option<Measured> {
    let number = |key, dimension| table.quantity(key, dimension, Bound::Positive);
    let uncertainty = |key| table.quantity(key, Dimension::NONE, Bound::NotNegative);
    let measured = Measured {
        sensitivity: number("sensitivity", Dimension::VOLTAGE_PER_FORCE),
        sensitivity_u: uncertainty("sensitivity_u"),
        time_constant: number("tau", Dimension::TIME),
        time_constant_u: uncertainty("tau_u"),
        load: None,
    };
    let resistance = number("input_resistance", Dimension::RESISTANCE);
    let capacitance =
        table.quantity("input_capacitance", Dimension::CAPACITANCE, Bound::NotNegative);
    let given = ["input_resistance", "input_capacitance"].map(|key| table.has(key));
    if given[0] != given[1] {
        let missing = if given[0] { "input_capacitance" } else { "input_resistance" };
        table.problem(
            missing,
            "no such key",
            "both of the input that `tau` and `sensitivity` were measured with",
        );
    }
    let load = resistance.zip(capacitance);
    let load = load.map(|(resistance, capacitance)| Load { resistance, capacitance });
    let unread = |key: &str, value: Option<f64>| table.has(key) && value.is_none();
    let wrong =
        unread("sensitivity", measured.sensitivity) || unread("tau", measured.time_constant);
    (!wrong).then_some(Measured { load, ..measured })
}

/// Masses of hosts that differ from their kind's, by the particle's number from 1 (kg).
pub fn host_masses(root: &Table<'_>, particles: usize) -> Vec<(usize, f64)> {
    let mut masses: Vec<(usize, f64)> = Vec::new();
    for (_, table) in root.tables("sensors") {
        let Some(mass) = table.quantity("host_mass", Dimension::MASS, Bound::Positive) else {
            continue;
        };
        if !table.has("particle") {
            table.problem("host_mass", "a mass", "none: only a sensor in a particle has a host");
            continue;
        }
        let particle = table.count("particle", 1, last_particle(particles));
        let Some(particle) = particle.and_then(|p| usize::try_from(p).ok()) else { continue };
        if masses.iter().any(|(other, before)| *other == particle && (before - mass).abs() > 0.0) {
            table.problem("host_mass", "a second mass of the same host", "one mass");
        }
        masses.push((particle, mass));
    }
    masses
}

/// `[effects.sensor_tolerance]`.
pub fn tolerance(table: &Table<'_>) -> Tolerance {
    let spread = table.required("spread", Dimension::NONE, Bound::Within(0.0, 0.5));
    let temperature =
        table.quantity("temperature_change", Dimension::TEMPERATURE, Bound::NotNegative);
    let read = if temperature.is_some() { Table::required } else { Table::quantity };
    let coefficient = |key| read(table, key, Dimension::PER_TEMPERATURE, Bound::Any).unwrap_or(0.0);
    Tolerance {
        spread: spread.unwrap_or(0.0),
        temperature: temperature.unwrap_or(0.0),
        permittivity_coefficient: coefficient("permittivity_coefficient"),
        d33_coefficient: coefficient("d33_coefficient"),
    }
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
