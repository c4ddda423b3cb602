//! One connection: copies bytes between a socket and the instrument's task.
//!
//! A piece of input is handed on only when the answer to the one before has been written, so a
//! client that does not read is not read from either, and nothing piles up.

use std::io;
use std::net::{IpAddr, SocketAddr};
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::TcpStream;
use tokio::sync::{mpsc, oneshot};

/// Delay before accepting again after an error, e.g. when file handles have run out.
pub const ACCEPT_RETRY_DELAY: Duration = Duration::from_millis(20);
/// Longest piece of input that is handed on at once (bytes).
const READ_BUFFER: usize = 1024;
/// Time without a byte after which the system asks whether the client is there.
const KEEPALIVE_TIME: Duration = Duration::from_secs(60);
/// Time from one such question to the next.
const KEEPALIVE_INTERVAL: Duration = Duration::from_secs(5);
/// Time after which a client that accepts no bytes is dropped.
const WRITE_TIMEOUT: Duration = Duration::from_secs(10);
/// Answers that wait for the socket. One belongs to the last piece, others come from acquisitions
/// that ended.
const REPLY_QUEUE_CAPACITY: usize = 64;

/// The protocol of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// Lines.
    Raw,
    /// HiSLIP.
    Hislip,
    /// VXI-11.
    Vxi11,
}

impl Protocol {
    /// How logs and recordings name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Hislip => "hislip",
            Self::Vxi11 => "vxi11",
        }
    }
}

/// Events of a connection.
#[derive(Debug)]
pub enum ConnectionEvent {
    /// Connection opened.
    Opened {
        /// Number of the connection.
        number: u64,
        /// Its protocol.
        protocol: Protocol,
        /// The client's address.
        peer: SocketAddr,
        /// Queue of its answers; the connection ends when the queue is closed.
        answers: mpsc::Sender<OutgoingBytes>,
    },
    /// Bytes received. Each piece is answered once, even if by an empty answer.
    Bytes {
        /// Number of the connection.
        number: u64,
        /// The bytes.
        bytes: Vec<u8>,
    },
    /// The client sends no more, but may still listen.
    Ended {
        /// Number of the connection.
        number: u64,
    },
    /// Another connection is waiting where there is no room.
    Crowded {
        /// The address that has as many as one may have; none if the server is full.
        peer: Option<IpAddr>,
        /// Takes whether an idle connection has given way.
        gave_way: oneshot::Sender<bool>,
    },
    /// Connection closed.
    Closed {
        /// Number of the connection.
        number: u64,
    },
}

/// Bytes for a client.
#[derive(Debug)]
pub struct OutgoingBytes {
    /// The bytes, which may be none.
    pub bytes: Vec<u8>,
    /// Whether this answers a piece; what comes later, when an acquisition has ended, does not.
    pub to_piece: bool,
}

/// A connection that was taken.
pub struct Connection {
    /// Its number.
    pub number: u64,
    /// Its protocol.
    pub protocol: Protocol,
    /// The client's address.
    pub peer: SocketAddr,
    /// The socket.
    pub stream: TcpStream,
}

impl Connection {
    /// Copies bytes until either side closes the connection.
    /// Returns the client's address.
    pub async fn run(self, events: mpsc::Sender<ConnectionEvent>) -> IpAddr {
        let Self { number, protocol, peer, stream } = self;
        let (answers, inbox) = mpsc::channel(REPLY_QUEUE_CAPACITY);
        if events.send(ConnectionEvent::Opened { number, protocol, peer, answers }).await.is_ok() {
            // The client notices how the connection ends; nothing else depends on it.
            let _ = exchange(stream, (number, protocol), &events, inbox).await;
            let _ = events.send(ConnectionEvent::Closed { number }).await;
        }
        peer.ip()
    }
}

/// First words of an HTTP request. A web page can have a browser send one here, commands in its
/// body.
const HTTP_METHODS: [&[u8]; 10] = [
    b"GET", b"POST", b"PUT", b"HEAD", b"OPTIONS", b"DELETE", b"PATCH", b"CONNECT", b"TRACE", b"PRI",
];
/// Bytes at the beginning of a connection that distinguish a request from a command.
const HTTP_PREFIX_LENGTH: usize = 10;

