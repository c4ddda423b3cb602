//! JSON lines: an object for each run, with the columns' heads as its keys.

use std::borrow::Cow;

use crate::sweep::plan::{Column, ColumnKind};

/// The object of a run. Numbers stand there with the digits that they have in the log; what is not known is null.
pub(super) fn object(columns: &[Column], cells: &[Cow<'_, str>]) -> String {
    let mut text = String::from("{");
    for (index, (column, cell)) in columns.iter().zip(cells).enumerate() {
        if index > 0 {
            text.push(',');
        }
        text.push_str(&quoted(&column.name));
        text.push(':');
        match column.kind {
            _ if cell.is_empty() => text.push_str("null"),
            ColumnKind::Number | ColumnKind::Count => text.push_str(cell),
            ColumnKind::Text => text.push_str(&quoted(cell)),
        }
    }
    text.push('}');
    text
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}
