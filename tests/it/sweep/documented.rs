//! What docs/sweeps.md shows is a sweep, and does what stands there.

use std::path::Path;

use hertzscope::sweep::plan::Plan;

use super::{column, done, folder, read};

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/sweeps.md");
    std::fs::read_to_string(path).expect("the page")
}

/// The fenced blocks of one language.
fn blocks(page: &str, language: &str) -> Vec<String> {
    let parts = page.split("```").skip(1).step_by(2);
    parts.filter_map(|block| Some(block.strip_prefix(language)?.to_owned())).collect()
}

#[test]
fn the_sweeps_shown_are_sweeps() {
    let page = page();
    let runs: Vec<u64> = blocks(&page, "toml")
        .iter()
        .map(|text| {
            let folder = folder(text);
            Plan::load(&folder.path().join("grid.toml"), None).expect("a sweep").count()
        })
        .collect();
    assert_eq!(runs, [30, 200]);
}

#[test]
fn the_first_sweep_gives_the_columns_shown() {
    let page = page();
    let folder = folder(&blocks(&page, "toml")[0]);
    let [shown] = &blocks(&page, "console")[..] else { panic!("one answer") };
    let (command, answer) = shown.trim().split_once('\n').expect("a command and its answer");
    let arguments = command.strip_prefix("$ hertzscope ").expect("a command");
    let printed = done(folder.path(), &arguments.split(' ').collect::<Vec<_>>());
    assert!(printed.starts_with(answer), "{printed}");
    let csv = read(folder.path(), "grid.csv");
    let table = page.split("## The table").nth(1).expect("the table's part");
    let table = table.split("##").next().expect("its end");
    let names = table.lines().filter(|line| line.starts_with("| `"));
    let names = names.filter_map(|line| line.split('|').nth(1));
    let mut seen = 0;
    for name in names.flat_map(|cell| cell.split('`').skip(1).step_by(2)) {
        if !name.starts_with('.') {
            assert_eq!(column(&csv, name).len(), 30, "{name}");
            seen += 1;
        }
    }
    assert_eq!(seen, 12, "columns named on the page");
}
