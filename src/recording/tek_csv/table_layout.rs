//! Where a table's names, units and samples stand, and the columns of its samples. Comes before
//! `table`, which finds out what they hold.

use super::cells::{Cells, CsvRows};
use super::column::SampleColumn;
use super::columns;
use super::names::{ColumnName, ColumnRole, unit};
use crate::recording::error::RecordingError;

/// Which rows hold what.
pub(super) struct TableLayout {
    pub(super) names: Option<usize>,
    units: Option<usize>,
    /// First row of samples.
    pub(super) first: usize,
    /// Cells with numbers in that row.
    pub(super) cells: Vec<usize>,
    /// Start and increment of a table whose first column counts rows, or that has no column of
    /// times.
    pub(super) even: Option<(f64, f64)>,
}

impl TableLayout {
    pub(super) fn find(table: &CsvRows<'_>) -> Result<Self, RecordingError> {
        let numeric = |index: usize| -> Vec<usize> {
            let row = table.row(index);
            (0..row.len()).filter(|cell| row.maybe_number(*cell).is_some()).collect()
        };
        let filled: Vec<usize> =
            (0..table.len()).rev().filter(|index| !table.row(*index).is_blank()).take(1).collect();
        let last = filled.first().copied().unwrap_or_default();
        let samples = [last / 4, last / 2, last * 3 / 4, last.saturating_sub(1), last].map(numeric);
        let same = |cells: &Vec<usize>| samples.iter().filter(|other| *other == cells).count();
        let usual =
            samples.iter().filter(|cells| !cells.is_empty()).max_by_key(|cells| same(cells));
        let Some(usual) = usual else { return Err(unknown(table, "rows of numbers")) };
        let has =
            |index: usize| usual.iter().all(|cell| table.row(index).maybe_number(*cell).is_some());
        let next = |index: usize| (index + 1..=last).find(|next| !table.row(*next).is_blank());
        let is_first = |index: &usize| has(*index) && next(*index).is_some_and(has);
        let either = || (0..=last).find(|index| has(*index));
        let Some(first) = (0..=last).find(is_first).or_else(either) else {
            return Err(unknown(table, "two rows of numbers"));
        };
        let mut layout =
            Self { names: None, units: None, first, cells: numeric(first), even: None };
        layout.include_broken_rows(table);
        layout.find_names(table);
        layout.find_even(table);
        if layout.cells.len() < 2 && layout.even.is_none() {
            return Err(unknown(table, "a column of times beside the values"));
        }
        Ok(layout)
    }

    /// Takes in the rows above that begin with a number: samples of which a cell is none, not
    /// names. Reading them names the cell.
    fn include_broken_rows(&mut self, table: &CsvRows<'_>) {
        let cell = self.first_cell();
        let above = (0..self.first).rev().filter(|index| !table.row(*index).is_blank());
        if let Some(first) =
            above.take_while(|index| table.row(*index).maybe_number(cell).is_some()).last()
        {
            self.first = first;
        }
    }

    /// The rows above the samples, from below, without blank ones.
    fn find_names(&mut self, table: &CsvRows<'_>) {
        let mut above = (0..self.first).rev().filter(|index| !table.row(*index).is_blank());
        let filled = |row: &Cells<'_>| row.texts().filter(|cell| !cell.is_empty()).count();
        let Some(lower) = above.next() else { return };
        let row = table.row(lower);
        let is_time = |text: &str| ColumnName::of(text, None).role == ColumnRole::Abscissa;
        if filled(&row) < self.cells.len().min(2) && !row.texts().any(is_time) {
            return;
        }
        let upper = above.next().filter(|upper| {
            let names = table.row(*upper);
            let starts = matches!(
                ColumnName::of(names.text(self.first_cell()), None).role,
                ColumnRole::Abscissa | ColumnRole::Index | ColumnRole::Nameless
            );
            starts && filled(&names) >= self.cells.len().min(2)
        });
        let is_units = row.texts().enumerate().all(|(cell, text)| {
            text.is_empty()
                || row.maybe_number(cell).is_some()
                || text.eq_ignore_ascii_case("sequence")
                || unit(text).is_some()
        });
        match upper {
            Some(upper) if is_units => (self.names, self.units) = (Some(upper), Some(lower)),
            // A row of remarks between names and samples.
            Some(upper) if !row.texts().any(is_time) && table.row(upper).texts().any(is_time) => {
                self.names = Some(upper);
            }
            _ => self.names = Some(lower),
        }
    }

    fn first_cell(&self) -> usize {
        self.cells.first().copied().unwrap_or_default()
    }

