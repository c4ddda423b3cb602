//! `serve --record`: what was said and what was triggered, however the server ends.

use std::path::Path;

use hertzscope::experiment::{Integration, facts};
use hertzscope::recording::mcap::{RecordingWriter, read};
use hertzscope::recording::{Direction, TraceSet};
use hertzscope::server::Options;

use super::{IDENTITY, Server, scene};

fn recorded(file: &Path) -> Server {
    let scene = scene();
    let known = facts::facts(&scene, Integration::Accuracy(scene.accuracy)).expect("stable");
    let writer = RecordingWriter::create(file, &known, &[facts::scene_attachment(&scene)]);
    Server::serving(scene, Options::default(), Some(writer.expect("writable")))
}

/// The levels of channel 1 as a client reads them after an impact.
fn shot(server: &Server) -> Vec<i16> {
    let mut client = server.connect();
    client.send(b"ACQ:STOPA SEQ;STATE ON;:BENC:IMP\n");
    assert_eq!(client.ask("*OPC?"), "1\n");
    let curve = client.ask("DATA:SOU CH1;ENC ASC;:CURVE?");
    curve.trim_end().split(',').map(|level| level.parse().expect("a level")).collect()
}

fn said(set: &TraceSet, direction: Direction) -> Vec<String> {
    let lines = set.lines.iter().filter(|line| line.direction == direction);
    lines.map(|line| String::from_utf8_lossy(&line.bytes).into_owned()).collect()
}

#[test]
fn a_session_is_written_down() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let server = recorded(&file);
    assert_eq!(server.connect().ask("*IDN?"), IDENTITY);
    let (first, second) = (shot(&server), shot(&server));
    assert_ne!(first, second, "another phase of the sample clock");
    drop(server);
    let set = read(&file).expect("a recording");
    assert_eq!(set.problems, [""; 0]);
    let levels = |index: usize| set.shots[index].captures[0].waveform.codes.clone();
    assert_eq!((set.shots.len(), levels(0), levels(1)), (2, first, second));
    let commands = said(&set, Direction::Command);
    let shot = ["ACQ:STOPA SEQ;STATE ON;:BENC:IMP", "*OPC?", "DATA:SOU CH1;ENC ASC;:CURVE?"];
    assert_eq!(commands, [["*IDN?"].as_slice(), &shot, &shot].concat());
    let replies = said(&set, Direction::Reply);
    assert_eq!(
        (replies.len(), &replies[0], &replies[1]),
        (5, &IDENTITY.to_owned(), &"1\n".to_owned())
    );
    assert!(set.lines.iter().all(|line| line.peer.starts_with("raw 127.0.0.1:")));
    assert!(set.lines.windows(2).all(|pair| pair[0].timestamp_ns <= pair[1].timestamp_ns));
    assert_eq!(set.log, ["shot 1: impact 1", "shot 2: impact 2"]);
}

/// A copy of the file while the server still writes is what a killed server leaves: its shots are in it.
#[test]
fn what_was_triggered_is_on_the_disk() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let server = recorded(&file);
    let levels = shot(&server);
    let set = read(&file).expect("an unfinished recording");
    assert_eq!(set.shots[0].captures[0].waveform.codes, levels);
    assert!(said(&set, Direction::Command).contains(&"*OPC?".to_owned()));
    assert_eq!(set.problems, ["the file has no end: it was not finished, or cut"]);
}
