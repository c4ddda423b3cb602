//! A scene with anything in it replaced: numbers, names of models, lists, whole tables. What a
//! sweep makes its scenes from.

use super::Scene;
use super::adjust::{AdjustError, Adjustable};
use super::document::{Node, Value};
use super::library;
use super::library::remove_model;
use super::problem::{Problem, SceneError};
use super::tree::{ANY, at_mut, expand, known, put};

/// A path and its new value.
#[derive(Debug, Clone)]
pub struct SceneOverride<'a> {
    /// Paths in the scene, `striker.speed`; a number is a place in a list, counted from 1.
    pub paths: &'a [String],
    /// The new value.
    pub node: Node,
}

impl Adjustable {
    /// The paths that `path` means: `*` is every name there is. A path without it may lead to what
    /// the scene leaves out.
    ///
    /// # Errors
    /// [`AdjustError::Nothing`] where `*` finds no name, and [`AdjustError::Scene`] where the scene
    /// itself is wrong.
    pub fn paths(&mut self, path: &str) -> Result<Vec<String>, AdjustError> {
        let keys: Vec<&str> = path.split('.').map(str::trim).collect();
        self.lay_open(&keys)?;
        if !keys.contains(&ANY) {
            return Ok(vec![keys.join(".")]);
        }
        let mut found = Vec::new();
        expand(&self.loaded.root, &keys, &mut Vec::new(), &mut found);
        if found.is_empty() {
            let known = known(&self.loaded.root, &keys);
            return Err(AdjustError::Nothing { path: path.to_owned(), known });
        }
        Ok(found.into_iter().map(|(path, _)| path).collect())
    }

    /// The scene with `settings` and this seed.
    ///
    /// # Errors
    /// [`SceneError`] with everything that is wrong with it, each problem where it was typed.
    pub fn varied(&self, settings: &[SceneOverride<'_>], seed: u64) -> Result<Scene, SceneError> {
        let mut root = self.loaded.root.clone();
        for SceneOverride { paths, node } in settings {
            for path in *paths {
                let keys: Vec<&str> = path.split('.').collect();
                change(&mut root, &keys, node.clone()).map_err(SceneError::Problems)?;
            }
        }
        let mut scene = self.standing_on(root)?;
        scene.seed = seed;
        Ok(scene)
    }
}

fn change(root: &mut Node, keys: &[&str], node: Node) -> Result<(), Vec<Problem>> {
    let place = node.place.clone();
    let name = if let Value::Text(name) = &node.value { Some(name.clone()) } else { None };
    if let (Some(kind), Some(name)) = (folder(keys), name) {
        let file = library::instrument(kind, &name, &place, &keys.join("."))?;
        if let Some(table) = at_mut(root, &keys[..keys.len() - 1]) {
            remove_model(table, kind);
            table.put_over(&file);
        }
    }
    if put(root, keys, node) {
        return Ok(());
    }
    let path = keys.join(".");
    let expected = format!("one of {}", known(root, keys).join(", "));
    Err(vec![place.problem(&path, "nothing there in the scene".to_owned(), expected)])
}

/// The folder that a model lies in, where a path names one.
fn folder(keys: &[&str]) -> Option<&'static str> {
    match keys {
        ["striker", "model"] => Some("strikers"),
        ["scope", "model"] => Some(""),
        ["effects", "magnet_preload", "model"] => Some("magnets"),
        ["sensors", _, "model"] => Some("sensors"),
        _ => None,
    }
}
