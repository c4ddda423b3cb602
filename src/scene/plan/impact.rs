//! One of a plan's `[[impacts]]`, and quantities with their uncertainties.

use std::path::Path;

use super::{PlannedImpact, SpeedMethod};
use crate::quantity::{Dimension, Uncertain, parse, parse_any};
use crate::scene::document::Value;
use crate::scene::reader::{Bound, TableReader};

/// Keys of a speed before the contact and after it, each with that of its uncertainty.
const INCOMING: [(&str, &str, SpeedMethod); 3] = [
    ("speed", "speed_u", SpeedMethod::Speed),
    ("height", "height_u", SpeedMethod::Height),
    ("gate_time", "gate_time_u", SpeedMethod::GateTime),
];
const REBOUND: [(&str, &str, SpeedMethod); 4] = [
    ("rebound_speed", "rebound_speed_u", SpeedMethod::Speed),
    ("rebound_height", "rebound_height_u", SpeedMethod::Height),
    ("rebound_gate_time", "rebound_gate_time_u", SpeedMethod::GateTime),
    ("flight_time", "flight_time_u", SpeedMethod::FlightTime),
];

/// The plan's data that impacts refer to.
pub struct ImpactContext<'a> {
    /// The plan's file.
    pub file: &'a Path,
    /// The channel of impacts that name none.
    pub channel: &'a str,
    /// The strikers.
    pub strikers: &'a [(String, Uncertain)],
    /// Whether there are light gates with a known distance.
    pub gates: bool,
}

/// Reads one of `[[impacts]]`.
pub fn impact(table: &TableReader<'_>, context: &ImpactContext<'_>) -> Option<PlannedImpact> {
    let recording = table.required_text(
        "recording",
        "a file: .mcap, .csv, .isf, a folder, or the address of a scope, e.g. tcp://HOST:PORT",
    );
    let is_address = |name: &str| name.contains("://") || name.starts_with("serial:");
    let path = recording.map(|name| match context.file.parent() {
        Some(folder) if !is_address(name) => folder.join(name),
        _ => name.into(),
    });
    if let (Some(name), Some(path)) = (recording, &path)
        && !is_address(name)
        && !path.exists()
    {
        let found = format!("\"{name}\", which does not exist");
        table.problem("recording", found, "a recording, its path relative to the plan");
    }
    let channel = table.text("channel").unwrap_or(context.channel).to_owned();
    let shot = table.count("shot", 1, u64::from(u32::MAX)).unwrap_or(1);
    let striker = match (table.text("striker"), context.strikers) {
        (None, [_]) => Some(0),
        (name, strikers) => {
            let found = strikers.iter().position(|(known, _)| Some(known.as_str()) == name);
            if found.is_none() {
                let names: Vec<&str> = strikers.iter().map(|(name, _)| name.as_str()).collect();
                let found = name.map_or("no such key".to_owned(), |name| format!("\"{name}\""));
                table.problem("striker", found, format!("one of [strikers]: {}", names.join(", ")));
            }
            found
        }
    };
    let incoming = speed(table, &INCOMING, context.gates);
    let rebound = speed(table, &REBOUND, context.gates);
    let window = window(table);
    Some(PlannedImpact {
        recording: path?,
        place: table.place_of("recording").clone(),
        channel,
        shot: u32::try_from(shot).ok()?,
        striker: striker?,
        incoming: incoming?,
        rebound: rebound?,
        window: window?,
    })
}

/// The one of several ways to tell a speed that is used.
fn speed(
    table: &TableReader<'_>,
    ways: &[(&'static str, &'static str, SpeedMethod)],
    gates: bool,
) -> Option<(SpeedMethod, Uncertain)> {
    let used: Vec<_> = ways.iter().filter(|(key, ..)| table.has(key)).collect();
    let first = ways.first()?.0;
    for (key, uncertainty, _) in ways {
        let _ = (table.node(key), table.node(uncertainty));
    }
    let [(key, uncertainty, means)] = used.as_slice() else {
        let names: Vec<&str> = ways.iter().map(|(key, ..)| *key).collect();
        let found = if used.is_empty() {
            "no such key".to_owned()
        } else {
            format!("{} of them", used.len())
        };
        table.problem(first, found, format!("one of {}", names.join(", ")));
        return None;
    };
    let dimension = match means {
        SpeedMethod::Speed => Dimension::SPEED,
        SpeedMethod::Height => Dimension::LENGTH,
        SpeedMethod::GateTime | SpeedMethod::FlightTime => Dimension::TIME,
    };
    if *means == SpeedMethod::GateTime && !gates {
        table.problem(key, "a time between gates", "[speeds] with gate_distance as well");
    }
    Some((*means, uncertain(table, (key, uncertainty), dimension)?))
}

/// `window = ["-10 us", "200 us"]`; `Some(None)` without one, none where it is wrong.
#[allow(clippy::option_option, reason = "wrong, or not there, or there")]
fn window(table: &TableReader<'_>) -> Option<Option<[f64; 2]>> {
    if !table.has("window") {
        let _ = table.node("window");
        return Some(None);
    }
    let texts = table.texts("window");
    let times: Vec<f64> =
        texts.iter().filter_map(|(text, _)| parse(text, Dimension::TIME).ok()).collect();
    match times.as_slice() {
        [from, to] if from < to && texts.len() == 2 => Some(Some([*from, *to])),
        _ => {
            let found = texts.iter().map(|(text, _)| *text).collect::<Vec<_>>().join(", ");
            let expected = "two times after the trigger, e.g. [\"-10 us\", \"200 us\"]";
            table.problem("window", format!("[{found}]"), expected);
            None
        }
    }
}

/// A quantity above zero and its standard uncertainty, in its unit or as a share of it.
pub fn uncertain(
    table: &TableReader<'_>,
    (key, uncertainty): (&'static str, &'static str),
    dimension: Dimension,
) -> Option<Uncertain> {
    let value = table.required(key, dimension, limits(dimension));
    let Some(node) = table.node(uncertainty) else {
        let expected =
            format!("the standard uncertainty of {key}, as {dimension} or a share, e.g. \"0.5 %\"");
        table.problem(uncertainty, "no such key", expected);
        return None;
    };
    let share = match &node.value {
        Value::Number { value, .. } => Some((*value, Dimension::NONE)),
        Value::Text(text) => parse_any(text).ok(),
        _ => None,
    };
    let u = match share {
        Some((u, found)) if found == dimension && (0.0..f64::INFINITY).contains(&u) => u,
        // A share needs its quantity.
        Some((u, Dimension::NONE)) if (0.0..f64::INFINITY).contains(&u) => u * value?,
        _ => {
            let expected = format!("{dimension} of zero or more, or a share, e.g. \"0.5 %\"");
            table.problem(uncertainty, node.describe(), expected);
            return None;
        }
    };
    let quantity = Uncertain::normal(value?, u);
    if !quantity.is_known() {
        let found = format!("{}, more than {key} itself", node.describe());
        table.problem(uncertainty, found, "a standard uncertainty (k = 1) below the value");
        return None;
    }
    Some(quantity)
}

/// Limits of a measured quantity that fits on a bench.
fn limits(dimension: Dimension) -> Bound {
    match dimension {
        Dimension::MASS => Bound::MASS,
        Dimension::LENGTH => Bound::LENGTH,
        Dimension::SPEED => Bound::SPEED,
        Dimension::TIME => Bound::Bench(1e-9, 1e6),
        Dimension::ACCELERATION => Bound::Bench(1e-3, 1e3),
        _ => Bound::Positive,
    }
}
