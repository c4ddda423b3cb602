//! The files of `instruments/sensors`: a plate with its wiring, what is known of both from
//! measurement, or both.

use std::path::Path;

use super::document::Node;
use super::library;
use super::problem::SceneError;
use super::reader::{Bound, Problems, TableReader};
use crate::data;
use crate::quantity::Dimension;
use crate::sensor::{InChain, Load, Sensor, SensorMeasurement, Wiring};

/// Keys of a sensor's own numbers: without any of them, it has no model.
const PLATE_KEYS: [&str; 9] = [
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
/// Most plates of a stack.
const MAX_PLATES: u64 = 1000;

/// Loads a sensor that ships with the program, by name, or a file, by path; none if there is no
/// such sensor.
///
/// # Errors
/// [`SceneError`]: not readable, or every problem found in its file.
pub fn load(name: &str) -> Result<Option<Sensor>, SceneError> {
    let Some(node) = library::open("sensors", name)? else { return Ok(None) };
    let problems = Problems::default();
    let sensor = TableReader::of(&node, "", &problems).and_then(|table| {
        let stem = Path::new(name).file_stem().and_then(|stem| stem.to_str()).unwrap_or(name);
        let sensor = plate(stem, &table, &problems);
        table.finish();
        sensor
    });
    let problems = problems.into_sorted();
    match sensor {
        Some(sensor) if problems.is_empty() => Ok(Some(sensor)),
        _ => Err(SceneError::Problems(problems)),
    }
}

/// The sensor itself, without its place: the keys of the files in `instruments/sensors`.
pub fn plate(name: &str, table: &TableReader<'_>, problems: &Problems) -> Option<Sensor> {
    let model = table.text("model").unwrap_or(name).to_owned();
    let _ = (table.text("source"), table.text("certificate"));
    let measured = measured(table)?;
    let calibrated_host = table.text("calibrated_host");
    if PLATE_KEYS.iter().all(|key| !table.has(key)) {
        let known = data::instrument_names("sensors").join("\", \"");
        let expected = format!(
            "one of \"{known}\", a file, or the plate's own numbers (hertzscope help scene)"
        );
        let _ = table.required_text("model", &expected);
        for key in PLATE_KEYS.iter().chain(&["plates", "wiring", "leak_resistance"]) {
            let _ = table.node(key);
        }
        return None;
    }
    let known = measured.time_constant.is_some() && measured.sensitivity.is_some();
    // A circuit that is known whole needs no plate.
    let ceramic = if known && !table.has("ceramic") && !table.has("d33") {
        Some((1.0, 0.0))
    } else {
        ceramic(table, problems)
    };
    let needed = if known { TableReader::quantity } else { TableReader::required };
    let side = needed(table, "side", Dimension::LENGTH, Bound::Positive);
    let thickness = needed(table, "thickness", Dimension::LENGTH, Bound::Positive);
    let plates = table.count("plates", 1, MAX_PLATES).unwrap_or(1);
    let wiring = [("parallel", Wiring::Parallel), ("series", Wiring::Series)];
    let wiring = table.choice("wiring", &wiring).unwrap_or_default();
    let leak = table.quantity("leak_resistance", Dimension::RESISTANCE, Bound::Positive);
    let cable = if measured.time_constant.is_some() {
        let _ = table.node("cable_capacitance");
        // A time constant measured here replaces the capacitance in the sensor's file.
        let is_replaced = table.is_own("tau") && !table.is_own("cable_capacitance");
        if table.has("cable_capacitance") && !is_replaced {
            let expected =
                "one of the two: the measured time constant holds the cable's capacitance";
            table.problem("cable_capacitance", "both `cable_capacitance` and `tau`", expected);
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
        calibrated_host: calibrated_host.map(str::to_owned),
    })
}

/// The measured circuit; none where it is invalid.
fn measured(table: &TableReader<'_>) -> Option<SensorMeasurement> {
    let number = |key, dimension| table.quantity(key, dimension, Bound::Positive);
    let uncertainty = |key| table.quantity(key, Dimension::NONE, Bound::NotNegative);
    let measured = SensorMeasurement {
        sensitivity: number("sensitivity", Dimension::VOLTAGE_PER_FORCE),
        sensitivity_u: uncertainty("sensitivity_u"),
        time_constant: number("tau", Dimension::TIME),
        time_constant_u: uncertainty("tau_u"),
        load: None,
        chain: chain(table),
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
    (!wrong).then_some(SensorMeasurement { load, ..measured })
}

/// `in_chain = true` with `channel` and `range`.
fn chain(table: &TableReader<'_>) -> Option<InChain> {
    let is_chain = table.flag("in_chain").unwrap_or(false);
    let range = table.quantity("range", Dimension::VOLTAGE_PER_DIVISION, Bound::Positive);
    let channel = table.choice("channel", &[("CH1", 1), ("CH2", 2), ("CH3", 3), ("CH4", 4)]);
    for key in ["range", "channel"] {
        if is_chain != table.has(key) {
            let found = if is_chain { "no such key" } else { "a chain's channel and range" };
            let expected = "in_chain = true, channel and range together, for a sensor calibrated with its scope's channel as one";
            table.problem(key, found, expected);
        }
    }
    Some(InChain { channel: channel?, range: range? }).filter(|_| is_chain)
}

/// Relative permittivity and d33, from the named ceramic or typed directly.
fn ceramic(table: &TableReader<'_>, problems: &Problems) -> Option<(f64, f64)> {
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
    let table = TableReader::of(node, "", problems)?;
    let _ = table.text("source");
    let permittivity = table.required("relative_permittivity", Dimension::NONE, Bound::Positive);
    let d33 = table.required("d33", Dimension::CHARGE_PER_FORCE, Bound::Positive);
    table.finish();
    Some((permittivity?, d33?))
}
