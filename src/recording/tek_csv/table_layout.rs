//! Where a table's names, units and samples stand, and the columns of its samples. Comes before
//! `table`, which finds out what they hold.

use super::cells::{Cells, CsvRows};
use super::column::SampleColumn;
use super::columns;
use super::keys::{self, KeyRequest, TableKeys};
use super::names::{ColumnName, ColumnRole, unit, unit_in_row};
use crate::recording::error::{RecordingError, excerpt};

/// Rows at the beginning of the samples, and as many spread over the rest, that tell which cells
/// hold numbers.
const SAMPLED_ROWS: usize = 64;
/// Share of a column's filled cells that hold numbers (1).
const MIN_NUMBER_SHARE: f64 = 0.75;
/// The same of a column that can only be one of damaged samples (1).
const MIN_DAMAGED_SHARE: f64 = 0.5;
/// Rows of a second table's head in which its names are searched.
const HEAD_ROWS: usize = 24;

/// Which rows hold what.
pub(super) struct TableLayout {
    pub(super) names: Option<usize>,
    units: Option<usize>,
    /// First row of samples.
    pub(super) first: usize,
    /// Row behind the samples: the end of the file, or the head of a second table.
    end: usize,
    /// Cells with numbers.
    pub(super) cells: Vec<usize>,
    /// Start and increment of a table whose first column counts rows, or that has no column of
    /// times.
    pub(super) even: Option<(f64, f64)>,
    /// Units that stand in every row behind a value: the value's cell and the text.
    beside: Vec<(usize, String)>,
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
        // A key with a value for each column stands in a cell that is empty beside samples.
        let before = usual.first().and_then(|cell| cell.checked_sub(1));
        let before = before.filter(|cell| table.row(last).text(*cell).is_empty());
        let is_key = |index: usize| {
            let text = before.map_or("", |cell| table.row(index).text(cell));
            text.contains(char::is_alphabetic)
        };
        let is_first =
            |index: &usize| has(*index) && !is_key(*index) && next(*index).is_some_and(has);
        let either = || (0..=last).find(|index| has(*index));
        let Some(first) = (0..=last).find(is_first).or_else(either) else {
            return Err(unknown(table, "two rows of numbers"));
        };
        // A first table with other cells than those of the last.
        let is_run = |index: &usize| {
            let second = next(*index);
            let third = second.and_then(next);
            let same = |other: Option<usize>| {
                other.is_some_and(|other| table.row(*index).is_like(&table.row(other)))
            };
            same(second) && same(third)
        };
        let first = (0..first).find(is_run).unwrap_or(first);
        let end = second_table(table, first).unwrap_or(table.len());
        let cells = sample_cells(table, first, end);
        let mut layout =
            Self { names: None, units: None, first, end, cells, even: None, beside: Vec::new() };
        layout.include_broken_rows(table);
        layout.find_channel_numbers(table)?;
        layout.find_names(table);
        layout.find_even(table);
        layout.find_units_beside(table)?;
        let row = table.row(layout.first);
        let thousands = |text: &&str| {
            text.contains(',') && text.contains('.') && !text.contains(char::is_alphabetic)
        };
        if let Some(text) = row.texts().find(thousands) {
            let what = format!("numbers without thousands separators, not {}", excerpt(text));
            return Err(unknown(table, &what));
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

    /// A first row of whole numbers that count the columns is a row of names: if the file says that
    /// it has one sample less, or if all numbers below have a decimal point.
    fn find_channel_numbers(&mut self, table: &CsvRows<'_>) -> Result<(), RecordingError> {
        let row = table.row(self.first);
        let counted = |from: usize| {
            let mut cells = (from..).zip(&self.cells);
            self.cells.len() > 1 && cells.all(|(n, cell)| row.text(*cell) == n.to_string())
        };
        if !counted(0) && !counted(1) {
            return Ok(());
        }
        let keys = TableKeys { table, rows: self.first, beside: &self.cells };
        let stated = keys.number(keys::RECORD_LENGTH, KeyRequest::default())?;
        let found = (self.first..self.end).filter(|index| !table.row(*index).is_blank()).count();
        let is_one_less = stated.is_some_and(|stated| (stated + 1.0 - found as f64).abs() < 0.5);
        let are_fractions = sampled(self.first + 1, self.end).all(|index| {
            let row = table.row(index);
            row.is_blank() || self.cells.iter().all(|cell| row.text(*cell).contains(['.', 'e']))
        });
        if is_one_less || (are_fractions && found > 2) {
            self.names = Some(self.first);
            self.first += 1;
        }
        Ok(())
    }

    /// The rows above the samples, from below, without blank ones.
    fn find_names(&mut self, table: &CsvRows<'_>) {
        if self.names.is_some() {
            return;
        }
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
            let role = |cell: usize| ColumnName::of(names.text(cell), None).role;
            let starts = matches!(
                role(self.first_cell()),
                ColumnRole::Abscissa | ColumnRole::Index | ColumnRole::Nameless
            );
            let are_channels =
                || self.cells.iter().all(|cell| matches!(role(*cell), ColumnRole::Values(Some(_))));
            (starts || are_channels()) && filled(&names) >= self.cells.len().min(2)
        });
        let text = |cell: &usize| row.text(*cell);
        let is_filler = |cell: &usize| {
            let text = text(cell);
            text.is_empty()
                || row.maybe_number(*cell).is_some()
                || text.eq_ignore_ascii_case("sequence")
        };
        let known = |cell: &usize| unit_in_row(unit_text(text(cell))).is_some();
        let cells = || self.cells.iter();
        let are_units = cells().all(|cell| is_filler(cell) || known(cell));
        // A unit that is not known beside a unit of times.
        let is_led_by_unit = || {
            let Some(names) = upper.map(|upper| table.row(upper)) else { return false };
            let is_led = cells().any(|cell| {
                let unit = unit_in_row(unit_text(text(cell)));
                unit.is_some_and(|unit| unit.is_abscissa()) && is_time(names.text(*cell))
            });
            is_led && cells().all(|cell| text(cell).is_empty() || !names.text(*cell).is_empty())
        };
        match upper {
            Some(upper) if are_units || is_led_by_unit() => {
                (self.names, self.units) = (Some(upper), Some(lower));
            }
            // A row of remarks between names and samples.
            Some(upper) if !row.texts().any(is_time) && table.row(upper).texts().any(is_time) => {
                self.names = Some(upper);
            }
            _ => self.names = Some(lower),
        }
        // A row of units above the names.
        let is_unit = |row: &Cells<'_>, cell: usize| unit(unit_text(row.text(cell))).is_some();
        let above = self
            .names
            .filter(|_| self.units.is_none())
            .and_then(|names| (0..names).rev().find(|index| !table.row(*index).is_blank()));
        if let Some(above) = above.filter(|above| {
            let row = table.row(*above);
            let is_led = self.cells.first().is_some_and(|cell| is_unit(&row, *cell));
            let is_filled = self.cells.iter().all(|cell| !row.text(*cell).is_empty());
            self.cells.len() > 1 && is_led && is_filled
        }) {
            self.units = Some(above);
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

    /// Texts behind the values, without a name of their own, that are units: if one is known, all
    /// are.
    fn find_units_beside(&mut self, table: &CsvRows<'_>) -> Result<(), RecordingError> {
        let mut found: Vec<(usize, Vec<&str>)> = Vec::new();
        for cell in &self.cells {
            let place = cell + 1;
            let name = self.names.map_or("", |names| table.row(names).text(place));
            if self.cells.contains(&place) || !name.is_empty() {
                continue;
            }
            let rows = sampled(self.first, self.end).map(|index| table.row(index).text(place));
            let mut texts: Vec<&str> = rows.filter(|text| !text.is_empty()).collect();
            texts.sort_unstable();
            texts.dedup();
            if !texts.is_empty() {
                found.push((*cell, texts));
            }
        }
        let is_unit = |text: &&str| unit(text).is_some() || text.starts_with("dB");
        if !found.iter().any(|(_, texts)| texts.iter().all(is_unit)) {
            return Ok(());
        }
        for (cell, texts) in found {
            match texts.as_slice() {
                [only] => self.beside.push((cell, (*only).to_owned())),
                several => {
                    let texts: Vec<String> = several.iter().map(|text| excerpt(text)).collect();
                    let texts = texts.join(" and ");
                    let what = format!("one unit for column {}: it has {texts}", cell + 1);
                    return Err(unknown(table, &what));
                }
            }
        }
        Ok(())
    }

    /// The row before which keys and values stand.
    pub(super) fn keys_end(&self) -> usize {
        self.names.unwrap_or(self.first)
    }

    /// Whether a cell holds the unit of the one before it.
    pub(super) fn is_unit(&self, cell: usize) -> bool {
        self.beside.iter().any(|(value, _)| value + 1 == cell)
    }

    pub(super) fn name(&self, table: &CsvRows<'_>, cell: usize) -> ColumnName {
        let row = self.units.map(|units| table.row(units));
        // Start and increment stand in the row of units.
        let below = row.as_ref().map(|row| (row, unit_text(row.text(cell))));
        let below = below.filter(|(row, text)| row.parse(text).is_none() && *text != "Sequence");
        let beside = self.beside.iter().find(|(value, _)| *value == cell);
        let unit = below.map(|(_, text)| text).or(beside.map(|(_, text)| text.as_str()));
        let text = self.names.map(|names| table.row(names)).map_or("", |row| row.text(cell));
        match (text, unit) {
            ("", None) => ColumnName::none(),
            _ => ColumnName::of(text, unit),
        }
    }

    /// What is said of the rows below the samples.
    pub(super) fn note_rows_below(&self, table: &CsvRows<'_>) -> Option<String> {
        let begins = excerpt(table.line(self.end).trim());
        (self.end < table.len()).then(|| {
            format!(
                "lines {} to {} are left out: a second table or remarks, which begin with {begins}",
                self.end + 1,
                table.len()
            )
        })
    }
}

/// A text of a row of units, without what says that it is one.
fn unit_text(text: &str) -> &str {
    let text = text.trim_start_matches(['#', ';', '%', ' ']);
    let rest = ["units:", "unit:", "units", "unit"].into_iter().find_map(|word| {
        let (head, rest) = text.split_at_checked(word.len())?;
        head.eq_ignore_ascii_case(word).then_some(rest)
    });
    rest.unwrap_or(text).trim()
}

/// Rows of samples that are looked at to tell what the columns are.
fn sampled(first: usize, end: usize) -> impl Iterator<Item = usize> + Clone {
    let head = end.min(first + SAMPLED_ROWS);
    let step = (end.saturating_sub(head) / SAMPLED_ROWS).max(1);
    (first..head).chain((head..end).step_by(step))
}

/// The row at which a second table or remarks begin below the samples: words in the place of
/// numbers, and names of a table in the next rows, or no numbers at all.
fn second_table(table: &CsvRows<'_>, first: usize) -> Option<usize> {
    let begins = |c: char| c.is_alphabetic() || matches!(c, '*' | '#' | ';' | '%');
    let is_word = |index: &usize| {
        let start = table.line(*index).trim_start_matches([' ', '"', '\t', ',']).chars().next();
        start.is_some_and(begins) && table.row(*index).has_no_number()
    };
    let is_name = |text: &str| ColumnName::of(text, None).role == ColumnRole::Abscissa;
    (first + 1..table.len()).filter(is_word).find(|index| {
        let head = *index..table.len().min(index + HEAD_ROWS);
        let is_named = head.clone().any(|index| table.row(index).texts().any(is_name));
        is_named || (*index..table.len()).all(|index| table.row(index).has_no_number())
    })
}

/// The cells that hold numbers, or nothing, in most of the rows that are looked at.
fn sample_cells(table: &CsvRows<'_>, first: usize, end: usize) -> Vec<usize> {
    // Filled cells, numbers, and numbers behind a word: values of settings beside the samples.
    let mut counts: Vec<[usize; 3]> = Vec::new();
    for index in sampled(first, end) {
        let row = table.row(index);
        if counts.len() < row.len() {
            counts.resize(row.len(), [0; 3]);
        }
        let is_number = |cell: usize| row.maybe_number(cell).is_some() || row.mark(cell).is_some();
        for (cell, [filled, numbers, settings]) in counts.iter_mut().enumerate() {
            let text = cell.checked_sub(1).map_or("", |before| row.text(before));
            let is_setting = text.contains(char::is_alphabetic) && !is_number(cell - 1);
            *filled += usize::from(!row.text(cell).is_empty());
            *numbers += usize::from(is_number(cell));
            *settings += usize::from(is_number(cell) && is_setting);
        }
    }
    let holds_numbers = |(_, [filled, numbers, settings]): &(usize, &[usize; 3])| {
        let least = if *settings == 0 { MIN_DAMAGED_SHARE } else { MIN_NUMBER_SHARE };
        *numbers > 0 && *numbers as f64 >= least * *filled as f64
    };
    counts.iter().enumerate().filter(holds_numbers).map(|(cell, _)| cell).collect()
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
        // Columns of nothing but digits, which could be the parts behind a decimal comma.
        let mut digits = vec![true; layout.cells.len()];
        let mut zeros = true;
        for index in layout.first..layout.end {
            let row = table.row(index);
            if row.is_blank() {
                continue;
            }
            let each = columns.iter_mut().zip(&layout.cells).zip(&mut ended).zip(&mut digits);
            for (((column, cell), ended), digits) in each {
                let text = row.text(*cell);
                // Without a value before it begins, or behind its end.
                if text.is_empty() {
                    column.skip_row();
                    *ended = column.len() > 0;
                    continue;
                }
                if *ended {
                    return Err(row.empty_above(*cell));
                }
                column.push(&row, *cell)?;
                *digits &= text.bytes().all(|byte| byte.is_ascii_digit());
                zeros &= could_be_part(text);
            }
        }
        // An unnamed column of indices in front counts, empty cells behind the names do not.
        let names = layout.names.map_or(0, |names| {
            let named = |name: &&str| !name.is_empty();
            let cells: Vec<&str> = table.row(names).texts().collect();
            cells.iter().rposition(named).map_or(0, |last| last + 1)
        });
        let pairs = columns.len() > 2 && columns.len().is_multiple_of(2) && zeros;
        // One column too many for each comma that splits a number.
        let surplus = columns.len().saturating_sub(names);
        let parts = digits.iter().skip(1).filter(|digits| **digits).count();
        let is_split = if names > 0 { surplus > 0 && parts >= surplus } else { pairs };
        if !is_given && table.separator == ',' && is_split {
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

/// Whether a number could be the part before or behind a decimal comma.
fn could_be_part(text: &str) -> bool {
    !text.contains(['.', 'e', 'E', ','])
}

/// The error that a table is none of the known forms: the nearest one, what it lacks, and how to
/// say what it is.
pub(super) fn unknown(table: &CsvRows<'_>, missing: &str) -> RecordingError {
    let advice = format!("say what its columns are, e.g. --columns {}", columns::EXAMPLE);
    nearest(table, missing, &advice)
}

/// The same of a table without times.
pub(super) fn without_times(table: &CsvRows<'_>) -> RecordingError {
    let advice = format!(
        "say which column holds them, e.g. --columns {}, or how far apart the values are, e.g. {}",
        columns::EXAMPLE,
        columns::INTERVAL_EXAMPLE
    );
    nearest(table, "a column of times, and a sample interval", &advice)
}

fn nearest(table: &CsvRows<'_>, missing: &str, advice: &str) -> RecordingError {
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
        ("labview measurement", "a LabVIEW file (`X_Value`, `Voltage_0`)"),
        ("segments", "a LeCroy file (`Time,Ampl`)"),
        ("waveform data", "an Instek file"),
        ("horizontal", "an oscilloscope's file with its settings above `TIME,CH1`"),
    ];
    let nearest = nearest.into_iter().find(|(word, _)| has(word)).map_or(
        "a table with a column of times and one for each channel (`Time (s),CH1 (V)`)",
        |(_, form)| form,
    );
    let problem = format!("this is nearest to {nearest}, but lacks {missing}");
    RecordingError::new(table.file, format_args!("{problem}; {advice}"))
}
