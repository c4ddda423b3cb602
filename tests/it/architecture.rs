//! Checks which module uses which, that numbers have units, how wide comments are, and
//! ARCHITECTURE.md's list of folders.
//!
//! `ARCHITECTURE.md` names what is allowed; this test reads it there, so that the document cannot
//! drift away from the code. Each rule is a function from sources to violations, and each is shown
//! to find a violation in a small source of its own, since a check that cannot fail checks nothing.
//!
//! Limits: the sources are read, not compiled. A module that is reached through a macro of another
//! crate, or a file pulled in by `include!`, is not seen.

mod circles;
mod dependencies;
mod folders;
mod named;
mod paths;
mod source;
mod table;
mod units;
mod walls;
mod widths;

use source::{SourceFile, Violation};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use table::Table;

/// Circles of files that are still to be resolved; the list may only become shorter.
const KNOWN_CIRCLES: &[&[&str]] = &[];

/// The repository's root folder.
fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// A text file of the repository; a missing one is a violation of its own.
fn read(name: &str) -> Result<String, Violation> {
    std::fs::read_to_string(root().join(name))
        .map_err(|error| Violation::new(name, 1, format!("cannot be read: {error}")))
}

/// All sources under `src/`, or the first one that is no Rust.
fn sources() -> Vec<SourceFile> {
    let files = source::read_folder(&root(), Path::new("src"))
        .unwrap_or_else(|violation| panic!("{violation}"));
    assert!(!files.is_empty(), "no sources under src/");
    files
}

/// Fails with every violation on a line of its own.
fn refuse(mut violations: Vec<Violation>) {
    violations.sort();
    violations.dedup();
    let mut list = String::new();
    for violation in &violations {
        let _ = writeln!(list, "  {violation}");
    }
    assert!(violations.is_empty(), "{} violation(s):\n{list}", violations.len());
}

#[test]
fn modules_use_only_what_the_table_allows() {
    match read("ARCHITECTURE.md").and_then(|text| Table::parse("ARCHITECTURE.md", &text)) {
        Ok(table) => refuse(walls::check(&sources(), &table)),
        Err(violation) => refuse(vec![violation]),
    }
}

#[test]
fn the_table_has_no_cycle_and_names_only_its_own_modules() {
    match read("ARCHITECTURE.md").and_then(|text| Table::parse("ARCHITECTURE.md", &text)) {
        Ok(table) => refuse(table.check()),
        Err(violation) => refuse(vec![violation]),
    }
}

#[test]
fn files_of_a_module_do_not_use_each_other_in_circles() {
    refuse(circles::check(&sources(), KNOWN_CIRCLES));
}

#[test]
fn every_public_f64_names_its_unit() {
    refuse(units::check(&sources()));
}

#[test]
fn comments_wrap_at_100_columns() {
    refuse(widths::check(&sources()));
}

#[test]
fn every_folder_in_the_list_exists() {
    match read("ARCHITECTURE.md") {
        Ok(text) => {
            refuse(folders::check("ARCHITECTURE.md", &text, |folder| root().join(folder).is_dir()));
        }
        Err(violation) => refuse(vec![violation]),
    }
}

#[test]
fn the_paths_in_the_document_lead_through_the_code() {
    let source = |path: &str| std::fs::read_to_string(root().join("src").join(path)).ok();
    match read("ARCHITECTURE.md") {
        Ok(text) => refuse(named::check("ARCHITECTURE.md", &text, source)),
        Err(violation) => refuse(vec![violation]),
    }
}

#[test]
fn every_dependency_is_used_and_says_what_for() {
    let mut tests = sources();
    for folder in ["tests/it", "benches/common"] {
        tests.extend(source::read_folder(&root(), Path::new(folder)).expect("sources"));
    }
    match read("Cargo.toml") {
        Ok(manifest) => refuse(dependencies::check(&manifest, &sources(), &tests)),
        Err(violation) => refuse(vec![violation]),
    }
}
