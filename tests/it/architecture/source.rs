//! Rust sources as the rules see them: path, text, syntax tree, place in the tree of modules.

use proc_macro2::Span;
use std::collections::BTreeSet;
use std::fmt;
use std::path::Path;
use syn::punctuated::Punctuated;
use syn::{Attribute, ImplItem, Item, Meta, Token, TraitItem};

/// Something that a rule does not allow, with its place.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Violation {
    file: String,
    line: usize,
    message: String,
}

impl Violation {
    pub fn new(file: &str, line: usize, message: impl Into<String>) -> Self {
        Self { file: file.to_owned(), line, message: message.into() }
    }
}

impl fmt::Display for Violation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}: {}", self.file, self.line, self.message)
    }
}

/// One parsed source file.
pub struct SourceFile {
    /// Path from the repository's root, with `/`.
    pub path: String,
    pub text: String,
    pub syntax: syn::File,
    /// Names of the modules from the crate's root to this file; empty for `lib.rs`.
    pub module_path: Vec<String>,
}

impl SourceFile {
    pub fn parse(path: &str, text: &str) -> Result<Self, Violation> {
        let syntax = syn::parse_file(text).map_err(|error| {
            Violation::new(path, error.span().start().line, format!("no Rust: {error}"))
        })?;
        Ok(Self {
            path: path.to_owned(),
            text: text.to_owned(),
            syntax,
            module_path: module_path(path),
        })
    }

    /// A violation at `span` in this file.
    pub fn violation(&self, span: Span, message: impl Into<String>) -> Violation {
        Violation::new(&self.path, span.start().line, message)
    }
}

/// `src/scope/trigger.rs` is `scope::trigger`; `src/scope.rs` and `src/scope/mod.rs` are `scope`.
fn module_path(path: &str) -> Vec<String> {
    let inner = path.strip_prefix("src/").unwrap_or(path);
    let mut names: Vec<String> =
        inner.strip_suffix(".rs").unwrap_or(inner).split('/').map(str::to_owned).collect();
    if names.len() > 1 && names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    if names == ["lib"] { Vec::new() } else { names }
}

/// Parses every `.rs` file under `folder`, in the order of their paths.
pub fn read_folder(root: &Path, folder: &Path) -> Result<Vec<SourceFile>, Violation> {
    let unreadable = |path: &Path, error: std::io::Error| {
        Violation::new(&path.to_string_lossy(), 1, format!("cannot be read: {error}"))
    };
    let mut files = Vec::new();
    let mut entries = std::fs::read_dir(root.join(folder))
        .and_then(Iterator::collect::<Result<Vec<_>, _>>)
        .map_err(|error| unreadable(folder, error))?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let path = folder.join(entry.file_name());
        if entry.path().is_dir() {
            files.extend(read_folder(root, &path)?);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text =
                std::fs::read_to_string(entry.path()).map_err(|error| unreadable(&path, error))?;
            files.push(SourceFile::parse(&path.to_string_lossy().replace('\\', "/"), &text)?);
        }
    }
    Ok(files)
}

/// Whether what carries these attributes exists only in tests.
pub fn only_in_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| {
        attribute.path().is_ident("test")
            || (attribute.path().is_ident("cfg")
                && attribute.parse_args::<Meta>().is_ok_and(|condition| requires_test(&condition)))
    })
}

/// Whether a `cfg` condition can only hold in a test build.
fn requires_test(condition: &Meta) -> bool {
    if condition.path().is_ident("test") {
        return true;
    }
    let Meta::List(list) = condition else {
        return false;
    };
    let parts =
        list.parse_args_with(Punctuated::<Meta, Token![,]>::parse_terminated).unwrap_or_default();
    if list.path.is_ident("all") {
        parts.iter().any(requires_test)
    } else {
        list.path.is_ident("any") && !parts.is_empty() && parts.iter().all(requires_test)
    }
}

/// Module paths that a parent declares as `#[cfg(test)] mod name;`, whose files are tests through
/// and through.
pub fn test_modules(files: &[SourceFile]) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for file in files {
        for item in &file.syntax.items {
            if let Item::Mod(module) = item
                && module.content.is_none()
                && only_in_tests(&module.attrs)
            {
                let mut path = file.module_path.clone();
                path.push(module.ident.to_string());
                found.insert(path);
            }
        }
    }
    found
}

/// Whether a whole file is test code.
pub fn is_test_file(file: &SourceFile, test_modules: &BTreeSet<Vec<String>>) -> bool {
    only_in_tests(&file.syntax.attrs)
        || (1..=file.module_path.len())
            .any(|length| test_modules.contains(&file.module_path[..length]))
}

/// The attributes of an item.
pub fn item_attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::ExternCrate(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::ForeignMod(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Mod(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::TraitAlias(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        Item::Union(item) => &item.attrs,
        Item::Use(item) => &item.attrs,
        _ => &[],
    }
}

/// The attributes of an item in an `impl` block.
pub fn impl_item_attributes(item: &ImplItem) -> &[Attribute] {
    match item {
        ImplItem::Const(item) => &item.attrs,
        ImplItem::Fn(item) => &item.attrs,
        ImplItem::Type(item) => &item.attrs,
        ImplItem::Macro(item) => &item.attrs,
        _ => &[],
    }
}

/// The attributes of an item in a trait.
pub fn trait_item_attributes(item: &TraitItem) -> &[Attribute] {
    match item {
        TraitItem::Const(item) => &item.attrs,
        TraitItem::Fn(item) => &item.attrs,
        TraitItem::Type(item) => &item.attrs,
        TraitItem::Macro(item) => &item.attrs,
        _ => &[],
    }
}

/// A source for the rules' own tests.
pub fn example(path: &str, text: &str) -> SourceFile {
    SourceFile::parse(path, text).unwrap_or_else(|violation| panic!("{violation}"))
}

#[test]
fn a_file_stands_where_its_path_says() {
    for (path, modules) in [
        ("src/lib.rs", &[][..]),
        ("src/main.rs", &["main"]),
        ("src/scope.rs", &["scope"]),
        ("src/scope/mod.rs", &["scope"]),
        ("src/scope/trigger/edge.rs", &["scope", "trigger", "edge"]),
    ] {
        assert_eq!(module_path(path), modules, "{path}");
    }
}

#[test]
fn test_code_is_told_from_other_code() {
    let source = "#[cfg(test)] mod a {} #[cfg(all(test, unix))] mod b {} #[test] fn c() {}
        #[cfg(any(test, unix))] mod d {} #[cfg(not(test))] mod e {} #[cfg(feature = \"test\")] mod f {}";
    let answers: Vec<bool> = example("src/a.rs", source)
        .syntax
        .items
        .iter()
        .map(|item| only_in_tests(item_attributes(item)))
        .collect();
    assert_eq!(answers, [true, true, true, false, false, false]);
}
