//! The physics that a scene switches on: `[effects.<name>]`.

use super::losses::losses;
use super::magnet_preload::magnet;
use super::reader::effect;
use super::reader::{Bound, TableReader};
use super::sensors;
use crate::chain::{EffectsSpec, Gravity, LinearisedContacts};
use crate::quantity::Dimension;
use crate::sensor::SensorTolerance;

/// The value of an effect's key `state`; its other keys stay as they are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EffectSwitch {
    /// On; so is a table without the key.
    On,
    /// Off.
    Off,
    /// Off where nothing would be seen of it.
    Auto,
}

/// Effects with an upper bound on what they change.
const BOUNDED_EFFECTS: [&str; 5] =
    ["gravity", "magnet_law", "dashpot", "kuwabara_kono", "power_law_loss"];
/// The others.
const UNBOUNDED_EFFECTS: [&str; 6] = [
    "linearised_contacts",
    "magnet_preload",
    "scope_errors",
    "scope_noise",
    "sensor_tolerance",
    "striker_speed_spread",
];

/// The `state` of every effect that has one.
pub fn switches(effects: &TableReader<'_>) -> Vec<(&'static str, EffectSwitch)> {
    let words =
        [("on", EffectSwitch::On), ("off", EffectSwitch::Off), ("auto", EffectSwitch::Auto)];
    let read = |name: &'static str, words: &[(&str, EffectSwitch)]| {
        let state = effect(effects, name)?.choice("state", words)?;
        Some((name, state))
    };
    let foretold = BOUNDED_EFFECTS.into_iter().filter_map(|name| read(name, &words));
    foretold
        .chain(UNBOUNDED_EFFECTS.into_iter().filter_map(|name| read(name, &words[..2])))
        .collect()
}

/// Whether `name` is switched off.
pub fn is_off(switches: &[(&'static str, EffectSwitch)], name: &str) -> bool {
    switches.iter().any(|(other, switch)| *other == name && *switch == EffectSwitch::Off)
}

/// Those whose state is `auto`.
pub fn left_to_accuracy(switches: &[(&'static str, EffectSwitch)]) -> Vec<&'static str> {
    let auto = switches.iter().filter(|(_, switch)| *switch == EffectSwitch::Auto);
    auto.map(|(name, _)| *name).collect()
}

/// Takes out what is switched off; it has been read, so that mistakes in it are told.
pub fn switch(spec: &mut EffectsSpec, switches: &[(&'static str, EffectSwitch)]) {
    for (name, switch) in switches {
        if *switch == EffectSwitch::Off {
            spec.remove(name);
        }
    }
}

/// Reads `[effects]`, noise and errors of the scope excepted.
/// `pairs` are the names of the bodies that touch, none where they are not known.
pub fn effects(
    effects: Option<&TableReader<'_>>,
    particles: usize,
    pairs: &[(&str, &str)],
) -> EffectsSpec {
    let mut spec = EffectsSpec::default();
    let Some(effects) = effects else { return spec };
    if let Some(table) = effect(effects, "gravity") {
        let acceleration = table.required("acceleration", Dimension::ACCELERATION, Bound::Any);
        spec.gravity = acceleration.map(|acceleration| Gravity { acceleration });
        table.finish();
    }
    if let Some(table) = effect(effects, "linearised_contacts") {
        spec.linearised_contacts = Some(LinearisedContacts);
        table.finish();
    }
    magnet(effects, particles, &mut spec);
    losses(effects, pairs, &mut spec);
    spec
}

/// Whether `[effects.scope_errors]` is on.
pub fn scope_errors(effects: &TableReader<'_>) -> bool {
    let table = effect(effects, "scope_errors");
    table.map(TableReader::finish).is_some()
}

/// `[effects.scope_noise]` (div).
pub fn scope_noise(effects: &TableReader<'_>) -> Option<f64> {
    let table = effect(effects, "scope_noise")?;
    let rms = table.required("rms", Dimension::DIVISION, Bound::NotNegative);
    table.finish();
    rms
}

/// `[effects.sensor_tolerance]`.
pub fn sensor_tolerance(effects: &TableReader<'_>) -> Option<SensorTolerance> {
    let table = effect(effects, "sensor_tolerance")?;
    let tolerance = sensors::tolerance(&table);
    table.finish();
    Some(tolerance)
}

/// Largest spread that is taken for one: beyond it a striker is no striker (1).
const MAX_SPREAD: f64 = 0.5;

/// `[effects.striker_speed_spread]` (1).
pub fn striker_speed_spread(effects: &TableReader<'_>, root: &TableReader<'_>) -> Option<f64> {
    let table = effect(effects, "striker_speed_spread")?;
    let bound = Bound::Within(0.0, MAX_SPREAD);
    let relative = table.required("relative", Dimension::NONE, bound);
    if !root.has("striker") {
        table.problem("", "no striker", "[striker], whose speed is spread");
    }
    table.finish();
    relative.filter(|relative| *relative > 0.0)
}
