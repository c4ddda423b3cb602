//! How long files and functions may grow.

use super::source::{self, SourceFile, Violation};
use syn::visit::{self, Visit};
use syn::{Block, Item};

/// Lines of a file without the tests at its end.
const FILE_LINES: usize = 600;
/// Lines of a file with the tests at its end, and of a file that is all tests.
const FILE_LINES_WITH_TESTS: usize = 800;
/// Lines between the braces of a function: one that has an arm for each action of the screen stays in one piece.
const FUNCTION_LINES: usize = 100;

/// Every file and function that is too long.
pub fn check(files: &[SourceFile]) -> Vec<Violation> {
    let test_modules = source::test_modules(files);
    let mut violations = Vec::new();
    for file in files {
        let all = file.text.lines().count();
        if all > FILE_LINES_WITH_TESTS {
            let message = format!("{all} lines, at most {FILE_LINES_WITH_TESTS} with tests");
            violations.push(Violation::new(&file.path, FILE_LINES_WITH_TESTS + 1, message));
        }
        let code = all - test_lines(file);
        if code > FILE_LINES && !source::is_test_file(file, &test_modules) {
            let message = format!("{code} lines, at most {FILE_LINES} without tests");
            violations.push(Violation::new(&file.path, FILE_LINES + 1, message));
        }
        let mut walk = Walk { file, violations: Vec::new() };
        walk.visit_file(&file.syntax);
        violations.append(&mut walk.violations);
    }
    violations
}

/// Lines of the `#[cfg(test)] mod tests` that ends a file.
fn test_lines(file: &SourceFile) -> usize {
    match file.syntax.items.last() {
        Some(Item::Mod(module))
            if module.ident == "tests" && source::only_in_tests(&module.attrs) =>
        {
            let (first, last) = source::lines_of(module);
            last - first + 1
        }
        _ => 0,
    }
}

struct Walk<'a> {
    file: &'a SourceFile,
    violations: Vec<Violation>,
}

impl Walk<'_> {
    fn measure(&mut self, name: &syn::Ident, body: &Block) {
        let (first, last) = source::lines_of(body);
        let lines = (last - first).saturating_sub(1);
        if lines > FUNCTION_LINES {
            let message = format!("`{name}` has {lines} lines, at most {FUNCTION_LINES}");
            self.violations.push(self.file.violation(name.span(), message));
        }
    }
}

impl<'ast> Visit<'ast> for Walk<'_> {
    fn visit_item_fn(&mut self, function: &'ast syn::ItemFn) {
        self.measure(&function.sig.ident, &function.block);
        visit::visit_item_fn(self, function);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast syn::ImplItemFn) {
        self.measure(&function.sig.ident, &function.block);
        visit::visit_impl_item_fn(self, function);
    }

    fn visit_trait_item_fn(&mut self, function: &'ast syn::TraitItemFn) {
        if let Some(body) = &function.default {
            self.measure(&function.sig.ident, body);
        }
        visit::visit_trait_item_fn(self, function);
    }
}

fn found(path: &str, text: &str) -> Vec<String> {
    check(&[source::example(path, text)]).iter().map(ToString::to_string).collect()
}

#[test]
fn a_long_file_is_found() {
    assert_eq!(found("src/a.rs", &"// line\n".repeat(600)), [""; 0]);
    let message = "src/a.rs:601: 601 lines, at most 600 without tests";
    assert_eq!(found("src/a.rs", &"// line\n".repeat(601)), [message]);
}

#[test]
fn tests_at_the_end_have_room_of_their_own() {
    let file = |code: usize, tests: usize| {
        format!(
            "{}#[cfg(test)]\nmod tests {{\n{}}}\n",
            "// code\n".repeat(code),
            "// test\n".repeat(tests)
        )
    };
    assert_eq!(found("src/a.rs", &file(600, 197)), [""; 0]);
    assert_eq!(
        found("src/a.rs", &file(601, 97)),
        ["src/a.rs:601: 601 lines, at most 600 without tests"]
    );
    assert_eq!(
        found("src/a.rs", &file(600, 198)),
        ["src/a.rs:801: 801 lines, at most 800 with tests"]
    );
    let not_at_the_end = format!("{}fn after() {{}}\n", file(400, 300));
    assert_eq!(found("src/a.rs", &not_at_the_end).len(), 1);
}

#[test]
fn a_long_function_is_found() {
    let body = |lines: usize| format!("{{\n{}}}", "g();\n".repeat(lines));
    for (before, after) in [("fn f()", ""), ("impl A { fn f()", "}"), ("trait A { fn f()", "}")] {
        assert_eq!(found("src/a.rs", &format!("{before} {}{after}", body(100))), [""; 0]);
        let too_long = found("src/a.rs", &format!("{before} {}{after}", body(101)));
        assert_eq!(too_long, ["src/a.rs:1: `f` has 101 lines, at most 100"]);
    }
}
