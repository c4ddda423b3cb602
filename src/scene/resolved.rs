//! A scene with its base and every default, as a scene again: what `hertzscope show` prints.
//!
//! Defaults are those of the annotated scene `instruments/help/scene.toml`: lines whose comment
//! begins with `default`, followed by the value where that is another than the line's. Tests hold
//! that the result is the same scene.

use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::rc::Rc;

use super::document::{DISTRIBUTION_KEYS, Entries, Entry, Node, Value};
use super::library::{self, LoadedScene};
use super::problem::SceneError;
use super::tree;
use crate::data;

/// File of a value that no file says.
const DEFAULT: &str = "default";

/// The scene `name`, one that ships or a path, as a scene that stands on none.
///
/// # Errors
/// [`SceneError`] if there is no such scene, or its text is not TOML; its values are not checked.
pub fn resolved(name: &str) -> Result<String, SceneError> {
    let LoadedScene { name, mut root, .. } = library::load(name)?;
    let own = root.place.file().to_owned();
    let keys = documented_keys();
    let model = root_text(&root, &["scope", "model"]);
    if let Some(entries) = root.entries_mut() {
        entries.remove("base");
    }
    add_materials(&mut root);
    if let Some(model) = &model {
        remove_model_numbers(&mut root, model);
    }
    for key in keys.iter().filter(|key| key.default.is_some()) {
        add_default(&mut root, &key.table, key);
    }
    let mut page = format!("# {name}, with its base and every default\n");
    let writer = Writer { own, keys };
    writer.table(&mut page, &[], &root);
    let on = tree::at(&root, &["effects"]);
    let off: BTreeSet<&str> = writer
        .keys
        .iter()
        .filter_map(|key| match key.table.as_slice() {
            // That of a described magnet is on without a table.
            ["effects", effect] if *effect != tree::ANY && *effect != "magnet_law" => Some(*effect),
            _ => None,
        })
        .filter(|effect| on.is_none_or(|on| tree::at(on, &[effect]).is_none()))
        .collect();
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
/// Models that ship with the program keep their names; of those from other files the numbers stay.
/// None for a scope from another file: its numbers are read from a scope's file only.
pub(super) fn merged(loaded: &LoadedScene) -> Option<String> {
    let mut root = loaded.root.clone();
    let own = root.place.file().to_owned();
    let scope = root_text(&root, &["scope", "model"]);
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
    Writer { own, keys: documented_keys() }.table(&mut page, &[], &root);
    Some(page)
}

/// The annotated scene with every key.
pub fn annotated_scene() -> &'static str {
    data::instrument("help", "scene").unwrap_or_default()
}

/// The annotated plan of a calibration with every key.
pub fn annotated_plan() -> &'static str {
    data::instrument("help", "plan").unwrap_or_default()
}

/// A key of the annotated scene.
struct DocumentedKey {
    /// Path of its table; `*` is every name.
    table: Vec<&'static str>,
    name: &'static str,
    /// Its default as TOML.
    default: Option<&'static str>,
}

/// Every key of the annotated scene in its order, those of alternatives included.
fn documented_keys() -> Vec<DocumentedKey> {
    let mut table: Vec<&'static str> = Vec::new();
    let mut keys = Vec::new();
    for line in annotated_scene().lines() {
        let line = line.strip_prefix("# ").unwrap_or(line);
        let header = line.strip_prefix('[').and_then(|rest| rest.split_once(']'));
        if let Some((path, _)) = header {
            table = path.trim_matches('[').split('.').collect();
            if let ["particles" | "materials" | "sensors", name] | ["effects", name @ "NAME"] =
                &mut table[..]
            {
                *name = tree::ANY;
            }
            keys.push(DocumentedKey { table: table.clone(), name: "", default: None });
            continue;
        }
        let Some((name, rest)) = line.split_once(" = ") else { continue };
        if name.contains(|c: char| !c.is_ascii_alphanumeric() && !"_.\"*".contains(c)) {
            continue;
        }
        let (value, comment) = rest.split_once(" # ").unwrap_or((rest, ""));
        let default = comment.trim().strip_prefix(DEFAULT).and_then(|words| {
            let end = words.find([';', ':']).unwrap_or(words.len());
            match (words[..end].trim(), words[end..].starts_with(':')) {
                ("", false) => Some(value.trim()),
                ("", true) => None,
                (stated, _) => Some(stated),
            }
        });
        keys.push(DocumentedKey { table: table.clone(), name, default });
    }
    keys
}

