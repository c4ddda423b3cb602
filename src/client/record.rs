//! The record of one trace as the scope sends it, checked against all that the scope says of it.
//!
//! The scope states most quantities more than once: the vertical scale in `YMULT` (with 8 bits, 25
//! levels in a division), in `WFID` and in `CHx:SCALE` of `SET?`; the time base in `XINCR` (250
//! points in a division), in `WFID` and in `HORizontal`; the number of points in `NR_PT`, in `WFID`
//! and in the block. A record that contradicts itself in its length, or names another trace than
//! was asked for, is an invalid reply. Other contradictions are notes of the capture: some are
//! true, as after a turn of the time base on a stopped scope. Sources: programmer manual 071-1075,
//! `WFMPre`; the project's fact sheet on the TDS2000 family, sections 2.4 and 2.5.

use crate::quantity::{engineering, printable_line};
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, isf};
use crate::scope::Source;
use crate::scope::waveform::{FAMILY_BITS, LEVELS_PER_DIVISION};

/// Points of one horizontal division of a signal (1).
const POINTS_PER_DIVISION: f64 = 250.0;
/// Points of the record of a signal.
const SIGNAL_POINTS: usize = 2500;
/// Relative difference of two statements of the same quantity: replies have five digits (1).
const PRINTING_TOLERANCE: f64 = 1e-4;
/// The encoding of points that is asked for, in 1 or 2 bytes.
const ENCODING: [(&str, &str); 2] = [("ENCDG", "BIN"), ("BN_FMT", "RI")];

/// Whether a channel's record in two bytes a point is that of an 8-bit converter: all lower bytes
/// are 0, in points that are not all the same.
pub fn has_empty_bytes(capture: &Capture) -> bool {
    let waveform = &capture.waveform;
    let bits = waveform.preamble.bits(waveform.vertical.scale, PRINTING_TOLERANCE);
    let varies = waveform.codes.windows(2).any(|pair| pair[0] != pair[1]);
    matches!(waveform.source, Source::Channel(_)) && bits == Some(FAMILY_BITS) && varies
}

/// A reply to `WAVFrm?`, with preamble and block.
pub struct Record<'a>(pub &'a [u8]);

