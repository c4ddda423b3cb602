//! The places of connections: how many there may be, and which one gives way to a new one.

use std::collections::BTreeMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::oneshot;
use tokio::time::Instant;

/// Connections at a time, of all protocols. A further one takes the place of the one that has been
/// idle for longest, or is closed at once if none is idle. A HiSLIP session has two.
pub const MAX_CONNECTIONS: usize = 128;
/// Connections of one address at a time; beyond it only an idle one of the same address gives way.
pub const MAX_CONNECTIONS_OF_PEER: usize = 96;
/// Time without a byte after which a connection gives way to another one where there is no room.
const IDLE_TIME: Duration = Duration::from_secs(1);

/// A place that is taken.
struct Place {
    peer: IpAddr,
    /// Number of connections that share it: two for a HiSLIP session.
    connections: usize,
    /// What the connection's client waits for at the moment.
    busy: usize,
    /// When bytes came last.
    last_received: Instant,
    /// Ends the connection when it is dropped.
    _end: oneshot::Sender<()>,
}

/// The places that are taken, by their numbers, and the next number.
#[derive(Default)]
struct Taken {
    places: BTreeMap<u64, Place>,
    next: u64,
}

/// All places.
#[derive(Clone, Default)]
pub struct Places {
    taken: Arc<Mutex<Taken>>,
}

impl Places {
    /// A place for a connection of `peer`, if need be that of an idle one. The receiver resolves
    /// when the connection has to give way.
    pub fn admit(&self, peer: IpAddr) -> Option<(Seat, oneshot::Receiver<()>)> {
        let mut taken = self.lock();
        let Taken { places, next } = &mut *taken;
        let count = |of: &dyn Fn(&Place) -> bool| -> usize {
            places.values().filter(|place| of(place)).map(|place| place.connections).sum()
        };
        if count(&|place| place.peer == peer) >= MAX_CONNECTIONS_OF_PEER {
            evict(places, |_, place| place.peer == peer)?;
        } else if count(&|_| true) >= MAX_CONNECTIONS {
            evict(places, |_, _| true)?;
        }
        let (end, ended) = oneshot::channel();
        let (number, last_received) = (*next, Instant::now());
        *next += 1;
        places.insert(number, Place { peer, connections: 1, busy: 0, last_received, _end: end });
        Some((Seat { places: self.clone(), number }, ended))
    }

    /// Ends the connection that has been idle for longest among those of `choice`. Its number, if
    /// there was one.
    pub fn evict(&self, choice: impl Fn(u64) -> bool) -> Option<u64> {
        evict(&mut self.lock().places, |number, _| choice(number))
    }

    fn lock(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn change(&self, number: u64, change: impl FnOnce(&mut Place)) {
        // The place of a connection that has given way is gone before the connection is.
        if let Some(place) = self.lock().places.get_mut(&number) {
            change(place);
        }
    }
}

fn evict(places: &mut BTreeMap<u64, Place>, choice: impl Fn(u64, &Place) -> bool) -> Option<u64> {
    let is_idle = |place: &Place| place.busy == 0 && place.last_received.elapsed() >= IDLE_TIME;
    let idle = places.iter().filter(|(number, place)| is_idle(place) && choice(**number, place));
    let (number, _) = idle.min_by_key(|(number, place)| (place.last_received, **number))?;
    let number = *number;
    places.remove(&number);
    Some(number)
}

/// A connection's place, free again when this is dropped.
pub struct Seat {
    places: Places,
    number: u64,
}

impl Seat {
    /// Number of the place.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// Notes that bytes came.
    pub fn touch(&self) {
        self.places.change(self.number, |place| place.last_received = Instant::now());
    }

    /// Marks the connection as not idle until the result is dropped.
    pub fn busy(&self) -> Busy {
        self.places.change(self.number, |place| place.busy += 1);
        Busy { places: self.places.clone(), number: self.number }
    }

    /// Takes over a second connection: the two are idle together, and give way together.
    pub fn join(&self, other: Self) {
        drop(other);
        self.places.change(self.number, |place| place.connections += 1);
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.places.lock().places.remove(&self.number);
    }
}

/// Keeps a connection from giving way.
pub struct Busy {
    places: Places,
    number: u64,
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.places.change(self.number, |place| place.busy -= 1);
    }
}
