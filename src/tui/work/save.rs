//! Writes what was seen: a recording, traces, the tuned scene, a picture of the screen.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::layout::Size;

use super::with_reasons;
use crate::files::{NewFile, Output as _};
use crate::recording::{TraceSet, mcap, tek_csv};
use crate::tui::model::ScreenState;
use crate::tui::view::{self, picture};

/// Writes the model to `file` by its ending, or to the next free number where that exists; tells
/// what was written, or why nothing was.
///
/// # Errors
/// Why it cannot be saved, as a message.
pub fn save(model: &ScreenState, size: Size, file: &Path) -> Result<String, String> {
    let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        "mcap" => recording(model, file),
        "csv" => traces(model, file),
        "toml" => scene(model, file),
        _ => screen(model, size, file),
    }
}

/// Writes a file that replaces none; returns its name for the user.
fn write(file: &Path, text: &str) -> Result<String, String> {
    let write = || {
        let mut new = NewFile::numbered(file)?;
        new.write_all(text.as_bytes())?;
        Box::new(new).complete()
    };
    let written = write().map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(written.display().to_string())
}

/// The shot on screen with everything that is known about it.
fn recording(model: &ScreenState, file: &Path) -> Result<String, String> {
    let shot = model.shot().ok_or("there is no shot to write")?;
    let set = TraceSet { shots: vec![shot.clone()], ..model.set().clone() };
    let written = mcap::write_numbered(file, &set).map_err(|error| with_reasons(&error))?;
    Ok(format!("wrote shot {} with its scene to {}", shot.number, written.display()))
}

/// Each trace in a file as the instrument saves it.
fn traces(model: &ScreenState, file: &Path) -> Result<String, String> {
    let mut written = Vec::new();
    for capture in model.captures() {
        let text = tek_csv::write(capture).map_err(|error| with_reasons(&error))?;
        let name = path_beside(file, &capture.waveform.source.to_string());
        written.push(write(&name, &text)?);
    }
    if written.is_empty() {
        Err("there are no traces".to_owned())
    } else {
        Ok(format!("wrote {}", written.join(", ")))
    }
}

/// `lab.csv` for CH1 is `lab-CH1.csv`.
fn path_beside(file: &Path, source: &str) -> PathBuf {
    let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    file.with_file_name(format!("{stem}-{source}.csv"))
}

fn scene(model: &ScreenState, file: &Path) -> Result<String, String> {
    let text = match (model.live(), model.scene()) {
        (Some(live), None) if live.served.is_some() => {
            return Err("the served scene is not one that ships: save it where it is served".into());
        }
        (Some(live), _) => live.text(),
        (None, Some(scene)) => scene.text.clone(),
        (None, None) => return Err("no scene travels with this recording".to_owned()),
    };
    let written = write(file, &text)?;
    Ok(format!("wrote the scene to {written}: hertzscope run {written}"))
}

fn screen(model: &ScreenState, size: Size, file: &Path) -> Result<String, String> {
    let backend = TestBackend::new(size.width, size.height);
    let Ok(mut terminal) = Terminal::new(backend);
    let Ok(drawn) = terminal.draw(|frame| view::draw(model, frame));
    let written = write(file, &picture::svg(drawn.buffer))?;
    Ok(format!("wrote this screen to {written}"))
}
