//! `hertzscope serve`: the scope on the network.

use std::future::pending;
use std::net::TcpListener;
use std::time::Duration;

use anyhow::Context as _;
use clap::{Args, ValueEnum};

use crate::quantity::{Dimension, parse};
use crate::scene::Scene;
use crate::server::{self, Options};

/// Let lab programs talk to the scope over a raw TCP socket, as to an instrument on the network
#[derive(Debug, Args)]
pub struct Arguments {
    /// A scene that ships with the program (see `hertzscope scenes`), or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: String,
    /// Address and port to listen on; port 0 takes any that is free
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:5025")]
    listen: String,
    /// Strike the chain this often, e.g. 2s [default: never]
    #[arg(long, value_name = "T", value_parser = period)]
    impact_every: Option<Duration>,
    /// Whether answers begin with headers until a client says HEADER
    #[arg(long, value_enum, default_value_t = Switch::Off)]
    header: Switch,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Switch {
    /// As the original on RS-232
    On,
    /// As most programs expect
    Off,
}

fn period(text: &str) -> Result<Duration, String> {
    let expected = "expected a time of 1 ms or more, e.g. 2s";
    match parse(text, Dimension::TIME) {
        Ok(seconds) if seconds >= 1e-3 => Duration::try_from_secs_f64(seconds)
            .ok()
            .filter(|period| *period <= LONGEST)
            .ok_or_else(|| format!("found {text}, expected at most a year")),
        Ok(_) => Err(format!("found {text}, {expected}")),
        Err(error) => Err(format!("found {error}, {expected}")),
    }
}

/// Longest time from one strike to the next: a year.
const LONGEST: Duration = Duration::from_secs(365 * 24 * 3600);

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let scene = Scene::load(&arguments.scene)?;
    let listener =
        TcpListener::bind(&arguments.listen).with_context(|| arguments.listen.clone())?;
    let address = listener.local_addr()?;
    if !address.ip().is_loopback() {
        eprintln!(
            "warning: the protocol has no authentication: everybody who reaches {address} can use the scope"
        );
    }
    super::print(&format!("listening on {address}"))?;
    let options =
        Options { header: arguments.header == Switch::On, impact_every: arguments.impact_every };
    let interrupted = async {
        if tokio::signal::ctrl_c().await.is_err() {
            // Without a handler the system ends the program by itself.
            pending::<()>().await;
        }
    };
    server::serve(listener, &scene, options, interrupted)?;
    Ok(())
}
