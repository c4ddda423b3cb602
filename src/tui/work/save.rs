//! Writes what was seen: a recording, traces, the tuned scene, a picture of the screen. What is
//! written is taken from the model here, and a thread writes it.

use std::io::Write as _;
use std::path::{Path, PathBuf};

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::layout::Size;

use crate::files::NewFile;
use crate::recording::{TraceSet, mcap, tek_csv};
use crate::tui::job::{Job, Queue, with_reasons};
use crate::tui::model::ScreenState;
use crate::tui::view::{self, picture};

/// A job that writes the model to `file` by its ending, or to the next free number if that exists.
///
/// # Errors
/// Why there is nothing to write, as a message.
pub fn job(model: &ScreenState, size: Size, file: PathBuf) -> Result<Job<ScreenState>, String> {
    let ending = file.extension().and_then(|e| e.to_str()).unwrap_or_default();
    match ending.to_ascii_lowercase().as_str() {
        "mcap" => recording(model, file),
        "csv" => traces(model, file),
        "toml" => scene(model, file),
        _ => screen(model, size, file),
    }
}

/// A job that writes, and shows what was written or why nothing was.
fn writing(
    write: impl FnOnce() -> Result<String, String> + Send + 'static,
) -> Result<Job<ScreenState>, String> {
    Ok(Job::new(
        Queue::File,
        move |_| write(),
        |model: &mut ScreenState, written| {
            model.set_notice(written.unwrap_or_else(|problem| problem));
        },
    ))
}

/// Writes a file that replaces none; returns its name for the user.
fn write(file: &Path, text: &str) -> Result<String, String> {
    let write = || {
        let mut new = NewFile::numbered(file)?;
        new.write_all(text.as_bytes())?;
        new.complete()
    };
    let written = write().map_err(|error| format!("{}: {error}", file.display()))?;
    Ok(written.display().to_string())
}

/// The shot on screen with everything that is known about it.
fn recording(model: &ScreenState, file: PathBuf) -> Result<Job<ScreenState>, String> {
    let shot = model.shot().ok_or("there is no shot to write")?;
    let set = &model.recordings.front().set;
    let set = TraceSet {
        log: set.log.clone(),
        problems: set.problems.clone(),
        notes: set.notes.clone(),
        lines: set.lines.clone(),
        ..set.with_shot(shot.clone())
    };
    let number = shot.number;
    writing(move || {
        let written = mcap::write_numbered(&file, &set).map_err(|error| with_reasons(&error))?;
        Ok(format!("wrote shot {number} with its scene to {}", written.display()))
    })
}

/// Each trace in a file as the instrument saves it.
fn traces(model: &ScreenState, file: PathBuf) -> Result<Job<ScreenState>, String> {
    let captures = model.captures().to_vec();
    if captures.is_empty() {
        return Err("there are no traces".to_owned());
    }
    writing(move || {
        let mut written = Vec::new();
        for capture in &captures {
            let text = tek_csv::write(capture).map_err(|error| with_reasons(&error))?;
            let name = path_beside(&file, &capture.waveform.source.to_string());
            written.push(write(&name, &text)?);
        }
        Ok(format!("wrote {}", written.join(", ")))
    })
}

/// `lab.csv` for CH1 is `lab-CH1.csv`.
fn path_beside(file: &Path, source: &str) -> PathBuf {
    let stem = file.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    file.with_file_name(format!("{stem}-{source}.csv"))
}

fn scene(model: &ScreenState, file: PathBuf) -> Result<Job<ScreenState>, String> {
    let front = model.recordings.front();
    let text = match (&front.live, &front.scene) {
        (Some(live), None) if live.served.is_some() => {
            return Err(
                "the served scene is not an included one: save it where it is served".into()
            );
        }
        (Some(live), _) => live.text_in(&file),
        (None, Some(scene)) => scene.text.clone(),
        (None, None) => return Err("this recording contains no scene".to_owned()),
    };
    writing(move || {
        let written = write(&file, &text)?;
        Ok(format!("wrote the scene to {written}: hertzscope run {written}"))
    })
}

fn screen(model: &ScreenState, size: Size, file: PathBuf) -> Result<Job<ScreenState>, String> {
    let backend = TestBackend::new(size.width, size.height);
    let Ok(mut terminal) = Terminal::new(backend);
    let Ok(drawn) = terminal.draw(|frame| view::draw(model, frame));
    let text = picture::svg(drawn.buffer);
    writing(move || Ok(format!("wrote this screen to {}", write(&file, &text)?)))
}
