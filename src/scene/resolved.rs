//! A scene with its base and every default, as a scene again: the output of `hertzscope show`, and
//! the merged scene in recordings. Defaults and order of keys are those of their declarations.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::path::Path;
use std::rc::Rc;

use super::document::{
    DISTRIBUTION_KEYS, Entries, Entry, Node, Value, at, at_mut, inline, put, quoted_key,
};
use super::effects::{EffectsKeys, LOSS_KEYS};
use super::library::{self, LoadedScene};
use super::problem::SceneError;
use super::root::RootKeys;
use super::table::{Keys, Kind, keys_at};

/// File of a value that no file has.
const DEFAULT: &str = "default";

/// The scene `name`, an included one or a path, as a scene without a base.
///
/// # Errors
/// [`SceneError`] if there is no such scene, or its text is no TOML; its values are not checked.
pub(super) fn resolved(name: &Path) -> Result<String, SceneError> {
    let LoadedScene { name, mut root, .. } = library::load(name)?;
    let own = root.place.file().to_owned();
    let model = model_of(&root);
    if let Some(entries) = root.entries_mut() {
        entries.remove("base");
    }
    add_materials(&mut root);
    if let Some(model) = &model {
        remove_model_numbers(&mut root, model);
    }
    if let Ok(default) = Node::parse(DEFAULT, "") {
        add_defaults(&mut root, &[RootKeys::KEYS], &default);
    }
    let mut page = format!("# {name}, with its base and every default\n");
    Writer { own }.table(&mut page, &[], &root);
    let is_there = |effect: &str| at(&root, &["effects", effect]).is_some();
    let effects = EffectsKeys::KEYS.iter().chain(LOSS_KEYS).map(|key| key.name);
    // That of a described magnet is on without a table.
    let off = effects.filter(|effect| *effect != "magnet_law" && !is_there(effect));
    let off: BTreeSet<&str> = off.collect();
    if !off.is_empty() {
        let names: Vec<&str> = off.into_iter().collect();
        let _ = writeln!(page, "\n# effects without a table are off: {}", names.join(", "));
    }
    if let Some(model) = model {
        let _ = writeln!(page, "# the scope's own numbers: hertzscope list scopes {model}");
    }
    Ok(page)
}

/// A scene with everything it is based on, as a scene that is based on no other file.
///
/// Models that are included in the program keep their names; of those from other files the numbers
/// stay. None for a scope from another file: its numbers are read from a scope's file only.
pub(super) fn merged(loaded: &LoadedScene) -> Option<String> {
    let mut root = loaded.root.clone();
    let own = root.place.file().to_owned();
    let scope = model_of(&root);
    if let Some(entries) = root.entries_mut() {
        entries.remove("base");
    }
    add_materials(&mut root);
    if let Some(model) = scope {
        if !library::is_shipped("", &model) {
            return None;
        }
        remove_model_numbers(&mut root, &model);
    }
    library::remove_other_models(&mut root);
    let mut page = format!("# {}, with everything it is based on\n", loaded.name);
    Writer { own }.table(&mut page, &[], &root);
    Some(page)
}

/// Puts the defaults of `keys` into the table `node`, and those of keys below; `default` has their
/// place.
fn add_defaults(node: &mut Node, keys: Keys, default: &Node) {
    let Some(entries) = node.entries_mut() else { return };
    let is_wall = entries.get("wall").is_some_and(|e| matches!(e.node.value, Value::Flag(true)));
    for key in keys.iter().flat_map(|keys| keys.iter()) {
        let Some(entry) = entries.get_mut(key.name) else {
            // A sensor at the wall has no offset.
            let value = key.default_value().filter(|_| !(is_wall && key.name == "offset"));
            if let Some(value) = value {
                let node = Node { place: default.place.clone(), value };
                let entry = Entry { key_place: default.place.clone(), node };
                entries.insert(Rc::from(key.name), entry);
            }
            continue;
        };
        let node = &mut entry.node;
        match (key.kind, &mut node.value) {
            (Kind::Tables(_), Value::Table(tables)) => {
                for entry in Rc::make_mut(tables).values_mut() {
                    add_defaults(&mut entry.node, key.below(), default);
                }
            }
            (Kind::List(_), Value::List(items)) => {
                for item in Rc::make_mut(items) {
                    add_defaults(item, key.below(), default);
                }
            }
            _ => add_defaults(node, key.below(), default),
        }
    }
}

