//! Recordings: what is written comes back, and what is damaged, unfinished or hostile does no harm.

mod damaged;
mod descriptors;
mod formats;
mod hostile;
mod round_trip;

use std::collections::BTreeMap;
use std::path::Path;

use hertzscope::recording::RecordingError;
use hertzscope::recording::mcap::message::{EnergyMessage, timestamp};
use hertzscope::recording::mcap::{ShotNotes, read_bytes, write};
use hertzscope::recording::{
    Attachment, Capture, Direction, InstrumentIdentity, Origin, ScpiLine, Shot, TraceSet,
};
use hertzscope::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use hertzscope::trace::Trace;

/// A capture of levels that follow a fixed, uneven pattern; those of 16 bits where `wide`.
fn capture(source: Source, wide: bool, seed: i32) -> Capture {
    let level = |i: i32| {
        let wave = (i * i + 7 * i * seed) % 251 - 125;
        i16::try_from(if wide { wave * 200 } else { wave }).expect("a level")
    };
    Capture {
        waveform: Waveform {
            source,
            codes: (0..500).map(level).collect(),
            as_read: if wide {
                (0..500).map(|i| f64::from(level(i)) / 24.9).collect()
            } else {
                Vec::new()
            },
            preamble: Preamble {
                x_zero: -1.25e-4,
                x_incr: 1e-7,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult: 0.04,
                y_zero: 0.1,
                y_off: -50.0,
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale: 1.0,
                position: -2.0,
                coupling: Some(Coupling::Ac),
                bandwidth_limited: Some(true),
                inverted: Some(false),
                probe: 10.0,
            },
            horizontal_scale: 2.5e-4,
            trigger_point: 1250.0,
        },
        instrument: Some(InstrumentIdentity {
            model: "TDS2014".to_owned(),
            serial: "0".to_owned(),
            firmware: "FV:v4.12".to_owned(),
        }),
        notes: vec!["a note".to_owned()],
    }
}

fn trace(name: &str, unit: &str, seed: u32) -> Trace {
    let value = |i: u32| f64::from(i * seed % 97) / 3.0;
    Trace {
        name: name.to_owned(),
        unit: unit.to_owned(),
        start: -1e-3,
        interval: 1e-5,
        values: (0..100).map(value).collect(),
    }
}

fn shot(number: u32) -> Shot {
    let seed = i32::try_from(number).expect("a small number");
    Shot {
        number,
        origin: Origin::Simulated,
        timestamp_ns: 1_700_000_000_123_456_789 + u64::from(number),
        captures: vec![
            capture(Source::Channel(1), false, seed),
            capture(Source::Channel(2), true, seed),
        ],
        truth: vec![
            trace("sensor/p2: force inside particle 2", "N", number + 1),
            trace("bead/0: displacement of body 0", "m", number + 2),
        ],
        trigger_time: Some(1.25e-5 * f64::from(number)),
    }
}

fn notes(shot: &Shot) -> ShotNotes {
    ShotNotes {
        set_up: format!(":CH1:SCALE {}.0E0", shot.number),
        energy: Some(EnergyMessage {
            timestamp: Some(timestamp(shot.timestamp_ns)),
            shot: shot.number,
            initial_j: 3e-4,
            final_j: 2.9e-4,
            dissipated_j: 1e-5,
            drift: -4e-8,
            kinetic_j: 1e-4,
            elastic_j: 2e-4,
            gravity_j: -3e-6,
            magnet_j: -7e-6,
            end_forces_j: -1e-6,
            dashpot_j: 6e-6,
            kuwabara_kono_j: 3e-6,
            power_law_loss_j: 0.5e-6,
            left_in_contacts_j: 0.5e-6,
            plasticity_j: 2e-6,
            top_wall_j: 1e-6,
            bottom_wall_j: 3e-6,
            work_of_drive_j: 4e-6,
        }),
        log: vec![
            (false, format!("shot {} is done", shot.number)),
            (true, "CH2 may be clipped".to_owned()),
        ],
    }
}

fn facts(pairs: &[(&str, &str)]) -> BTreeMap<String, String> {
    pairs.iter().map(|(key, value)| ((*key).to_owned(), (*value).to_owned())).collect()
}

/// A set as reading gives it: its lines stand with their shots and in the log.
fn set(shots: u32) -> TraceSet {
    let shots: Vec<Shot> = (1..=shots).map(shot).collect();
    let notes: BTreeMap<u32, ShotNotes> = shots.iter().map(|s| (s.number, notes(s))).collect();
    TraceSet {
        log: notes.values().flat_map(|n| n.log.iter().map(|(_, line)| line.clone())).collect(),
        shots,
        metadata: BTreeMap::from([
            ("hertzscope:recording".to_owned(), facts(&[("scene", "made up"), ("seed", "1")])),
            ("hertzscope:scope".to_owned(), facts(&[("model", "TDS 2014"), ("µ", "°")])),
        ]),
        attachments: vec![Attachment {
            name: "made-up.toml".to_owned(),
            media_type: "application/toml".to_owned(),
            data: b"title = \"x\"\n".to_vec(),
        }],
        lines: vec![
            line(500, Direction::Command, b"CURVE?"),
            line(600, Direction::Reply, b"#42\x00\xff\n"),
        ],
        notes,
        problems: Vec::new(),
    }
}

fn line(timestamp_ns: u64, direction: Direction, bytes: &[u8]) -> ScpiLine {
    ScpiLine { timestamp_ns, peer: "raw 127.0.0.1:1".to_owned(), direction, bytes: bytes.to_vec() }
}

fn bytes_of(set: &TraceSet) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("set.mcap");
    write(&file, set).expect("a writable folder");
    std::fs::read(&file).expect("what was written")
}

fn read(bytes: &[u8]) -> Result<TraceSet, RecordingError> {
    read_bytes(bytes, Path::new("test.mcap"))
}
