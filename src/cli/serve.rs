//! `hertzscope serve`: the scope on the network.

use std::fmt::Write as _;
use std::fs::File;
use std::future::pending;
use std::io::{Write, stderr};
use std::net::{SocketAddr, TcpListener, UdpSocket};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::thread;
use std::time::Duration;

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};
use serde_json::json;
use tokio::sync::{mpsc, oneshot};

use super::value::quantity;
use crate::chain::Support;
use crate::experiment::{Integration, facts};
use crate::instrument::{BenchAccess, Fault, fault};
use crate::quantity::Dimension;
use crate::recording::mcap::RecordingWriter;
use crate::scene::Scene;
use crate::scope::TriggerMode;
use crate::server::{self, ServerOptions, Sockets};
use crate::vxi11;

/// Serve the simulated scope to lab programs over the network: a raw TCP socket, HiSLIP or VXI-11
#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "each is an option of its own")]
pub struct Arguments {
    /// An included scene (`hertzscope scenes` lists them), or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Address and port to listen on; port 0: any free port
    #[arg(long, value_name = "ADDRESS", default_value = "127.0.0.1:5025")]
    listen: String,
    /// Also listen for HiSLIP on this port of the same address, usually 4880; 0: any free port
    #[arg(long, value_name = "PORT")]
    hislip: Option<u16>,
    /// Also listen for VXI-11 on this port of the same address; 0: any free port
    #[arg(long, value_name = "PORT")]
    vxi11: Option<u16>,
    /// Run a port mapper on this port, where VXI-11 clients ask for the VXI-11 port; most ask port
    /// 111, which needs privileges; 0: any free port
    #[arg(long, value_name = "PORT", requires = "vxi11")]
    port_mapper: Option<u16>,
    /// Strike the chain at this interval, e.g. 2s [default: only when a client sends BENCh:IMPact]
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, STRIKE_INTERVALS, "2s"))]
    impact_every: Option<f64>,
    /// Strike the chain at each line on standard input: press Enter in this terminal
    #[arg(long)]
    impact_on_enter: bool,
    /// End when standard input ends: a program that starts the server and holds a pipe to it leaves
    /// none behind, however it ends
    #[arg(long, conflicts_with = "impact_on_enter")]
    until_eof: bool,
    /// Write every command, reply and triggered waveform to this recording (.mcap); if it exists, a
    /// number is appended
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
    /// Write a line for each connection, command, reply, error and impact, to standard error or to
    /// FILE
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true, default_missing_value = "-")]
    log: Option<PathBuf>,
    #[arg(long, value_name = "KIND", help = FAULTS_HELP, long_help = faults_help())]
    fault: Vec<Fault>,
    /// Let no client change the bench (BENCh): they may look, and use the oscilloscope
    #[arg(long)]
    read_only: bool,
    /// Let no client switch faults on (BENCh:FAUlt); those of --fault stay
    #[arg(long, conflicts_with = "read_only")]
    no_faults: bool,
    /// End the recording and the log, each by itself, at so many megabytes; the server goes on
    #[arg(long, value_name = "MB", value_parser = clap::value_parser!(u64).range(1..=MAX_SIZE_LIMIT))]
    size_limit: Option<u64>,
    /// Print addresses, resource strings and the command that strikes as one line of JSON
    #[arg(long)]
    json: bool,
    /// Random seed of noise, sampling phase and striker speed [default: the scene's]
    #[arg(long, value_name = "N")]
    seed: Option<u64>,
    /// Initial state of `HEADer`: whether replies begin with the command's header
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

const FAULTS_HELP: &str = "Disturb replies, trigger or sensors, KIND[@CHn][=VALUE][*COUNT], e.g. late=500ms; may be repeated; --help lists the kinds";

fn faults_help() -> String {
    let mut text = "Disturb replies, trigger or sensors; may be repeated. KIND[@CHn][=VALUE][*COUNT]; @CHn limits it to channel n's sensor, *COUNT to this many replies or impacts"
        .to_owned();
    for (form, what) in fault::KINDS {
        let _ = write!(text, "\n  {form:<17}{what}");
    }
    text
}

