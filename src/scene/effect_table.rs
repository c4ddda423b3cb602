//! The table of one effect.

use super::document::Value;
use super::reader::TableReader;

/// The table of an effect; `false` in its place switches off what a base scene switched on.
pub(super) fn effect<'a>(effects: &TableReader<'a>, name: &'static str) -> Option<TableReader<'a>> {
    let node = effects.node(name)?;
    if matches!(node.value, Value::Flag(false)) {
        return None;
    }
    let table = effects.table(name)?;
    let _ = table.node("state");
    Some(table)
}
