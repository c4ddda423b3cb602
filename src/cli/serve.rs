//! `hertzscope serve`: the scope on the network.

use std::fmt::Write as _;
use std::future::pending;
use std::net::{SocketAddr, TcpListener};
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use tokio::sync::mpsc;

use crate::experiment::accuracy::of_scene;
use crate::experiment::{Integration, facts};
use crate::quantity::{Dimension, parse};
use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use crate::server::{self, ServerOptions, Sockets};

/// Serve the simulated scope to lab programs over the network: a raw TCP socket or HiSLIP
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene (`hertzscope scenes` lists them), or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: String,
    /// Address and port to listen on; port 0: any that is free
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:5025")]
    listen: String,
    /// Also listen for HiSLIP on this port of the same address, usually 4880; 0: any that is free
    #[arg(long, value_name = "PORT")]
    hislip: Option<u16>,
    /// Strike the chain at this interval, e.g. 2s [default: only when a client sends BENCh:IMPact]
    #[arg(long, value_name = "T", value_parser = period)]
    impact_every: Option<Duration>,
    /// Strike the chain at each line on standard input: press Enter in this terminal
    #[arg(long)]
    impact_on_enter: bool,
    /// Write every command, reply and triggered waveform to this recording (.mcap); if it exists, a number is appended
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Random seed of noise, sampling phase and striker speed [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Whether replies begin with the command's header, until a client sends `HEADer`
    #[arg(long, value_enum, default_value_t = Switch::Off)]
    header: Switch,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Switch {
    /// As the instrument after power-up
    On,
    /// As most programs expect it
    Off,
}

fn period(text: &str) -> Result<Duration, String> {
    let expected = "expected a time of 1 ms or more, e.g. 2s";
    match parse(text, Dimension::TIME) {
        Ok(seconds) if seconds >= 1e-3 => Duration::try_from_secs_f64(seconds)
            .ok()
            .filter(|period| *period <= MAX_STRIKE_INTERVAL)
            .ok_or_else(|| format!("found {text}, expected at most a year")),
        Ok(_) => Err(format!("found {text}, {expected}")),
        Err(error) => Err(format!("found {error}, {expected}")),
    }
}

/// Longest time from one strike to the next: a year.
const MAX_STRIKE_INTERVAL: Duration = Duration::from_secs(365 * 24 * 3600);

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut scene = Scene::load(&arguments.scene)?;
    scene.seed = arguments.seed.unwrap_or(scene.seed);
    let raw = TcpListener::bind(&arguments.listen).with_context(|| {
        format!(
            "cannot listen on {} (this computer's own address is 127.0.0.1:5025)",
            arguments.listen
        )
    })?;
    let address = raw.local_addr()?;
    let hislip = match arguments.hislip {
        Some(port) => {
            let address = SocketAddr::new(address.ip(), port);
            Some(TcpListener::bind(address).with_context(|| format!("HiSLIP on {address}"))?)
        }
        None => None,
    };
    // After the sockets: a second server on the same port must not empty the first one's recording.
    let recording =
        arguments.record.as_deref().map(|file| create_recording(file, &scene)).transpose()?;
    if !address.ip().is_loopback() {
        super::say(&format!(
            "warning: the protocols have no authentication: everybody who reaches {} can use the scope",
            address.ip()
        ));
    }
    let mut told = format!("listening on {address}");
    if let Some(hislip) = &hislip {
        let _ = write!(told, "\nHiSLIP on {}", hislip.local_addr()?);
    }
    if arguments.impact_on_enter {
        told.push_str("\nEnter strikes the chain");
    }
    let visa = |address: SocketAddr, kind: &dyn Fn(&str, u16) -> String| {
        let host =
            if address.ip().is_unspecified() { "HOST".into() } else { address.ip().to_string() };
        kind(&host, address.port())
    };
    let socket = visa(address, &|host, port| format!("TCPIP::{host}::{port}::SOCKET"));
    let _ = write!(told, "\nVISA        {socket} (ends of lines: LF)");
    if let Some(hislip) = &hislip {
        let hislip = visa(hislip.local_addr()?, &|host, port| {
            format!("TCPIP::{host}::hislip0,{port}::INSTR")
        });
        let _ = write!(told, "\nVISA        {hislip}");
    }
    if arguments.impact_every.is_none() {
        told.push_str("\nto strike   send BENCh:IMPact");
    }
    let file = recording.as_ref().map(|recording| recording.file().display().to_string());
    if let Some(file) = &file {
        let _ = write!(told, "\nrecording   {file}");
    }
    let options = ServerOptions {
        header: arguments.header == Switch::On,
        impact_every: arguments.impact_every,
        warn: Some(|text| super::say(&format!("warning: {text}"))),
        strikes: arguments.impact_on_enter.then(lines),
    };
    let mut announced = Ok(());
    let shutdown = async {
        let stopped = stopped();
        // Only after signals are handled: a reader of this line may end the program at once, and the recording must be complete.
        announced = super::print(&told);
        if announced.is_ok() {
            stopped.await;
        }
    };
    server::serve(Sockets { raw, hislip }, &scene, options, recording, shutdown)?;
    announced?;
    if let Some(file) = &file {
        super::print(&format!("recorded    {file}"))?;
    }
    Ok(())
}

fn create_recording(file: &Path, scene: &Scene) -> anyhow::Result<RecordingWriter> {
    if file.extension().is_none_or(|extension| extension != "mcap") {
        bail!("found {}, expected a name that ends in .mcap", file.display());
    }
    let integration = Integration::Accuracy(of_scene(scene)?.value);
    let mut known = facts::facts(scene, integration)?;
    if let Some(recording) = known.get_mut("hertzscope:recording") {
        let times = "of messages: nanoseconds since 1970; of records: seconds after the trigger; of the truth: seconds after the striker's first contact";
        recording.insert("time_base".to_owned(), times.to_owned());
    }
    Ok(RecordingWriter::create_live(file, &known, &[facts::scene_attachment(scene)])?)
}

/// A message for every line on standard input, until it ends.
fn lines() -> mpsc::Receiver<()> {
    let (sender, receiver) = mpsc::channel(1);
    thread::spawn(move || {
        for line in std::io::stdin().lines() {
            if line.is_err() || sender.blocking_send(()).is_err() {
                break;
            }
        }
    });
    receiver
}

/// What waits for Ctrl-C, for what ends a service, or for a terminal that is closed; all are listened to from now on. Where they cannot be, the system ends the program by
/// itself.
#[cfg(unix)]
fn stopped() -> impl Future<Output = ()> {
    use std::io;

    use tokio::signal::unix::{Signal, SignalKind, signal};
    async fn received(signal: io::Result<Signal>) {
        match signal {
            Ok(mut signal) => drop(signal.recv().await),
            Err(_) => pending().await,
        }
    }
    let signals =
        [SignalKind::interrupt(), SignalKind::terminate(), SignalKind::hangup()].map(signal);
    async {
        let [interrupted, terminated, hung_up] = signals.map(received);
        tokio::select! {
            () = interrupted => {}
            () = terminated => {}
            () = hung_up => {}
        }
    }
}

#[cfg(not(unix))]
async fn stopped() {
    if tokio::signal::ctrl_c().await.is_err() {
        pending().await
    }
}
