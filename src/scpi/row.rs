//! One row of the table of commands.

use super::setting::Setting;

/// How far a command is supported.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Support {
    /// Implemented as in the manual.
    Implemented,
    /// Implemented here, unknown to the real oscilloscope.
    Extension,
    /// The value is stored and returned without further effect.
    Stub,
    /// Rejected with an event.
    Unsupported,
    /// Another spelling of the row that is named.
    Alias(&'static str),
}

/// One command.
pub struct CommandRow {
    /// Header as in the manual: short forms in capitals, `<x>` for a number, `<wfm>` for a
    /// waveform.
    pub header: &'static str,
    /// The setting behind the command.
    pub setting: Setting,
    /// How far it is supported.
    pub support: Support,
    /// Whether queries of the group that it is in tell it.
    pub in_group: bool,
    /// One line about it.
    pub about: &'static str,
}

impl CommandRow {
    const fn new(
        support: Support,
        header: &'static str,
        setting: Setting,
        about: &'static str,
    ) -> Self {
        let in_group = !matches!(support, Support::Unsupported | Support::Alias(_));
        Self { header, setting, support, in_group, about }
    }

    /// A command that does what the manual says.
    pub const fn acts(header: &'static str, setting: Setting, about: &'static str) -> Self {
        Self::new(Support::Implemented, header, setting, about)
    }

    /// A command that acts and that no real oscilloscope has.
    pub const fn own(header: &'static str, setting: Setting, about: &'static str) -> Self {
        Self::new(Support::Extension, header, setting, about)
    }

    /// A command that is kept and told.
    pub const fn accepted(header: &'static str, setting: Setting, about: &'static str) -> Self {
        Self::new(Support::Stub, header, setting, about)
    }

    /// A command that is refused.
    pub const fn refused(header: &'static str, setting: Setting, about: &'static str) -> Self {
        Self::new(Support::Unsupported, header, setting, about)
    }

    /// Another spelling of the row `of`.
    pub const fn alias(header: &'static str, of: &'static str) -> Self {
        Self::new(Support::Alias(of), header, Setting::NONE, "")
    }

    /// The same, left out when its group is asked for.
    pub const fn apart(self) -> Self {
        Self { in_group: false, ..self }
    }

    /// The header's words.
    pub fn nodes(&self) -> impl Iterator<Item = &'static str> {
        self.header.split(':')
    }
}

/// Rows that belong together.
pub struct Group {
    /// Heading in the manual.
    pub title: &'static str,
    /// Its commands, in the order in which queries of a group tell them.
    pub rows: &'static [CommandRow],
}
