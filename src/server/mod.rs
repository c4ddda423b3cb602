//! The scope on the network: raw TCP sockets and HiSLIP sessions on which lab clients talk to one instrument.
//!
//! One task owns the instrument and what it remembers of every connection (`instrument_task`, with `sessions`, and
//! `bench_state` for the bench's settings); each connection has a task that copies bytes (`connection`); the chain moves on a thread
//! of its own (`bench_thread`), so that no reply waits for a simulation; `recorder` writes down what happens.

mod bench_state;
mod bench_thread;
mod connection;
mod error;
mod instrument_task;
mod options;
mod recorder;
mod sessions;

pub use error::ServeError;
pub use options::ServerOptions;

use std::future::Future;
use std::io;
use std::net::TcpListener;
use std::pin::pin;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinSet;

use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use connection::{Connection, Protocol};
use instrument_task::InstrumentTask;
use recorder::Recorder;

/// Connections at a time, of both protocols. A further one takes the place of the one that has been idle for longest, or is closed at
/// once if none is idle. A HiSLIP session has two.
pub const MOST_CONNECTIONS: usize = 128;
/// Capacity of the queue of input pieces from all connections.
const PIECES: usize = 64;
/// Delay before accepting again after an error, e.g. when file handles have run out.
const ACCEPT_RETRY_DELAY: Duration = Duration::from_millis(20);
/// Time limit for writing the answers that are pending at shutdown.
const SHUTDOWN_GRACE: Duration = Duration::from_secs(1);

/// Where the server listens.
#[derive(Debug)]
pub struct Sockets {
    /// For raw connections.
    pub raw: TcpListener,
    /// For HiSLIP, if it is spoken.
    pub hislip: Option<TcpListener>,
}

/// Answers all connections until `shutdown` resolves, and writes all of it to `recording`, which is finished then. The
/// instrument begins as the scene sets it, running. A simulation that is under way at the end goes on, on its thread, unheard.
///
/// # Errors
/// [`ServeError`] where the server cannot start, the scene cannot be run or the recording cannot be written; no client can
/// cause one.
pub fn serve(
    sockets: Sockets,
    scene: &Scene,
    options: ServerOptions,
    recording: Option<RecordingWriter>,
    shutdown: impl Future<Output = ()>,
) -> Result<(), ServeError> {
    let start = |reason| ServeError::Start { reason };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(start)?.block_on(async {
        let raw = listener(sockets.raw).map_err(start)?;
        let hislip = sockets.hislip.map(listener).transpose().map_err(start)?;
        let bench = bench_thread::BenchHandle::start().map_err(start)?;
        let (pieces, inbox) = mpsc::channel(PIECES);
        let mut task = InstrumentTask::new(
            scene,
            options,
            bench,
            recording.map(|writer| Recorder::new(writer, scene)),
        );
        let mut connections = JoinSet::new();
        let done = tokio::select! {
            () = shutdown => Ok(()),
            done = task.run(inbox) => done,
            () = accept_loop((raw, hislip), pieces, &mut connections) => Ok(()),
        };
        let finished = task.finish();
        // The instrument task has ended, so every connection ends as soon as its answers are written.
        let _ = tokio::time::timeout(SHUTDOWN_GRACE, async {
            while connections.join_next().await.is_some() {}
        })
        .await;
        done.and(finished)
    })
}

fn listener(socket: TcpListener) -> io::Result<tokio::net::TcpListener> {
    socket.set_nonblocking(true)?;
    tokio::net::TcpListener::from_std(socket)
}

/// Accepts connections until it is cancelled.
async fn accept_loop(
    (raw, hislip): (tokio::net::TcpListener, Option<tokio::net::TcpListener>),
    pieces: mpsc::Sender<connection::ConnectionEvent>,
    connections: &mut JoinSet<()>,
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
            Some(_) = connections.join_next(), if !connections.is_empty() => {}
            (protocol, taken) = accept => match taken {
                // A stream that is dropped is closed.
                Ok((stream, peer)) => {
                    if has_room(connections.len(), &pieces).await {
                        number += 1;
                        let connection = Connection { number, protocol, peer, stream };
                        connections.spawn(connection.run(pieces.clone()));
                    }
                }
                Err(_) => tokio::time::sleep(ACCEPT_RETRY_DELAY).await,
            },
        }
    }
}

/// Whether there is room for one more connection beside `open` others, if need be because an idle one gives way.
async fn has_room(open: usize, pieces: &mpsc::Sender<connection::ConnectionEvent>) -> bool {
    if open < MOST_CONNECTIONS {
        return true;
    }
    let (gave_way, answer) = oneshot::channel();
    pieces.send(connection::ConnectionEvent::Crowded { gave_way }).await.is_ok()
        && answer.await == Ok(true)
}
