//! `hertzscope convert`: between recordings and the files a TDS2000 saves.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, bail};
use clap::{Args, ValueEnum};

use super::input::{ReadingArguments, no_capture};
use super::overwrite::OverwriteArguments;
use super::picture;
use super::plain_table::{TableContent, TrueColumns, plain_table};
use crate::files;
use crate::recording::format::{FORMATS, FileFormat, Recording};
use crate::recording::mcap::RecordingWriter;
use crate::recording::{InstrumentIdentity, Shot, TraceSet};
use crate::report;
use crate::report::plot::Theme;
use crate::scene::oscilloscope;
use crate::scope::{Model, Source};
use crate::screen::{PictureFormat, draw, file};
use crate::table;

use super::saved::saved;

/// Convert between recordings and a scope's files, or into tables and pictures
#[derive(Debug, Args)]
#[allow(clippy::struct_excessive_bools, reason = "switches of a command line")]
pub struct Arguments {
    /// A recording (.mcap), a scope's file (.csv, .isf), or a folder of them
    input: PathBuf,
    /// By its extension: a recording (.mcap); a table (.csv, .jsonl, .parquet); a scope's file with
    /// one channel (.isf, or .csv with --as tds); a picture of the first shot (.svg, .png, or the
    /// scope's own .bmp, .tif); without extension a folder with ALL0000, ALL0001, ...
    /// as the scope writes them
    output: PathBuf,
    /// Format of a .csv file
    #[arg(long = "as", value_name = "FORM", value_enum, default_value = "table")]
    form: Form,
    /// In a table: also the simulated (true) forces at the sensors, or all true signals
    #[arg(long, value_enum, value_name = "WHICH", num_args = 0..=1, require_equals = true, default_missing_value = "sensors")]
    truth: Option<TrueColumns>,
    /// In a table: forces (N) instead of voltages, by the sensors' calibrations
    #[arg(long)]
    newtons: bool,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Scope model for captures that name none, as in `hertzscope list scopes`; --as tds needs one
    #[arg(long, value_name = "MODEL")]
    instrument: Option<String>,
    /// In a picture (.svg, .png): dark on white, for print
    #[arg(long)]
    light: bool,
    #[command(flatten)]
    overwrite: OverwriteArguments,
    /// Do not print the names of written files
    #[arg(short, long)]
    quiet: bool,
}

/// What a .csv is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Form {
    /// `time_s,CH1_V,...`, one row per sample, for pandas and spreadsheets
    Table,
    /// As the instrument saves it, one file per channel
    Tds,
}

/// Endings of files with one row for each sample, of pictures, and of the scope's own pictures.
const TABLES: [&str; 3] = ["csv", "jsonl", "parquet"];
const PICTURES: [&str; 2] = ["svg", "png"];
const SCREENS: [(&str, PictureFormat); 3] =
    [("bmp", PictureFormat::Bmp), ("tif", PictureFormat::Tiff), ("tiff", PictureFormat::Tiff)];

