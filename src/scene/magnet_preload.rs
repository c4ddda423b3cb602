//! The magnet that pulls a particle: `[effects.magnet_preload]` and `[effects.magnet_law]`.

use super::bodies::last_particle;
use super::document::Value;
use super::magnets;
use super::reader::effect;
use super::reader::{Bound, TableReader};
use crate::chain::{EffectsSpec, MagnetForce, MagnetLaw, MagnetPreload, PlacedAt, PlacedMagnet};
use crate::magnet::Magnet;
use crate::quantity::{Dimension, engineering};

/// Keys of the position of a ring or table.
const PLACES: [&str; 3] = ["distance", "distance_unloaded", "force"];

/// Reads both tables into `spec`. A described magnet's force follows the particle unless the scene
/// says otherwise.
pub fn magnet(effects: &TableReader<'_>, particles: usize, spec: &mut EffectsSpec) {
    if let Some(table) = effect(effects, "magnet_preload") {
        let force = force(&table);
        if !table.has("particle") {
            table.problem("particle", "no such key", "the particle that the magnet pulls, e.g. 1");
        }
        let particle = table.count("particle", 1, last_particle(particles));
        let particle = particle.and_then(|p| usize::try_from(p).ok());
        spec.magnet_preload =
            force.zip(particle).map(|(force, particle)| MagnetPreload { particle, force });
        table.finish();
    }
    let constant = |magnet: &MagnetPreload| matches!(magnet.force, MagnetForce::Constant(_));
    let refused = effects.node("magnet_law").map(|node| &node.value);
    let refused = matches!(refused, Some(Value::Flag(false)));
    if let Some(table) = effect(effects, "magnet_law") {
        if spec.magnet_preload.as_ref().is_some_and(constant) {
            let expected = "a magnet with outer_diameter, ... or [[measured]], whose force changes with distance";
            table.problem("", "a magnet of constant force", expected);
        }
        table.finish();
    }
    let described = spec.magnet_preload.as_ref().is_some_and(|magnet| !constant(magnet));
    spec.magnet_law = (described && !refused).then_some(MagnetLaw);
}

fn force(table: &TableReader<'_>) -> Option<MagnetForce> {
    let model = table.text("model");
    let source = table.text("source").unwrap_or_default().to_owned();
    let force =
        |table: &TableReader<'_>| table.required("force", Dimension::FORCE, Bound::NotNegative);
    match (table.has("outer_diameter"), table.has("measured")) {
        (false, false) => return force(table).map(MagnetForce::Constant),
        (true, true) => {
            let _ = (magnets::law(table), table.list("measured"));
            for key in PLACES {
                let _ = table.node(key);
            }
            table.problem("measured", "a table beside a ring", "one of them");
            return None;
        }
        _ => (),
    }
    let law = magnets::law(table);
    let temperature = table.quantity("temperature", Dimension::TEMPERATURE, Bound::Positive);
    let found: Vec<&str> = PLACES.into_iter().filter(|key| table.has(key)).collect();
    let length = |key| table.quantity(key, Dimension::LENGTH, Bound::Any);
    let [distance, unloaded] = [length("distance"), length("distance_unloaded")];
    let wanted = found.contains(&"force").then(|| force(table)).flatten();
    if found.len() != 1 {
        let expected = "one of distance (in the static state), distance_unloaded and force, the magnet's position";
        let listed = if found.is_empty() { "none of them".to_owned() } else { found.join(" and ") };
        table.problem("distance", listed, expected);
        return None;
    }
    let name = model.map_or_else(|| "magnet".to_owned(), str::to_owned);
    let magnet = Magnet { name, source, law: law? };
    let temperature = temperature.unwrap_or(magnet.stated_temperature());
    let at = match (distance, unloaded, wanted) {
        (Some(distance), _, _) => PlacedAt::Rest(distance),
        (_, Some(distance), _) => PlacedAt::Unloaded(distance),
        (_, _, Some(force)) => {
            let Some(nearest) = magnet.distances(force, temperature).first().copied() else {
                let found = format!("{}, which it reaches nowhere", engineering(force, "N", 4));
                table.problem("force", found, "a force that `hertzscope magnet` shows");
                return None;
            };
            PlacedAt::Pull { force, distance: nearest }
        }
        _ => return None,
    };
    Some(MagnetForce::Placed(PlacedMagnet { magnet, temperature, at }))
}
