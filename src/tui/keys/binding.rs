//! A key and what it does.

use ratatui::crossterm::event::{KeyCode, KeyModifiers};

use crate::tui::model::Action;

/// A key with the modifiers that tell it from others.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeyPress {
    /// The key; a letter carries its case.
    pub code: KeyCode,
    /// Control, Alt, and for keys without a case of their own Shift.
    pub modifiers: KeyModifiers,
}

/// Where a binding holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BindingScope {
    /// Everywhere.
    Everywhere,
    /// On the scope's screen.
    Scope,
    /// In a panel over it.
    Panels,
}

/// One line of the help: keys that belong together, and what each does.
#[derive(Debug, Clone, Copy)]
pub struct Binding {
    /// Where the keys hold.
    pub place: BindingScope,
    /// The keys as people write them.
    pub label: &'static str,
    /// The keys and their actions.
    pub keys: &'static [(KeyPress, Action)],
    /// Help text.
    pub help: &'static str,
}
