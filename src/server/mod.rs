//! The scope on the network: a raw TCP socket on which lab clients talk to one instrument.
//!
//! One task owns the instrument and what it remembers of every connection (`owner`); each connection has a task that
//! carries bytes (`link`); the chain moves on a thread of its own (`bench`), so that no reply waits for a simulation.

mod bench;
mod link;
mod owner;

use std::future::Future;
use std::io;
use std::net::TcpListener;
use std::pin::pin;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::task::JoinSet;

use crate::experiment::RunError;
use crate::scene::Scene;
use owner::Owner;

/// Connections at a time; further ones are closed at once.
pub const MOST_CONNECTIONS: usize = 32;
/// Pieces of input that wait for the owner, from all connections.
const PIECES: usize = 64;
/// Pause after a connection that could not be taken, e.g. for want of file handles.
const PAUSE: Duration = Duration::from_millis(20);

/// How the server behaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// Whether headers stand before answers on a fresh connection (`HEADer`).
    pub header: bool,
    /// From one strike to the next; none leaves the chain at rest.
    pub impact_every: Option<Duration>,
}

/// Why a server ended by itself.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// No runtime, no thread, or a listener that is none.
    #[error("the server could not start: {reason}")]
    Start {
        /// What the system says.
        reason: io::Error,
    },
    /// The chain could not be followed.
    #[error("impact {shot}: {reason}")]
    Impact {
        /// Number of the shot.
        shot: u32,
        /// What went wrong.
        reason: RunError,
    },
    /// The bench's thread ended.
    #[error("the simulation has ended unexpectedly")]
    BenchLost,
}

/// Answers everybody who connects to `listener`, until `shutdown` is there. The instrument begins as the scene sets it,
/// running. A simulation that is under way at the end goes on, on its thread, unheard.
///
/// # Errors
/// [`ServeError`] where the server cannot start or the scene cannot be run; no client can cause one.
pub fn serve(
    listener: TcpListener,
    scene: &Scene,
    options: Options,
    shutdown: impl Future<Output = ()>,
) -> Result<(), ServeError> {
    let start = |reason| ServeError::Start { reason };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(start)?.block_on(async {
        listener.set_nonblocking(true).map_err(start)?;
        let listener = tokio::net::TcpListener::from_std(listener).map_err(start)?;
        let bench = bench::Handle::start(scene.clone()).map_err(start)?;
        let (pieces, inbox) = mpsc::channel(PIECES);
        let owner = Owner::new(scene, options, bench);
        tokio::select! {
            () = shutdown => Ok(()),
            done = owner.run(inbox) => done,
            () = welcome(listener, pieces) => Ok(()),
        }
    })
}

/// Takes connections for ever; all of them end with this.
async fn welcome(listener: tokio::net::TcpListener, pieces: mpsc::Sender<link::News>) {
    let mut links = JoinSet::new();
    let mut number = 0_u64;
    loop {
        let accept = pin!(listener.accept());
        tokio::select! {
            Some(_) = links.join_next(), if !links.is_empty() => {}
            taken = accept => match taken {
                // A stream that is dropped is closed.
                Ok(_) if links.len() >= MOST_CONNECTIONS => {}
                Ok((stream, _)) => {
                    number += 1;
                    links.spawn(link::carry(stream, number, pieces.clone()));
                }
                Err(_) => tokio::time::sleep(PAUSE).await,
            },
        }
    }
}
