//! The scope on the network: raw TCP sockets, HiSLIP sessions and VXI-11 links on which lab clients
//! talk to one instrument.
//!
//! One task owns the instrument and executes the requests of all sessions, a message at a time
//! (`instrument_task`, with `sessions`, and `bench_state` for the bench's settings). Each
//! connection has a task of its own that speaks its protocol (`connection`; `raw`, `hislip`,
//! `vxi11`, `port_mapper`) and reaches the instrument through `network`. The chain moves on a
//! thread of its own (`bench_thread`), so that no reply waits for a simulation; `recorder` writes
//! down what happens.

mod bench_state;
mod bench_thread;
mod connection;
mod error;
mod hislip;
mod instrument_task;
mod locks;
mod log;
mod network;
mod options;
mod places;
mod port_mapper;
mod raw;
mod recorder;
mod sessions;
mod vxi11;
mod wire;
mod writer;

pub use connection::{Connections, Protocol};
pub use error::ServeError;
pub use locks::{Grant, LockTable};
pub use network::{Answer, Inbox, Interrupts, Network, Request};
pub use options::ServerOptions;
pub use places::{MAX_CONNECTIONS, MAX_CONNECTIONS_OF_PEER};
pub use vxi11::{MAX_LINKS, MAX_LINKS_OF_CONNECTION};
pub use wire::Stream;

use std::future::{Future, poll_fn};
use std::io;
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::sync::Arc;
use std::task::Poll;
use std::time::Duration;

use tokio::net::TcpStream;
use tokio::task::JoinSet;

use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use instrument_task::InstrumentTask;
use recorder::Recorder;

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
    /// For VXI-11, if it is spoken.
    pub vxi11: Option<TcpListener>,
    /// For its port mapper, if there is one.
    pub port_mapper: Option<(TcpListener, UdpSocket)>,
}

/// Answers all connections until `shutdown` resolves, and writes all of it to `recording`, which is
/// finished then. The instrument begins as the scene sets it, running. A simulation that is under
/// way at the end continues on its thread; its result is discarded.
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
        let mut datagrams = JoinSet::new();
        if let Some((socket, of_mapper)) = sockets.port_mapper {
            of_mapper.set_nonblocking(true).map_err(start)?;
            let of_mapper = tokio::net::UdpSocket::from_std(of_mapper).map_err(start)?;
            listeners.push((Protocol::PortMapper, listener(socket).map_err(start)?));
            datagrams.spawn(port_mapper::answer_datagrams(of_mapper, port));
        }
        let bench = bench_thread::BenchHandle::start().map_err(start)?;
        let (warn, limit) = (options.warn.unwrap_or(|_| ()), options.size_limit);
        let recorder = recording.map(|writer| Recorder::start(writer, scene, limit, warn));
        let recorder = recorder.transpose().map_err(start)?;
        let (connections, inbox) = Connections::new(port);
        let mut tasks = JoinSet::new();
        let mut task =
            InstrumentTask::new(scene, options, bench, recorder, inbox).map_err(start)?;
        let done = tokio::select! {
            () = shutdown => Ok(()),
            done = task.run() => done,
            () = accept_loop(&listeners, &connections, &mut tasks) => Ok(()),
        };
        let finished = task.finish().await;
        // The instrument task has ended, so every connection ends as soon as its answers are
        // written.
        let _ = tokio::time::timeout(SHUTDOWN_GRACE, async {
            while tasks.join_next().await.is_some() {}
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
    connections: &Arc<Connections>,
    tasks: &mut JoinSet<()>,
) {
    let mut turn = 0;
    loop {
        tokio::select! {
            Some(_) = tasks.join_next() => {}
            (protocol, taken) = accept(listeners, &mut turn) => match taken {
                // A stream that is dropped is closed.
                Ok((stream, peer)) => {
                    if let Ok(stream) = wire::configured(stream) {
                        tasks.spawn(Arc::clone(connections).serve(protocol, stream, peer));
                    }
                }
                Err(_) => tokio::time::sleep(ACCEPT_RETRY_DELAY).await,
            },
        }
    }
}

/// The next connection. Each listener has its turn as the first one that is asked, so that none is
/// starved by a flood or an error of another.
async fn accept(
    listeners: &[(Protocol, tokio::net::TcpListener)],
    turn: &mut usize,
) -> (Protocol, io::Result<(TcpStream, SocketAddr)>) {
    poll_fn(|context| {
        *turn = turn.wrapping_add(1);
        let (front, back) = listeners.split_at(*turn % listeners.len().max(1));
        let mut taken = back.iter().chain(front).map(|(protocol, listener)| {
            listener.poll_accept(context).map(|taken| (*protocol, taken))
        });
        taken.find(Poll::is_ready).unwrap_or(Poll::Pending)
    })
    .await
}

#[cfg(test)]
mod tests {
    use super::{Protocol, accept, listener};

    /// A hundred raw connections wait, and one of HiSLIP behind them: it is the first or second to
    /// be accepted.
    #[tokio::test]
    async fn a_flood_on_one_port_starves_no_other() {
        let bound = [Protocol::Raw, Protocol::Hislip].map(|protocol| {
            let socket = std::net::TcpListener::bind("127.0.0.1:0").expect("a port");
            (protocol, listener(socket).expect("a listener"))
        });
        let connect = |at: usize| {
            let address = bound[at].1.local_addr().expect("an address");
            std::net::TcpStream::connect(address).expect("a connection")
        };
        let _flood: Vec<_> = (0..100).map(|_| connect(0)).collect();
        let _client = connect(1);
        let mut turn = 0;
        let mut accepted = Vec::new();
        for _ in 0..4 {
            accepted.push(accept(&bound, &mut turn).await.0);
        }
        assert!(accepted[..2].contains(&Protocol::Hislip), "{accepted:?}");
        assert!(accepted.contains(&Protocol::Raw), "{accepted:?}");
    }
}
