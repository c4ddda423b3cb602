//! Sensors in their places: `[sensors.<name>]`.
//!
//! How well the gain of a scope's channel is known when its volts become newtons.
//!
//! A data sheet's limit `a` counts as a rectangular distribution, `u = a/sqrt(3)` (JCGM 100:2008,
//! 4.3.7). A sensor that was calibrated with its channel as one chain carries that channel's gain:
//! at the same channel and range nothing is added, elsewhere both gains count.

use super::bodies::last_particle;
use super::distance::{PlatePlace, Site};
use super::plates::plate;
use super::reader::{Bound, Problems, TableReader};
use crate::quantity::Dimension;
use crate::scope::{Model, VerticalSetup};
use crate::sensor::{InChain, Sensor, SensorTolerance};

/// Most sensors of a scene: each is a trace of the truth, and all of a run's traces are in memory
/// at once.
const MOST_SENSORS: usize = 1000;

/// A sensor in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSensor {
    /// Name in the scene.
    pub name: String,
    /// Where it sits.
    pub site: Site,
    /// Distance from the particle's centre in particle lengths, downward positive; 0.5 feels the
    /// contact below alone (1).
    pub offset: f64,
    /// Standard uncertainty of the offset, from the scene's `[uncertainty]` (1).
    pub offset_u: f64,
    /// The sensor itself.
    pub sensor: Sensor,
}

impl PlacedSensor {
    /// Where its plate sits.
    pub fn place(&self) -> PlatePlace {
        PlatePlace { site: self.site, offset: self.offset, offset_u: self.offset_u }
    }
}

/// Data of the chain for the checks.
pub struct SensorHosts<'a> {
    /// Kind of each particle, from the top; empty where that is not known.
    pub kinds: &'a [&'a str],
    /// Whether a wall stands at the bottom.
    pub wall: bool,
}

/// Reads `[sensors.<name>]`, in the order of where they sit.
pub fn sensors(
    root: &TableReader<'_>,
    hosts: &SensorHosts<'_>,
    problems: &Problems,
) -> Vec<PlacedSensor> {
    let tables = root.tables("sensors");
    if tables.len() > MOST_SENSORS {
        let found = format!("{} sensors", tables.len());
        root.problem("sensors", found, format!("at most {MOST_SENSORS}"));
        return Vec::new();
    }
    let mut sensors: Vec<PlacedSensor> = tables
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
    table: &TableReader<'_>,
    hosts: &SensorHosts<'_>,
    problems: &Problems,
) -> Option<PlacedSensor> {
    let place = site(table, hosts);
    let offset = table.quantity("offset", Dimension::NONE, Bound::Within(-0.5, 0.5)).unwrap_or(0.0);
    // Read where the host's body is made.
    let _ = table.node("host_mass");
    let sensor = plate(name, table, problems);
    Some(PlacedSensor {
        name: name.to_owned(),
        site: place?,
        offset,
        offset_u: 0.0,
        sensor: sensor?,
    })
}

/// Masses of hosts that differ from their kind's, by the particle's number from 1 (kg).
pub fn host_masses(root: &TableReader<'_>, particles: usize) -> Vec<(usize, f64)> {
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
pub fn tolerance(table: &TableReader<'_>) -> SensorTolerance {
    let spread = table.required("spread", Dimension::NONE, Bound::Within(0.0, 0.5));
    let temperature =
        table.difference("temperature_change", Dimension::TEMPERATURE, Bound::NotNegative);
    let read = if temperature.is_some() { TableReader::required } else { TableReader::quantity };
    let coefficient = |key| read(table, key, Dimension::PER_TEMPERATURE, Bound::Any).unwrap_or(0.0);
    SensorTolerance {
        spread: spread.unwrap_or(0.0),
        temperature: temperature.unwrap_or(0.0),
        permittivity_coefficient: coefficient("permittivity_coefficient"),
        d33_coefficient: coefficient("d33_coefficient"),
    }
}

fn site(table: &TableReader<'_>, hosts: &SensorHosts<'_>) -> Option<Site> {
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

/// Names of the sensors as typed, those included that could not be read.
pub fn sensor_names<'a>(root: &TableReader<'a>) -> Vec<&'a str> {
    root.tables("sensors").into_iter().map(|(name, _)| name).collect()
}

/// Relative standard uncertainty of the gain of channel `number`, set as `vertical`, for a sensor
/// that was calibrated in `chain` (1).
pub fn gain_u(model: &Model, number: u8, vertical: &VerticalSetup, chain: Option<InChain>) -> f64 {
    let of = |scale: f64| model.accuracy.gain_at(scale / vertical.probe) / 3f64.sqrt();
    match chain {
        Some(chain) if chain.is(number, vertical.scale) => 0.0,
        Some(chain) => of(vertical.scale).hypot(of(chain.range)),
        None => of(vertical.scale),
    }
}
