//! `hertzscope convert`: between recordings and the files a TDS2000 saves.

use std::path::{Path, PathBuf};

use anyhow::{Context as _, anyhow, bail};
use clap::{Args, ValueEnum};

use super::input::{ReadingArguments, no_capture};
use super::overwrite::OverwriteArguments;
use super::picture;
use super::plain_table::{TableContent, plain_table};
use crate::files;
use crate::recording::format::open_large;
use crate::recording::mcap::RecordingWriter;
use crate::recording::mcap::indexed_recording::IndexedRecording;
use crate::recording::tek_csv::TekCsvError;
use crate::recording::{Capture, InstrumentIdentity, Shot, TraceSet, isf, mcap, tek_csv};
use crate::report::{self, ScreenTheme};
use crate::scene::oscilloscope;
use crate::scope::{Model, Source};
use crate::screen::{PictureFormat, draw, file};
use crate::sweep::table;

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
    /// In a table: also the simulated (true) forces at the sensors
    #[arg(long)]
    truth: bool,
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

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    if let Some(recording) = open_large(&arguments.input)? {
        return shot_by_shot(arguments, recording);
    }
    let set = arguments.reading.table.open(&arguments.input)?;
    for problem in &set.problems {
        super::say(&format!("warning: {}: {problem}", arguments.input.display()));
    }
    convert(arguments, set)
}

/// Converts a recording that is too large to be read at once: each shot by itself.
fn shot_by_shot(arguments: &Arguments, mut recording: IndexedRecording) -> anyhow::Result<()> {
    let output = &arguments.output;
    let facts = recording.facts();
    for problem in &facts.problems {
        super::say(&format!("warning: {}: {problem}", arguments.input.display()));
    }
    let ending = output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    match ending.as_deref() {
        Some("mcap") => return recording_shot_by_shot(arguments, recording),
        Some("isf" | "csv")
            if recording.shots() > 1 && arguments.reading.selection.shot().is_none() =>
        {
            bail!(
                "found {} shots, expected one for a single file: give a folder, or --shot",
                recording.shots()
            )
        }
        _ => {}
    }
    let is_folder = ending.is_none();
    for place in 0..recording.shots() {
        let Some((shot, notes)) = recording.shot_and_notes(place)? else { continue };
        if shot.captures.is_empty() || !arguments.reading.selection.wants(shot.number) {
            continue;
        }
        let mut set = TraceSet { problems: Vec::new(), ..facts.clone() };
        set.notes.insert(shot.number, notes);
        set.shots.push(shot);
        convert(arguments, set)?;
        // A picture is that of the first shot.
        if !is_folder {
            return Ok(());
        }
    }
    Ok(())
}

/// Copies a recording that is too large to be read at once into another, with what the user says of
/// it.
fn recording_shot_by_shot(
    arguments: &Arguments,
    mut recording: IndexedRecording,
) -> anyhow::Result<()> {
    let output = &arguments.output;
    refuse_input_as_output(arguments)?;
    arguments.overwrite.check(output)?;
    let facts = recording.facts();
    let mut copy = None;
    for place in 0..recording.shots() {
        let Some((shot, notes)) = recording.shot_and_notes(place)? else { continue };
        if !arguments.reading.selection.wants(shot.number) {
            continue;
        }
        let mut set = facts.clone();
        set.shots.push(shot);
        prepare(arguments, &mut set)?;
        let writer = match &mut copy {
            Some(writer) => writer,
            None => copy.insert(RecordingWriter::create(output, &set.metadata, &set.attachments)?),
        };
        for shot in &set.shots {
            writer.add(shot, &notes)?;
        }
    }
    let Some(writer) = copy else {
        bail!("found no such shot: the file has {}", recording.shots());
    };
    let file = writer.finish()?;
    let messages = recording.traffic().commands + recording.traffic().replies;
    if messages > 0 {
        let input = arguments.input.display();
        super::say(&format!(
            "warning: {input}: {messages} messages of its remote sessions are not copied (a recording of this size is copied by shots)"
        ));
    }
    if !arguments.quiet {
        super::print(&file.display().to_string())?;
    }
    Ok(())
}

fn refuse_input_as_output(arguments: &Arguments) -> anyhow::Result<()> {
    let output = &arguments.output;
    let same = |input: PathBuf| std::fs::canonicalize(output).is_ok_and(|output| output == input);
    if std::fs::canonicalize(&arguments.input).is_ok_and(same) && output.is_file() {
        bail!("{}: found the input as the output, expected another file", output.display());
    }
    Ok(())
}

/// Leaves out what is not meant, and notes what the user says of the rest.
fn prepare(arguments: &Arguments, set: &mut TraceSet) -> anyhow::Result<()> {
    arguments.reading.apply(set)?;
    if let Some(name) = &arguments.instrument {
        name_instrument(set, &oscilloscope(name)?);
    }
    Ok(())
}