/// Shortest and longest time from one strike to the next: a millisecond, a year (s).
const STRIKE_INTERVALS: RangeInclusive<f64> = 1e-3..=365.0 * 24.0 * 3600.0;
/// Largest limit of a file (MB).
const MAX_SIZE_LIMIT: u64 = 1_000_000_000;
/// Bytes in a megabyte.
const MEGABYTE: u64 = 1_000_000;

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
    let at = |port| SocketAddr::new(address.ip(), port);
    let bind = |port: Option<u16>, what: &str| {
        let bound = port.map(|port| {
            TcpListener::bind(at(port)).with_context(|| format!("{what} on {}", at(port)))
        });
        bound.transpose()
    };
    let hislip = bind(arguments.hislip, "HiSLIP")?;
    let vxi11 = bind(arguments.vxi11, "VXI-11")?;
    let port_mapper = arguments.port_mapper.map(|port| port_mapper(at(port))).transpose()?;
    let log = arguments.log.as_deref().map(open_log).transpose()?;
    // After the sockets: a second server on the same port must not empty the first one's recording.
    let recording =
        arguments.record.as_deref().map(|file| create_recording(file, &scene)).transpose()?;
    if !address.ip().is_loopback() {
        super::say(&format!(
            "warning: the protocols have no authentication: everybody who reaches {} can use the scope",
            address.ip()
        ));
    }
    let file = recording.as_ref().map(|recording| recording.file().display().to_string());
    let sockets = Sockets { raw, hislip, vxi11, port_mapper };
    let mut told = announcement(arguments, &scene, &sockets, file.as_deref())?;
    if scene.scope.trigger.mode == TriggerMode::Auto && !arguments.json {
        told.push_str("\ntrigger     AUTO: records without a trigger follow the impact; to keep it, send TRIGger:MAIn:MODe NORMal");
    }
    let options = ServerOptions {
        header: arguments.header == Switch::On,
        impact_every: arguments.impact_every.map(Duration::from_secs_f64),
        warn: Some(|text| super::say(&format!("warning: {text}"))),
        strikes: arguments.impact_on_enter.then(lines),
        faults: arguments.fault.clone(),
        access: match (arguments.read_only, arguments.no_faults) {
            (true, _) => BenchAccess::ReadOnly,
            (false, true) => BenchAccess::NoFaults,
            (false, false) => BenchAccess::Full,
        },
        size_limit: arguments.size_limit.map(|limit| limit.saturating_mul(MEGABYTE)),
        log,
    };
    let mut announced = Ok(());
    let shutdown = async {
        let stopped = stopped();
        // Only after signals are handled: a reader of this line may end the program at once, and
        // the recording must be complete.
        announced = super::print(&told);
        if announced.is_ok() {
            tokio::select! {
                () = stopped => {}
                () = end_of_input(arguments.until_eof) => {}
            }
        }
    };
    server::serve(sockets, &scene, options, recording, shutdown)?;
    announced?;
    if let Some(file) = file.filter(|_| !arguments.json) {
        super::print(&format!("recorded    {file}"))?;
    }
    Ok(())
}

/// The port mapper's sockets, on the same port.
fn port_mapper(address: SocketAddr) -> anyhow::Result<(TcpListener, UdpSocket)> {
    let bound = || {
        let listener = TcpListener::bind(address)?;
        let datagrams = UdpSocket::bind(listener.local_addr()?)?;
        Ok::<_, std::io::Error>((listener, datagrams))
    };
    bound().with_context(|| {
        format!("port mapper on {address} (ports below 1024 need privileges, and 111 is taken where rpcbind runs)")
    })
}

fn open_log(file: &Path) -> anyhow::Result<Box<dyn Write + Send>> {
    if file == Path::new("-") {
        return Ok(Box::new(stderr()));
    }
    let opened = File::create(file).with_context(|| format!("cannot write {}", file.display()))?;
    Ok(Box::new(opened))
}

