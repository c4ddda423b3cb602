//! Paths through a scene's tree: finding, inserting, and what `*` stands for.

use std::collections::BTreeMap;

use super::document::{Entry, Node, Value};

/// Stands for every name in a path.
pub(super) const ANY: &str = "*";

pub(super) fn at<'a>(node: &'a Node, keys: &[&str]) -> Option<&'a Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    let Value::Table(table) = &node.value else { return None };
    at(&table.get(*first)?.node, rest)
}

pub(super) fn at_mut<'a>(node: &'a mut Node, keys: &[&str]) -> Option<&'a mut Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    let Value::Table(table) = &mut node.value else { return None };
    at_mut(&mut table.get_mut(*first)?.node, rest)
}

/// Puts `value` at the path, with tables on the way where there are none.
pub(super) fn insert(node: &mut Node, keys: &[&str], value: Value) {
    let place = node.place.clone();
    let Some((first, rest)) = keys.split_first() else {
        node.value = value;
        return;
    };
    let Value::Table(table) = &mut node.value else { return };
    let empty = || Entry {
        key_place: place.clone(),
        node: Node { place: place.clone(), value: Value::Table(BTreeMap::new()) },
    };
    insert(&mut table.entry((*first).to_owned()).or_insert_with(empty).node, rest, value);
}

pub(super) fn expand<'a>(
    node: &'a Node,
    keys: &[&str],
    path: &mut Vec<String>,
    found: &mut Vec<(String, &'a Node)>,
) {
    let Some((first, rest)) = keys.split_first() else {
        found.push((path.join("."), node));
        return;
    };
    let Value::Table(table) = &node.value else { return };
    for (key, entry) in table.iter().filter(|(key, _)| *first == ANY || key.as_str() == *first) {
        path.push(key.clone());
        expand(&entry.node, rest, path, found);
        path.pop();
    }
}

/// Names at the last place of a path that is there.
pub(super) fn known(root: &Node, keys: &[&str]) -> Vec<String> {
    let mut node = root;
    for key in keys {
        let Value::Table(table) = &node.value else { return Vec::new() };
        let next = if *key == ANY { table.values().next() } else { table.get(*key) };
        let Some(entry) = next else { return table.keys().cloned().collect() };
        node = &entry.node;
    }
    Vec::new()
}