/// Puts the default of `key` into every table at `path` below `node` that lacks it.
fn add_default(node: &mut Node, path: &[&str], key: &DocumentedKey) {
    match (&mut node.value, path) {
        (Value::List(items), _) => {
            for item in Rc::make_mut(items) {
                add_default(item, path, key);
            }
        }
        (Value::Table(entries), []) => {
            // A sensor at the wall has no offset.
            let is_wall =
                entries.get("wall").is_some_and(|e| matches!(e.node.value, Value::Flag(true)));
            if entries.contains_key(key.name) || (is_wall && key.name == "offset") {
                return;
            }
            let line = format!("{} = {}", key.name, key.default.unwrap_or_default());
            if let Ok(Node { value: Value::Table(default), .. }) = Node::parse(DEFAULT, &line) {
                Rc::make_mut(entries).extend((*default).clone());
            }
        }
        (Value::Table(entries), [first, rest @ ..]) => {
            // Channels are alike.
            let is_meant = |name: &str| match *first {
                tree::ANY => true,
                "ch1" => name.len() == 3 && name.starts_with("ch"),
                first => name == first,
            };
            let below = Rc::make_mut(entries).iter_mut().filter(|(name, _)| is_meant(name));
            below.for_each(|(_, entry)| add_default(&mut entry.node, rest, key));
        }
        _ => {}
    }
}

fn root_text(root: &Node, path: &[&str]) -> Option<String> {
    match &tree::at(root, path)?.value {
        Value::Text(text) => Some(text.to_string()),
        _ => None,
    }
}

/// Puts the numbers of all materials that are named into `[materials]`.
fn add_materials(root: &mut Node) {
    let mut named = Vec::new();
    collect_materials(root, &mut named);
    for (name, below) in named {
        if tree::at(root, &["materials", &name]).is_none() {
            tree::put(root, &["materials", &name], below);
        }
    }
}

fn collect_materials(node: &Node, named: &mut Vec<(String, Node)>) {
    match &node.value {
        Value::Table(entries) => {
            for key in ["material", "wall"] {
                let Some((name, place)) = node.text(key) else { continue };
                if let Ok(file) = library::instrument("materials", name, place, key) {
                    named.push((name.to_owned(), (*file).clone()));
                }
            }
            entries.values().for_each(|entry| collect_materials(&entry.node, named));
        }
        Value::List(items) => items.iter().for_each(|item| collect_materials(item, named)),
        _ => {}
    }
}

/// Takes out what the scope's file says: its model brings that back.
fn remove_model_numbers(root: &mut Node, model: &str) {
    let Some(scope) = tree::at_mut(root, &["scope"]) else { return };
    let Ok(file) = library::instrument("", model, &scope.place.clone(), "") else { return };
    if let Some(entries) = scope.entries_mut() {
        entries.retain(|_, entry| entry.node.place.file() != file.place.file());
    }
}

/// Writes a tree as TOML.
struct Writer {
    /// The scene's own file.
    own: String,
    keys: Vec<DocumentedKey>,
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
                self.sorted(path, entries)
                    .into_iter()
                    .filter(|(_, entry)| is_inline(path, &entry.node))
                    .map(|(name, entry)| (quoted_key(name), entry)),
            );
        }
        let deeper = self.sorted(path, entries);
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
                        let keys = self.sorted(&below, keys);
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

    /// The entries in the order of the annotated scene.
    fn sorted<'e>(&self, path: &[&str], entries: &'e Entries) -> Vec<(&'e str, &'e Entry)> {
        let fits = |pattern: &str, name: &str| {
            pattern == name || pattern == tree::ANY || (pattern == "ch1" && name.starts_with("ch"))
        };
        let place = |name: &str| {
            let is = |key: &DocumentedKey| {
                let of_table = key.table.len() == path.len() && key.name == name;
                let below = key.table.len() > path.len()
                    && key.table.get(path.len()).is_some_and(|part| fits(part, name));
                (of_table || below) && path.iter().zip(&key.table).all(|(p, part)| fits(part, p))
            };
            self.keys.iter().position(is).unwrap_or(usize::MAX)
        };
        let mut sorted: Vec<_> = entries.iter().map(|(name, entry)| (&**name, entry)).collect();
        sorted.sort_by_key(|(name, _)| place(name));
        sorted
    }
}

/// Whether a value stands on the line of its key.
fn is_inline(path: &[&str], node: &Node) -> bool {
    match &node.value {
        Value::Table(_) => path.first() == Some(&"chain"),
        Value::List(items) => !items.iter().any(|item| matches!(item.value, Value::Table(_))),
        _ => true,
    }
}

/// Paths of `[uncertainty]`, each with what it says.
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

/// A value on one line.
fn inline(node: &Node) -> String {
    match &node.value {
        Value::Text(text) => quoted(text),
        Value::Number { typed, .. } => typed.to_string(),
        Value::Flag(flag) => flag.to_string(),
        Value::Date(date) => date.to_string(),
        Value::List(items) => {
            format!("[{}]", items.iter().map(inline).collect::<Vec<_>>().join(", "))
        }
        Value::Table(entries) => {
            let pair = |(name, entry): (&Rc<str>, &Entry)| {
                format!("{} = {}", quoted_key(name), inline(&entry.node))
            };
            format!("{{ {} }}", entries.iter().map(pair).collect::<Vec<_>>().join(", "))
        }
    }
}

/// A TOML basic string: JSON's escapes are among TOML's.
fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

fn quoted_key(name: &str) -> String {
    let is_bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if !name.is_empty() && name.chars().all(is_bare) { name.to_owned() } else { quoted(name) }
}

fn joined(path: &[&str]) -> String {
    path.iter().map(|name| quoted_key(name)).collect::<Vec<_>>().join(".")
}
