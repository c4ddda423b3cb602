//! The port mapper on its sockets. Each call is answered by itself; a connection ends after a
//! while, and so does one whose bytes are no call.

use std::io;
use std::time::Duration;

use tokio::net::UdpSocket;
use tokio::time::{sleep, timeout};

use super::places::Seat;
use super::wire::Wire;
use crate::vxi11::port_mapper::answer;
use crate::vxi11::rpc::{RecordDecoder, record};

/// Longest datagram (bytes).
const DATAGRAM_LENGTH: usize = 2048;
/// Time limit for a connection.
const CONNECTION_TIME: Duration = Duration::from_secs(10);
/// Delay before receiving again after an error.
const RETRY_DELAY: Duration = Duration::from_millis(20);

/// Answers datagrams until it is cancelled; `port` is where the VXI-11 server listens.
pub async fn answer_datagrams(socket: UdpSocket, port: u16) {
    let mut buffer = [0; DATAGRAM_LENGTH];
    loop {
        let Ok((length, peer)) = socket.recv_from(&mut buffer).await else {
            sleep(RETRY_DELAY).await;
            continue;
        };
        if let Some(reply) = answer(buffer.get(..length).unwrap_or_default(), port) {
            // Who asked asks again where the reply is lost.
            let _ = socket.send_to(&reply, peer).await;
        }
    }
}

/// Serves a connection.
///
/// # Errors
/// The system's error, that the bytes are no call, or that the time is over.
pub async fn run(mut wire: Wire, seat: &Seat, port: u16) -> io::Result<()> {
    timeout(CONNECTION_TIME, async {
        let mut records = RecordDecoder::default();
        loop {
            while let Some(call) = records.next_record().map_err(|_| io::ErrorKind::InvalidData)? {
                let reply = answer(&call, port).ok_or(io::ErrorKind::InvalidData)?;
                wire.write(&record(&reply)).await?;
            }
            let bytes = wire.read().await?;
            if bytes.is_empty() {
                return Ok(());
            }
            seat.touch();
            records.push(bytes);
        }
    })
    .await?
}
