//! Reads and writes `.SET` files: the front panel at the time of a save, as the instrument's answer
//! to `SET?`.
//!
//! A folder `ALLnnnn` holds one beside its `.CSV` files. [`SetFile::complete`] takes from it what
//! those do not tell (coupling, bandwidth limit, inversion) and notes where the two disagree: of
//! 308 published pairs 6 do, three saved in scan mode, three after the time base was turned on a
//! stopped instrument.
//!
//! # Sources
//! Tektronix programmer manual 071-1075, `SET?`; the project's fact sheet on the TDS2000 family,
//! section 2.7, with files of two firmwares.
//! `trigger point = 1250 - horizontal position / sample interval`.

use std::fmt::Write as _;

use super::Capture;
use super::command_text::{command, path, unquoted};
use super::error::{RecordingError, excerpt_of_bytes};
use crate::quantity::engineering;
use crate::scope::waveform::LEVELS_PER_DIVISION;
use crate::scope::{Coupling, Slope, Source};

/// Larger files are refused unread; the family's own have less than 2000 bytes.
pub const MAXIMUM_BYTES: usize = 1 << 20;
/// Index of the point in the middle of the screen (1).
const SCREEN_CENTRE_POINT: f64 = 1250.0;
/// How far two statements of the same may differ, relative; a `.CSV` prints seven digits.
const PRINTING_TOLERANCE: f64 = 1e-6;

/// One setting.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetFileEntry {
    /// Where it belongs, in capitals: `CH1:SCALE`.
    pub path: String,
    /// As written, without quotes.
    pub value: String,
    /// Whether it stood in quotes.
    pub quoted: bool,
}

/// The settings of one file, in its order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SetFile {
    /// The settings.
    pub settings: Vec<SetFileEntry>,
}

impl SetFile {
    /// Reads the `bytes` of a `.SET` file; `file_name` is for messages.
    ///
    /// # Errors
    /// [`RecordingError`] for anything that is not a list of settings.
    pub fn read(bytes: &[u8], file_name: &str) -> Result<Self, RecordingError> {
        if bytes.len() > MAXIMUM_BYTES {
            let found = format!("{} bytes", bytes.len());
            return Err(RecordingError::found(
                file_name,
                found,
                format!("at most {MAXIMUM_BYTES}"),
            ));
        }
        let (mut at, mut settings) = (0, Vec::<SetFileEntry>::new());
        while let Some((found, next)) = command(bytes, at) {
            // The first setting starts at the root: that tells a set-up from any other text.
            let starts = |text: &str| !settings.is_empty() || text.starts_with(':');
            let header = std::str::from_utf8(found.header).ok();
            let header = header.filter(|text| is_header(text) && starts(text));
            let value = std::str::from_utf8(found.value).ok().filter(|text| is_value(text));
            let (Some(header), Some(value)) = (header, value) else {
                let before = bytes.get(..found.offset).unwrap_or_default();
                let line = before.split(|byte| *byte == b'\n').count();
                let place = format!("{file_name}, line {line}, byte {}", found.offset);
                let text = excerpt_of_bytes(bytes.get(found.offset..next).unwrap_or_default());
                let expected = "a setting such as `:CH1:SCALE 1.0E0`";
                return Err(RecordingError::found(place, text, expected));
            };
            let before = settings.last().map(|setting| setting.path.as_str()).unwrap_or_default();
            let path = path(header, before);
            let bare = unquoted(value);
            let quoted = bare.len() < value.len();
            settings.push(SetFileEntry { path, value: bare.to_owned(), quoted });
            at = next;
        }
        if settings.is_empty() {
            let expected = "at least one, such as `:CH1:SCALE 1.0E0`";
            return Err(RecordingError::found(file_name, "no setting", expected));
        }
        Ok(Self { settings })
    }

    /// The settings as the instrument writes them: a header leaves out the path that it shares with
    /// all of the one before, and begins at the root where it does not. What an instrument of the
    /// family saved comes back byte for byte.
    pub fn write(&self) -> String {
        let mut text = String::new();
        let mut stem: Option<String> = None;
        for setting in &self.settings {
            let shared = stem.as_deref().and_then(|stem| setting.path.strip_prefix(stem));
            let header = shared.map_or_else(|| format!(":{}", setting.path), str::to_owned);
            let mark = if setting.quoted { "\"" } else { "" };
            let separator = if text.is_empty() { "" } else { ";" };
            // Writing to a String cannot fail.
            let _ = write!(text, "{separator}{header} {mark}{}{mark}", setting.value);
            stem = setting.path.rsplit_once(':').map(|(stem, _)| format!("{stem}:"));
        }
        text.push('\n');
        text
    }

    /// The last value of `path`, which is in capitals.
    pub fn value(&self, path: &str) -> Option<&str> {
        let found = self.settings.iter().rev().find(|setting| setting.path == path);
        found.map(|setting| setting.value.as_str())
    }

