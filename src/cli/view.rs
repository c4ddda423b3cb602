//! `hertzscope view`: the scope's screen in the terminal.

use std::io::IsTerminal as _;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use anyhow::bail;
use clap::Args;

use super::acquire::StopSignal;
use super::input::{ReadingArguments, note_option};
use super::overwrite::ending;
use crate::client::{Address, ClientTiming};
use crate::recording::TraceSet;
use crate::recording::format::Format;
use crate::recording::mcap::IndexedRecording;
use crate::scene::Scene;
use crate::tui::work::served::ServedConnection;
use crate::tui::{self, ViewSource};

/// Time from one look for a recording to the next, until it is begun.
const FILE_POLL_INTERVAL: Duration = Duration::from_millis(100);
/// Bytes at the beginning of every recording.
const MCAP_MAGIC_LENGTH: u64 = 8;

/// Look at a recording on the scope's screen in the terminal, operate a simulated bench, or watch a
/// served scope
#[derive(Debug, Args)]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf) or a folder of them; an included scene or a
    /// .toml file; or the address of a served or real scope, e.g. tcp://HOST:PORT (see `acquire`)
    what: String,
    /// Further recordings, files or folders: on the same axes, dotted; the key O brings the next
    /// one to the front
    #[arg(value_name = "RECORDING")]
    behind: Vec<PathBuf>,
    /// Show each new shot of a recording that is still being written, or does not exist yet;
    /// stepping back to an older shot stops this, the key End resumes it
    #[arg(long)]
    follow: bool,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Compare with this recording, folder or scene
    #[arg(long, value_name = "WHAT")]
    against: Option<String>,
    /// With a scope's address: record the traces shown (.mcap); if the file exists, a number is
    /// appended
    #[arg(long, value_name = "FILE")]
    record: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(address) = Address::recognise(&arguments.what)? {
        if arguments.follow {
            bail!("{address}: found --follow, expected it with an .mcap recording");
        }
        return watch(arguments, &address);
    }
    if let Some(file) = &arguments.record {
        bail!(
            "--record {}: {} is no scope's address, e.g. tcp://127.0.0.1:5025; :write saves what is on screen",
            file.display(),
            arguments.what
        );
    }
    let path = Path::new(&arguments.what);
    if arguments.follow && !path.exists() && path.extension().is_some_and(|e| e == "mcap") {
        wait_for(path);
    }
    let format = Format::of(path);
    if arguments.follow && format != Some(Format::Mcap) {
        bail!("{}: found --follow, expected it with an .mcap recording", arguments.what);
    }
    let as_is = arguments.reading.is_as_it_is();
    let subject = match format {
        Some(Format::Mcap) if as_is => {
            ViewSource::IndexedRecording(Box::new(IndexedRecording::open(path)?), arguments.follow)
        }
        Some(_) if arguments.follow => {
            bail!(
                "{}: --follow shows a recording as it is: leave the other options away",
                arguments.what
            )
        }
        Some(_) => ViewSource::Set(Box::new(arguments.reading.open(path)?)),
        None => bench(&arguments.what)?,
    };
    let stem = if format.is_some() { path.file_name() } else { path.file_stem() };
    // A shipped scene's name may hold points.
    let name = match stem {
        Some(stem) if path.exists() => stem.to_string_lossy().into_owned(),
        _ => arguments.what.clone(),
    };
    let (title, behind) = behind(arguments, name)?;
    terminal()?;
    tui::run(subject, title, behind, arguments.against.clone(), note_option)?;
    Ok(())
}

/// The further recordings, and a name for each and for the one that is called `first`: the file's,
/// or the whole path where two files have the same name.
fn behind(
    arguments: &Arguments,
    first: String,
) -> anyhow::Result<(String, Vec<(String, TraceSet)>)> {
    let file_name = |path: &Path| path.file_name().map(|name| name.to_string_lossy().into_owned());
    let mut names = vec![first.clone()];
    names.extend(arguments.behind.iter().filter_map(|path| file_name(path)));
    let name = |short: String, whole: String| {
        if names.iter().filter(|name| **name == short).count() > 1 { whole } else { short }
    };
    let mut found = Vec::new();
    for path in &arguments.behind {
        let whole = path.display().to_string();
        if Format::of(path).is_none() {
            bail!(
                "{whole}: expected a recording; a scene is shown beside one with --against {whole}"
            );
        }
        let set = arguments.reading.open(path)?;
        if set.shots.is_empty() {
            bail!("{whole}: found no shots");
        }
        found.push((name(file_name(path).unwrap_or_default(), whole), set));
    }
    Ok((name(first, arguments.what.clone()), found))
}

/// Waits until a recording is begun at `path`.
fn wait_for(path: &Path) {
    super::say(&format!("waiting for {} (Ctrl-C ends)", path.display()));
    let is_begun = || std::fs::metadata(path).is_ok_and(|file| file.len() > MCAP_MAGIC_LENGTH);
    while !is_begun() {
        std::thread::sleep(FILE_POLL_INTERVAL);
    }
}

/// Refuses to draw where the output is not a terminal.
fn terminal() -> anyhow::Result<()> {
    if !std::io::stdout().is_terminal() {
        bail!(
            "found no terminal on standard output, expected one; `hertzscope info` prints what is in the file"
        );
    }
    Ok(())
}

/// Shows a scope, served or real.
fn watch(arguments: &Arguments, address: &Address) -> anyhow::Result<()> {
    if let Some(file) = &arguments.record {
        ending(file, &["mcap"])?;
    }
    terminal()?;
    let stop = StopSignal::new()?;
    let mut scope =
        ServedConnection::connect(address, ClientTiming::default(), Arc::clone(&stop.0))?;
    let file = arguments.record.as_deref().map(|file| scope.record(file)).transpose()?;
    let subject = ViewSource::Served(Box::new(scope));
    let (title, behind) = behind(arguments, address.to_string())?;
    tui::run(subject, title, behind, arguments.against.clone(), note_option)?;
    if let Some(file) = file {
        super::print(&format!("recorded    {}", file.display()))?;
    }
    Ok(())
}

/// The bench of a scene, read here so that its problems are reported before the screen opens.
fn bench(scene: &str) -> anyhow::Result<ViewSource> {
    Scene::load(scene)?;
    let base = match std::fs::canonicalize(scene) {
        Ok(path) if path.is_file() => path.display().to_string(),
        _ => scene.to_owned(),
    };
    Ok(ViewSource::Bench(base))
}
