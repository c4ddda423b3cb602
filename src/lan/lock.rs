//! Locks of sessions: at most one exclusive lock, and one shared lock that all HiSLIP sessions with
//! the same key hold together. VXI-11 links have the exclusive one alone.
//!
//! The exclusive lock is granted if no other session holds it, and the shared lock is free or held
//! by the requesting session, too. The shared lock is granted if no other session holds the
//! exclusive one, and the shared lock is free or has the same key. Source: IVI-6.1, section 5
//! (locking).

use std::collections::{BTreeMap, BTreeSet};

/// Longest key of a shared lock (bytes).
pub const MAX_KEY_LENGTH: usize = 256;

/// The outcome of a lock request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Grant {
    /// The lock was granted.
    Granted,
    /// Another session holds the lock, or one that excludes it.
    Busy,
    /// The session holds it already, or the key is invalid.
    Invalid,
}

/// The kind of lock that was released.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Released {
    /// The exclusive lock.
    Exclusive,
    /// The share in the shared lock.
    Shared,
    /// There was none.
    Nothing,
}

/// The locks of all sessions.
#[derive(Debug, Clone, Default)]
pub struct Locks {
    exclusive: Option<u16>,
    key: Vec<u8>,
    sharers: BTreeSet<u16>,
}

impl Locks {
    /// Requests the shared lock with this key or, if the key is empty, the exclusive lock.
    pub fn request(&mut self, session: u16, key: &[u8]) -> Grant {
        let held_by_another = self.exclusive.is_some_and(|holder| holder != session);
        if key.is_empty() {
            if self.exclusive == Some(session) {
                return Grant::Invalid;
            }
            if held_by_another || !self.may_share(session) {
                return Grant::Busy;
            }
            self.exclusive = Some(session);
        } else {
            let readable = key.len() <= MAX_KEY_LENGTH && key.is_ascii();
            if !readable || self.sharers.contains(&session) {
                return Grant::Invalid;
            }
            if held_by_another || !(self.sharers.is_empty() || self.key == key) {
                return Grant::Busy;
            }
            self.key = key.to_vec();
            self.sharers.insert(session);
        }
        Grant::Granted
    }

    /// Gives a lock back, the exclusive one first.
    pub fn release(&mut self, session: u16) -> Released {
        if self.exclusive == Some(session) {
            self.exclusive = None;
            Released::Exclusive
        } else if self.sharers.remove(&session) {
            Released::Shared
        } else {
            Released::Nothing
        }
    }

    /// The session is gone, and its locks with it.
    pub fn remove_session(&mut self, session: u16) {
        while self.release(session) != Released::Nothing {}
    }

    /// Whether the session's messages reach the instrument.
    pub fn may_act(&self, session: u16) -> bool {
        self.exclusive.is_none_or(|holder| holder == session) && self.may_share(session)
    }

    /// Whether a session holds the exclusive lock.
    pub fn is_exclusive(&self) -> bool {
        self.exclusive.is_some()
    }

    /// How many sessions have a lock.
    pub fn holders(&self) -> usize {
        let alone = self.exclusive.is_some_and(|holder| !self.sharers.contains(&holder));
        self.sharers.len() + usize::from(alone)
    }

    fn may_share(&self, session: u16) -> bool {
        self.sharers.is_empty() || self.sharers.contains(&session)
    }
}

/// A request that waits for its lock.
#[derive(Debug, Clone)]
pub struct LockRequest {
    /// Key of the shared lock; empty for the exclusive one.
    pub key: Vec<u8>,
    /// Time at which the request expires, on the server's clock (s).
    pub until: f64,
}

/// Requests that wait, by session: one each.
pub type Queue = BTreeMap<u16, LockRequest>;
