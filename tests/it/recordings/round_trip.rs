//! What is written comes back, field by field.

use hertzscope::experiment::{self, Integration, facts};
use hertzscope::recording::mcap::{RecordingWriter, read as read_file};
use hertzscope::recording::{Direction, Origin, Shot, TraceSet};
use hertzscope::scene::Scene;
use hertzscope::scope::{Coupling, PointFormat, Source};

use super::{bytes_of, capture, line, notes, read, set, shot};

#[test]
fn a_set_comes_back_as_it_was() {
    let set = set(3);
    let back = read(&bytes_of(&set)).expect("a sound file");
    assert_eq!(back, set);
    // And again: what was read can be written without loss.
    assert_eq!(bytes_of(&back), bytes_of(&set));
}

#[test]
fn what_a_file_does_not_tell_stays_untold() {
    let mut untold = shot(1);
    untold.origin = Origin::Measured;
    untold.trigger_time = None;
    untold.truth.clear();
    for capture in &mut untold.captures {
        capture.instrument = None;
        capture.waveform.vertical.coupling = None;
        capture.waveform.vertical.bandwidth_limited = None;
        capture.waveform.vertical.inverted = None;
    }
    let set = TraceSet { shots: vec![untold.clone()], ..TraceSet::default() };
    let back = read(&bytes_of(&set)).expect("a sound file");
    assert_eq!(back.shots, [untold]);
    assert_eq!(back.problems, [""; 0]);
}

#[test]
fn every_source_coupling_format_and_width_comes_back() {
    let sources = [
        Source::Channel(1),
        Source::Channel(4),
        Source::Math,
        Source::Reference('A'),
        Source::Reference('D'),
    ];
    let couplings = [Some(Coupling::Dc), Some(Coupling::Ac), Some(Coupling::Ground), None];
    let mut one = shot(1);
    one.captures.clear();
    for (index, source) in sources.into_iter().enumerate() {
        let mut capture = capture(source, index % 2 == 1, 3);
        capture.waveform.vertical.coupling = couplings[index % couplings.len()];
        capture.waveform.vertical.inverted = [None, Some(false), Some(true)][index % 3];
        if index % 2 == 0 {
            capture.waveform.preamble.pt_fmt = PointFormat::Envelope;
        }
        capture.waveform.codes.extend([-128, 127]);
        if index % 2 == 1 {
            capture.waveform.codes.extend([i16::MIN, i16::MAX]);
            capture.waveform.as_read.extend([-1.5, 1.5, -800.25, 800.25]);
        }
        one.captures.push(capture);
    }
    let empty = &mut one.captures[2].waveform.codes;
    empty.clear();
    let set = TraceSet { shots: vec![one.clone()], ..TraceSet::default() };
    assert_eq!(read(&bytes_of(&set)).expect("a sound file").shots, [one]);
}

/// What a served session said stands between the shots and behind them, whatever bytes it was.
#[test]
fn a_session_without_shots_comes_back() {
    let every_byte: Vec<u8> = (0..=u8::MAX).collect();
    let lines = vec![
        line(5, Direction::Command, b""),
        line(5, Direction::Reply, &every_byte),
        line(u64::MAX / 4, Direction::Command, b"CH1:SCALE 1"),
    ];
    let session = TraceSet { lines, ..TraceSet::default() };
    assert_eq!(read(&bytes_of(&session)).expect("a sound file"), session);
    let mut after = set(1);
    after.lines.extend(session.lines);
    assert_eq!(read(&bytes_of(&after)).expect("a sound file"), after);
}

/// Shots come back in order of time, whatever order they were written in.
#[test]
fn shots_are_ordered_by_time() {
    let mut set = set(3);
    set.shots.reverse();
    let back = read(&bytes_of(&set)).expect("a sound file");
    let numbers: Vec<u32> = back.shots.iter().map(|shot| shot.number).collect();
    assert_eq!(numbers, [1, 2, 3]);
}

/// An import has lines but no shots' notes: they are not lost.
#[test]
fn lines_without_a_shot_are_kept() {
    let mut set = set(2);
    set.notes.clear();
    let back = read(&bytes_of(&set)).expect("a sound file");
    assert_eq!(back.log, set.log);
}

fn recording(scene: &Scene, shots: u32) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("run.mcap");
    // A loose accuracy: this is about bytes, not about physics.
    let integration = Integration::Accuracy(1e-3);
    let known = facts::facts(scene, integration).expect("stable");
    let attachments = facts::scene_attachments(scene);
    let mut writer = RecordingWriter::create(&file, &known, &attachments).expect("writable");
    for number in 1..=shots {
        let outcome = experiment::run(scene, integration, number, &mut |_| {}).expect("a run");
        writer.add(&outcome.shot, &facts::shot_notes(scene, &outcome)).expect("writable");
    }
    writer.finish().expect("writable");
    std::fs::read(&file).expect("what was written")
}

#[test]
fn the_same_seed_gives_the_same_bytes_and_another_seed_others() {
    let mut scene = Scene::load("magnet-0.61g").expect("it ships");
    let first = recording(&scene, 1);
    assert_eq!(recording(&scene, 1), first);
    scene.seed += 1;
    let other = recording(&scene, 1);
    assert_ne!(other, first);
    // The other seed reaches the screen, not only the note of the seed.
    let codes = |bytes: &[u8]| -> Vec<Vec<i16>> {
        let set = read(bytes).expect("a sound file");
        set.shots[0].captures.iter().map(|c| c.waveform.codes.clone()).collect()
    };
    assert_ne!(codes(&other), codes(&first));
    assert_eq!(codes(&first).len(), 4);
}

/// Nothing is finished, nothing is closed: what was triggered is on disk all the same.
#[test]
fn an_abort_loses_no_shot() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("aborted.mcap");
    let whole = set(3);
    let mut writer =
        RecordingWriter::create_live(&file, &whole.metadata, &whole.attachments).expect("writable");
    let so_far = read_file(&file).expect("facts before the first shot");
    assert_eq!(so_far.metadata, whole.metadata);
    assert_eq!(so_far.shots, [] as [Shot; 0]);
    for (index, shot) in whole.shots.iter().enumerate() {
        writer.add(shot, &notes(shot)).expect("writable");
        let so_far = read_file(&file).expect("an unfinished file");
        assert_eq!(so_far.shots, whole.shots[..=index]);
        assert_eq!(so_far.attachments, whole.attachments);
        assert_eq!(so_far.problems.len(), 1, "{:?}", so_far.problems);
        assert!(so_far.problems[0].contains("no end"), "{:?}", so_far.problems);
    }
    // As a process that is killed: no destructor runs.
    std::mem::forget(writer);
    let left = read_file(&file).expect("an unfinished file");
    assert_eq!((left.shots, left.notes, left.log), (whole.shots, whole.notes, whole.log));
}
