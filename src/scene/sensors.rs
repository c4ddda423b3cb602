//! Sensors: `[sensors.NAME]` of a scene and the files of `instruments/sensors`. A sensor is a plate
//! with its wiring, a circuit that is known from measurement, or both.

use std::path::Path;

use super::bodies::{particle_in, particle_number};
use super::distance::{PlatePlace, Site};
use super::document::Node;
use super::library;
use super::problem::SceneError;
use super::problems::Problems;
use super::table::{Bound, TableReader};
use super::table::{count, flag, not_negative, positive, quantity, table, text, word, words};
use crate::data;
use crate::quantity::Dimension;
use crate::scope::{Model, VerticalSetup};
use crate::sensor::{InChain, Load, Sensor, SensorMeasurement, Wiring};

/// Most sensors of a scene: each is a trace of the truth, and all of a run's traces are in memory
/// at once.
const MAX_SENSORS: usize = 1000;
/// Most plates of a stack.
const MAX_PLATES: u64 = 1000;
/// Keys of a sensor's own numbers: without any of them, it has no model.
const NUMBERS: [&str; 9] = [
    "model",
    "ceramic",
    "d33",
    "relative_permittivity",
    "side",
    "thickness",
    "cable_capacitance",
    "sensitivity",
    "tau",
];

table! {
    /// Place of a sensor, `[sensors.NAME]`.
    pub struct PlaceKeys<'a> {
        /// sits in this particle
        particle: &'a Node = particle_number(),
        /// under the bottom wall
        wall: bool = flag().or("false"),
        /// of the plate from the particle's centre, -0.5 (top) to 0.5 (bottom) of its length
        offset: f64 = quantity(Dimension::NONE, Bound::Within(-0.5, 0.5)).or("0"),
        /// checks that the particle is of this kind
        host: &'a str = text(),
        /// the particle's mass with the plate in it; default: its kind's
        host_mass: f64 = quantity(Dimension::MASS, Bound::MASS),
    }
}

table! {
    /// The sensor itself.
    pub struct SensorKeys<'a> {
        /// `hertzscope list sensors`, or a file such as `calibrate` writes; or the
        /// plate's own numbers:
        model: &'a str = text(),
        side: f64 = positive(Dimension::LENGTH),
        thickness: f64 = positive(Dimension::LENGTH),
        /// or `relative_permittivity` and `d33`:
        ceramic: &'a str = text(),
        relative_permittivity: f64 = positive(Dimension::NONE),
        d33: f64 = positive(Dimension::CHARGE_PER_FORCE),
        cable_capacitance: f64 = not_negative(Dimension::CAPACITANCE),
        /// of a stack
        plates: u32 = count(1, MAX_PLATES).or("1"),
        /// or "series"
        wiring: Wiring = word::<Wiring>().or("parallel"),
        /// default: none
        leak_resistance: f64 = positive(Dimension::RESISTANCE),
        /// measured, with the input's load; replaces what the plate's numbers give
        sensitivity: f64 = positive(Dimension::VOLTAGE_PER_FORCE),
        /// its relative standard uncertainty
        sensitivity_u: f64 = not_negative(Dimension::NONE),
        /// measured time constant, with the input's load; replaces `cable_capacitance`
        tau: f64 = positive(Dimension::TIME),
        tau_u: f64 = not_negative(Dimension::NONE),
        /// of the input that sensitivity and tau were measured with
        input_resistance: f64 = positive(Dimension::RESISTANCE),
        input_capacitance: f64 = not_negative(Dimension::CAPACITANCE),
        /// true where sensor and channel were calibrated as one, with:
        in_chain: bool = flag().or("false"),
        channel: ChannelName = word::<ChannelName>(),
        range: f64 = positive(Dimension::VOLTAGE_PER_DIVISION),
        /// kind of particle that it was calibrated in
        calibrated_host: &'a str = text(),
        certificate: &'a str = text(),
    }
}

table! {
    /// The files of `instruments/piezoceramics`.
    struct CeramicKeys<'a> {
        relative_permittivity: f64 = positive(Dimension::NONE).required(),
        d33: f64 = positive(Dimension::CHARGE_PER_FORCE).required(),
    }
}

words! { Wiring { "parallel" => Parallel, "series" => Series } }

/// A channel of the scope by its name.
#[derive(Clone, Copy)]
pub enum ChannelName {
    /// CH1.
    One = 1,
    /// CH2.
    Two,
    /// CH3.
    Three,
    /// CH4.
    Four,
}

words! { ChannelName { "CH1" => One, "CH2" => Two, "CH3" => Three, "CH4" => Four } }

/// A sensor in its place.
#[derive(Debug, Clone, PartialEq)]
pub struct PlacedSensor {
    /// Name in the scene.
    pub name: String,
    /// Its host.
    pub site: Site,
    /// Distance from the particle's centre in particle lengths, downward positive; at 0.5 the force
    /// is that of the contact below alone (1).
    pub offset: f64,
    /// Standard uncertainty of the offset, from the scene's `[uncertainty]` (1).
    pub offset_u: f64,
    /// The sensor itself.
    pub sensor: Sensor,
}

