//! What is left of an instrument, or of an end of the chain, when a scene names another one over its base scene's.

use super::document::{Node, Value};
use super::library::instrument;
use super::tree::{at, at_mut};

/// The ends of a chain.
const ENDS: [&str; 2] = ["top", "bottom"];

/// Takes away what the model of a sensor or magnet said below where another model is named above: half of each would be neither.
pub fn forget_models(above: &Node, below: &mut Node) {
    let child = |node: &Node, key: &str| match &node.value {
        Value::Table(table) => table.get(key).map(|entry| entry.node.clone()),
        _ => None,
    };
    for (folder, kind, only) in
        [("sensors", "sensors", None), ("effects", "magnets", Some("magnet_preload"))]
    {
        let Some(above) = child(above, folder) else { continue };
        let Some(below) = below.entries_mut().and_then(|b| b.get_mut(folder)) else { continue };
        let Some(below) = below.node.entries_mut() else { continue };
        for (name, entry) in below.iter_mut().filter(|(name, _)| only.is_none_or(|o| o == &***name))
        {
            if child(&above, name).and_then(|node| node.text("model").map(|_| ())).is_some() {
                forget_model(&mut entry.node, kind);
            }
        }
    }
}

/// Takes away the ends of the chain below that are others above: half of each would be neither.
pub fn forget_ends(above: &Node, below: &mut Node) {
    let (Some(above), Some(below)) = (at(above, &["chain"]), at_mut(below, &["chain"])) else {
        return;
    };
    if let Some(ends) = below.entries_mut() {
        ends.retain(|key, _| !ENDS.contains(&&**key) || at(above, &[key]).is_none());
    }
}

/// Takes away what the model said that this table names, so that another's can take its place; what the scene says itself stays.
pub fn forget_model(table: &mut Node, kind: &str) {
    let Some((model, place)) = table.text("model") else { return };
    let Ok(file) = instrument(kind, model, place, "") else { return };
    if let Some(keys) = table.entries_mut() {
        keys.retain(|_, entry| entry.node.place.file() != file.place.file());
    }
}
