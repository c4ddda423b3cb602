//! `ARCHITECTURE.md` names files and what they define; both exist.

use super::source::Violation;

/// In numbered steps, each `path.rs` that is not a file below `src`, and each `name` behind a path
/// and a colon that the file lacks.
pub fn check(
    document: &str,
    text: &str,
    source: impl Fn(&str) -> Option<String>,
) -> Vec<Violation> {
    let mut violations = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if !line.starts_with(|c: char| c.is_ascii_digit()) {
            continue;
        }
        let paths = line
            .split('`')
            .filter(|part| part.strip_suffix(".rs").is_some() && !part.contains(' '));
        for path in paths.filter(|path| source(path).is_none()) {
            let message = format!("`src/{path}` does not exist");
            violations.push(Violation::new(document, index + 1, message));
        }
        for (path, name) in pairs(line) {
            let found = source(path).is_some_and(|text| {
                text.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|word| word == name)
            });
            if !found {
                let message = format!("`src/{path}` has no `{name}`");
                violations.push(Violation::new(document, index + 1, message));
            }
        }
    }
    violations
}

/// File and name of each "`file.rs`: `name`".
fn pairs(line: &str) -> Vec<(&str, &str)> {
    let named = line.match_indices(".rs`: `").filter_map(|(end, between)| {
        let path = line[..end + 3].rsplit('`').next()?;
        let name = line[end + between.len()..].split('`').next()?;
        Some((path, name.rsplit("::").next()?))
    });
    named.collect()
}

#[test]
fn files_and_names_that_do_not_exist_are_found() {
    let source = |path: &str| (path == "a.rs").then(|| "pub fn run() {}".to_owned());
    let found = |line: &str| {
        check("X.md", line, source).iter().map(ToString::to_string).collect::<Vec<_>>()
    };
    assert_eq!(found("1. `a.rs`: `run` and `a.rs`: `stop`"), ["X.md:1: `src/a.rs` has no `stop`"]);
    assert_eq!(found("2. (`b.rs`)"), ["X.md:1: `src/b.rs` does not exist"]);
    assert_eq!(found("| `b.rs` |"), [""; 0]);
}
