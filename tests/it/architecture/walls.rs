//! Which module uses which: every path in code that is not a test, resolved from the crate's root.

use super::paths::{self, PathUse};
use super::source::{self, SourceFile, Violation};
use super::table::Table;
use std::collections::BTreeSet;
use syn::ItemMod;
use syn::visit::{self, Visit};

/// Every use that the table does not allow, every module without a row, every `super::super`.
pub fn check(files: &[SourceFile], table: &Table) -> Vec<Violation> {
    let test_modules = source::test_modules(files);
    let mut violations = Vec::new();
    for file in files {
        if let Some(module) =
            file.module_path.first().filter(|module| !table.rows.contains_key(*module))
        {
            let message = format!("the module `{module}` has no row in ARCHITECTURE.md");
            violations.push(Violation::new(&file.path, 1, message));
        }
        for path in paths::of(file, source::is_test_file(file, &test_modules)) {
            let mut refuse = |message| violations.push(file.violation(path.span, message));
            let written = path.segments.join("::");
            if path.segments.windows(2).any(|pair| pair[0] == "super" && pair[1] == "super") {
                refuse(format!("`{written}`: no `super::super`; begin at `crate`"));
            }
            if let Some(message) = judge(&path, &written, table) {
                refuse(message);
            }
        }
        let mut walk = Names { file, violations: Vec::new() };
        walk.visit_file(&file.syntax);
        violations.append(&mut walk.violations);
    }
    violations.sort();
    violations.dedup();
    violations
}

/// What the table says against `path`, `written` like this.
fn judge(path: &PathUse, written: &str, table: &Table) -> Option<String> {
    if path.in_test {
        return None;
    }
    let module = path.module_path.first()?;
    let absolute = path.resolve()?;
    let row = table.rows.get(module)?;
    let Some(used) = absolute.first() else {
        return Some(format!("`{written}` is the crate's root; name the module that is meant"));
    };
    if used == module || row.may_use.contains(used) {
        None
    } else if table.rows.contains_key(used) {
        Some(format!("`{module}` may not use `{used}` (`{written}`)"))
    } else {
        Some(format!(
            "`{written}`: `{used}` is no module in ARCHITECTURE.md; reach it through its module"
        ))
    }
}

/// Looks for second names: of a module's file, and of the crate.
struct Names<'a> {
    file: &'a SourceFile,
    violations: Vec<Violation>,
}

impl<'ast> Visit<'ast> for Names<'_> {
    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if let Some(attribute) =
            module.attrs.iter().find(|attribute| attribute.path().is_ident("path"))
        {
            let message =
                format!("the module `{}` lies elsewhere than its name says", module.ident);
            self.violations.push(self.file.violation(attribute.pound_token.spans[0], message));
        }
        visit::visit_item_mod(self, module);
    }

    fn visit_item_extern_crate(&mut self, item: &'ast syn::ItemExternCrate) {
        if item.ident == "self" || item.ident == paths::CRATE {
            self.violations
                .push(self.file.violation(item.ident.span(), "the crate has no second name"));
        }
    }
}

/// What the rules say to one source in a house of four modules: `scope` may use `quantity` only.
fn found(path: &str, text: &str) -> Vec<String> {
    let table = super::table::example(&[
        ("quantity", "-"),
        ("scope", "quantity"),
        ("recording", "quantity, scope"),
        ("cli", "quantity, scope, recording"),
        ("main", "cli"),
    ]);
    check(&[source::example(path, text)], &table).iter().map(ToString::to_string).collect()
}

#[test]
fn every_way_to_use_another_module_is_seen() {
    let not_allowed = |written: &str| {
        vec![format!("src/scope/a.rs:2: `scope` may not use `recording` (`{written}`)")]
    };
    for (code, written) in [
        ("use crate::recording::Capture;", "crate::recording::Capture"),
        ("use crate::recording;", "crate::recording"),
        ("use crate::recording as r;", "crate::recording"),
        ("use crate::recording::*;", "crate::recording::*"),
        ("use crate::{quantity, recording::{Capture as C}};", "crate::recording::Capture"),
        ("use hertzscope::recording::Capture;", "hertzscope::recording::Capture"),
        ("pub use crate::recording::Capture;", "crate::recording::Capture"),
        ("fn f() { crate::recording::read(); }", "crate::recording::read"),
        ("fn f(c: &Vec<crate::recording::Capture>) {}", "crate::recording::Capture"),
        ("impl crate::recording::Read for A {}", "crate::recording::Read"),
        ("fn f() { use crate::recording::read; }", "crate::recording::read"),
        ("fn f() { println!(\"{}\", crate::recording::read()); }", "crate::recording::read"),
        ("macro_rules! m { () => { $crate::recording::read() } }", "crate::recording::read"),
        (
            "macro_rules! m { () => { use crate::{quantity, recording::A}; } }",
            "crate::recording::A",
        ),
        (
            "#[derive(D)] #[serde(with = \"crate::recording::text\")] struct A;",
            "crate::recording::text",
        ),
        ("mod inner { use crate::recording::Capture; }", "crate::recording::Capture"),
        ("mod inner { fn f() { super::g(); crate::recording::h() } }", "crate::recording::h"),
    ] {
        assert_eq!(found("src/scope/a.rs", &format!("\n{code}")), not_allowed(written), "{code}");
    }
}

