//! How wide comments are: rustfmt wraps code only.

use super::source::{self, SourceFile, Violation};

/// Columns of a comment's line, its indentation included.
const COMMENT_COLUMNS: usize = 100;

/// Every comment on a line of its own that is wider, unless it is a single word, such as an
/// address.
pub fn check(files: &[SourceFile]) -> Vec<Violation> {
    let mut violations = Vec::new();
    for file in files {
        for (index, line) in file.text.lines().enumerate() {
            let columns = line.chars().count();
            let comment = line.trim_start();
            if columns > COMMENT_COLUMNS
                && comment.starts_with("//")
                && comment.split_whitespace().count() > 2
            {
                let message = format!("a comment of {columns} columns, at most {COMMENT_COLUMNS}");
                violations.push(Violation::new(&file.path, index + 1, message));
            }
        }
    }
    violations
}

#[test]
fn a_wide_comment_is_found() {
    let found =
        |text: &str| check(&[source::example("src/a.rs", &format!("{text}\nfn f() {{}}\n"))]).len();
    let words = "ab ".repeat(32);
    assert_eq!(found(&format!("// {words}x\n")), 0, "100 columns");
    assert_eq!(found(&format!("// {words}xy\n")), 1, "101 columns");
    assert_eq!(found(&format!("/// https://{}\n", "x".repeat(120))), 0, "one word");
}
