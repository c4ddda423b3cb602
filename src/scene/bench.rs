//! Sensors and scope: the part of a scene that looks.

use super::document::Node;
use super::library;
use super::reader::{Bound, Problems, Table};
use crate::quantity::{Dimension, engineering, parse};
use crate::scope::{
    ChannelSetup, Coupling, Model, Setup, Slope, Source, Trigger, TriggerMode, VerticalSetup,
};
use crate::sensor::{Load, Sensor};

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
    /// Kind of each particle, from the top.
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
    let site = site(table, hosts);
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
    Some(PlacedSensor { name: name.to_owned(), site: site?, offset, sensor })
}

fn site(table: &Table<'_>, hosts: &Hosts<'_>) -> Option<Site> {
    let wall = table.flag("wall").unwrap_or(false);
    let last = hosts.kinds.len();
    let host = table.text("host");
    if wall {
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
        let _ = table.node("particle");
        table.problem(
            "particle",
            "no such key",
            format!("a particle from 1 to {last}, or wall = true"),
        );
        return None;
    }
    let particle = usize::try_from(table.count("particle", 1, last as u64)?).ok()?;
    let kind = hosts.kinds.get(particle - 1).copied().unwrap_or_default();
    if let Some(host) = host.filter(|host| *host != kind) {
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

/// Reads `[scope]`, without noise.
pub fn scope(table: &Table<'_>, sensors: &[PlacedSensor]) -> Option<Setup> {
    let model = model(table)?;
    let time_base = table.required("time_base", Dimension::TIME_PER_DIVISION, Bound::Positive);
    if let Some(found) = time_base.filter(|t| !is_one_of(*t, &model.time_bases)) {
        let nearest = nearest(found, &model.time_bases);
        let found = engineering(found, "s/div", 4);
        table.problem(
            "time_base",
            found,
            format!(
                "a time base of the {}, the nearest is {}",
                model.name,
                engineering(nearest, "s/div", 3)
            ),
        );
    }
    let position = table.quantity("position", Dimension::TIME, Bound::Any).unwrap_or(0.0);
    let keys: [&'static str; 4] = ["ch1", "ch2", "ch3", "ch4"];
    let mut channels = Vec::new();
    for key in keys.into_iter().take(usize::from(model.channels)) {
        let channel = table.table(key);
        channels.push(channel.and_then(|channel| {
            let setup = channel_setup(&channel, &model, sensors);
            channel.finish();
            setup
        }));
    }
    if keys.iter().all(|key| !table.has(key)) {
        table.problem("ch1", "no channel", "at least one channel, [scope.ch1] to [scope.ch4]");
    }
    let trigger = match table.table("trigger") {
        Some(trigger) => {
            let read = trigger_setup(&trigger, &model, &channels);
            trigger.finish();
            read
        }
        None => {
            table.problem(
                "trigger",
                "no such key",
                "a table [scope.trigger] with source and level",
            );
            None
        }
    };
    Some(Setup {
        model,
        channels,
        time_base: time_base?,
        horizontal_position: position,
        trigger: trigger?,
        noise: 0.0,
    })
}

fn channel_setup(
    table: &Table<'_>,
    model: &Model,
    sensors: &[PlacedSensor],
) -> Option<ChannelSetup> {
    let probe = table.quantity("probe", Dimension::NONE, Bound::Positive).unwrap_or(1.0);
    if !is_one_of(probe, &model.probes) {
        table.problem("probe", probe.to_string(), format!("one of {:?}", model.probes));
    }
    let scale = table.required("scale", Dimension::VOLTAGE_PER_DIVISION, Bound::Positive);
    if let Some(scale) = scale {
        let (low, high) = ends(&model.vertical_scales);
        if !(low..=high).contains(&(scale / probe * (1.0 + 1e-12))) {
            let range = format!(
                "{} to {} through this probe",
                engineering(low * probe, "V/div", 3),
                engineering(high * probe, "V/div", 3)
            );
            table.problem("scale", engineering(scale, "V/div", 3), range);
        }
    }
    let position = table.quantity("position", Dimension::DIVISION, Bound::Any).unwrap_or(0.0);
    let steps = position / model.position_step;
    if (steps - steps.round()).abs() > 1e-9 * steps.abs().max(1.0) {
        let expected = format!("a multiple of {} div, as on the front panel", model.position_step);
        table.problem("position", format!("{position} div"), expected);
    }
    let input = table.text("input").map(ToOwned::to_owned);
    if let Some(name) = input.as_ref().filter(|name| sensors.iter().all(|s| s.name != **name)) {
        let names: Vec<&str> = sensors.iter().map(|s| s.name.as_str()).collect();
        table.problem(
            "input",
            format!("\"{name}\""),
            format!("a sensor: one of {}", names.join(", ")),
        );
    }
    let coupling = [("DC", Coupling::Dc), ("AC", Coupling::Ac), ("GND", Coupling::Ground)];
    let vertical = VerticalSetup {
        scale: scale?,
        position,
        coupling: table.choice("coupling", &coupling).or(Some(Coupling::Dc)),
        bandwidth_limited: table.flag("bandwidth_limit").or(Some(false)),
        inverted: table.flag("invert").or(Some(false)),
        probe,
    };
    Some(ChannelSetup { vertical, input })
}

fn trigger_setup(
    table: &Table<'_>,
    model: &Model,
    channels: &[Option<ChannelSetup>],
) -> Option<Trigger> {
    let sources: Vec<(String, Source)> =
        (1..=model.channels).map(|n| (format!("CH{n}"), Source::Channel(n))).collect();
    let words: Vec<(&str, Source)> = sources.iter().map(|(name, s)| (name.as_str(), *s)).collect();
    let source = table.choice("source", &words);
    if source.is_none() && !table.has("source") {
        table.problem("source", "no such key", "the channel to watch, e.g. \"CH1\"");
    }
    let level = table.required("level", Dimension::VOLTAGE, Bound::Any);
    let slopes = [("rise", Slope::Rise), ("fall", Slope::Fall)];
    let modes = [("auto", TriggerMode::Auto), ("normal", TriggerMode::Normal)];
    let slope = table.choice("slope", &slopes).unwrap_or(Slope::Rise);
    let mode = table.choice("mode", &modes).unwrap_or(TriggerMode::Auto);
    let (source, level) = (source?, level?);
    let Source::Channel(number) = source else {
        return None;
    };
    let Some(channel) = channels.get(usize::from(number) - 1).and_then(Option::as_ref) else {
        table.problem("source", source.to_string(), "a channel that is on");
        return None;
    };
    let vertical = channel.vertical;
    let divisions = level / vertical.scale + vertical.position;
    if divisions.abs() > model.trigger_range {
        let expected = format!("a level within {} div of the screen's centre", model.trigger_range);
        table.problem("level", engineering(level, "V", 3), expected);
    }
    Some(Trigger { source, level, slope, mode })
}

/// Reads the keys of an oscilloscope's data file.
fn model(table: &Table<'_>) -> Option<Model> {
    if table.required_text("model", "the name of an oscilloscope, e.g. \"tds2014\"").is_none() {
        return None;
    }
    let positive = Bound::Positive;
    let record_length = usize::try_from(table.count("record_length", 2, 1_000_000)?).ok()?;
    let channels = u8::try_from(table.count("channels", 1, 4)?).ok()?;
    Some(Model {
        name: table.text("name")?.to_owned(),
        serial: table.text("serial")?.to_owned(),
        firmware: table.text("firmware")?.to_owned(),
        interface: table.text("interface")?.to_owned(),
        channels,
        bandwidth: table.required("bandwidth", Dimension::FREQUENCY, positive)?,
        limited_bandwidth: table.required("limited_bandwidth", Dimension::FREQUENCY, positive)?,
        sample_rate: table.required("sample_rate", Dimension::FREQUENCY, positive)?,
        record_length,
        horizontal_divisions: table.required(
            "horizontal_divisions",
            Dimension::DIVISION,
            positive,
        )?,
        vertical_scales: series(table, "vertical_scales", Dimension::VOLTAGE_PER_DIVISION)?,
        time_bases: series(table, "time_bases", Dimension::TIME_PER_DIVISION)?,
        probes: series(table, "probes", Dimension::NONE)?,
        position_step: table.required("position_step", Dimension::DIVISION, positive)?,
        input_resistance: table.required("input_resistance", Dimension::RESISTANCE, positive)?,
        input_capacitance: table.required("input_capacitance", Dimension::CAPACITANCE, positive)?,
        probe_resistance: table.required("probe_resistance", Dimension::RESISTANCE, positive)?,
        probe_capacitance: table.required("probe_capacitance", Dimension::CAPACITANCE, positive)?,
        ac_corner: table.required("ac_corner", Dimension::FREQUENCY, positive)?,
        trigger_range: table.required("trigger_range", Dimension::DIVISION, positive)?,
        trigger_hysteresis: table.required(
            "trigger_hysteresis",
            Dimension::DIVISION,
            Bound::NotNegative,
        )?,
        external_trigger_range: table.required(
            "external_trigger_range",
            Dimension::VOLTAGE,
            positive,
        )?,
        event_queue: usize::try_from(table.count("event_queue", 2, 1000)?).ok()?,
    })
}

/// A list of quantities, ascending.
fn series(table: &Table<'_>, key: &'static str, dimension: Dimension) -> Option<Vec<f64>> {
    let mut values = Vec::new();
    for (text, place) in table.texts(key) {
        match parse(text, dimension) {
            Ok(value) if value > 0.0 => values.push(value),
            _ => {
                let expected = format!("{dimension} above zero");
                table.problem_at(place, key, format!("\"{text}\""), expected);
                return None;
            }
        }
    }
    values.sort_by(f64::total_cmp);
    (!values.is_empty()).then_some(values)
}

fn ends(values: &[f64]) -> (f64, f64) {
    (values.first().copied().unwrap_or(0.0), values.last().copied().unwrap_or(f64::INFINITY))
}

fn is_one_of(value: f64, values: &[f64]) -> bool {
    values.iter().any(|v| (value - v).abs() <= 1e-9 * v)
}

fn nearest(value: f64, values: &[f64]) -> f64 {
    let distance = |v: &f64| (v / value).ln().abs();
    values.iter().copied().min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(value)
}

/// What a sensor at this channel's input is loaded with.
#[must_use]
pub fn load(model: &Model, channel: &ChannelSetup) -> Load {
    if channel.vertical.probe > 1.0 {
        Load { resistance: model.probe_resistance, capacitance: model.probe_capacitance }
    } else {
        Load { resistance: model.input_resistance, capacitance: model.input_capacitance }
    }
}
