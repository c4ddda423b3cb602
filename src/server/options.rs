//! How the server serves.

use std::time::Duration;

use tokio::sync::mpsc;

/// How the server behaves.
#[derive(Debug, Default)]
pub struct ServerOptions {
    /// Whether headers stand before answers on a fresh connection (`HEADer`).
    pub header: bool,
    /// From one strike to the next; none leaves the chain at rest until a client strikes it.
    pub impact_every: Option<Duration>,
    /// Takes what the user should know while the server goes on.
    pub warn: Option<fn(&str)>,
    /// Strikes requested at the bench, one a message.
    pub strikes: Option<mpsc::Receiver<()>>,
}
