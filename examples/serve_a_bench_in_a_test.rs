//! Serves a bench inside a test: the client under test talks to the scope at a free port.

#![allow(clippy::disallowed_macros, reason = "an example prints")]

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};

use hertzscope::Scene;
use hertzscope::server::{ServerOptions, Sockets, serve};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scene = Scene::load("magnet-0.61g")?;
    let raw = TcpListener::bind("127.0.0.1:0")?;
    let address = raw.local_addr()?;
    let (stop, stopped) = tokio::sync::oneshot::channel::<()>();
    let server = std::thread::spawn(move || {
        let sockets = Sockets { raw, hislip: None, vxi11: None, port_mapper: None };
        let shutdown = async { _ = stopped.await };
        serve(sockets, &scene, ServerOptions::default(), None, shutdown)
    });

    // The client under test.
    let mut scope = TcpStream::connect(address)?;
    scope.write_all(b"*IDN?\n")?;
    let mut reply = String::new();
    BufReader::new(&scope).read_line(&mut reply)?;
    print!("{reply}");
    assert!(reply.starts_with("TEKTRONIX,TDS 2014"));

    _ = stop.send(());
    server.join().map_err(|_| "the server panicked")??;
    Ok(())
}
