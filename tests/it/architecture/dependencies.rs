//! What the program stands on: every dependency is used, and says what for.

use super::source::{SourceFile, Violation};

/// Every line under `[dependencies]` has its reason behind it and is named in one of `sources`,
/// likewise every one under `[dev-dependencies]` in one of `tests`.
pub fn check(manifest: &str, sources: &[SourceFile], tests: &[SourceFile]) -> Vec<Violation> {
    let mut violations = Vec::new();
    let mut users = None;
    for (index, line) in manifest.lines().enumerate() {
        if line.starts_with('[') {
            users = match line {
                "[dependencies]" => Some(sources),
                "[dev-dependencies]" => Some(tests),
                _ => None,
            };
        }
        let (Some(users), Some((name, rest))) = (users, line.split_once(" = ")) else { continue };
        let mut refuse = |what: &str| {
            violations.push(Violation::new("Cargo.toml", index + 1, format!("{name} {what}")));
        };
        let reason = rest.split_once("  #").or(rest.split_once("} #"));
        if reason.is_none_or(|(_, why)| why.len() <= 5) {
            refuse("has no reason behind it");
        }
        let crate_name = name.replace('-', "_");
        let ways = ["::", "!", " as ", ";"].map(|end| format!("{crate_name}{end}"));
        if !users.iter().any(|file| ways.iter().any(|way| file.text.contains(way))) {
            refuse("is not used");
        }
    }
    violations
}

#[test]
fn a_dependency_without_reason_or_use_is_found() {
    let manifest = "[package]\nname = \"x\"\n[dependencies]\nserde = \"1\"   # reads JSON\ntoml = \"1\"\n[dev-dependencies]\nsyn = { version = \"2\" } # reads source\n";
    let file = |text| super::source::example("src/a.rs", text);
    let (both, neither) =
        ([file("use serde::Serialize;\nuse toml::de;\n")], [file("use syn::File;\n")]);
    let found: Vec<String> =
        check(manifest, &both, &both).iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        ["Cargo.toml:5: toml has no reason behind it", "Cargo.toml:7: syn is not used"]
    );
    assert_eq!(check(manifest, &neither, &neither).len(), 3);
}
