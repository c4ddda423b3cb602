//! The problems of a file, collected while it is read.

use std::cell::{Cell, RefCell};

use super::document::SourceLocation;
use super::problem::Problem;

/// Most problems that are listed. A file of a million wrong keys would make a gigabyte of messages.
const MAX_PROBLEMS: usize = 100;
/// The problems found so far: the first hundred, and how many more there are.
#[derive(Debug, Default)]
pub struct Problems {
    list: RefCell<Vec<Problem>>,
    more: Cell<usize>,
}

impl Problems {
    /// Notes that `found` is at `place` instead of `expected`.
    pub fn push(
        &self,
        place: &SourceLocation,
        key: &str,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) {
        if self.takes_more() {
            self.add(place.problem(key, found.into(), expected.into()));
        }
    }

    /// Adds several.
    pub fn extend(&self, problems: Vec<Problem>) {
        for problem in problems {
            if self.takes_more() {
                self.add(problem);
            }
        }
    }

    /// Adds one, unless it is known: some values are read twice.
    fn add(&self, problem: Problem) {
        let mut list = self.list.borrow_mut();
        if !list.contains(&problem) {
            list.push(problem);
        }
    }

    /// Whether there is room for another problem; if not, it is counted.
    pub(super) fn takes_more(&self) -> bool {
        let is_full = self.is_full();
        self.more.set(self.more.get() + usize::from(is_full));
        !is_full
    }

    /// Whether further problems are only counted.
    pub(super) fn is_full(&self) -> bool {
        self.list.borrow().len() >= MAX_PROBLEMS
    }

    /// All of them, in the order of file and place; behind a hundred how many more there are.
    pub fn into_sorted(self) -> Vec<Problem> {
        let mut problems = self.list.into_inner();
        let key = |p: &Problem| (p.file.clone(), p.line, p.column, p.key.clone());
        problems.sort_by_key(key);
        let more = self.more.get();
        if let (true, Some(last)) = (more > 0, problems.last()) {
            problems.push(Problem {
                file: last.file.clone(),
                line: 0,
                column: 0,
                key: String::new(),
                found: match more {
                    1 => "1 more problem, which is not listed".to_owned(),
                    _ => format!("{more} more problems, which are not listed"),
                },
                expected: String::new(),
            });
        }
        problems
    }

    /// `value`, or all problems if there are some.
    ///
    /// # Errors
    /// All problems.
    pub fn finish<T>(self, value: Option<T>) -> Result<T, Vec<Problem>> {
        let problems = self.into_sorted();
        match value {
            Some(value) if problems.is_empty() => Ok(value),
            _ => Err(problems),
        }
    }
}
