//! A connection: a task that speaks its protocol, as long as it has a place.

use std::io;
use std::net::SocketAddr;
use std::sync::Arc;

use super::network::{Inbox, Network};
use super::places::Seat;
use super::wire::{Stream, Wire};
use super::{hislip, port_mapper, raw, vxi11};

/// The protocol of a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Protocol {
    /// Lines.
    Raw,
    /// HiSLIP.
    Hislip,
    /// VXI-11.
    Vxi11,
    /// VXI-11's port mapper.
    PortMapper,
}

impl Protocol {
    /// The name in logs and recordings.
    fn name(self) -> &'static str {
        match self {
            Self::Raw => "raw",
            Self::Hislip => "hislip",
            Self::Vxi11 => "vxi11",
            Self::PortMapper => "port mapper",
        }
    }
}

/// The connections to one instrument.
pub struct Connections {
    network: Network,
    sessions: hislip::Sessions,
    links: vxi11::Links,
    vxi11_port: u16,
}

impl Connections {
    /// No connections yet, and the instrument's end of them. VXI-11 is spoken on `vxi11_port`.
    pub fn new(vxi11_port: u16) -> (Arc<Self>, Inbox) {
        let (network, inbox) = Network::new();
        let (sessions, links) = (hislip::Sessions::default(), vxi11::Links::new(vxi11_port));
        (Arc::new(Self { network, sessions, links, vxi11_port }), inbox)
    }

    /// Serves a connection until either side closes it; at once where there is no place for it.
    pub async fn serve(
        self: Arc<Self>,
        protocol: Protocol,
        stream: Box<dyn Stream>,
        peer: SocketAddr,
    ) {
        let Some((seat, gives_way)) = self.network.places.admit(peer.ip()) else { return };
        tokio::select! {
            // The client notices how the connection ends; nothing else depends on it.
            _ = self.run(protocol, Wire::new(stream), seat, peer) => {}
            _ = gives_way => {}
        }
    }

    async fn run(
        &self,
        protocol: Protocol,
        wire: Wire,
        seat: Seat,
        peer: SocketAddr,
    ) -> io::Result<()> {
        let peer = format!("{} {peer}", protocol.name());
        match protocol {
            Protocol::Raw => raw::run(&self.network, wire, &seat, &peer).await,
            Protocol::Hislip => hislip::run(&self.network, &self.sessions, wire, seat, &peer).await,
            Protocol::Vxi11 => vxi11::run(&self.network, &self.links, wire, &seat, &peer).await,
            Protocol::PortMapper => tokio::select! {
                ended = port_mapper::run(wire, &seat, self.vxi11_port) => ended,
                () = self.network.closed() => Ok(()),
            },
        }
    }
}
