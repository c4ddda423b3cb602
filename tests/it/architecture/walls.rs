//! Which module uses which: every path in code that is not a test, resolved from the crate's root.
//!
//! Paths are looked for in `use` declarations, in expressions, types and patterns, in the tokens of macro
//! calls, and in the texts of attributes (`#[serde(with = "crate::...")]`).

use super::source::{self, SourceFile, Violation};
use super::table::Table;
use proc_macro2::{Span, TokenStream, TokenTree};
use std::collections::BTreeSet;
use syn::visit::{self, Visit};
use syn::{Attribute, ImplItem, Item, ItemMod, Macro, TraitItem, UseTree, VisRestricted};

/// The library's name, by which `main.rs` reaches it.
const CRATE: &str = "hertzscope";

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
        let mut walk = Walk {
            file,
            table,
            module_path: file.module_path.clone(),
            in_test: source::is_test_file(file, &test_modules),
            violations: Vec::new(),
        };
        walk.visit_file(&file.syntax);
        violations.append(&mut walk.violations);
    }
    violations.sort();
    violations.dedup();
    violations
}

struct Walk<'a> {
    file: &'a SourceFile,
    table: &'a Table,
    /// The module that the walk is in, from the crate's root.
    module_path: Vec<String>,
    in_test: bool,
    violations: Vec<Violation>,
}

impl Walk<'_> {
    fn violation(&mut self, span: Span, message: impl Into<String>) {
        self.violations.push(self.file.violation(span, message));
    }

    /// Walks on with `walk`, in test code if `attributes` say so.
    fn guarded(&mut self, attributes: &[Attribute], walk: impl FnOnce(&mut Self)) {
        let before = self.in_test;
        self.in_test |= source::only_in_tests(attributes);
        walk(self);
        self.in_test = before;
    }

    /// Judges one path as written.
    fn judge(&mut self, segments: &[String], span: Span) {
        let written = segments.join("::");
        if segments.windows(2).any(|pair| pair[0] == "super" && pair[1] == "super") {
            self.violation(span, format!("`{written}`: no `super::super`; begin at `crate`"));
        }
        let Some(module) = self.module_path.first().cloned() else {
            return;
        };
        if self.in_test {
            return;
        }
        let Some(absolute) = self.resolve(segments) else {
            return;
        };
        let Some(row) = self.table.rows.get(&module) else {
            return;
        };
        let Some(used) = absolute.first() else {
            self.violation(
                span,
                format!("`{written}` is the crate's root; name the module that is meant"),
            );
            return;
        };
        if *used == module || row.may_use.contains(used) {
            return;
        }
        let message = if self.table.rows.contains_key(used) {
            format!("`{module}` may not use `{used}` (`{written}`)")
        } else {
            format!(
                "`{written}`: `{used}` is no module in ARCHITECTURE.md; reach it through its module"
            )
        };
        self.violation(span, message);
    }

    /// The path from the crate's root; `None` for one that begins with a local or a foreign name.
    fn resolve(&self, segments: &[String]) -> Option<Vec<String>> {
        // `main.rs` is a crate of its own, whose root is not the library's.
        let own_root = usize::from(self.module_path.first().is_some_and(|module| module == "main"));
        let (first, rest) = segments.split_first()?;
        let mut absolute = match first.as_str() {
            CRATE => Vec::new(),
            "crate" | "$crate" => self.module_path[..own_root].to_vec(),
            "self" => self.module_path.clone(),
            "super" => self.module_path[..self.module_path.len().saturating_sub(1)].to_vec(),
            _ => return None,
        };
        for segment in rest {
            match segment.as_str() {
                "self" => {}
                "super" => {
                    absolute.pop();
                }
                name => absolute.push(name.to_owned()),
            }
        }
        Some(absolute)
    }

    /// Judges each leaf of a `use` declaration.
    fn judge_use(&mut self, prefix: &[String], tree: &UseTree) {
        let with = |name: String| [prefix, &[name]].concat();
        match tree {
            UseTree::Path(path) => self.judge_use(&with(path.ident.to_string()), &path.tree),
            UseTree::Name(name) => self.judge(&with(name.ident.to_string()), name.ident.span()),
            UseTree::Rename(rename) => {
                self.judge(&with(rename.ident.to_string()), rename.ident.span());
            }
            UseTree::Glob(glob) => self.judge(&with("*".to_owned()), glob.star_token.spans[0]),
            UseTree::Group(group) => {
                for part in &group.items {
                    self.judge_use(prefix, part);
                }
            }
        }
    }

    /// Judges the paths in tokens that are not parsed: what stands inside a macro call or an attribute.
    fn judge_tokens(&mut self, tokens: TokenStream) {
        let trees: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            match &trees[at] {
                TokenTree::Group(group) => {
                    self.judge_tokens(group.stream());
                    at += 1;
                }
                TokenTree::Ident(ident) if !follows_path_separator(&trees, at) => {
                    let span = ident.span();
                    at = self.judge_token_path(&trees, at, &[], span);
                }
                TokenTree::Literal(literal) => {
                    self.judge_text(&literal.to_string(), literal.span());
                    at += 1;
                }
                _ => at += 1,
            }
        }
    }

    /// Judges the path that begins with the name at `at`; returns where it ends.
    fn judge_token_path(
        &mut self,
        trees: &[TokenTree],
        mut at: usize,
        prefix: &[String],
        span: Span,
    ) -> usize {
        let mut segments = prefix.to_vec();
        while let Some(TokenTree::Ident(ident)) = trees.get(at) {
            segments.push(ident.to_string());
            at += 1;
            if !is_path_separator(trees, at) {
                break;
            }
            at += 2;
        }
        if let Some(TokenTree::Group(group)) =
            trees.get(at).filter(|_| follows_path_separator(trees, at))
        {
            // A `use` with a group inside a macro: each part continues the path.
            let parts: Vec<TokenTree> = group.stream().into_iter().collect();
            for part in parts
                .split(|tree| matches!(tree, TokenTree::Punct(punct) if punct.as_char() == ','))
            {
                self.judge_token_path(part, 0, &segments, span);
            }
            return at + 1;
        }
        self.judge(&segments, span);
        at
    }

    /// Judges a text that reads as a path, as `serde` takes them.
    fn judge_text(&mut self, literal: &str, span: Span) {
        if let Ok(path) =
            syn::parse_str::<syn::LitStr>(literal).and_then(|text| text.parse::<syn::Path>())
        {
            // A text of one word is far more often a name than a path.
            if path.segments.len() > 1 {
                self.judge(&names(&path), span);
            }
        }
    }
}