fn convert(arguments: &Arguments, mut set: TraceSet) -> anyhow::Result<()> {
    prepare(arguments, &mut set)?;
    let output = &arguments.output;
    refuse_input_as_output(arguments)?;
    let is_folder = output.is_dir() || output.as_os_str().as_encoded_bytes().ends_with(b"/");
    arguments.overwrite.check(output)?;
    let extension = output.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let is_table = match extension.as_deref() {
        Some("csv") => arguments.form == Form::Table,
        Some("jsonl" | "parquet") => true,
        _ => false,
    };
    if (arguments.truth || arguments.newtons) && !is_table {
        bail!("{}: --truth and --newtons are for tables (.csv)", output.display());
    }
    if arguments.light && !matches!(extension.as_deref(), Some("svg" | "png")) {
        bail!("{}: --light is for pictures (.svg, .png)", output.display());
    }
    let written = match extension.as_deref() {
        _ if is_folder => folders(&set, output)?,
        Some("mcap") => {
            mcap::write(output, &set)?;
            vec![output.clone()]
        }
        _ if is_table => {
            let content = TableContent { truth: arguments.truth, newtons: arguments.newtons };
            table::write(output, &plain_table(&set, content)?)?;
            vec![output.clone()]
        }
        Some("csv") => csv_file(&set, output)?,
        Some("isf") => isf_file(&set, output)?,
        Some("svg" | "png") => {
            let theme = if arguments.light { ScreenTheme::Light } else { ScreenTheme::Dark };
            draw_screen(&set, output, theme)?;
            vec![output.clone()]
        }
        Some("bmp") => screen(&set, output, PictureFormat::Bmp)?,
        Some("tif" | "tiff") => screen(&set, output, PictureFormat::Tiff)?,
        None => folders(&set, output)?,
        Some(other) => bail!(
            "{}: found the ending .{other}, expected .mcap, .csv, .jsonl, .parquet, .isf, .svg, .png, .bmp, .tif, or a folder",
            output.display()
        ),
    };
    if !arguments.quiet {
        for file in written {
            super::print(&file.display().to_string())?;
        }
    }
    Ok(())
}

/// Gives captures of an unknown instrument one of this model.
fn name_instrument(set: &mut TraceSet, model: &Model) {
    for capture in set.shots.iter_mut().flat_map(|shot| &mut shot.captures) {
        capture.instrument.get_or_insert_with(|| InstrumentIdentity {
            model: model.name.replace(' ', ""),
            serial: model.serial.clone(),
            firmware: model.firmware.clone(),
        });
    }
}

/// The first shot that has captures.
fn first_shot(set: &TraceSet) -> anyhow::Result<&Shot> {
    let Some(shot) = set.shots.iter().find(|shot| !shot.captures.is_empty()) else {
        return Err(no_capture(&set.problems));
    };
    Ok(shot)
}

/// The scope's own picture of its screen at the first shot that has captures.
fn screen(set: &TraceSet, path: &Path, format: PictureFormat) -> anyhow::Result<Vec<PathBuf>> {
    let saved = saved(set, first_shot(set)?)?;
    let bytes = file(&draw(&saved.screen), format);
    files::write(path, bytes).with_context(|| path.display().to_string())?;
    Ok(vec![path.to_owned()])
}

/// The screen at the first shot that has captures, as a drawing.
fn draw_screen(set: &TraceSet, file: &Path, theme: ScreenTheme) -> anyhow::Result<()> {
    let shot = first_shot(set)?;
    let facts = set.metadata.get("hertzscope:recording");
    let file_name = set.attachments.first().map(|attachment| &attachment.name);
    let title = facts.and_then(|facts| facts.get("title")).or(file_name).map_or("", String::as_str);
    picture::save(file, &report::screen(shot, title, theme))
}

/// The single capture of a set.
fn isf_file(set: &TraceSet, file: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let captures: Vec<&Capture> = set.shots.iter().flat_map(|shot| &shot.captures).collect();
    let [capture] = captures.as_slice() else {
        bail!(
            "found {} captures, expected one: an .isf file holds a single channel",
            captures.len()
        );
    };
    let bytes = isf::write(capture, isf::Width::One)?;
    files::write(file, bytes).with_context(|| file.display().to_string())?;
    Ok(vec![file.to_owned()])
}

/// A capture as the scope saves it.
fn native(capture: &Capture) -> anyhow::Result<String> {
    match tek_csv::write(capture) {
        Err(error @ TekCsvError::NoInstrument) => {
            Err(anyhow!("{error}; `--instrument MODEL` gives it one"))
        }
        other => Ok(other?),
    }
}

/// A single capture goes into the file itself, several into folders beside each other in one of the
/// file's name.
fn csv_file(set: &TraceSet, file: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut captures = set.shots.iter().flat_map(|shot| &shot.captures);
    match (captures.next(), captures.next()) {
        (None, _) => Err(no_capture(&set.problems)),
        (Some(capture), None) => {
            files::write(file, native(capture)?).with_context(|| file.display().to_string())?;
            Ok(vec![file.to_owned()])
        }
        (Some(_), Some(_)) => folders(set, &file.with_extension("")),
    }
}

/// One folder a shot, one file a channel with set-up and screen, numbered on from what is there as
/// the scope does.
fn folders(set: &TraceSet, parent: &Path) -> anyhow::Result<Vec<PathBuf>> {
    let mut written = Vec::new();
    for shot in set.shots.iter().filter(|shot| !shot.captures.is_empty()) {
        // Everything is put into words before a folder is made: a capture that cannot be written
        // leaves no half of it.
        let contents = contents(set, shot)?;
        let name = |number| format!("ALL{number:04}");
        let files = |number| {
            let named =
                |(name, bytes): &(String, Vec<u8>)| (format!("F{number:04}{name}"), bytes.clone());
            contents.iter().map(named).collect()
        };
        let made = files::write_numbered_folder(parent, name, files);
        written.extend(made.with_context(|| parent.display().to_string())?);
    }
    if written.is_empty() {
        return Err(no_capture(&set.problems));
    }
    Ok(written)
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
        files.push((format!("{channel}.CSV"), native(capture)?.into_bytes()));
    }
    let saved = saved(set, shot)?;
    if let Some(set_up) = saved.set_up {
        files.push(("TEK.SET".to_owned(), set_up));
    }
    files.push(("TEK.BMP".to_owned(), file(&draw(&saved.screen), PictureFormat::Bmp)));
    Ok(files)
}
