//! A recording of what a scope took, which others can read while it grows.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use super::acquisition::AcquiredShot;
use super::address::Address;
use crate::recording::mcap::{RecordingWriter, ShotNotes, WriteError};
use crate::recording::{InstrumentIdentity, Shot, TraceSet};

/// Facts by group.
type Facts = BTreeMap<String, BTreeMap<String, String>>;

/// A recording that is being written.
pub struct ShotRecorder(RecordingWriter);

impl ShotRecorder {
    /// Begins the recording `file` or, if that exists, one with the next free number.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written.
    pub fn create(
        file: &Path,
        address: &Address,
        instrument: &InstrumentIdentity,
    ) -> Result<Self, WriteError> {
        RecordingWriter::create_live(file, &facts(address, instrument), &[]).map(Self)
    }

    /// The file's name.
    pub fn file(&self) -> &Path {
        self.0.file()
    }

    /// Adds a shot; when this returns, the file has it.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written.
    pub fn add(&mut self, shot: &Shot, notes: &ShotNotes) -> Result<(), WriteError> {
        self.0.add(shot, notes)
    }

    /// Ends the recording, and waits until the disk has it.
    ///
    /// # Errors
    /// [`WriteError`] where the file cannot be written.
    pub fn finish(self) -> Result<PathBuf, WriteError> {
        self.0.finish()
    }
}

/// What holds for all shots.
fn facts(address: &Address, instrument: &InstrumentIdentity) -> Facts {
    let group = |pairs: &[(&str, &str)]| {
        pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
    };
    let recording = [
        ("version", env!("CARGO_PKG_VERSION")),
        ("address", &address.to_string()),
        ("time_base", "of shots: nanoseconds since 1970; of records: seconds after the trigger"),
    ];
    let scope = [
        ("model", instrument.model.as_str()),
        ("serial", &instrument.serial),
        ("firmware", &instrument.firmware),
    ];
    Facts::from([
        ("hertzscope:recording".to_owned(), group(&recording)),
        ("hertzscope:scope".to_owned(), group(&scope)),
    ])
}

impl AcquiredShot {
    /// The shot as the recording's `number`th, and what is kept beside it.
    pub fn numbered(self, number: u32, address: &Address) -> (Shot, ShotNotes) {
        let late = self.late.as_secs_f64();
        let line = format!(
            "shot {number}: read from {address}; the trigger came up to {late:.2} s before the time of this shot"
        );
        let notes = ShotNotes { set_up: self.set_up, energy: None, log: vec![(false, line)] };
        let shot = Shot {
            number,
            origin: crate::recording::Origin::Measured,
            timestamp_ns: self.timestamp_ns,
            captures: self.captures,
            truth: Vec::new(),
            trigger_time: None,
        };
        (shot, notes)
    }

    /// A recording in memory of this shot alone.
    pub fn into_set(self, address: &Address, instrument: &InstrumentIdentity) -> TraceSet {
        let (shot, notes) = self.numbered(1, address);
        TraceSet {
            log: notes.log.iter().map(|(_, line)| line.clone()).collect(),
            notes: BTreeMap::from([(1, notes)]),
            metadata: facts(address, instrument),
            shots: vec![shot],
            ..TraceSet::default()
        }
    }
}