fn names(path: &syn::Path) -> Vec<String> {
    path.segments.iter().map(|segment| segment.ident.to_string()).collect()
}

fn is_colon(tree: Option<&TokenTree>) -> bool {
    matches!(tree, Some(TokenTree::Punct(punct)) if punct.as_char() == ':')
}

fn is_path_separator(trees: &[TokenTree], at: usize) -> bool {
    is_colon(trees.get(at)) && is_colon(trees.get(at + 1))
}

fn follows_path_separator(trees: &[TokenTree], at: usize) -> bool {
    at >= 2 && is_path_separator(trees, at - 2)
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_item(&mut self, item: &'ast Item) {
        self.guarded(source::item_attributes(item), |walk| {
            visit::visit_item(walk, item);
        });
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        self.guarded(source::impl_item_attributes(item), |walk| {
            visit::visit_impl_item(walk, item);
        });
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        self.guarded(source::trait_item_attributes(item), |walk| {
            visit::visit_trait_item(walk, item);
        });
    }

    fn visit_local(&mut self, local: &'ast syn::Local) {
        self.guarded(&local.attrs, |walk| visit::visit_local(walk, local));
    }

    fn visit_field(&mut self, field: &'ast syn::Field) {
        self.guarded(&field.attrs, |walk| visit::visit_field(walk, field));
    }

    fn visit_item_mod(&mut self, module: &'ast ItemMod) {
        if let Some(attribute) =
            module.attrs.iter().find(|attribute| attribute.path().is_ident("path"))
        {
            let message =
                format!("the module `{}` lies elsewhere than its name says", module.ident);
            self.violation(attribute.pound_token.spans[0], message);
        }
        self.module_path.push(module.ident.to_string());
        visit::visit_item_mod(self, module);
        self.module_path.pop();
    }

    fn visit_item_extern_crate(&mut self, item: &'ast syn::ItemExternCrate) {
        if item.ident == "self" || item.ident == CRATE {
            self.violation(item.ident.span(), "the crate has no second name");
        }
    }

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        self.judge_use(&[], &item.tree);
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if let Some(first) = path.segments.first() {
            self.judge(&names(path), first.ident.span());
        }
        visit::visit_path(self, path);
    }

    fn visit_macro(&mut self, call: &'ast Macro) {
        visit::visit_macro(self, call);
        self.judge_tokens(call.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let syn::Meta::List(list) = &attribute.meta {
            self.judge_tokens(list.tokens.clone());
        }
    }

    /// `pub(crate)` says who may look in, which is no use; only `super::super` is looked for.
    fn visit_vis_restricted(&mut self, visibility: &'ast VisRestricted) {
        let before = std::mem::replace(&mut self.in_test, true);
        visit::visit_vis_restricted(self, visibility);
        self.in_test = before;
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
