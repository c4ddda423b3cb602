//! The table of modules in `ARCHITECTURE.md`.

use super::source::Violation;
use std::collections::{BTreeMap, BTreeSet};

/// One row: what a module may use, and where that is written.
#[derive(Debug)]
pub struct Row {
    pub may_use: BTreeSet<String>,
    line: usize,
}

/// The rows by module name.
#[derive(Debug)]
pub struct Table {
    file: String,
    pub rows: BTreeMap<String, Row>,
}

impl Table {
    /// Reads the table whose columns are `Module | Holds | May use`.
    pub fn parse(file: &str, text: &str) -> Result<Self, Violation> {
        let mut lines = text.lines().enumerate().map(|(index, line)| (index + 1, cells(line)));
        let header = lines.find(|(_, cells)| {
            cells.len() == 3 && cells[0] == "Module" && cells[1] == "Holds" && cells[2] == "May use"
        });
        let Some((header_line, _)) = header else {
            return Err(Violation::new(file, 1, "has no table `Module | Holds | May use`"));
        };
        let mut rows = BTreeMap::new();
        for (line, cells) in lines.skip(1).take_while(|(_, cells)| !cells.is_empty()) {
            let [module, _, may_use] = cells.as_slice() else {
                return Err(Violation::new(
                    file,
                    line,
                    "a row of the module table has three cells",
                ));
            };
            let nothing = matches!(may_use.as_str(), "-" | "–" | "—");
            let may_use = if nothing {
                BTreeSet::new()
            } else {
                may_use.split(',').map(|name| name.trim().to_owned()).collect()
            };
            if rows.insert(module.clone(), Row { may_use, line }).is_some() {
                return Err(Violation::new(file, line, format!("`{module}` has two rows")));
            }
        }
        if rows.is_empty() {
            return Err(Violation::new(file, header_line, "the module table has no rows"));
        }
        Ok(Self { file: file.to_owned(), rows })
    }

    /// Names without a row, and modules that reach themselves.
    pub fn check(&self) -> Vec<Violation> {
        let mut violations = Vec::new();
        for (module, row) in &self.rows {
            for name in row.may_use.iter().filter(|name| !self.rows.contains_key(*name)) {
                let message = format!("`{module}` may use `{name}`, which has no row");
                violations.push(Violation::new(&self.file, row.line, message));
            }
            if let Some(way) = self.way_back(module) {
                let message = format!("cycle: {}", way.join(" -> "));
                violations.push(Violation::new(&self.file, row.line, message));
            }
        }
        violations
    }

    /// A shortest way from `module` over what it may use back to itself, however many steps it
    /// takes.
    fn way_back(&self, module: &str) -> Option<Vec<String>> {
        let mut ways = vec![vec![module.to_owned()]];
        let mut seen = BTreeSet::new();
        while !ways.is_empty() {
            let mut longer = Vec::new();
            for way in ways {
                let reached = way.last().and_then(|last| self.rows.get(last));
                for next in reached.into_iter().flat_map(|row| &row.may_use) {
                    let mut extended = way.clone();
                    extended.push(next.clone());
                    if next == module {
                        return Some(extended);
                    }
                    if seen.insert(next.clone()) {
                        longer.push(extended);
                    }
                }
            }
            ways = longer;
        }
        None
    }
}

/// The cells of a Markdown table row without backticks; nothing for any other line.
fn cells(line: &str) -> Vec<String> {
    line.trim()
        .strip_prefix('|')
        .and_then(|inner| inner.strip_suffix('|'))
        .map(|inner| inner.split('|').map(|cell| cell.replace('`', "").trim().to_owned()).collect())
        .unwrap_or_default()
}

/// A table for the rules' own tests: `("scope", "quantity, trace")`.
pub fn example(rows: &[(&str, &str)]) -> Table {
    let mut text = "# Title\n\n| Module | Holds | May use |\n|---|---|---|\n".to_owned();
    for (module, may_use) in rows {
        text.push_str("| `");
        text.push_str(module);
        text.push_str("` | something | ");
        text.push_str(may_use);
        text.push_str(" |\n");
    }
    Table::parse("ARCHITECTURE.md", &text).unwrap_or_else(|violation| panic!("{violation}"))
}

fn messages(table: &Table) -> Vec<String> {
    table.check().iter().map(ToString::to_string).collect()
}

#[test]
fn a_table_without_cycle_is_clean() {
    let table = example(&[("quantity", "-"), ("trace", "quantity"), ("scope", "quantity, trace")]);
    assert!(table.rows["scope"].may_use.contains("trace"));
    assert!(table.rows["quantity"].may_use.is_empty());
    assert_eq!(messages(&table), [""; 0]);
}

#[test]
fn a_cycle_is_found_across_several_modules() {
    let table = example(&[("a", "b"), ("b", "c"), ("c", "a"), ("d", "a")]);
    assert_eq!(
        messages(&table),
        [
            "ARCHITECTURE.md:5: cycle: a -> b -> c -> a",
            "ARCHITECTURE.md:6: cycle: b -> c -> a -> b",
            "ARCHITECTURE.md:7: cycle: c -> a -> b -> c",
        ]
    );
}

#[test]
fn a_module_that_uses_itself_is_a_cycle() {
    assert_eq!(messages(&example(&[("a", "a")])), ["ARCHITECTURE.md:5: cycle: a -> a"]);
}

#[test]
fn a_name_without_row_is_found() {
    let found = messages(&example(&[("a", "b")]));
    assert_eq!(found, ["ARCHITECTURE.md:5: `a` may use `b`, which has no row"]);
}

#[test]
fn a_text_without_table_is_refused() {
    let header = "| Module | Holds | May use |\n|---|---|---|\n";
    for text in [
        "# Architecture\n".to_owned(),
        header.to_owned(),
        format!("{header}| a | b |\n"),
        format!("{header}| a | b | - |\n| a | b | - |\n"),
    ] {
        assert!(Table::parse("ARCHITECTURE.md", &text).is_err(), "{text}");
    }
}
