//! How replies look, and the transfer of records.
//!
//! Both are settings of the instrument that others may have made theirs: replies' form is put back
//! at the end, and the settings of the transfer (`DATa`) are set, used and put back within one
//! message, which the instrument carries out as a whole.

use std::io;

use super::connection::Client;
use super::line::invalid_reply;
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, isf};
use crate::scope::Source;

/// Settings of the transfer, in the order of the reply.
const TRANSFER_FIELDS: [&str; 5] = ["ENC", "WID", "STAR", "STOP", "SOU"];

/// Whether replies begin with headers, and whether words are in full.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReplyForm {
    header: bool,
    verbose: bool,
}

/// Replies without headers, words in full.
pub const PLAIN_REPLIES: &str = ":HEAD OFF;:VERB ON";

impl ReplyForm {
    /// Asks for the form that replies have now, and makes them plain.
    ///
    /// # Errors
    /// The system's error; also for a reply that is no switch.
    pub fn replace(client: &mut Client) -> io::Result<Self> {
        let mut is_on = |query| {
            let reply = client.ask(query)?;
            // With a header or without.
            match reply.rsplit(' ').next() {
                Some("1" | "ON") => Ok(true),
                Some("0" | "OFF") => Ok(false),
                _ => Err(invalid_reply("a reply to HEADer? or VERBose? that is no switch")),
            }
        };
        let form = Self { header: is_on("HEAD?")?, verbose: is_on("VERB?")? };
        client.send(PLAIN_REPLIES)?;
        Ok(form)
    }

    /// The commands that give replies this form.
    pub fn commands(self) -> String {
        format!(":VERB {};:HEAD {}", u8::from(self.verbose), u8::from(self.header))
    }
}

/// The traces that a front panel has on its screen.
pub fn displayed(panel: &SetFile) -> Vec<Source> {
    let channels = (1..=4).map(Source::Channel);
    let others = std::iter::once(Source::Math).chain(('A'..='D').map(Source::Reference));
    channels.chain(others).filter(|source| panel.is_selected(*source) == Some(true)).collect()
}

/// Asks for the records of `sources`, each as an ISF file holds it.
///
/// # Errors
/// The system's error; also for a reply that makes no sense.
pub fn records(client: &mut Client, sources: &[Source]) -> io::Result<Vec<Vec<u8>>> {
    let asked = TRANSFER_FIELDS.map(|word| format!("{word}?")).join(";");
    let before = client.ask(&format!(":DAT:{asked}"))?;
    let restore = restoring(&before)?;
    let records: Vec<String> =
        sources.iter().map(|source| format!(":DAT:SOU {source};:WAVF?")).collect();
    let records = records.join(";");
    let message = format!(
        ":DAT:{asked};ENC RIB;WID 1;STAR 1;STOP 2500;:HEAD ON;{records};:HEAD OFF;:DAT:{restore}"
    );
    let (found, records) = client.ask_for_records(&message)?;
    if found != before {
        // Another client changed the setting between the two messages.
        client.send(&format!(":DAT:{}", restoring(&found)?))?;
    }
    Ok(records)
}

/// The commands that set the transfer to what a query of it told.
fn restoring(told: &str) -> io::Result<String> {
    let values: Vec<&str> = told.split(';').collect();
    let is_word = |value: &&str| !value.is_empty() && value.chars().all(char::is_alphanumeric);
    if values.len() != TRANSFER_FIELDS.len() || !values.iter().all(is_word) {
        return Err(invalid_reply("a reply to DATa? that is no list of five words"));
    }
    let pairs = TRANSFER_FIELDS.iter().zip(values).map(|(word, value)| format!("{word} {value}"));
    Ok(pairs.collect::<Vec<_>>().join(";"))
}

/// The capture in a record, with what the front panel says of it.
///
/// # Errors
/// A message: no record, or one with another number of points than its preamble says.
pub fn capture(
    record: &[u8],
    panel: &SetFile,
    instrument: &InstrumentIdentity,
) -> Result<Capture, String> {
    let mut capture = isf::read(record, "record").map_err(|error| error.to_string())?;
    let points = capture.waveform.codes.len();
    if stated_points(record) != Some(points) {
        return Err(format!("found {points} points in a record whose NR_PT says otherwise"));
    }
    // What a file does not tell and has to be guessed, the front panel tells.
    capture.notes.clear();
    if let Source::Channel(number) = capture.waveform.source {
        capture.waveform.vertical.probe = panel.probe(number).unwrap_or(1.0);
    }
    panel.complete(&mut capture);
    capture.instrument = Some(instrument.clone());
    Ok(capture)
}

/// The number of points that a preamble states.
fn stated_points(record: &[u8]) -> Option<usize> {
    const KEY: &[u8] = b"NR_PT ";
    let at = record.windows(KEY.len()).position(|part| part.eq_ignore_ascii_case(KEY))?;
    let digits = record.get(at + KEY.len()..)?.split(|byte| !byte.is_ascii_digit()).next()?;
    std::str::from_utf8(digits).ok()?.parse().ok()
}