#[test]
fn a_neighbour_is_reached_by_super_as_well() {
    assert_eq!(
        found("src/scope.rs", "use super::recording::Capture;"),
        ["src/scope.rs:1: `scope` may not use `recording` (`super::recording::Capture`)"]
    );
    assert_eq!(found("src/scope/trigger.rs", "use super::recording::Tape; use super::*;"), [""; 0]);
}

#[test]
fn allowed_uses_and_tests_are_clean() {
    for code in [
        "use crate::quantity::{self, parse}; use std::fmt; use crate::scope::Waveform; use self::inner::A;",
        "use mcap::recording::A; fn f() { recording::g(); }",
        "#[cfg(test)] mod tests { use super::*; use crate::recording::Capture; }",
        "#[cfg(test)] use crate::recording::Capture;",
        "impl A { #[cfg(test)] fn f() { crate::recording::g() } }",
        "pub(crate) fn f(&self) { self.g(); } pub(super) fn h() {} pub(in crate::scope) fn i() {}",
        "/// See [`crate::recording`].\n#[doc = \"crate::recording\"] fn f() { g(\"crate::recording\") }",
    ] {
        assert_eq!(found("src/scope/a.rs", code), [""; 0], "{code}");
    }
}

#[test]
fn the_root_is_no_way_around_the_table() {
    for code in [
        "use crate::*;",
        "use crate::Waveform;",
        "use crate::{self as root};",
        "fn f() { crate::g() }",
    ] {
        assert_eq!(found("src/scope/mod.rs", code).len(), 1, "{code}");
    }
    assert_eq!(found("src/scope/mod.rs", "extern crate self as root;").len(), 1);
    assert_eq!(found("src/scope/mod.rs", "#[path = \"../recording/tape.rs\"] mod tape;").len(), 1);
    assert_eq!(
        found("src/lib.rs", "pub mod scope; pub mod recording; pub use scope::Waveform;"),
        [""; 0]
    );
}

#[test]
fn main_sees_only_the_command_line() {
    assert_eq!(
        found("src/main.rs", "fn main() { hertzscope::cli::run() } mod a { use crate::b; }"),
        [""; 0]
    );
    assert_eq!(
        found("src/main.rs", "fn main() { hertzscope::scope::run() }"),
        ["src/main.rs:1: `main` may not use `scope` (`hertzscope::scope::run`)"]
    );
}

#[test]
fn a_module_without_row_is_found() {
    let message = "src/scpi/server.rs:1: the module `scpi` has no row in ARCHITECTURE.md";
    assert_eq!(found("src/scpi/server.rs", "fn f() {}"), [message]);
}

#[test]
fn super_super_is_found_in_tests_as_well() {
    for code in [
        "use super::super::quantity;",
        "use super::{super::quantity};",
        "fn f() { super::super::quantity::g() }",
        "#[cfg(test)] mod tests { fn f() { super::super::g() } }",
        "fn f() { assert!(super::super::quantity::g()) }",
        "pub(in super::super) fn f() {}",
    ] {
        let found = found("src/scope/trigger/edge.rs", code);
        assert!(found.len() == 1 && found[0].contains("no `super::super`"), "{code}: {found:?}");
    }
    assert_eq!(
        found("src/scope/trigger/edge.rs", "use super::level; use crate::scope::a;"),
        [""; 0]
    );
}

#[test]
fn a_file_that_is_all_test_is_exempt() {
    let table = super::table::example(&[("scope", "-"), ("recording", "-")]);
    let files = [
        source::example("src/scope/mod.rs", "#[cfg(test)] mod tests;"),
        source::example("src/scope/tests.rs", "use crate::recording::Capture;"),
    ];
    assert!(check(&files, &table).is_empty());
    assert_eq!(check(&files[1..], &table).len(), 1);
    assert_eq!(
        BTreeSet::from([vec!["scope".to_owned(), "tests".to_owned()]]),
        source::test_modules(&files)
    );
}
