//! Reads a native file that a spreadsheet saved again, or to which column names were added. Numbers have
//! lost digits, not places; the zero level stands in `Vertical Offset` (V), of an FFT in `Yzero` (dB).

use super::cells::CsvRows;
use super::error::TekCsvError;
use super::header_columns::blocks;
use super::layout;
use crate::recording::Capture;

pub(super) fn read(table: &CsvRows<'_>) -> Result<Vec<Capture>, TekCsvError> {
    (1..)
        .zip(blocks(table))
        .map(|(channel, block)| {
            let mut draft = block.import()?;
            let key = match draft.y_unit.as_deref() {
                Some("dB") => layout::Y_ZERO,
                _ => layout::VERTICAL_OFFSET,
            };
            draft.zero = block.number(key)?;
            draft.capture(table.file, channel)
        })
        .collect()
}
