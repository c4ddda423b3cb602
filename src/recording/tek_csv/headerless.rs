//! Reads a file of samples alone, or below column names that somebody put there: the first column is time, each
//! further one a channel. Everything else is guessed, and said.
//!
//! A name may hold a unit in brackets, `Time (ms)`; it is taken into account.

use super::cells::{Cells, CsvRows};
use super::column::SampleColumn;
use super::error::{TekCsvError, excerpt};
use super::header_columns::unit;
use super::unscaled_import::UnscaledImport;
use crate::recording::Capture;
use crate::scope::Source;

/// Prefixes of units in brackets, with their powers of ten.
const PREFIXES: [(&str, i32); 6] = [("", 0), ("m", -3), ("u", -6), ("µ", -6), ("n", -9), ("k", 3)];

pub(super) fn read(table: &CsvRows<'_>) -> Result<Vec<Capture>, TekCsvError> {
    let first = usize::from(!table.row(0).is_samples());
    let names = (first == 1).then(|| table.row(0));
    let filled = table.row(first);
    let mut cells = (0..filled.len()).filter(|index| !filled.text(*index).is_empty());
    let Some(time) = cells.next() else { return Ok(Vec::new()) };
    let times = column(table, first, time)?;
    let own_channel = Some(channel_in(table.file)).filter(|_| cells.clone().count() == 1).flatten();
    (1..)
        .zip(cells)
        .map(|(channel, cell)| {
            let mut draft = UnscaledImport {
                times: times.clone(),
                values: column(table, first, cell)?,
                ..UnscaledImport::default()
            };
            match &names {
                None => draft.notes.push("the file has no header".to_owned()),
                Some(names) => use_names(&mut draft, names, time, cell),
            }
            if let Some(own) = own_channel.filter(|_| draft.source.is_none()) {
                draft.notes.push(format!("source taken as {own} from the file's name"));
                draft.source = Some(own);
            }
            if table.decimal_comma {
                draft.notes.push("numbers have a decimal comma".to_owned());
            }
            draft.capture(table.file, channel)
        })
        .collect()
}

/// The channel in a name that the instrument gave, `F0001CH2.CSV`.
fn channel_in(file: &str) -> Option<Source> {
    let name = file.rsplit(['/', '\\']).next().unwrap_or_default().to_ascii_uppercase();
    let (_, rest) = name.rsplit_once("CH")?;
    let number = rest.strip_suffix(".CSV")?;
    Source::from_name(&format!("CH{number}"))
}

fn column(table: &CsvRows<'_>, first: usize, cell: usize) -> Result<SampleColumn, TekCsvError> {
    let mut column = SampleColumn::default();
    for index in first..table.len() {
        column.push(&table.row(index), cell)?;
    }
    Ok(column)
}

fn use_names(draft: &mut UnscaledImport, names: &Cells<'_>, time: usize, value: usize) {
    let shown = names.texts().collect::<Vec<_>>().join(",");
    draft.notes.push(format!("the file has no header but {}", excerpt(&shown)));
    let (time, value) = (names.text(time), names.text(value));
    let word = value.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or_default();
    draft.source = Source::from_name(word);
    if let Some((text, power)) = in_brackets(time, &["s", "S", "Hz"]) {
        draft.times.scale(power);
        draft.x_unit = Some(text);
    }
    if let Some((text, power)) = in_brackets(value, &["V", "v", "A", "dB"]) {
        draft.values.scale(power);
        draft.y_unit = Some(text);
    }
}

/// The unit in brackets at the end of `name`, with the power of ten of its prefix.
fn in_brackets(name: &str, units: &[&str]) -> Option<(String, i32)> {
    let inner = name.trim_end().strip_suffix([')', ']'])?;
    let (_, text) = inner.rsplit_once(['(', '['])?;
    let parts = |base: &&str| {
        let prefix = text.trim().strip_suffix(base)?;
        let power = PREFIXES.iter().find(|(known, _)| *known == prefix)?.1;
        Some((unit(base), power))
    };
    units.iter().find_map(parts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_in_file_names() {
        assert_eq!(channel_in("lab/ALL0001/F0001CH2.CSV"), Some(Source::Channel(2)));
        assert_eq!(channel_in("lab/CH2/TEK0001.CSV"), None);
        assert_eq!(channel_in("march.csv"), None);
    }

    #[test]
    fn units_in_brackets() {
        assert_eq!(in_brackets("Time (ms)", &["s"]), Some(("s".to_owned(), -3)));
        assert_eq!(in_brackets("u [V]", &["V"]), Some(("V".to_owned(), 0)));
        assert_eq!(in_brackets("x", &["s"]), None);
        assert_eq!(in_brackets("t (min)", &["s"]), None);
    }
}