/// The beginning of what a raw connection sends, until it is known to be no HTTP request.
#[derive(Debug, Default)]
struct HttpFilter {
    bytes: Vec<u8>,
    is_known: bool,
}

impl HttpFilter {
    /// Whether the connection begins with an HTTP request: a method, a blank, and what no command
    /// has as its argument. No command is executed before its line ends, so no part of a request
    /// is.
    fn is_http(&mut self, piece: &[u8]) -> bool {
        if self.is_known {
            return false;
        }
        let missing = HTTP_PREFIX_LENGTH.saturating_sub(self.bytes.len());
        self.bytes.extend(piece.iter().take(missing));
        let mut words = self.bytes.splitn(2, |byte| *byte == b' ');
        let is_method = words.next().is_some_and(|word| HTTP_METHODS.contains(&word));
        let target = words.next().and_then(|rest| rest.first());
        if is_method && target.is_some_and(|first| b"/*h[".contains(first)) {
            return true;
        }
        self.is_known = self.bytes.len() >= HTTP_PREFIX_LENGTH || piece.contains(&b'\n');
        false
    }
}

/// Has the system ask a silent peer every minute whether it is there; one that is not loses its
/// connection within two.
fn keep_alive(stream: &TcpStream) -> io::Result<()> {
    let keepalive = socket2::TcpKeepalive::new().with_time(KEEPALIVE_TIME);
    #[cfg(not(any(target_os = "openbsd", target_os = "haiku")))]
    let keepalive = keepalive.with_interval(KEEPALIVE_INTERVAL);
    socket2::SockRef::from(stream).set_tcp_keepalive(&keepalive)
}

async fn exchange(
    mut stream: TcpStream,
    (number, protocol): (u64, Protocol),
    events: &mpsc::Sender<ConnectionEvent>,
    mut inbox: mpsc::Receiver<OutgoingBytes>,
) -> io::Result<()> {
    // Clients give an unknown query a millisecond to stay silent.
    stream.set_nodelay(true)?;
    acknowledge(&stream)?;
    keep_alive(&stream)?;
    let mut http_filter =
        HttpFilter { is_known: protocol != Protocol::Raw, ..HttpFilter::default() };
    let mut buffer = [0; READ_BUFFER];
    let mut reply_pending = false;
    loop {
        tokio::select! {
            answer = inbox.recv() => {
                let Some(answer) = answer else { return Ok(()) };
                write(&mut stream, &answer.bytes).await?;
                reply_pending &= !answer.to_piece;
            }
            length = stream.read(&mut buffer), if !reply_pending => {
                let bytes = buffer.get(..length?).unwrap_or_default().to_vec();
                acknowledge(&stream)?;
                if http_filter.is_http(&bytes) {
                    return Ok(());
                }
                // After the last piece nothing is read: the instrument task ends the connection
                // when all is answered.
                reply_pending = true;
                let event = if bytes.is_empty() {
                    ConnectionEvent::Ended { number }
                } else {
                    ConnectionEvent::Bytes { number, bytes }
                };
                if events.send(event).await.is_err() {
                    return Ok(());
                }
            }
        }
    }
}

/// Has the system acknowledge at once what comes. A client whose own system gathers small messages
/// (Nagle) holds a query back until the command before it is acknowledged, which takes 40 ms
/// otherwise. The system forgets it, hence after each read.
#[cfg(any(target_os = "linux", target_os = "android"))]
fn acknowledge(stream: &TcpStream) -> io::Result<()> {
    stream.set_quickack(true)
}

/// No such option on other systems.
#[cfg(not(any(target_os = "linux", target_os = "android")))]
fn acknowledge(_: &TcpStream) -> io::Result<()> {
    Ok(())
}

/// Writes all of `bytes`, as long as the client takes some in time.
async fn write(stream: &mut TcpStream, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        let written = tokio::time::timeout(WRITE_TIMEOUT, stream.write(bytes)).await??;
        if written == 0 {
            return Err(io::ErrorKind::WriteZero.into());
        }
        bytes = bytes.get(written..).unwrap_or_default();
    }
    Ok(())
}
