//! Clients of a served instrument, in memory and with a clock that is paused: time passes when the
//! test says so, and nothing else is left to be done when a call returns.

use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard};
use std::task::Poll;
use std::time::Duration;

use hertzscope::instrument::StatusSummary;
use hertzscope::server::{Connections, Inbox, Protocol, Request};
use tokio::io::{AsyncRead as _, AsyncWriteExt as _, DuplexStream, ReadBuf};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep, sleep_until};

/// What executes the sessions' requests.
pub trait Device: Default + Send + 'static {
    fn execute(&mut self, request: Request);
}

/// Bytes that a client may send or leave unread.
const STREAM_BUFFER: usize = 1 << 20;

/// The client's end of a connection; none if the client has closed it.
struct Client {
    stream: Option<DuplexStream>,
    received: Vec<u8>,
    is_closed: bool,
    reads: bool,
}

/// The clients of an instrument, by number.
pub struct Network<D> {
    runtime: Runtime,
    connections: Arc<Connections>,
    tasks: JoinSet<()>,
    device: Arc<Mutex<D>>,
    status: watch::Sender<StatusSummary>,
    clients: Vec<Client>,
    start: Instant,
}

impl<D: Device> Network<D> {
    /// VXI-11 is spoken on `vxi11_port`.
    pub fn new(vxi11_port: u16) -> Self {
        let runtime = Builder::new_current_thread().enable_time().start_paused(true).build();
        let runtime = runtime.expect("a runtime");
        let (connections, Inbox { mut requests, status }) = Connections::new(vxi11_port);
        let device = Arc::new(Mutex::new(D::default()));
        let (mut tasks, executes) = (JoinSet::new(), Arc::clone(&device));
        let execute = async move {
            while let Some(request) = requests.recv().await {
                executes.lock().expect("no panic").execute(request);
            }
        };
        tasks.spawn_on(execute, runtime.handle());
        let start = runtime.block_on(async { Instant::now() });
        Self { runtime, connections, tasks, device, status, clients: Vec::new(), start }
    }

    pub fn device(&self) -> MutexGuard<'_, D> {
        self.device.lock().expect("no panic")
    }

    pub fn set_status(&mut self, event: bool, enabled: u8) {
        self.status.send_replace(StatusSummary { event, enabled });
        self.settle();
    }

    /// A connection from this computer.
    pub fn connect(&mut self, protocol: Protocol) -> usize {
        self.connect_from([127, 0, 0, 1], protocol)
    }

    pub fn connect_from(&mut self, peer: [u8; 4], protocol: Protocol) -> usize {
        let (own, far) = tokio::io::duplex(STREAM_BUFFER);
        let number = self.clients.len();
        let port = u16::try_from(number).expect("few connections");
        let peer = SocketAddr::from((peer, port));
        let served = Arc::clone(&self.connections).serve(protocol, Box::new(far), peer);
        self.tasks.spawn_on(served, self.runtime.handle());
        let (stream, received) = (Some(own), Vec::new());
        self.clients.push(Client { stream, received, is_closed: false, reads: true });
        self.settle();
        number
    }

    /// Sends bytes; those to a closed connection are lost.
    pub fn send(&mut self, at: usize, bytes: &[u8]) {
        self.send_all(&[(at, bytes)]);
    }

    /// Sends bytes on several connections before the server sees any of them.
    pub fn send_all(&mut self, pieces: &[(usize, &[u8])]) {
        for (at, bytes) in pieces {
            if let Some(stream) = &mut self.clients[*at].stream {
                let _ = self.runtime.block_on(stream.write_all(bytes));
            }
        }
        self.settle();
    }

    /// A client reads no more.
    pub fn stop_reading(&mut self, at: usize) {
        self.clients[at].reads = false;
    }

    /// All that a connection was sent since the last call.
    pub fn received(&mut self, at: usize) -> Vec<u8> {
        std::mem::take(&mut self.clients[at].received)
    }

    /// Whether either side has closed a connection.
    pub fn is_closed(&self, at: usize) -> bool {
        self.clients[at].is_closed
    }

    pub fn close(&mut self, at: usize) {
        self.clients[at].stream = None;
        self.clients[at].is_closed = true;
        self.settle();
    }

    /// Time passes until `seconds` after the start.
    pub fn wait_until(&mut self, seconds: f64) {
        let end = self.start + Duration::from_secs_f64(seconds);
        self.runtime.block_on(async { sleep_until(end).await });
        self.settle();
    }

    /// Lets all tasks do what there is to do: the paused clock moves on when none can go on.
    pub fn settle(&mut self) {
        self.runtime.block_on(async { sleep(Duration::from_millis(1)).await });
        while let Some(ended) = self.tasks.try_join_next() {
            ended.expect("no panic");
        }
        for client in &mut self.clients {
            let Some(stream) = &mut client.stream else { continue };
            let mut buffer = vec![0; 1 << 16];
            let read = std::future::poll_fn(|context| {
                while client.reads && !client.is_closed {
                    let mut piece = ReadBuf::new(&mut buffer);
                    match Pin::new(&mut *stream).poll_read(context, &mut piece) {
                        Poll::Pending => break,
                        Poll::Ready(read) => {
                            client.received.extend_from_slice(piece.filled());
                            client.is_closed = read.is_err() || piece.filled().is_empty();
                        }
                    }
                }
                Poll::Ready(())
            });
            self.runtime.block_on(read);
        }
    }
}
