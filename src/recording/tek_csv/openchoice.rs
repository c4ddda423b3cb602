//! Reads a file that the desktop program `OpenChoice` saved: channels side by side, unit words in the third column,
//! and numbers that went through single precision: `19.9999996E-3` means 20 mV. They are taken to six digits.
//!
//! Other than in a native file, the zero level stands in `Yzero` (V), and `Vertical Offset` is 0. The instrument
//! stands in `Note`, as `TDS 1002B - <time of day> <date>`; its firmware is not told.

use super::cells::CsvRows;
use super::column::{SINGLE_PRECISION_DIGITS, rounded};
use super::error::TekCsvError;
use super::header_columns::{Block, blocks};
use super::layout;
use super::unscaled_import::UnscaledImport;
use crate::recording::{Capture, InstrumentIdentity};

const NOTE: &str = "Note";
/// Digits of single precision that the header's numbers keep.
const DIGITS: usize = 6;

pub(super) fn read(table: &CsvRows<'_>) -> Result<Vec<Capture>, TekCsvError> {
    (1..).zip(blocks(table)).map(|(channel, block)| capture(table, &block, channel)).collect()
}

fn capture(
    table: &CsvRows<'_>,
    block: &Block<'_, '_>,
    channel: u8,
) -> Result<Capture, TekCsvError> {
    let mut draft = block.import()?;
    draft.times.limit_digits(SINGLE_PRECISION_DIGITS);
    draft.values.limit_digits(SINGLE_PRECISION_DIGITS);
    draft.zero = block.number(layout::Y_ZERO)?;
    for number in [
        &mut draft.stated.interval,
        &mut draft.stated.trigger_point,
        &mut draft.scale,
        &mut draft.zero,
        &mut draft.horizontal_scale,
        &mut draft.probe,
    ] {
        *number = number.map(|value| rounded(value, DIGITS));
    }
    let offset = block.number(layout::VERTICAL_OFFSET)?.unwrap_or_default();
    if offset.abs() > 0.0 {
        draft
            .notes
            .push(format!("Vertical Offset {offset} is not used: no file with one has been seen"));
    }
    note(&mut draft, block);
    draft.capture(table.file, channel)
}

/// Instrument and time as the program wrote them.
fn note(draft: &mut UnscaledImport, block: &Block<'_, '_>) {
    let Some((text, _)) = block.text(NOTE).filter(|(text, _)| !text.is_empty()) else { return };
    let model = text.split(" - ").next().unwrap_or_default().replace(' ', "");
    if draft.instrument.is_none() && !model.is_empty() {
        let (serial, firmware) = (String::new(), String::new());
        draft.instrument = Some(InstrumentIdentity { model, serial, firmware });
    }
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    draft.notes.push(format!("OpenChoice says: {text}"));
}
