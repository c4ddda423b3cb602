//! Circles of files inside a module: files that use each other, directly or over others.
//!
//! A file uses another of its module where a path in it, outside of tests, leads to an item that
//! the other defines, or names the other as a module. Two things are no use: a declaration,
//! `mod child;`, and a re-export, `pub use child::Item;`, which only gives an item a second
//! address. A path through a re-export leads to the file that defines the item. So a `mod.rs` may
//! declare and re-export its children, and may use them; but then its children must not use what
//! the `mod.rs` defines itself. What children and parent both need is a file of its own beside the
//! children.
//!
//! Limits: methods are called without a path, and are not seen. Names are looked up without regard
//! to scopes inside functions.

use super::paths::{self, PathUse};
use super::source::{self, SourceFile, Violation};
use std::collections::{BTreeMap, BTreeSet};

/// Files by their module paths, with the names that each makes known by `use` and where those lead.
struct Files<'a> {
    by_module: BTreeMap<&'a [String], usize>,
    bindings: Vec<BTreeMap<String, Vec<String>>>,
}

impl<'a> Files<'a> {
    fn of(files: &'a [SourceFile], paths: &[Vec<PathUse>]) -> Self {
        let by_module =
            files.iter().enumerate().map(|(index, file)| (&*file.module_path, index)).collect();
        let mut all = Self { by_module, bindings: Vec::new() };
        all.bindings = paths.iter().map(|paths| all.bindings_of(paths)).collect();
        all
    }

    fn bindings_of(&self, paths: &[PathUse]) -> BTreeMap<String, Vec<String>> {
        let bound = paths.iter().filter(|path| !path.in_test);
        bound
            .filter_map(|path| {
                let name = path.binding.as_ref()?.name.clone();
                Some((name, path.resolve().or_else(|| self.in_child(path))?))
            })
            .collect()
    }

    /// The path from the crate's root where `path` begins with the name of a child of its module.
    fn in_child(&self, path: &PathUse) -> Option<Vec<String>> {
        let first = path.segments.first()?;
        let child = [&*path.module_path, std::slice::from_ref(first)].concat();
        let is_file = self.by_module.contains_key(&*child);
        is_file.then(|| [&*path.module_path, &*path.segments].concat())
    }

    /// The same for `path` in the file of number `index`, by the names that its declarations make
    /// known as well.
    fn absolute(&self, path: &PathUse, index: usize) -> Option<Vec<String>> {
        let (first, rest) = path.segments.split_first()?;
        let bound = || Some([self.bindings.get(index)?.get(first)?, rest].concat());
        path.resolve().or_else(|| self.in_child(path)).or_else(bound)
    }

    /// The file that defines what `absolute` names.
    fn definition(&self, absolute: &[String]) -> Option<usize> {
        let mut absolute = absolute.to_vec();
        // Longer chains of re-exports than this there are none.
        for _ in 0..8 {
            let (length, index) = (1..=absolute.len())
                .rev()
                .find_map(|length| Some((length, *self.by_module.get(&absolute[..length])?)))?;
            let name = absolute.get(length);
            match name.and_then(|name| self.bindings.get(index)?.get(name)) {
                Some(target) => absolute = [target, &absolute[length + 1..]].concat(),
                None => return Some(index),
            }
        }
        None
    }
}

/// For each file, the files of its module that it uses.
fn uses(files: &[SourceFile]) -> Vec<BTreeSet<usize>> {
    let test_modules = source::test_modules(files);
    let paths: Vec<Vec<PathUse>> = files
        .iter()
        .map(|file| paths::of(file, source::is_test_file(file, &test_modules)))
        .collect();
    let all = Files::of(files, &paths);
    let module = |index: usize| files[index].module_path.first();
    let of = |(index, paths): (usize, &Vec<PathUse>)| {
        let code = paths.iter().filter(|path| {
            !path.in_test && !path.binding.as_ref().is_some_and(|binding| binding.exported)
        });
        let used = code.filter_map(|path| all.definition(&all.absolute(path, index)?));
        used.filter(|used| *used != index && module(*used) == module(index)).collect()
    };
    paths.iter().enumerate().map(of).collect()
}

/// Whatever can be reached from `start` over `uses`.
fn reached(uses: &[BTreeSet<usize>], start: usize) -> BTreeSet<usize> {
    let (mut found, mut open) = (BTreeSet::new(), vec![start]);
    while let Some(file) = open.pop() {
        open.extend(uses[file].iter().filter(|next| found.insert(**next)));
    }
    found
}

