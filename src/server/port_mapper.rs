//! The port mapper on its sockets. Each call is answered by itself; a connection ends after a
//! while, and so does one whose bytes are no call.

use std::collections::VecDeque;
use std::time::Duration;

use tokio::io::{AsyncReadExt as _, AsyncWriteExt as _};
use tokio::net::{TcpListener, TcpStream, UdpSocket};
use tokio::task::AbortHandle;

use super::connection::ACCEPT_RETRY_DELAY;
use crate::vxi11::port_mapper::answer;
use crate::vxi11::rpc::{RecordDecoder, record};

/// Longest datagram (bytes).
const DATAGRAM_LENGTH: usize = 2048;
/// Time limit for a connection.
const CONNECTION_TIME: Duration = Duration::from_secs(10);
/// Connections at a time; a further one takes the place of the oldest.
const MAX_CONNECTIONS: usize = 16;

/// Answers datagrams and connections until it is cancelled; `port` is where the VXI-11 server
/// listens.
pub async fn answer_all(listener: TcpListener, datagrams: UdpSocket, port: u16) {
    tokio::join!(answer_connections(listener, port), answer_datagrams(datagrams, port));
}

async fn answer_datagrams(socket: UdpSocket, port: u16) {
    let mut buffer = [0; DATAGRAM_LENGTH];
    loop {
        let Ok((length, peer)) = socket.recv_from(&mut buffer).await else {
            tokio::time::sleep(ACCEPT_RETRY_DELAY).await;
            continue;
        };
        if let Some(reply) = answer(buffer.get(..length).unwrap_or_default(), port) {
            // Who asked asks again where the reply is lost.
            let _ = socket.send_to(&reply, peer).await;
        }
    }
}

async fn answer_connections(listener: TcpListener, port: u16) {
    let mut open = VecDeque::<AbortHandle>::new();
    loop {
        let Ok((stream, _)) = listener.accept().await else {
            tokio::time::sleep(ACCEPT_RETRY_DELAY).await;
            continue;
        };
        open.retain(|connection| !connection.is_finished());
        if open.len() >= MAX_CONNECTIONS
            && let Some(oldest) = open.pop_front()
        {
            oldest.abort();
        }
        let connection = tokio::spawn(async move {
            // A client that is cut off asks again.
            let _ = tokio::time::timeout(CONNECTION_TIME, answer_connection(stream, port)).await;
        });
        open.push_back(connection.abort_handle());
    }
}

/// None where the connection has ended.
async fn answer_connection(mut stream: TcpStream, port: u16) -> Option<()> {
    let mut records = RecordDecoder::default();
    let mut buffer = [0; DATAGRAM_LENGTH];
    loop {
        while let Some(call) = records.next_record().ok()? {
            stream.write_all(&record(&answer(&call, port)?)).await.ok()?;
        }
        let length = stream.read(&mut buffer).await.ok().filter(|length| *length > 0)?;
        records.push(buffer.get(..length)?);
    }
}
