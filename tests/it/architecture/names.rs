//! Every public type name stands for one thing, so that a search for it finds that thing.
//!
//! Public are all types with `pub` in any form. `Arguments` is exempt: each subcommand has its own. Names within `chain` and `integrate`
//! are only compared with those of other modules until both are rewritten.
//!
//! Limits: types that a macro declares are not seen.

use super::source::{self, SourceFile, Violation};
use proc_macro2::Span;
use std::collections::BTreeMap;
use syn::visit::{self, Visit};
use syn::{Item, Visibility};

const SHARED: [&str; 1] = ["Arguments"];
const BEING_REWRITTEN: [&str; 2] = ["src/chain/", "src/integrate/"];

/// Every declaration of a public type whose name another file, or another module of the same file, declares before it.
pub fn check(files: &[SourceFile]) -> Vec<Violation> {
    let test_modules = source::test_modules(files);
    let mut first: BTreeMap<String, &SourceFile> = BTreeMap::new();
    let mut violations = Vec::new();
    for file in files.iter().filter(|file| !source::is_test_file(file, &test_modules)) {
        let mut types = Types(Vec::new());
        types.visit_file(&file.syntax);
        for (name, span) in types.0 {
            let Some(before) = first.get(&name) else {
                first.insert(name, file);
                continue;
            };
            let rewritten =
                |file: &SourceFile| BEING_REWRITTEN.iter().any(|p| file.path.starts_with(p));
            if !(SHARED.contains(&&*name) || rewritten(before) && rewritten(file)) {
                let message = format!("`{name}` is a type of {} already", before.path);
                violations.push(file.violation(span, message));
            }
        }
    }
    violations
}

struct Types(Vec<(String, Span)>);

impl<'ast> Visit<'ast> for Types {
    fn visit_item(&mut self, item: &'ast Item) {
        if source::only_in_tests(source::item_attributes(item)) {
            return;
        }
        let declared = match item {
            Item::Struct(item) => Some((&item.vis, &item.ident)),
            Item::Enum(item) => Some((&item.vis, &item.ident)),
            Item::Union(item) => Some((&item.vis, &item.ident)),
            Item::Trait(item) => Some((&item.vis, &item.ident)),
            Item::Type(item) => Some((&item.vis, &item.ident)),
            _ => None,
        };
        if let Some((visibility, name)) = declared
            && !matches!(visibility, Visibility::Inherited)
        {
            self.0.push((name.to_string(), name.span()));
        }
        visit::visit_item(self, item);
    }
}

/// What the rule says to these sources.
fn found(sources: &[(&str, &str)]) -> Vec<String> {
    let files: Vec<_> = sources.iter().map(|(path, text)| source::example(path, text)).collect();
    check(&files).iter().map(ToString::to_string).collect()
}

#[test]
fn a_name_of_two_public_types_is_found() {
    let first = ("src/scope/a.rs", "pub struct Plan;");
    for second in [
        "pub enum Plan {}",
        "pub(super) trait Plan {}",
        "pub(crate) type Plan = u8;",
        "mod inner { pub struct Plan; }",
    ] {
        assert_eq!(
            found(&[first, ("src/scene/b.rs", second)]),
            ["src/scene/b.rs:1: `Plan` is a type of src/scope/a.rs already"],
            "{second}"
        );
    }
}

#[test]
fn private_types_tests_and_subcommands_are_exempt() {
    let files = [
        ("src/cli/a.rs", "pub struct Arguments; struct Plan;"),
        ("src/cli/b.rs", "pub struct Arguments; pub struct Plan;"),
        ("src/cli/c.rs", "#[cfg(test)] mod tests { pub struct Plan; }"),
    ];
    assert_eq!(found(&files), [""; 0]);
}
