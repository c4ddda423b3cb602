//! Dialects of the format.

use std::fmt;

/// A CSV dialect other than the instrument's own.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Dialect {
    /// Saved by the `OpenChoice` desktop program: unit words in the third column.
    OpenChoice,
    /// Saved by a newer model such as the TBS1000C: the header stands above the samples.
    NewerModel,
    /// A native file re-saved by a spreadsheet: shortened numbers, no comma at the end of a row.
    Spreadsheet,
    /// Column names, such as `x,y`, put above the samples by hand.
    HandHeader,
    /// Only samples; the header was cut away.
    Headerless,
}

impl fmt::Display for Dialect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OpenChoice => "a file of OpenChoice Desktop",
            Self::NewerModel => "a file of a newer model (TBS1000C)",
            Self::Spreadsheet => "a file re-saved by a spreadsheet",
            Self::HandHeader => "a file with column names put in by hand",
            Self::Headerless => "a file without its header",
        })
    }
}