/// Puts the numbers of all materials that are named into `[materials]`.
fn add_materials(root: &mut Node) {
    let mut named = Vec::new();
    library::each_constant(root, &mut |kind, name, file| {
        if kind == "materials" {
            named.push((name.to_owned(), file.clone()));
        }
    });
    for (name, below) in named {
        if at(root, &["materials", &name]).is_none() {
            put(root, &["materials", &name], below);
        }
    }
}

/// The name of the scope's model.
fn model_of(root: &Node) -> Option<String> {
    at(root, &["scope", "model"]).and_then(Node::as_text).map(str::to_owned)
}

/// Removes the numbers of the scope's file: its model brings them back.
fn remove_model_numbers(root: &mut Node, model: &str) {
    let Some(scope) = at_mut(root, &["scope"]) else { return };
    let Ok(file) = library::instrument("", model, &scope.place.clone(), "") else { return };
    if let Some(entries) = scope.entries_mut() {
        entries.retain(|_, entry| entry.node.place.file() != file.place.file());
    }
}

/// Writes a tree as TOML.
struct Writer {
    /// The scene's own file.
    own: String,
}

impl Writer {
    fn table(&self, page: &mut String, path: &[&str], node: &Node) {
        let Value::Table(entries) = &node.value else { return };
        let is_uncertainty = path == ["uncertainty"];
        let mut flat = Vec::new();
        if is_uncertainty {
            flatten(entries, &mut Vec::new(), &mut flat);
        } else {
            flat.extend(
                sorted(path, entries)
                    .into_iter()
                    .filter(|(_, entry)| is_inline(path, &entry.node))
                    .map(|(name, entry)| (quoted_key(name), entry)),
            );
        }
        let deeper = sorted(path, entries);
        let deeper = deeper.iter().filter(|(_, e)| !is_uncertainty && !is_inline(path, &e.node));
        if !path.is_empty() && (!flat.is_empty() || entries.is_empty()) {
            let _ = writeln!(page, "\n[{}]", joined(path));
        }
        self.lines(page, &flat);
        for (name, entry) in deeper {
            let below: Vec<&str> = path.iter().copied().chain([*name]).collect();
            match &entry.node.value {
                Value::List(items) => {
                    for item in &**items {
                        let Value::Table(keys) = &item.value else { continue };
                        let _ = writeln!(page, "\n[[{}]]", joined(&below));
                        let keys = sorted(&below, keys);
                        let keys = keys.into_iter().map(|(name, e)| (quoted_key(name), e));
                        self.lines(page, &keys.collect::<Vec<_>>());
                    }
                }
                _ => self.table(page, &below, &entry.node),
            }
        }
    }

    fn lines(&self, page: &mut String, entries: &[(String, &Entry)]) {
        for (name, entry) in entries {
            let line = format!("{name} = {}", inline(&entry.node));
            let file = entry.node.place.file();
            let _ = if file == self.own {
                writeln!(page, "{line}")
            } else {
                writeln!(page, "{line:<36}  # {file}")
            };
        }
    }
}

/// The entries in the order of their declarations.
fn sorted<'e>(path: &[&str], entries: &'e Entries) -> Vec<(&'e str, &'e Entry)> {
    let keys = keys_at(&[RootKeys::KEYS], path);
    let place = |name: &str| {
        let mut keys = keys.iter().flat_map(|keys| keys.iter());
        keys.position(|key| key.name == name).unwrap_or(usize::MAX)
    };
    let mut sorted: Vec<_> = entries.iter().map(|(name, entry)| (&**name, entry)).collect();
    sorted.sort_by_key(|(name, _)| place(name));
    sorted
}

/// Whether a value is written on the line of its key.
fn is_inline(path: &[&str], node: &Node) -> bool {
    match &node.value {
        Value::Table(_) => path.first() == Some(&"chain"),
        Value::List(items) => !items.iter().any(|item| matches!(item.value, Value::Table(_))),
        _ => true,
    }
}

/// Paths of `[uncertainty]`, each with its entry.
fn flatten<'e>(entries: &'e Entries, above: &mut Vec<String>, flat: &mut Vec<(String, &'e Entry)>) {
    for (name, entry) in entries {
        above.push(quoted_key(name));
        match &entry.node.value {
            Value::Table(inner)
                if !DISTRIBUTION_KEYS.iter().any(|key| inner.contains_key(*key)) =>
            {
                flatten(inner, above, flat);
            }
            _ => flat.push((above.join("."), entry)),
        }
        above.pop();
    }
}

fn joined(path: &[&str]) -> String {
    path.iter().map(|name| quoted_key(name)).collect::<Vec<_>>().join(".")
}