impl Record<'_> {
    /// The capture of `source` in this record. Its notes are the contradictions between the record
    /// and the front panel.
    ///
    /// # Errors
    /// A message: no record, another trace's, or another number of points than its preamble says.
    pub fn capture(
        &self,
        source: Source,
        panel: &SetFile,
        instrument: &InstrumentIdentity,
    ) -> Result<Capture, String> {
        let mut capture = isf::read(self.0, "record").map_err(|error| error.to_string())?;
        let points = capture.waveform.codes.len();
        if self.number("NR_PT") != Some(points as f64) {
            return Err(format!("found {points} points in a record whose NR_PT says otherwise"));
        }
        let name = self.name_items().first().map(|name| name.replace(' ', ""));
        let named = name.as_deref().and_then(Source::from_name);
        if named != Some(source) {
            let found = name.unwrap_or_else(|| "none".to_owned());
            return Err(format!("found the record of {found}, expected that of {source}"));
        }
        // What a file does not say and has to be guessed, the front panel says.
        capture.notes.clear();
        if let Source::Channel(number) = source {
            capture.waveform.vertical.probe = panel.probe(number).unwrap_or(1.0);
        }
        let coupling = capture.waveform.vertical.coupling;
        panel.complete(&mut capture);
        let mut notes = self.contradictions(&capture);
        if let Source::Channel(number) = source {
            notes.extend(invalid_numbers(panel, number));
            if let (Some(one), Some(other)) = (coupling, panel.coupling(number))
                && one != other
            {
                notes.push(format!("WFID says {one} coupling, SET? says {other}"));
            }
        }
        // They quote the scope.
        capture.notes.extend(notes.iter().map(|note| printable_line(note).into_owned()));
        capture.instrument = Some(instrument.clone());
        Ok(capture)
    }

    /// Differences between what the record says and what it says elsewhere.
    fn contradictions(&self, capture: &Capture) -> Vec<String> {
        let waveform = &capture.waveform;
        let preamble = &waveform.preamble;
        // False also for numbers that are not finite.
        let same = |a: f64, b: f64| (a - b).abs() <= PRINTING_TOLERANCE * b.abs();
        let mut notes = Vec::new();
        if preamble.bits(waveform.vertical.scale, PRINTING_TOLERANCE).is_none() {
            let scale = preamble.y_mult * LEVELS_PER_DIVISION;
            let unit = format!("{}/div", preamble.y_unit);
            let (found, other) =
                (engineering(scale, &unit, 4), engineering(waveform.vertical.scale, &unit, 4));
            notes.push(format!("YMULT means {found}, WFID says {other}"));
        }
        let is_signal = preamble.x_unit == "s";
        let time_base = preamble.x_incr * POINTS_PER_DIVISION;
        if is_signal && !same(time_base, waveform.horizontal_scale) {
            let (found, other) = (
                engineering(time_base, "s/div", 4),
                engineering(waveform.horizontal_scale, "s/div", 4),
            );
            notes.push(format!("XINCR means {found}, WFID says {other}"));
        }
        let points = waveform.codes.len();
        if is_signal && points != SIGNAL_POINTS {
            notes.push(format!("found {points} points, expected {SIGNAL_POINTS}"));
        }
        let items = self.name_items();
        let stated = items.iter().find_map(|item| item.strip_suffix(" points"));
        if let Some(stated) = stated
            && stated.parse() != Ok(points)
        {
            notes.push(format!("found {points} points, WFID says {stated}"));
        }
        for (key, expected) in ENCODING {
            if let Some(found) = self.value(key)
                && found != expected
            {
                notes.push(format!("found {key} {found}, expected {expected}"));
            }
        }
        for key in ["PT_OFF", "YZERO"] {
            let is_channel = matches!(waveform.source, Source::Channel(_));
            if let Some(found) = self.number(key).filter(|found| *found != 0.0 && is_channel) {
                notes.push(format!("found {key} {found}, expected 0"));
            }
        }
        notes
    }

    /// The items of `WFID`: `Ch1`, `DC coupling`, `5.0E-1 V/div` and so on.
    fn name_items(&self) -> Vec<String> {
        let name = self.value("WFID").unwrap_or_default();
        name.split(',').map(|item| item.trim().to_owned()).collect()
    }

    fn number(&self, key: &str) -> Option<f64> {
        self.value(key)?.parse().ok()
    }

    /// The value of `key` in the preamble, without quotes.
    fn value(&self, key: &str) -> Option<String> {
        let preamble = self.0.split(|byte| *byte == b'#').next()?;
        let text = String::from_utf8_lossy(preamble);
        let mut is_quoted = false;
        let fields = text.split(|letter| {
            is_quoted ^= letter == '"';
            letter == ';' && !is_quoted
        });
        let of_key = |field: &str| {
            let (header, value) = field.split_once(' ')?;
            let word = header.rsplit(':').next().unwrap_or_default();
            word.eq_ignore_ascii_case(key).then(|| value.trim().trim_matches('"').to_owned())
        };
        fields.filter_map(of_key).last()
    }
}

/// Settings of channel `number` in the reply to `SET?` that are not finite numbers.
fn invalid_numbers(panel: &SetFile, number: u8) -> Vec<String> {
    let mut paths = ["SCALE", "POSITION", "PROBE"].map(|key| format!("CH{number}:{key}")).to_vec();
    paths.extend(["SCALE", "POSITION"].map(|key| format!("HORIZONTAL:MAIN:{key}")));
    let invalid = paths.iter().filter_map(|path| {
        let found = panel.value(path)?;
        let note = format!("SET? says {path} {found}, expected a finite number");
        panel.number(path).is_none().then_some(note)
    });
    invalid.collect()
}

/// The traces that a front panel has on its screen.
pub fn displayed(panel: &SetFile) -> Vec<Source> {
    let channels = (1..=4).map(Source::Channel);
    let others = std::iter::once(Source::Math).chain(('A'..='D').map(Source::Reference));
    channels.chain(others).filter(|source| panel.is_selected(*source) == Some(true)).collect()
}
