//! How the server serves.

use std::io::Write;
use std::time::Duration;

use tokio::sync::mpsc;

use crate::instrument::{BenchAccess, Fault};

/// How the server behaves.
#[derive(Default)]
pub struct ServerOptions {
    /// Whether replies of a new connection begin with headers (`HEADer`).
    pub header: bool,
    /// From one strike to the next; none leaves the chain at rest until a client strikes it.
    pub impact_every: Option<Duration>,
    /// Takes what the user should know while the server goes on.
    pub warn: Option<fn(&str)>,
    /// Strikes requested at the bench, one a message.
    pub strikes: Option<mpsc::Receiver<()>>,
    /// Faults that act from the start.
    pub faults: Vec<Fault>,
    /// What clients may change of the bench.
    pub access: BenchAccess,
    /// Size at which log and recording end, each by itself (bytes).
    pub size_limit: Option<u64>,
    /// Takes a line for each connection, command, reply, error and impact.
    pub log: Option<Box<dyn Write + Send>>,
}
