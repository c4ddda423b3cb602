//! The columns that docs/sweeps.md names are those of its first sweep.

use std::path::Path;

use super::{column, done, folder, read};

#[test]
fn the_first_sweep_gives_the_columns_shown() {
    let page = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/sweeps.md");
    let page = std::fs::read_to_string(page).expect("the page");
    let (_, sweep) = page.split_once("```toml grid.toml\n").expect("a sweep");
    let (sweep, _) = sweep.split_once("```").expect("its end");
    let folder = folder(sweep);
    done(folder.path(), &["sweep", "grid.toml"]);
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
