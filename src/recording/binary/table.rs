//! A binary file's columns, and their text.

use std::fmt::Write as _;

/// The columns of a file.
#[derive(Debug, Default)]
pub struct BinaryTable {
    /// What is known of the instrument, key and value.
    pub keys: Vec<(&'static str, String)>,
    /// Time of the first sample and distance to the next, where no column has times (s).
    pub grid: Option<(f64, f64)>,
    pub columns: Vec<BinaryColumn>,
}

/// One column; the name is empty if the file gives none.
#[derive(Debug, Default)]
pub struct BinaryColumn {
    pub name: String,
    pub unit: String,
    /// Its values; NaN becomes an empty cell (unit).
    pub cells: Vec<f64>,
}

/// A cell as CSV has it.
fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r', ';', '\t']) {
        format!("\"{}\"", text.replace('"', "\"\"").replace(['\n', '\r'], " "))
    } else {
        text.to_owned()
    }
}

impl BinaryTable {
    /// As text that the reader of tables takes.
    pub fn text(&self) -> String {
        let mut text = String::new();
        let mut row = |key: &str, value: &str| {
            let _ = writeln!(text, "{},{}", key, quoted(value));
        };
        for (key, value) in &self.keys {
            row(key, value);
        }
        if let Some((_, interval)) = self.grid {
            row("Sample Interval", &interval.to_string());
        }
        let named = |column: &BinaryColumn| match (&*column.name, &*column.unit) {
            (name, "") => quoted(name),
            (name, unit) => quoted(&format!("{name} ({unit})")),
        };
        if self.columns.iter().any(|column| !column.name.is_empty()) {
            text.push_str(self.grid.map_or("", |_| "Time (s),"));
            text.push_str(&self.columns.iter().map(named).collect::<Vec<_>>().join(","));
            text.push('\n');
        }
        let rows = self.columns.iter().map(|column| column.cells.len()).max().unwrap_or(0);
        for row in 0..rows {
            if let Some((start, interval)) = self.grid {
                let _ = write!(text, "{},", start + interval * row as f64);
            }
            for (place, column) in self.columns.iter().enumerate() {
                if place > 0 {
                    text.push(',');
                }
                if let Some(value) = column.cells.get(row).filter(|value| !value.is_nan()) {
                    let _ = write!(text, "{value}");
                }
            }
            text.push('\n');
        }
        text
    }
}
