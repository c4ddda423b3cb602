//! Connections from the server to VXI-11 clients that are told of service requests.

use std::collections::BTreeMap;
use std::net::SocketAddrV4;
use std::time::Duration;

use tokio::io::AsyncWriteExt as _;
use tokio::net::TcpStream;
use tokio::sync::mpsc;

use crate::vxi11::Interrupt;

/// Time limit for the connection, and for each request.
const TIMEOUT: Duration = Duration::from_secs(5);
/// Requests that wait for the socket; further ones are lost.
const REQUESTS: usize = 16;

/// The connections, by the number of the client's core channel.
pub struct InterruptChannels {
    requests: BTreeMap<u64, mpsc::Sender<Vec<u8>>>,
    news: mpsc::Sender<(u64, bool)>,
}

impl InterruptChannels {
    /// No connections. Whether one was opened, or is closed again, comes out of the receiver.
    pub fn new() -> (Self, mpsc::Receiver<(u64, bool)>) {
        let (news, inbox) = mpsc::channel(REQUESTS);
        (Self { requests: BTreeMap::new(), news }, inbox)
    }

    /// Does what the protocol asks for.
    pub fn act(&mut self, interrupt: Interrupt) {
        match interrupt {
            Interrupt::Connect(number, address) => {
                let (requests, inbox) = mpsc::channel(REQUESTS);
                self.requests.insert(number, requests);
                tokio::spawn(run(number, address, inbox, self.news.clone()));
            }
            Interrupt::Send(number, bytes) => {
                if let Some(requests) = self.requests.get(&number) {
                    // A client that takes none has asked for them in vain.
                    let _ = requests.try_send(bytes);
                }
            }
            Interrupt::Close(number) => _ = self.requests.remove(&number),
        }
    }
}

/// Connects and writes requests until there are no more; replies to them, which clients need not
/// send, are not read.
async fn run(
    number: u64,
    address: SocketAddrV4,
    mut inbox: mpsc::Receiver<Vec<u8>>,
    news: mpsc::Sender<(u64, bool)>,
) {
    let connected = tokio::time::timeout(TIMEOUT, TcpStream::connect(address)).await;
    if let Ok(Ok(mut stream)) = connected
        && news.send((number, true)).await.is_ok()
    {
        loop {
            // The client or its core channel has ended it.
            let Some(bytes) = inbox.recv().await else { return };
            let written = tokio::time::timeout(TIMEOUT, stream.write_all(&bytes)).await;
            if !matches!(written, Ok(Ok(()))) {
                break;
            }
        }
    }
    // The server has ended where this fails.
    let _ = news.send((number, false)).await;
}
