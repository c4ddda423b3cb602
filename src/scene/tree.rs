//! Paths through a scene's tree: finding, inserting, and what `*` stands for. A number is a place
//! in a list, counted from 1.

use std::rc::Rc;

use super::document::{Entries, Entry, Node, Value};

/// Stands for every name in a path.
pub(super) const ANY: &str = "*";

pub(super) fn at<'a>(node: &'a Node, keys: &[&str]) -> Option<&'a Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    match &node.value {
        Value::Table(table) => at(&table.get(*first)?.node, rest),
        Value::List(items) => at(items.get(place_in_list(first)?)?, rest),
        _ => None,
    }
}

/// `1` is the first of a list.
fn place_in_list(key: &str) -> Option<usize> {
    key.parse::<usize>().ok()?.checked_sub(1)
}

pub(super) fn at_mut<'a>(node: &'a mut Node, keys: &[&str]) -> Option<&'a mut Node> {
    let Some((first, rest)) = keys.split_first() else { return Some(node) };
    match &mut node.value {
        Value::Table(table) => at_mut(&mut Rc::make_mut(table).get_mut(*first)?.node, rest),
        Value::List(items) => at_mut(Rc::make_mut(items).get_mut(place_in_list(first)?)?, rest),
        _ => None,
    }
}

/// Puts `value` at the path, creating the tables on the way.
pub(super) fn insert(node: &mut Node, keys: &[&str], value: Value) {
    let place = node.place.clone();
    put(node, keys, Node { place, value });
}

/// Puts `new` at the path, creating the tables on the way; false where it cannot: a list is not
/// made longer, and what is no table has nothing in it.
pub(super) fn put(node: &mut Node, keys: &[&str], new: Node) -> bool {
    let Some((first, rest)) = keys.split_first() else {
        *node = new;
        return true;
    };
    match &mut node.value {
        Value::Table(table) => {
            let table = Rc::make_mut(table);
            if !table.contains_key(*first) {
                let place = new.place.clone();
                let value = Value::Table(Rc::new(Entries::new()));
                let node = Node { place: place.clone(), value };
                table.insert(Rc::from(*first), Entry { key_place: place, node });
            }
            table.get_mut(*first).is_some_and(|entry| put(&mut entry.node, rest, new))
        }
        Value::List(items) => {
            let items = Rc::make_mut(items);
            let item = place_in_list(first).and_then(|index| items.get_mut(index));
            item.is_some_and(|item| put(item, rest, new))
        }
        _ => false,
    }
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
    let mut deeper = |key: String, node: &'a Node| {
        path.push(key);
        expand(node, rest, path, found);
        path.pop();
    };
    let meant = |key: &str| *first == ANY || key == *first;
    match &node.value {
        Value::Table(table) => {
            let entries = table.iter().filter(|(key, _)| meant(key));
            entries.for_each(|(key, entry)| deeper(key.to_string(), &entry.node));
        }
        Value::List(items) => {
            let items = (1..).map(|place: usize| place.to_string()).zip(&**items);
            items.filter(|(key, _)| meant(key)).for_each(|(key, node)| deeper(key, node));
        }
        _ => {}
    }
}

/// Whether the way along `path` leads through no list.
pub(super) fn is_in_tables(root: &Node, path: &str) -> bool {
    let keys: Vec<&str> = path.split('.').collect();
    let is_table = |end| matches!(at(root, &keys[..end]).map(|n| &n.value), Some(Value::Table(_)));
    (0..keys.len()).all(is_table)
}

/// Names at the last place of a path that is there.
pub(super) fn known(root: &Node, keys: &[&str]) -> Vec<String> {
    let mut node = root;
    for key in keys {
        let next = match &node.value {
            Value::Table(table) if *key == ANY => table.values().next().map(|entry| &entry.node),
            Value::List(items) if *key == ANY => items.first(),
            _ => at(node, &[key]),
        };
        node = match (next, &node.value) {
            (Some(next), _) => next,
            (None, Value::Table(table)) => return table.keys().map(ToString::to_string).collect(),
            (None, Value::List(items)) => {
                return (1..=items.len()).map(|i| i.to_string()).collect();
            }
            _ => return Vec::new(),
        };
    }
    Vec::new()
}