/// Where the server listens, what VISA calls that, and how to strike or drive the chain.
fn announcement(
    arguments: &Arguments,
    scene: &Scene,
    sockets: &Sockets,
    recording: Option<&str>,
) -> anyhow::Result<String> {
    let raw = sockets.raw.local_addr()?;
    let of =
        |socket: &Option<TcpListener>| socket.as_ref().map(TcpListener::local_addr).transpose();
    let (hislip, vxi11) = (of(&sockets.hislip)?, of(&sockets.vxi11)?);
    let mapper = sockets.port_mapper.as_ref().map(|(socket, _)| socket.local_addr()).transpose()?;
    let host = if raw.ip().is_unspecified() { "HOST".into() } else { raw.ip().to_string() };
    let is_found = mapper.is_some_and(|address| address.port() == vxi11::port_mapper::PORT);
    let resources = [
        ("socket", Some(format!("TCPIP::{host}::{}::SOCKET", raw.port()))),
        ("hislip", hislip.map(|at| format!("TCPIP::{host}::hislip0,{}::INSTR", at.port()))),
        (
            "vxi11",
            vxi11.map(|at| {
                let port = if is_found { String::new() } else { format!(",{}", at.port()) };
                format!("TCPIP::{host}{port}::inst0::INSTR")
            }),
        ),
    ];
    if arguments.json {
        let resources: serde_json::Map<_, _> = resources
            .into_iter()
            .filter_map(|(name, text)| Some((name.to_owned(), text?.into())))
            .collect();
        let told = json!({
            "listening": raw, "hislip": hislip, "vxi11": vxi11, "port_mapper": mapper,
            "resources": resources, "strike": "BENCh:IMPact", "recording": recording,
        });
        return Ok(told.to_string());
    }
    let mut told = format!("listening on {raw}");
    for (name, address) in [("HiSLIP", hislip), ("VXI-11", vxi11), ("port mapper", mapper)] {
        if let Some(address) = address {
            let _ = write!(told, "\n{name} on {address}");
        }
    }
    // On a driven bench without a striker, an impact is the drive's signal.
    let is_drive = |support: &Support| matches!(support, Support::Driven(_));
    let spec = &scene.spec;
    let is_driven = spec.striker.is_none() && spec.effects.supports.iter().any(is_drive);
    if arguments.impact_on_enter {
        told.push_str(if is_driven {
            "\nEnter plays the drive's signal once"
        } else {
            "\nEnter strikes the chain"
        });
    }
    for (name, text) in resources {
        let note = if name == "socket" { " (ends of lines: LF)" } else { "" };
        if let Some(text) = text {
            let _ = write!(told, "\nVISA        {text}{note}");
        }
    }
    match (arguments.impact_every, is_driven) {
        (None, false) => told.push_str("\nto strike   send BENCh:IMPact"),
        (None, true) => {
            told.push_str("\nto drive    send BENCh:IMPact: the drive's signal plays once, from rest");
        }
        (Some(time), true) => {
            let _ = write!(told, "\ndriven      every {time} s: the drive's signal plays once, from rest");
        }
        (Some(_), false) => {}
    }
    if let Some(file) = recording {
        let _ = write!(told, "\nrecording   {file}");
    }
    Ok(told)
}

fn create_recording(file: &Path, scene: &Scene) -> anyhow::Result<RecordingWriter> {
    if file.extension().is_none_or(|extension| extension != "mcap") {
        bail!("found {}, expected a name that ends in .mcap", file.display());
    }
    let integration = Integration::Accuracy(scene.accuracy);
    let mut known = facts::facts(scene, integration)?;
    if let Some(recording) = known.get_mut("hertzscope:recording") {
        let times = "of messages: nanoseconds since 1970; of records: seconds after the trigger; of the truth: seconds after the striker's first contact";
        recording.insert("time_base".to_owned(), times.to_owned());
    }
    Ok(RecordingWriter::create_live(file, &known, &facts::scene_attachments(scene))?)
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

/// Waits until standard input ends if `is_awaited`, else for ever.
async fn end_of_input(is_awaited: bool) {
    if !is_awaited {
        pending::<()>().await;
    }
    let (sender, ended) = oneshot::channel();
    thread::spawn(move || {
        // Any failure is an end, too.
        let _ = std::io::copy(&mut std::io::stdin(), &mut std::io::sink());
        let _ = sender.send(());
    });
    let _ = ended.await;
}

/// What waits for Ctrl-C, for what ends a service, or for a terminal that is closed; all are
/// listened to from now on. Where they cannot be, the system ends the program by itself.
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