impl PlacedSensor {
    /// Place of its plate.
    pub fn place(&self) -> PlatePlace {
        PlatePlace { site: self.site, offset: self.offset, offset_u: self.offset_u }
    }
}

/// Data of the chain for the checks.
pub struct SensorHosts<'a> {
    /// Kind of each particle, from the top; empty if that is not known.
    pub kinds: &'a [&'a str],
    /// Whether a wall is at the bottom.
    pub wall: bool,
}

/// Reads `[sensors.NAME]`, in the order of their places.
pub fn sensors(
    root: &TableReader<'_>,
    places: &[(&str, PlaceKeys<'_>)],
    hosts: &SensorHosts<'_>,
) -> Vec<PlacedSensor> {
    if places.len() > MAX_SENSORS {
        let found = format!("{} sensors", places.len());
        root.problem("sensors", found, format!("at most {MAX_SENSORS}"));
        return Vec::new();
    }
    let placed = |(name, keys): &(&str, PlaceKeys<'_>)| {
        let site = site(keys, hosts);
        let offset = if site == Some(Site::Wall) { Some(0.0) } else { keys.offset };
        let sensor = sensor(name, &keys.table);
        let name = (*name).to_owned();
        Some(PlacedSensor { name, site: site?, offset: offset?, offset_u: 0.0, sensor: sensor? })
    };
    let mut sensors: Vec<PlacedSensor> = places.iter().filter_map(placed).collect();
    let order = |sensor: &PlacedSensor| match sensor.site {
        Site::Particle(particle) => (particle, sensor.name.clone()),
        Site::Wall => (usize::MAX, sensor.name.clone()),
    };
    sensors.sort_by_key(order);
    sensors
}

/// Masses of hosts that differ from their kind's, by the particle's number from 1 (kg).
pub fn host_masses(places: &[(&str, PlaceKeys<'_>)], particles: usize) -> Vec<(usize, f64)> {
    let mut masses: Vec<(usize, f64)> = Vec::new();
    for (_, keys) in places {
        let table = &keys.table;
        let Some(mass) = keys.host_mass else { continue };
        if !table.has("particle") {
            table.problem("host_mass", "a mass", "none: only a sensor in a particle has a host");
            continue;
        }
        let Some(particle) = particle_in(table, keys.particle, particles) else { continue };
        if masses.iter().any(|(other, before)| *other == particle && (before - mass).abs() > 0.0) {
            table.problem("host_mass", "a second mass of the same host", "one mass");
        }
        masses.push((particle, mass));
    }
    masses
}

fn site(keys: &PlaceKeys<'_>, hosts: &SensorHosts<'_>) -> Option<Site> {
    let table = &keys.table;
    let last = hosts.kinds.len();
    if keys.wall.unwrap_or(false) {
        if table.has("particle") || table.has("offset") {
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
        table.missing("particle", format!("a particle from 1 to {last}, or wall = true"));
        return None;
    }
    let particle = particle_in(table, keys.particle, last)?;
    let kind = hosts.kinds.get(particle - 1).copied();
    if let Some((host, kind)) = keys.host.zip(kind).filter(|(host, kind)| host != kind) {
        let expected = format!("\"{kind}\", which particle {particle} is");
        table.problem("host", format!("\"{host}\""), expected);
    }
    Some(Site::Particle(particle))
}

/// Loads an included sensor, by name, or a file, by path; `None` if there is no such sensor.
///
/// # Errors
/// [`SceneError`]: not readable, or every problem found in its file.
pub fn load(name: &str) -> Result<Option<Sensor>, SceneError> {
    let Some(node) = library::open("sensors", Path::new(name))? else { return Ok(None) };
    let problems = Problems::default();
    let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or(name);
    let sensor = TableReader::of(&node, "", &[SensorKeys::KEYS], &problems)
        .and_then(|table| sensor(stem, &table));
    problems.finish(sensor).map(Some).map_err(SceneError::Problems)
}

/// Loads the sensor whose name or file `key` of `table` names; `None` leaves a problem.
pub(super) fn load_beside(table: &TableReader<'_>, key: &str, name: &str) -> Option<Sensor> {
    let place = table.place_of(key);
    match library::instrument("sensors", name, place, &table.path_of(key)) {
        Ok(node) => {
            sensor(name, &TableReader::of(&node, "", &[SensorKeys::KEYS], table.problems())?)
        }
        Err(found) => {
            table.problems().extend(found);
            None
        }
    }
}

/// The sensor itself, without its place.
fn sensor(name: &str, table: &TableReader<'_>) -> Option<Sensor> {
    let keys = SensorKeys::read(table);
    let measured = measured(&keys)?;
    if NUMBERS.iter().all(|key| !table.has(key)) {
        let known = data::instrument_names("sensors").join("\", \"");
        let expected = format!(
            "one of \"{known}\", a file, or the plate's own numbers (hertzscope help scene)"
        );
        table.missing("model", expected);
        return None;
    }
    // A circuit that is known whole needs no plate.
    let known = measured.time_constant.is_some() && measured.sensitivity.is_some();
    let ceramic = if known && !table.has("ceramic") && !table.has("d33") {
        Some((1.0, 0.0))
    } else {
        ceramic(&keys)
    };
    if !known {
        for key in ["side", "thickness"] {
            table.require(SensorKeys::KEYS, key);
        }
    }
    let cable = if measured.time_constant.is_some() {
        // A time constant measured here replaces the capacitance in the sensor's file.
        let is_replaced = table.is_own("tau") && !table.is_own("cable_capacitance");
        if table.has("cable_capacitance") && !is_replaced {
            let expected =
                "one of the two: the measured time constant holds the cable's capacitance";
            table.problem("cable_capacitance", "both `cable_capacitance` and `tau`", expected);
        }
        Some(0.0)
    } else {
        table.require(SensorKeys::KEYS, "cable_capacitance");
        keys.cable_capacitance
    };
    let (relative_permittivity, d33) = ceramic?;
    let size = |size: Option<f64>| if known { size.or(Some(1.0)) } else { size };
    Some(Sensor {
        model: keys.model.unwrap_or(name).to_owned(),
        d33,
        relative_permittivity,
        side: size(keys.side)?,
        thickness: size(keys.thickness)?,
        plates: keys.plates?,
        wiring: keys.wiring?,
        cable_capacitance: cable?,
        leak_resistance: keys.leak_resistance.unwrap_or(f64::INFINITY),
        measured,
        calibrated_host: keys.calibrated_host.map(str::to_owned),
    })
}

/// The measured circuit; `None` if it is invalid.
fn measured(keys: &SensorKeys<'_>) -> Option<SensorMeasurement> {
    let table = &keys.table;
    let given = ["input_resistance", "input_capacitance"].map(|key| table.has(key));
    if given[0] != given[1] {
        let missing = if given[0] { "input_capacitance" } else { "input_resistance" };
        table.missing(missing, "both of the input that `tau` and `sensitivity` were measured with");
    }
    let load = keys.input_resistance.zip(keys.input_capacitance);
    let unread = |key: &str, value: Option<f64>| table.has(key) && value.is_none();
    let chain = chain(keys);
    if unread("sensitivity", keys.sensitivity) || unread("tau", keys.tau) {
        return None;
    }
    Some(SensorMeasurement {
        sensitivity: keys.sensitivity,
        sensitivity_u: keys.sensitivity_u,
        time_constant: keys.tau,
        time_constant_u: keys.tau_u,
        load: load.map(|(resistance, capacitance)| Load { resistance, capacitance }),
        chain,
    })
}

/// `in_chain = true` with `channel` and `range`.
fn chain(keys: &SensorKeys<'_>) -> Option<InChain> {
    let is_chain = keys.in_chain.unwrap_or(false);
    for key in ["range", "channel"] {
        if is_chain != keys.table.has(key) {
            let found = if is_chain { "no such key" } else { "a chain's channel and range" };
            let expected = "in_chain = true, channel and range together, for a sensor calibrated with its scope's channel as one";
            keys.table.problem(key, found, expected);
        }
    }
    Some(InChain { channel: keys.channel? as u8, range: keys.range? }).filter(|_| is_chain)
}

/// Relative permittivity and d33, from the named ceramic or typed directly.
fn ceramic(keys: &SensorKeys<'_>) -> Option<(f64, f64)> {
    let table = &keys.table;
    let Some(name) = keys.ceramic else {
        if table.has("ceramic") {
            return None;
        }
        for key in ["relative_permittivity", "d33"] {
            table.require(SensorKeys::KEYS, key);
        }
        return keys.relative_permittivity.zip(keys.d33);
    };
    let place = table.place_of("ceramic");
    let constants = |node: &Node| {
        let table = TableReader::of(node, "", &[CeramicKeys::KEYS], table.problems())?;
        let constants = CeramicKeys::read(&table);
        constants.relative_permittivity.zip(constants.d33)
    };
    match library::instrument("piezoceramics", name, place, &table.path_of("ceramic")) {
        Ok(node) => {
            let (permittivity, d33) = constants(&node)?;
            Some((keys.relative_permittivity.unwrap_or(permittivity), keys.d33.unwrap_or(d33)))
        }
        Err(found) => {
            table.problems().extend(found);
            None
        }
    }
}

/// Relative standard uncertainty of the gain of channel `number`, set as `vertical`, for a sensor
/// that was calibrated in `chain` (1).
///
/// A data sheet's limit `a` counts as a rectangular distribution, `u = a/sqrt(3)` (JCGM 100:2008,
/// 4.3.7). The calibration of a sensor with its channel as one chain includes that channel's gain:
/// at the same channel and range it adds nothing, elsewhere both gains count.
pub fn gain_u(model: &Model, number: u8, vertical: &VerticalSetup, chain: Option<InChain>) -> f64 {
    let of = |scale: f64| model.accuracy.gain_at(scale / vertical.probe) / 3f64.sqrt();
    match chain {
        Some(chain) if chain.is(number, vertical.scale) => 0.0,
        Some(chain) => of(vertical.scale).hypot(of(chain.range)),
        None => of(vertical.scale),
    }
}
