//! The scope on the network: raw TCP sockets and HiSLIP sessions on which lab clients talk to one instrument.
//!
//! One task owns the instrument and what it remembers of every connection (`owner`, with `desk` for the sessions and `stand`
//! for the bench's settings); each connection has a task that carries bytes (`link`); the chain moves on a thread of its own
//! (`bench`), so that no reply waits for a simulation; `recorder` writes down what happens.

mod bench;
mod desk;
mod error;
mod link;
mod options;
mod owner;
mod recorder;
mod stand;

pub use error::ServeError;
pub use options::Options;

use std::future::Future;
use std::io;
use std::net::TcpListener;
use std::pin::pin;
use std::time::Duration;

use tokio::sync::mpsc;
use tokio::task::JoinSet;

use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use link::{Link, Protocol};
use owner::Owner;
use recorder::Recorder;

/// Connections at a time, of both protocols; further ones are closed at once. A HiSLIP session has two.
pub const MOST_CONNECTIONS: usize = 128;
/// Pieces of input that wait for the owner, from all connections.
const PIECES: usize = 64;
/// Pause after a connection that could not be taken, e.g. for want of file handles.
const PAUSE: Duration = Duration::from_millis(20);
/// What was answered before the end is delivered within this time.
const FAREWELL: Duration = Duration::from_secs(1);

/// Where the server listens.
#[derive(Debug)]
pub struct Sockets {
    /// For raw connections.
    pub raw: TcpListener,
    /// For HiSLIP, if it is spoken.
    pub hislip: Option<TcpListener>,
}

/// Answers everybody who connects, until `shutdown` is there, and writes all of it to `recording`, which is finished then. The
/// instrument begins as the scene sets it, running. A simulation that is under way at the end goes on, on its thread, unheard.
///
/// # Errors
/// [`ServeError`] where the server cannot start, the scene cannot be run or the recording cannot be written; no client can
/// cause one.
pub fn serve(
    sockets: Sockets,
    scene: &Scene,
    options: Options,
    recording: Option<RecordingWriter>,
    shutdown: impl Future<Output = ()>,
) -> Result<(), ServeError> {
    let start = |reason| ServeError::Start { reason };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(start)?.block_on(async {
        let raw = listener(sockets.raw).map_err(start)?;
        let hislip = sockets.hislip.map(listener).transpose().map_err(start)?;
        let bench = bench::Handle::start().map_err(start)?;
        let (pieces, inbox) = mpsc::channel(PIECES);
        let mut owner =
            Owner::new(scene, options, bench, recording.map(|writer| Recorder::new(writer, scene)));
        let mut links = JoinSet::new();
        let done = tokio::select! {
            () = shutdown => Ok(()),
            done = owner.run(inbox) => done,
            () = welcome((raw, hislip), pieces, &mut links) => Ok(()),
        };
        let finished = owner.finish();
        // The owner is gone, so every connection ends as soon as its answers are written.
        let _ =
            tokio::time::timeout(FAREWELL, async { while links.join_next().await.is_some() {} })
                .await;
        done.and(finished)
    })
}

fn listener(socket: TcpListener) -> io::Result<tokio::net::TcpListener> {
    socket.set_nonblocking(true)?;
    tokio::net::TcpListener::from_std(socket)
}

/// Takes connections for ever.
async fn welcome(
    (raw, hislip): (tokio::net::TcpListener, Option<tokio::net::TcpListener>),
    pieces: mpsc::Sender<link::News>,
    links: &mut JoinSet<()>,
) {
    let mut number = 0_u64;
    loop {
        let accept = pin!(async {
            match &hislip {
                None => (Protocol::Raw, raw.accept().await),
                Some(hislip) => tokio::select! {
                    taken = raw.accept() => (Protocol::Raw, taken),
                    taken = hislip.accept() => (Protocol::Hislip, taken),
                },
            }
        });
        tokio::select! {
            Some(_) = links.join_next(), if !links.is_empty() => {}
            (protocol, taken) = accept => match taken {
                // A stream that is dropped is closed.
                Ok(_) if links.len() >= MOST_CONNECTIONS => {}
                Ok((stream, peer)) => {
                    number += 1;
                    links.spawn(Link { number, protocol, peer, stream }.carry(pieces.clone()));
                }
                Err(_) => tokio::time::sleep(PAUSE).await,
            },
        }
    }
}
