//! What a user says of a table: its columns (`time=1:ms,CH1=2:V,p14=4:N`), its sample interval, and
//! whether uneven times are resampled.

use std::str::FromStr;

use super::names::{self, ColumnUnit};
use crate::recording::Capture;
use crate::scope::Source;

/// One column as the user names it.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct GivenColumn {
    pub(super) label: String,
    /// Counted from 0.
    pub(super) index: usize,
    pub(super) unit: ColumnUnit,
}

/// The columns of tables, in the order typed, and what else the user says of tables.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct TableColumns {
    pub(super) columns: Vec<GivenColumn>,
    /// Sample interval of tables without times (s).
    pub interval: Option<f64>,
    /// Whether uneven times are resampled.
    pub resample: bool,
}

/// How `--columns` is written.
pub const EXAMPLE: &str = "time=1:ms,CH1=2:V,p14=4:N";
/// How `--interval` is written.
pub(super) const INTERVAL_EXAMPLE: &str = "--interval \"1 us\"";

impl TableColumns {
    /// Whether the user left the columns to the file.
    pub fn is_empty(&self) -> bool {
        self.columns.is_empty()
    }

    /// Labels that are no channels' names, with the sources of the `captures` that these columns
    /// became.
    pub fn labels(&self, captures: &[Capture]) -> Vec<(Source, String)> {
        let values = self.sources().into_iter().zip(captures);
        let labelled = values.filter(|((_, source), _)| source.is_none());
        labelled
            .map(|((column, _), capture)| (capture.waveform.source, column.label.clone()))
            .collect()
    }

    pub(super) fn is_time(label: &str) -> bool {
        label.eq_ignore_ascii_case("time") || label.eq_ignore_ascii_case("t")
    }

    /// The column of times.
    pub(super) fn time(&self) -> Option<&GivenColumn> {
        self.columns.iter().find(|column| Self::is_time(&column.label))
    }

    /// The channel of each column of values, in the order typed: by its name, or the first that is
    /// free.
    pub(super) fn sources(&self) -> Vec<(&GivenColumn, Option<Source>)> {
        let values = self.columns.iter().filter(|column| !Self::is_time(&column.label));
        values.map(|column| (column, names::source(&column.label))).collect()
    }
}

impl FromStr for TableColumns {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let wrong = |what: String| format!("{what}: give name=column:unit, e.g. {EXAMPLE}");
        let column = |part: &str| {
            let (label, place) =
                part.split_once('=').ok_or_else(|| wrong(format!("`{part}` has no `=`")))?;
            let (number, unit) = place.split_once(':').unwrap_or((place, ""));
            let label = label.trim().to_owned();
            let otherwise = if Self::is_time(&label) { "s" } else { "V" };
            let unit = if unit.trim().is_empty() { otherwise } else { unit };
            let known = names::unit(unit).filter(|u| u.is_abscissa() == Self::is_time(&label));
            let unit = known.ok_or_else(|| {
                wrong(format!("`{}` is no unit of `{label}` that is known", unit.trim()))
            })?;
            let number: usize = number.trim().parse().unwrap_or_default();
            let index = number
                .checked_sub(1)
                .ok_or_else(|| wrong(format!("`{part}` has no column, counted from 1")))?;
            Ok(GivenColumn { label, index, unit })
        };
        let columns: Vec<GivenColumn> =
            text.split(',').map(column).collect::<Result<_, String>>()?;
        let times = columns.iter().filter(|column| Self::is_time(&column.label)).count();
        if times > 1 || times == columns.len() {
            return Err(wrong(format!("{times} columns of times and {} in all", columns.len())));
        }
        Ok(Self { columns, interval: None, resample: false })
    }
}