    /// A finite number at `path` (unit).
    pub fn number(&self, path: &str) -> Option<f64> {
        self.value(path)?.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// A switch at `path`.
    pub fn is_on(&self, path: &str) -> Option<bool> {
        match self.value(path)? {
            "ON" | "1" => Some(true),
            "OFF" | "0" => Some(false),
            _ => None,
        }
    }

    /// Vertical scale of channel `number`, probe included (V/div).
    pub fn scale(&self, number: u8) -> Option<f64> {
        self.number(&format!("CH{number}:SCALE"))
    }

    /// Where zero volts of channel `number` stands, upward from the centre (div).
    pub fn position(&self, number: u8) -> Option<f64> {
        self.number(&format!("CH{number}:POSITION"))
    }

    /// Probe attenuation of channel `number` (1).
    pub fn probe(&self, number: u8) -> Option<f64> {
        self.number(&format!("CH{number}:PROBE"))
    }

    /// Coupling of channel `number`.
    pub fn coupling(&self, number: u8) -> Option<Coupling> {
        match self.value(&format!("CH{number}:COUPLING"))? {
            "DC" => Some(Coupling::Dc),
            "AC" => Some(Coupling::Ac),
            "GND" => Some(Coupling::Ground),
            _ => None,
        }
    }

    /// Time base (s/div).
    pub fn time_base(&self) -> Option<f64> {
        self.number("HORIZONTAL:MAIN:SCALE").or_else(|| self.number("HORIZONTAL:SCALE"))
    }

    /// From the trigger to the middle of the screen (s).
    pub fn horizontal_position(&self) -> Option<f64> {
        self.number("HORIZONTAL:MAIN:POSITION")
    }

    /// Source of the edge trigger; `None` for the external inputs and the mains too.
    pub fn trigger_source(&self) -> Option<Source> {
        self.value("TRIGGER:MAIN:EDGE:SOURCE").and_then(Source::from_name)
    }

    /// Trigger level (V).
    pub fn trigger_level(&self) -> Option<f64> {
        self.number("TRIGGER:MAIN:LEVEL")
    }

    /// Direction of the edge trigger.
    pub fn trigger_slope(&self) -> Option<Slope> {
        match self.value("TRIGGER:MAIN:EDGE:SLOPE")? {
            "RISE" => Some(Slope::Rise),
            "FALL" => Some(Slope::Fall),
            _ => None,
        }
    }

    /// Whether a trace was on the screen.
    pub fn is_selected(&self, source: Source) -> Option<bool> {
        let name = match source {
            Source::Reference(letter) => format!("REF{letter}"),
            other => other.to_string(),
        };
        self.is_on(&format!("SELECT:{name}"))
    }

    /// Fills in what a channel's file does not tell, and notes what disagrees with it. Other traces
    /// have no settings of their own; of those only the selection is compared.
    pub fn complete(&self, capture: &mut Capture) {
        let source = capture.waveform.source;
        if self.is_selected(source) == Some(false) {
            capture.notes.push(format!("the .SET file says that {source} was off"));
        }
        let Source::Channel(number) = source else { return };
        let vertical = &mut capture.waveform.vertical;
        vertical.coupling = vertical.coupling.or(self.coupling(number));
        let bandwidth_limited = self.is_on(&format!("CH{number}:BANDWIDTH"));
        vertical.bandwidth_limited = vertical.bandwidth_limited.or(bandwidth_limited);
        vertical.inverted = vertical.inverted.or(self.is_on(&format!("CH{number}:INVERT")));
        let disagreements = self.disagreements(capture, number);
        capture.notes.extend(disagreements);
    }

    fn disagreements(&self, capture: &Capture, number: u8) -> Vec<String> {
        let waveform = &capture.waveform;
        let vertical = &waveform.vertical;
        let expected = self
            .horizontal_position()
            .map(|at| SCREEN_CENTRE_POINT - at / waveform.preamble.x_incr);
        let printed = |value: f64| PRINTING_TOLERANCE * value.abs();
        // The file's scale and offset are rounded; half a level is less than the panel can be
        // turned.
        let level = 0.5 / LEVELS_PER_DIVISION;
        let point = 0.5;
        [
            (
                "vertical scale",
                vertical.scale,
                self.scale(number),
                printed(vertical.scale),
                "V/div",
            ),
            ("vertical position", vertical.position, self.position(number), level, "div"),
            ("probe attenuation", vertical.probe, self.probe(number), printed(vertical.probe), ""),
            (
                "time base",
                waveform.horizontal_scale,
                self.time_base(),
                printed(waveform.horizontal_scale),
                "s/div",
            ),
            ("trigger point", waveform.trigger_point, expected, point, ""),
        ]
        .into_iter()
        .filter_map(|(what, found, other, tolerance, unit)| {
            let other = other.filter(|other| (other - found).abs() > tolerance)?;
            let (found, other) = (amount(found, unit), amount(other, unit));
            Some(format!("{what} is {found}, the .SET file says {other}"))
        })
        .collect()
    }
}

fn amount(value: f64, unit: &str) -> String {
    match unit {
        // Six decimals of a point or a ratio; the rest is round-off.
        "" => ((value * 1e6).round() / 1e6).to_string(),
        _ => engineering(value, unit, 4),
    }
}

fn is_header(text: &str) -> bool {
    let known = |c: char| c.is_ascii_alphanumeric() || matches!(c, ':' | '_' | '*');
    text.contains(|c: char| c.is_ascii_alphabetic()) && text.chars().all(known)
}

fn is_value(text: &str) -> bool {
    !text.is_empty() && !text.chars().any(char::is_control)
}
