//! The scope on the network: raw TCP sockets, HiSLIP sessions and VXI-11 links on which lab clients
//! talk to one instrument.
//!
//! One task owns the instrument and what it remembers of every connection (`instrument_task`, with
//! `sessions`, and `bench_state` for the bench's settings); each connection has a task that copies
//! bytes (`connection`); the chain moves on a thread of its own (`bench_thread`), so that no reply
//! waits for a simulation; `recorder` writes down what happens.

mod bench_state;
mod bench_thread;
mod connection;
mod error;
mod instrument_task;
mod log;
mod options;
mod port_mapper;
mod recorder;
mod sessions;
mod writer;

pub use error::ServeError;
pub use options::ServerOptions;

use std::collections::BTreeMap;
use std::future::{Future, poll_fn};
use std::io;
use std::net::{IpAddr, TcpListener, UdpSocket};
use std::task::Poll;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot};
use tokio::task::JoinSet;

use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use connection::{ACCEPT_RETRY_DELAY, Connection, Protocol};
use instrument_task::InstrumentTask;
use recorder::Recorder;

/// Connections at a time, of all protocols. A further one takes the place of the one that has been
/// idle for longest, or is closed at once if none is idle. A HiSLIP session has two.
pub const MAX_CONNECTIONS: usize = 128;
/// Connections of one address at a time; beyond it only an idle one of the same address gives way.
pub const MAX_CONNECTIONS_OF_PEER: usize = 96;
/// Capacity of the queue of input pieces from all connections.
const EVENT_QUEUE_CAPACITY: usize = 64;
/// Time limit for writing the answers that are pending at shutdown.
const SHUTDOWN_GRACE: Duration = Duration::from_secs(1);

/// Where the server listens.
#[derive(Debug)]
pub struct Sockets {
    /// For raw connections.
    pub raw: TcpListener,
    /// For HiSLIP, if it is spoken.
    pub hislip: Option<TcpListener>,
    /// For VXI-11, if it is spoken.
    pub vxi11: Option<TcpListener>,
    /// For its port mapper, if there is one.
    pub port_mapper: Option<(TcpListener, UdpSocket)>,
}

/// Answers all connections until `shutdown` resolves, and writes all of it to `recording`, which is
/// finished then. The instrument begins as the scene sets it, running. A simulation that is under
/// way at the end goes on, on its thread, unheard.
///
/// # Errors
/// [`ServeError`] where the server cannot start, the scene cannot be run or the recording cannot be
/// written; no client can cause one.
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
        let vxi11_port = sockets.vxi11.as_ref().map(TcpListener::local_addr).transpose();
        let port = vxi11_port.map_err(start)?.map_or(0, |address| address.port());
        let mut listeners = vec![(Protocol::Raw, listener(sockets.raw).map_err(start)?)];
        let others = [(Protocol::Hislip, sockets.hislip), (Protocol::Vxi11, sockets.vxi11)];
        for (protocol, socket) in others {
            if let Some(socket) = socket {
                listeners.push((protocol, listener(socket).map_err(start)?));
            }
        }
        let mut connections = JoinSet::new();
        let mut mapper = JoinSet::new();
        if let Some((socket, datagrams)) = sockets.port_mapper {
            datagrams.set_nonblocking(true).map_err(start)?;
            let datagrams = tokio::net::UdpSocket::from_std(datagrams).map_err(start)?;
            let socket = listener(socket).map_err(start)?;
            mapper.spawn(port_mapper::answer_all(socket, datagrams, port));
        }
        let bench = bench_thread::BenchHandle::start().map_err(start)?;
        let (events, inbox) = mpsc::channel(EVENT_QUEUE_CAPACITY);
        let (warn, limit) = (options.warn.unwrap_or(|_| ()), options.size_limit);
        let recorder = recording.map(|writer| Recorder::start(writer, scene, limit, warn));
        let recorder = recorder.transpose().map_err(start)?;
        let mut task =
            InstrumentTask::new(scene, (options, port), bench, recorder).map_err(start)?;
        let done = tokio::select! {
            () = shutdown => Ok(()),
            done = task.run(inbox) => done,
            () = accept_loop(&listeners, events, &mut connections) => Ok(()),
        };
        let finished = task.finish().await;
        // The instrument task has ended, so every connection ends as soon as its answers are
        // written.
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
    listeners: &[(Protocol, tokio::net::TcpListener)],
    events: mpsc::Sender<connection::ConnectionEvent>,
    connections: &mut JoinSet<IpAddr>,
) {
    let mut number = 0_u64;
    let mut turn = 0_usize;
    let mut peers = BTreeMap::<IpAddr, usize>::new();
    loop {
        let accept = poll_fn(|context| {
            // Each has its turn as the first, so that none is starved by a flood or an error of
            // another.
            turn = turn.wrapping_add(1);
            let first = turn % listeners.len().max(1);
            let (front, back) = listeners.split_at(first);
            let mut taken = back.iter().chain(front).map(|(protocol, listener)| {
                listener.poll_accept(context).map(|taken| (*protocol, taken))
            });
            taken.find(Poll::is_ready).unwrap_or(Poll::Pending)
        });
        tokio::select! {
            Some(ended) = connections.join_next(), if !connections.is_empty() => {
                if let Ok(peer) = ended
                    && let Some(count) = peers.get_mut(&peer)
                {
                    *count -= 1;
                    if *count == 0 {
                        peers.remove(&peer);
                    }
                }
            }
            (protocol, taken) = accept => match taken {
                // A stream that is dropped is closed.
                Ok((stream, peer)) => {
                    let own = peers.get(&peer.ip()).copied().unwrap_or(0);
                    if has_room((connections.len(), own), peer.ip(), &events).await {
                        peers.insert(peer.ip(), own + 1);
                        number += 1;
                        let connection = Connection { number, protocol, peer, stream };
                        connections.spawn(connection.run(events.clone()));
                    }
                }
                Err(_) => tokio::time::sleep(ACCEPT_RETRY_DELAY).await,
            },
        }
    }
}

/// Whether there is room for one more connection of `peer` beside `open` others, `own` of them its
/// own; if need be because an idle one gives way.
async fn has_room(
    (open, own): (usize, usize),
    peer: IpAddr,
    events: &mpsc::Sender<connection::ConnectionEvent>,
) -> bool {
    let peer = (own >= MAX_CONNECTIONS_OF_PEER).then_some(peer);
    if open < MAX_CONNECTIONS && peer.is_none() {
        return true;
    }
    let (gave_way, answer) = oneshot::channel();
    events.send(connection::ConnectionEvent::Crowded { peer, gave_way }).await.is_ok()
        && answer.await == Ok(true)
}
