//! Locks of sessions: at most one exclusive lock, and one shared lock that all HiSLIP sessions with
//! the same key hold together. VXI-11 links have the exclusive one alone.
//!
//! The exclusive lock is granted if no other session holds it, and the shared lock is free or held
//! by the requesting session, too. The shared lock is granted if no other session holds the
//! exclusive one, and the shared lock is free or has the same key. Source: IVI-6.1, section 5
//! (locking).

use std::collections::BTreeSet;
use std::time::Duration;

use tokio::sync::watch;
use tokio::time::timeout;

/// Longest key of a shared lock (bytes).
const MAX_KEY_LENGTH: usize = 256;

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
struct Locks {
    exclusive: Option<u64>,
    key: Vec<u8>,
    sharers: BTreeSet<u64>,
}

impl Locks {
    /// Requests the shared lock with this key or, if the key is empty, the exclusive lock.
    fn request(&mut self, session: u64, key: &[u8]) -> Grant {
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
    fn release(&mut self, session: u64) -> Released {
        if self.exclusive == Some(session) {
            self.exclusive = None;
            Released::Exclusive
        } else if self.sharers.remove(&session) {
            Released::Shared
        } else {
            Released::Nothing
        }
    }

    /// Whether the session's messages reach the instrument.
    fn may_act(&self, session: u64) -> bool {
        self.exclusive.is_none_or(|holder| holder == session) && self.may_share(session)
    }

    /// How many sessions have a lock.
    fn holders(&self) -> usize {
        let alone = self.exclusive.is_some_and(|holder| !self.sharers.contains(&holder));
        self.sharers.len() + usize::from(alone)
    }

    fn may_share(&self, session: u64) -> bool {
        self.sharers.is_empty() || self.sharers.contains(&session)
    }
}

/// The locks of all sessions, for connections that wait for them.
#[derive(Debug, Default)]
pub struct LockTable(watch::Sender<Locks>);

impl LockTable {
    /// Requests the shared lock with this key or, if the key is empty, the exclusive lock.
    pub fn request(&self, session: u64, key: &[u8]) -> Grant {
        let mut grant = Grant::Busy;
        self.0.send_if_modified(|locks| {
            grant = locks.request(session, key);
            grant == Grant::Granted
        });
        grant
    }

    /// The same, for a lock that may be free within a time.
    pub async fn acquire(&self, session: u64, key: Vec<u8>, within: Duration) -> Grant {
        let mut changes = self.0.subscribe();
        let granted = async {
            loop {
                let grant = self.request(session, &key);
                if grant != Grant::Busy || changes.changed().await.is_err() {
                    return grant;
                }
            }
        };
        timeout(within, granted).await.unwrap_or(Grant::Busy)
    }

    /// Waits until the session's messages reach the instrument.
    pub async fn may_act(&self, session: u64) {
        // The sender is alive as long as this is borrowed.
        let _ = self.0.subscribe().wait_for(|locks| locks.may_act(session)).await;
    }

    /// Gives a lock back, the exclusive one first.
    pub fn release(&self, session: u64) -> Released {
        let mut released = Released::Nothing;
        self.0.send_if_modified(|locks| {
            released = locks.release(session);
            released != Released::Nothing
        });
        released
    }

    /// The session is gone, and its locks with it.
    pub fn remove_session(&self, session: u64) {
        while self.release(session) != Released::Nothing {}
    }

    /// Whether a session holds the exclusive lock, and how many sessions have a lock.
    pub fn holders(&self) -> (bool, usize) {
        let locks = self.0.borrow();
        (locks.exclusive.is_some(), locks.holders())
    }
}