    /// Start and increment beside the names: `X,CH1,Start,Increment` above numbers, or
    /// `t0 = ...,tInc = ...`.
    fn find_even(&mut self, table: &CsvRows<'_>) {
        let Some(names) = self.names.map(|names| table.row(names)) else { return };
        let below = self.units.map(|units| table.row(units));
        let value = |words: [&str; 2]| {
            names.texts().enumerate().find_map(|(cell, name)| {
                let (name, inside) = name.split_once('=').unwrap_or((name, ""));
                words.iter().find(|word| word.eq_ignore_ascii_case(name.trim()))?;
                let number = names.parse(inside.trim().trim_end_matches('s'));
                let printed = number.or_else(|| below.as_ref()?.maybe_number(cell))?;
                Some(printed.value)
            })
        };
        self.even = value(["start", "t0"])
            .zip(value(["increment", "tinc"]))
            .filter(|(_, step)| *step > 0.0);
    }

    /// The row before which keys and values stand.
    pub(super) fn keys_end(&self) -> usize {
        self.names.unwrap_or(self.first)
    }

    pub(super) fn name(&self, table: &CsvRows<'_>, cell: usize) -> ColumnName {
        let below = self.units.map(|units| table.row(units));
        // Start and increment stand in the row of units.
        let below = below.as_ref().map(|row| row.text(cell)).filter(|text| unit(text).is_some());
        let text = self.names.map(|names| table.row(names)).map_or("", |row| row.text(cell));
        ColumnName::of(text, below)
    }
}

/// The columns of samples, read in one pass.
pub(super) struct TableBody {
    pub(super) columns: Vec<SampleColumn>,
}

impl TableBody {
    /// Reads the samples; `is_given` says that the user names the columns.
    pub(super) fn read(
        table: &CsvRows<'_>,
        layout: &TableLayout,
        is_given: bool,
    ) -> Result<Self, RecordingError> {
        let mut columns = vec![SampleColumn::default(); layout.cells.len()];
        let mut ended = vec![false; layout.cells.len()];
        let mut zeros = true;
        for index in layout.first..table.len() {
            let row = table.row(index);
            if row.is_blank() {
                continue;
            }
            for ((column, cell), ended) in columns.iter_mut().zip(&layout.cells).zip(&mut ended) {
                // A capture beside a longer one ends early.
                if row.text(*cell).is_empty() && column.len() > 0 {
                    *ended = true;
                    continue;
                }
                if *ended {
                    return Err(row.empty_above(*cell));
                }
                column.push(&row, *cell)?;
                zeros &= looks_cut(row.text(*cell));
            }
        }
        let names = layout
            .names
            .map_or(0, |names| table.row(names).texts().filter(|name| !name.is_empty()).count());
        let pairs = columns.len() > 2 && columns.len().is_multiple_of(2);
        if zeros && !is_given && table.separator == ',' && pairs && names < columns.len() {
            return Err(unknown(
                table,
                "decimal points: commas cannot be both decimal marks and separators",
            ));
        }
        Ok(Self { columns })
    }

    pub(super) fn column(&self, layout: &TableLayout, cell: usize) -> SampleColumn {
        let at = layout.cells.iter().position(|found| *found == cell);
        at.and_then(|at| self.columns.get(at)).cloned().unwrap_or_default()
    }
}

/// Whether a whole number could be the part behind or before a decimal comma: all are, where commas
/// had two duties.
fn looks_cut(text: &str) -> bool {
    !text.contains(['.', 'e', 'E', ','])
}

/// The error that a table is none of the known forms: the nearest one, what it lacks, and how to
/// say what it is.
pub(super) fn unknown(table: &CsvRows<'_>, missing: &str) -> RecordingError {
    let head = (0..table.len().min(8)).map(|index| table.row(index));
    let words: Vec<String> =
        head.flat_map(|row| row.texts().map(str::to_ascii_lowercase).collect::<Vec<_>>()).collect();
    let has = |word: &str| words.iter().any(|cell| cell.contains(word));
    let nearest = [
        ("record length", "a Tektronix header beside samples (TDS1000/2000, OpenChoice)"),
        ("firmware version", "a file of a newer Tektronix model (`TIME,CH1` above the samples)"),
        ("x-axis", "a Keysight file (`x-axis,1`, `second,Volt`)"),
        ("increment", "a Rigol file (`X,CH1,Start,Increment`)"),
        ("digilent", "a Digilent file (`Time (s),Channel 1 (V)`)"),
        ("segments", "a LeCroy file (`Time,Ampl`)"),
        ("waveform data", "an Instek file"),
        ("horizontal", "an oscilloscope's file with its settings above `TIME,CH1`"),
    ];
    let nearest = nearest.into_iter().find(|(word, _)| has(word)).map_or(
        "a table with a column of times and one for each channel (`Time (s),CH1 (V)`)",
        |(_, form)| form,
    );
    let problem = format!("this is nearest to {nearest}, but lacks {missing}");
    let advice = format!("say what its columns are, e.g. --columns {}", columns::EXAMPLE);
    RecordingError::new(table.file, format_args!("{problem}; {advice}"))
}
