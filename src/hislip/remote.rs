//! Remote and local control: what the control codes of `AsyncRemoteLocalControl` ask for. Source: IVI-6.1, table 17.

/// Remote and local state of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RemoteControl {
    /// Its keys are free.
    Free,
    /// Its keys are locked out.
    LockedOut,
    /// Any state: a virtual panel is remote and local at once.
    Unchanged,
}

impl RemoteControl {
    /// The request of a control code; none for an unknown code.
    pub fn from_code(code: u8) -> Option<Self> {
        match code {
            // Remote disabled, the same with going to local, go to local.
            0 | 2 | 6 => Some(Self::Free),
            // Remote enabled, the same with going to remote.
            1 | 3 => Some(Self::Unchanged),
            // Remote enabled with local lock-out, the same with going to remote.
            4 | 5 => Some(Self::LockedOut),
            _ => None,
        }
    }
}
