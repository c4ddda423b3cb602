//! The folders that ARCHITECTURE.md names.

use super::source::Violation;

/// Every bullet or table row that begins with a folder in backticks, `` - `src/` ``, names one that
/// exists.
pub fn check(file: &str, text: &str, exists: impl Fn(&str) -> bool) -> Vec<Violation> {
    let named: Vec<(usize, &str)> = text
        .lines()
        .enumerate()
        .filter_map(|(index, line)| Some((index + 1, folder(line)?)))
        .collect();
    if named.is_empty() {
        return vec![Violation::new(
            file,
            1,
            "names no folder: a list such as \"- `src/`: ...\" is missing",
        )];
    }
    named
        .into_iter()
        .filter(|(_, folder)| !exists(folder))
        .map(|(line, folder)| {
            Violation::new(file, line, format!("the folder `{folder}` does not exist"))
        })
        .collect()
}

/// The folder that a line of the list begins with.
fn folder(line: &str) -> Option<&str> {
    let entry = line.trim_start().strip_prefix(['-', '*', '|'])?.trim_start().strip_prefix('`')?;
    let (name, _) = entry.split_once('`')?;
    (name.ends_with('/') && !name.contains(' ')).then_some(name)
}

#[test]
fn a_folder_that_does_not_exist_is_found() {
    let text = "# Title\n- `src/`: code\n| `benches/` | timing |\n  * `tests/readers/` others\n- `run` it\n";
    let found: Vec<String> =
        check("LIST.md", text, |folder| folder == "src/").iter().map(ToString::to_string).collect();
    assert_eq!(
        found,
        [
            "LIST.md:3: the folder `benches/` does not exist",
            "LIST.md:4: the folder `tests/readers/` does not exist"
        ]
    );
    assert!(check("LIST.md", text, |_| true).is_empty());
}

#[test]
fn a_readme_without_folders_is_refused() {
    assert_eq!(check("LIST.md", "# Title\n\nThe folder `src/` holds code.\n", |_| true).len(), 1);
}
