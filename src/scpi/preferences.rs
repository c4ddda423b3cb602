//! How replies on one connection look.

use crate::instrument::word::words;

words! {
    /// Terminator of replies.
    Terminator {
        /// Carriage return.
        Cr = "CR",
        /// Line feed.
        Lf = "LF",
        /// Carriage return, line feed.
        CrLf = "CRLf",
        /// Line feed, carriage return.
        LfCr = "LFCr",
    }
}

impl Terminator {
    /// The bytes.
    pub fn bytes(self) -> &'static [u8] {
        match self {
            Self::Cr => b"\r",
            Self::Lf => b"\n",
            Self::CrLf => b"\r\n",
            Self::LfCr => b"\n\r",
        }
    }
}

/// How replies on one connection look.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Preferences {
    /// Whether headers stand before answers (`HEADer`).
    pub header: bool,
    /// Whether words are written in full (`VERBose`).
    pub verbose: bool,
    /// Terminator of replies (`RS232:TRANsmit:TERMinator`).
    pub terminator: Terminator,
}

impl Preferences {
    /// Words in full, a line feed at the end, headers as asked for. The original answers with headers over RS-232, most
    /// programs expect none.
    pub fn new(header: bool) -> Self {
        Self { header, verbose: true, terminator: Terminator::Lf }
    }
}
