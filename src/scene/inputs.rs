//! What channels of the scope may be wired to: sensors, and outputs of a drive's generator.

use super::drive::OUTPUTS;
use super::root::RootKeys;
use super::table::NamedTables;

/// Names of all of them.
pub fn inputs<'a>(keys: &RootKeys<'a>) -> Vec<&'a str> {
    let sensors = named(keys.sensors.as_ref()).into_iter().chain(motion_names(keys));
    sensors.chain(OUTPUTS.into_iter().filter(|_| keys.table.has("drive"))).collect()
}

/// Names of the sensors of motion.
fn motion_names<'a>(keys: &RootKeys<'a>) -> Vec<&'a str> {
    [&keys.vibrometers, &keys.accelerometers, &keys.strain_gauges]
        .map(Option::as_ref)
        .into_iter()
        .flat_map(named)
        .collect()
}

fn named<'a>(tables: Option<&NamedTables<'a>>) -> Vec<&'a str> {
    tables.into_iter().flatten().map(|(name, _)| *name).collect()
}

/// Refuses two inputs of one name.
pub fn refuse_twins(keys: &RootKeys<'_>) {
    let names = inputs(keys);
    for (place, name) in names.iter().enumerate() {
        if names[..place].contains(name) {
            let found = format!("two inputs called \"{name}\"");
            keys.table.problem("sensors", found, "a name of its own for each sensor");
        }
    }
}