/// What is written.
#[derive(Debug, Clone, Copy)]
enum Target {
    /// A recording with all shots.
    Recording,
    /// A table of all shots.
    Table,
    /// A folder `ALLnnnn` for each shot.
    Folders,
    /// A file with a single capture.
    File(&'static FileFormat),
    /// A drawing of the first shot.
    Picture,
    /// The scope's screen at the first shot.
    Screen(PictureFormat),
}

impl Target {
    /// What the output's name, and the options, ask for.
    fn of(arguments: &Arguments) -> anyhow::Result<Self> {
        let output = &arguments.output;
        let ending = output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
        let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
        let ending = ending.as_deref();
        let is_table = ending.is_some_and(|ending| TABLES.contains(&ending));
        let file = ending.and_then(FileFormat::by_ending);
        let file = file.filter(|_| !is_table || arguments.form == Form::Tds);
        let screen = SCREENS.iter().find(|(known, _)| Some(*known) == ending);
        let target = match (ending, file, screen) {
            _ if is_folder => Self::Folders,
            (None, ..) => Self::Folders,
            (Some("mcap"), ..) => Self::Recording,
            (_, Some(format), _) => Self::File(format),
            _ if is_table => Self::Table,
            (Some(picture), ..) if PICTURES.contains(&picture) => Self::Picture,
            (.., Some((_, format))) => Self::Screen(*format),
            (Some(other), ..) => bail!(
                "{}: found the ending .{other}, expected .mcap, .csv, .jsonl, .parquet, .isf, .svg, .png, .bmp, .tif, or a folder",
                output.display()
            ),
        };
        if (arguments.truth.is_some() || arguments.newtons) && !matches!(target, Self::Table) {
            bail!("{}: --truth and --newtons are for tables (.csv)", output.display());
        }
        if arguments.light && !matches!(target, Self::Picture) {
            bail!("{}: --light is for pictures (.svg, .png)", output.display());
        }
        Ok(target)
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let mut recording = arguments.reading.open_recording(&arguments.input)?;
    for problem in &recording.facts().problems {
        super::say(&format!("warning: {}: {problem}", arguments.input.display()));
    }
    let output = &arguments.output;
    refuse_input_as_output(arguments)?;
    let target = Target::of(arguments)?;
    arguments.overwrite.check(output)?;
    let model = arguments.instrument.as_deref().map(oscilloscope).transpose()?;
    let written = match target {
        Target::Recording => vec![copy(arguments, recording, model.as_ref())?],
        Target::Table => {
            let content = TableContent { truth: arguments.truth, newtons: arguments.newtons };
            let set = arguments.reading.whole(recording)?;
            table::write(output, &plain_table(&set, content)?)?;
            vec![output.clone()]
        }
        _ => by_shots(arguments, &mut recording, target, model.as_ref())?,
    };
    if !arguments.quiet {
        for file in written {
            super::print(&file.display().to_string())?;
        }
    }
    Ok(())
}

/// Writes the files of each shot, or one file of the first.
fn by_shots(
    arguments: &Arguments,
    recording: &mut Recording,
    mut target: Target,
    model: Option<&Model>,
) -> anyhow::Result<Vec<PathBuf>> {
    let mut output = arguments.output.clone();
    let mut written = Vec::new();
    if let Target::File(format) = target {
        let captures = arguments.reading.selection.captures(recording)?;
        if captures > 1 && format.is_in_folders {
            // In folders beside each other in one of the file's name.
            (target, output) = (Target::Folders, output.with_extension(""));
        } else if captures > 1 {
            bail!(
                "found {captures} captures, expected one: an .{} file holds a single channel; choose it with --shot and --channel",
                format.ending
            );
        }
    }
    arguments.reading.for_each_shot(recording, |set| {
        name_instrument(set, model);
        let Some(shot) = set.shots.iter().find(|shot| !shot.captures.is_empty()) else {
            return Ok(());
        };
        if matches!(target, Target::Folders) {
            written.extend(folder(set, shot, &output)?);
            return Ok(());
        }
        if !written.is_empty() {
            return Ok(());
        }
        match (target, shot.captures.first()) {
            (Target::File(format), Some(capture)) => save(&output, (format.write)(capture)?)?,
            (Target::Screen(format), _) => {
                save(&output, file(&draw(&saved(set, shot)?.screen), format))?;
            }
            _ => {
                let theme = if arguments.light { Theme::Light } else { Theme::Dark };
                draw_screen(set, shot, &output, theme)?;
            }
        }
        written.push(output.clone());
        Ok(())
    })?;
    if written.is_empty() {
        return Err(no_capture(&recording.facts().problems));
    }
    Ok(written)
}

fn save(file: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    files::write(file, bytes).with_context(|| file.display().to_string())
}

/// Copies a recording shot by shot, with its remote sessions and what the user says of it.
fn copy(
    arguments: &Arguments,
    mut recording: Recording,
    model: Option<&Model>,
) -> anyhow::Result<PathBuf> {
    let places = arguments.reading.selection.shots(&recording)?;
    arguments.reading.count_gains(&mut recording)?;
    let facts = recording.facts();
    let mut writer =
        RecordingWriter::create(&arguments.output, &facts.metadata, &facts.attachments)?;
    let before = facts.notes.get(&0).cloned().unwrap_or_default();
    writer.add_log(&before.log)?;
    let mut from = 0;
    for (place, number) in places {
        let set = arguments.reading.selection.read(&mut recording, place)?;
        name_instrument(set, model);
        let Some(shot) = set.shots.pop() else { continue };
        let notes = set.notes.remove(&number).unwrap_or_default();
        for line in recording.lines(from, shot.timestamp_ns)? {
            writer.add_line(&line)?;
        }
        from = shot.timestamp_ns.saturating_add(1);
        writer.add(&shot, &notes)?;
    }
    for line in recording.lines(from, u64::MAX)? {
        writer.add_line(&line)?;
    }
    Ok(writer.finish()?)
}

fn refuse_input_as_output(arguments: &Arguments) -> anyhow::Result<()> {
    let output = &arguments.output;
    let same = |input: PathBuf| std::fs::canonicalize(output).is_ok_and(|output| output == input);
    if std::fs::canonicalize(&arguments.input).is_ok_and(same) && output.is_file() {
        bail!("{}: found the input as the output, expected another file", output.display());
    }
    Ok(())
}

/// Gives captures of an unknown instrument one of this model.
fn name_instrument(set: &mut TraceSet, model: Option<&Model>) {
    let Some(model) = model else { return };
    for capture in set.shots.iter_mut().flat_map(|shot| &mut shot.captures) {
        capture.instrument.get_or_insert_with(|| InstrumentIdentity {
            model: model.name.replace(' ', ""),
            serial: model.serial.clone(),
            firmware: model.firmware.clone(),
        });
    }
}

/// The screen at a shot, as a drawing.
fn draw_screen(set: &TraceSet, shot: &Shot, file: &Path, theme: Theme) -> anyhow::Result<()> {
    let facts = set.metadata.get("hertzscope:recording");
    let file_name = set.attachments.first().map(|attachment| &attachment.name);
    let title = facts.and_then(|facts| facts.get("title")).or(file_name).map_or("", String::as_str);
    picture::save(file, &report::screen(shot, title), theme)
}

/// A folder with one file for each channel of a shot, its set-up and its screen, numbered on from
/// the folders that exist, as the scope does.
fn folder(set: &TraceSet, shot: &Shot, parent: &Path) -> anyhow::Result<Vec<PathBuf>> {
    // All contents are made before the folder: a capture that cannot be written leaves none.
    let contents = contents(set, shot)?;
    let name = |number| format!("ALL{number:04}");
    let files = |number| {
        let named =
            |(name, bytes): &(String, Vec<u8>)| (format!("F{number:04}{name}"), bytes.clone());
        contents.iter().map(named).collect()
    };
    files::write_numbered_folder(parent, name, files).with_context(|| parent.display().to_string())
}

/// The files of one shot, by their names behind the number.
fn contents(set: &TraceSet, shot: &Shot) -> anyhow::Result<Vec<(String, Vec<u8>)>> {
    let mut files = Vec::new();
    for capture in &shot.captures {
        let channel = match capture.waveform.source {
            Source::Channel(channel) => format!("CH{channel}"),
            Source::Math => "MTH".to_owned(),
            Source::Reference(letter) => format!("RF{letter}"),
        };
        let format = FORMATS.iter().find(|format| format.is_in_folders);
        let Some(format) = format else { continue };
        let ending = format.ending.to_ascii_uppercase();
        files.push((format!("{channel}.{ending}"), (format.write)(capture)?));
    }
    let saved = saved(set, shot)?;
    if let Some(set_up) = saved.set_up {
        files.push(("TEK.SET".to_owned(), set_up));
    }
    files.push(("TEK.BMP".to_owned(), file(&draw(&saved.screen), PictureFormat::Bmp)));
    Ok(files)
}