/// The circles: files that reach each other, each file in one of them at most, by their paths in
/// order.
fn circles(files: &[SourceFile]) -> Vec<BTreeSet<&str>> {
    let uses = uses(files);
    let reached: Vec<_> = (0..files.len()).map(|index| reached(&uses, index)).collect();
    let circle = |index: usize| -> BTreeSet<&str> {
        let back = reached[index].iter().filter(|other| reached[**other].contains(&index));
        back.map(|other| &*files[*other].path).collect()
    };
    let found: BTreeSet<_> = (0..files.len()).map(circle).filter(|c| c.len() > 1).collect();
    found.into_iter().collect()
}

/// Circles that `known` does not cover, and files of `known` that are in no circle any more. An
/// entry that ends in `/` covers all below it.
pub fn check(files: &[SourceFile], known: &[&[&str]]) -> Vec<Violation> {
    let circles = circles(files);
    let covers = |entries: &[&str], path: &str| {
        entries
            .iter()
            .any(|entry| *entry == path || (entry.ends_with('/') && path.starts_with(entry)))
    };
    let unknown = circles.iter().filter(|circle| {
        !known.iter().any(|entries| circle.iter().all(|path| covers(entries, path)))
    });
    let mut violations: Vec<Violation> = unknown
        .filter_map(|circle| {
            let list: Vec<&str> = circle.iter().copied().collect();
            let message = format!("files use each other in a circle: {}", list.join(", "));
            Some(Violation::new(list.first()?, 1, message))
        })
        .collect();
    for entry in known.iter().copied().flatten() {
        if !circles.iter().flatten().any(|path| covers(&[entry], path)) {
            let message = "is in no circle any more: remove it from the list of known ones";
            violations.push(Violation::new(entry, 1, message));
        }
    }
    violations
}

/// What the rule says to files of one module, with nothing known.
fn found(sources: &[(&str, &str)]) -> Vec<String> {
    let files: Vec<_> = sources.iter().map(|(path, text)| source::example(path, text)).collect();
    check(&files, &[]).iter().map(ToString::to_string).collect()
}

#[test]
fn files_that_use_each_other_are_found() {
    let message =
        "src/scope/a.rs:1: files use each other in a circle: src/scope/a.rs, src/scope/b.rs";
    for (a, b) in [
        ("use super::b::B;", "use super::a::A;"),
        ("use super::b;", "use crate::scope::a::A;"),
        ("fn f() { super::b::g() }", "fn g(a: super::a::A) {}"),
        ("use super::b::{self, B};", "fn g() { println!(\"{}\", super::a::f()) }"),
        // Over a name that the parent re-exports.
        ("pub struct A; use super::B;", "pub struct B; use super::A;"),
    ] {
        let parent = "mod a; mod b; pub use a::A; pub use b::B;";
        let files = [("src/scope/mod.rs", parent), ("src/scope/a.rs", a), ("src/scope/b.rs", b)];
        assert_eq!(found(&files), [message], "{a} {b}");
    }
}

#[test]
fn a_parent_that_declares_and_exports_is_in_no_circle() {
    let child = ("src/scope/a.rs", "pub struct A; use super::B;");
    for (parent, circles) in [
        ("mod a; pub use a::A; pub struct B;", 0),
        ("mod a; use a::A; pub struct B;", 1),
        ("mod a; pub use a::A; pub struct B; fn f(a: A) {}", 1),
        ("mod a; pub struct B; fn f() { a::g() }", 1),
        ("mod a; pub struct B; #[cfg(test)] mod tests { use super::a::A; }", 0),
    ] {
        assert_eq!(found(&[("src/scope/mod.rs", parent), child]).len(), circles, "{parent}");
    }
}

#[test]
fn other_modules_and_ways_without_return_are_no_circle() {
    let files = [
        ("src/scope/a.rs", "use super::b::B; use crate::trace::T;"),
        ("src/scope/b.rs", "use super::c::C;"),
        ("src/scope/c.rs", "use std::fmt; use a::b;"),
        ("src/trace.rs", "use crate::scope::a::A;"),
    ];
    assert_eq!(found(&files), [""; 0]);
}

#[test]
fn known_circles_are_left_and_must_go_from_the_list_once_resolved() {
    let files = [
        source::example("src/scope/a.rs", "use super::b::B;"),
        source::example("src/scope/b.rs", "use super::a::A;"),
    ];
    for known in [&["src/scope/a.rs", "src/scope/b.rs"][..], &["src/scope/"]] {
        assert!(check(&files, &[known]).is_empty(), "{known:?}");
    }
    assert_eq!(check(&files, &[&["src/scope/a.rs"], &["src/scope/b.rs"]]).len(), 1);
    let found = check(&files, &[&["src/scope/a.rs", "src/scope/b.rs", "src/scope/c.rs"]]);
    let message =
        "src/scope/c.rs:1: is in no circle any more: remove it from the list of known ones";
    assert_eq!(found.iter().map(ToString::to_string).collect::<Vec<_>>(), [message]);
}
