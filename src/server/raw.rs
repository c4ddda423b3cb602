//! A raw connection: messages end with a line, replies come as they are.

use std::io;
use std::time::Duration;

use tokio::time::{Instant, sleep_until};

use super::network::{Answer, ClientSession, Interrupts, Network};
use super::places::Seat;
use super::wire::Wire;

/// Time after which a connection that is closed for sending is dropped although an answer is
/// pending.
const HALF_CLOSED_TIMEOUT: Duration = Duration::from_secs(60);

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
    /// Whether the connection begins with an HTTP request: a method, a space, and an argument that
    /// no command takes. A command is executed when its line ends, so no part of a request is.
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

/// A raw connection with its session.
struct RawConnection<'a> {
    session: ClientSession<'a>,
    wire: Wire,
    seat: &'a Seat,
    /// Replies that are not written yet.
    replies: Vec<u8>,
}

/// Serves a connection until either side closes it. A piece of input is read only when the replies
/// to the one before are written, so a client that does not read is not read from either.
///
/// # Errors
/// The system's error.
pub async fn run(network: &Network, wire: Wire, seat: &Seat, peer: &str) -> io::Result<()> {
    let session = network.open(peer, seat);
    let mut connection = RawConnection { session, wire, seat, replies: Vec::new() };
    let mut http_filter = HttpFilter::default();
    loop {
        tokio::select! {
            biased;
            answer = connection.session.answer() => {
                connection.take(answer?).await?;
                connection.flush().await?;
            }
            bytes = connection.wire.read() => {
                let bytes = bytes?.to_vec();
                if http_filter.is_http(&bytes) {
                    return Ok(());
                }
                if bytes.is_empty() {
                    return connection.finish().await;
                }
                connection.execute(&bytes).await?;
            }
        }
    }
}

impl RawConnection<'_> {
    /// Executes the messages in a piece of input one after the other; those of other clients come
    /// between them.
    async fn execute(&mut self, bytes: &[u8]) -> io::Result<()> {
        // Ends of lines alone keep no connection.
        if !bytes.trim_ascii().is_empty() {
            self.seat.touch();
        }
        for message in bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r')) {
            self.session.send(message.to_vec(), false, Interrupts::Never);
            loop {
                let answer = self.session.answer().await?;
                let is_done = matches!(answer, Answer::Done { .. });
                self.take(answer).await?;
                if is_done {
                    break;
                }
            }
        }
        self.flush().await
    }

    async fn take(&mut self, answer: Answer) -> io::Result<()> {
        match answer {
            Answer::Reply(bytes) => self.replies.extend(bytes),
            Answer::DropAfter(length) => {
                self.flush().await?;
                self.wire.drop_after(length);
            }
            Answer::Done { .. } | Answer::Resumed | Answer::Interrupted => {}
        }
        Ok(())
    }

    async fn flush(&mut self) -> io::Result<()> {
        let replies = std::mem::take(&mut self.replies);
        self.wire.write(&replies).await
    }

    /// The client sends no more, but may still wait for a reply.
    async fn finish(mut self) -> io::Result<()> {
        let end = Instant::now() + HALF_CLOSED_TIMEOUT;
        while self.session.is_busy() {
            tokio::select! {
                answer = self.session.answer() => {
                    self.take(answer?).await?;
                    self.flush().await?;
                }
                () = sleep_until(end) => return Ok(()),
            }
        }
        Ok(())
    }
}
