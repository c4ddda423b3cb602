//! Recordings that are read as they are looked at: finished, cut, growing; and going through them.

use std::io::Write as _;
use std::path::Path;
use std::time::Duration;

use super::bench::{after, channel, draw, model, recording, shot};
use hertzscope::recording::mcap::{self, RecordingWriter, ShotNotes};
use hertzscope::recording::mcap::{IndexedRecording, ReadState};
use hertzscope::recording::{Direction, ScpiLine, Shot, TraceSet};
use hertzscope::trace::Trace;
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::job::Queue;
use hertzscope::tui::model::{Action, Palette, Request, ScreenState, update};
use hertzscope::tui::pages;
use hertzscope::tui::work::{ScreenEvent, Workers};
use ratatui::layout::Size;
use ratatui::style::Color;

/// Shots that differ in their volts.
fn shots(count: u32) -> Vec<Shot> {
    let volts = |number: u32| f64::from(number) * 0.1;
    (1..=count)
        .map(|number| {
            let mut shot = shot(number, vec![channel(1, 0.5, 0.0, |_| volts(number))]);
            shot.timestamp_ns = u64::from(number) * 1_000_000_000;
            shot
        })
        .collect()
}

fn write(file: &Path, count: u32) -> TraceSet {
    let set = TraceSet { shots: shots(count), ..TraceSet::default() };
    mcap::write(file, &set).expect("a recording");
    set
}

fn read_to_end(tape: &mut IndexedRecording) -> ReadState {
    loop {
        match tape.read_on().expect("a readable file") {
            ReadState::More => {}
            end => return end,
        }
    }
}

#[test]
fn a_tape_holds_what_reading_all_of_it_finds() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    write(&file, 5);
    let whole = mcap::read(&file).expect("a recording");
    let mut tape = IndexedRecording::open(&file).expect("a tape");
    assert_eq!(read_to_end(&mut tape), ReadState::Finished);
    assert_eq!(tape.shots(), 5);
    // In any order.
    for place in [4, 0, 2, 1, 3] {
        assert_eq!(
            tape.shot_and_notes(place).expect("readable").map(|(shot, _)| shot).as_ref(),
            whole.shots.get(place)
        );
    }
    assert_eq!(tape.shot_and_notes(5).expect("readable").map(|(shot, _)| shot), None);
    let facts = tape.facts();
    assert_eq!((facts.metadata, facts.attachments), (whole.metadata, whole.attachments));
    assert_eq!((facts.log, facts.problems), (whole.log, whole.problems));
}

#[test]
fn a_shipped_recording_with_truth_is_read_shot_by_shot_alike() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("recordings/gravity-0.61g.mcap");
    let whole = mcap::read(&file).expect("a recording");
    let mut tape = IndexedRecording::open(&file).expect("a tape");
    assert_eq!(read_to_end(&mut tape), ReadState::Finished);
    assert_eq!(
        tape.shot_and_notes(0).expect("readable").map(|(shot, _)| shot).as_ref(),
        whole.shots.first()
    );
}

#[test]
fn a_growing_tape_gets_each_shot_once_it_is_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let none = std::collections::BTreeMap::new();
    let mut writer = RecordingWriter::create_live(&file, &none, &[]).expect("a recording");
    let mut tape = IndexedRecording::open(&file).expect("a tape");
    assert_eq!(read_to_end(&mut tape), ReadState::Open);
    for (number, shot) in (1..).zip(&shots(3)) {
        writer.add(shot, &ShotNotes::default()).expect("written");
        assert_eq!(read_to_end(&mut tape), ReadState::Open);
        assert_eq!(tape.shots(), number);
        assert_eq!(
            tape.shot_and_notes(number - 1).expect("readable").map(|(shot, _)| shot).as_ref(),
            Some(shot)
        );
    }
    writer.finish().expect("finished");
    assert_eq!(read_to_end(&mut tape), ReadState::Finished);
    assert_eq!(tape.shots(), 3);
}

/// Whatever byte the file is cut at: no panic, and every shot before the cut.
#[test]
fn a_tape_cut_anywhere_keeps_what_is_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let set = write(&file, 3);
    let bytes = std::fs::read(&file).expect("bytes");
    let cut = folder.path().join("cut.mcap");
    let mut most = 0;
    for length in (8..bytes.len()).step_by(97) {
        std::fs::File::create(&cut).expect("a file").write_all(&bytes[..length]).expect("bytes");
        let mut tape = IndexedRecording::open(&cut).expect("a tape");
        read_to_end(&mut tape);
        assert!(tape.shots() >= most, "fewer shots from a longer file");
        most = tape.shots();
        for place in 0..most {
            assert_eq!(
                tape.shot_and_notes(place).expect("readable").map(|(shot, _)| shot).as_ref(),
                set.shots.get(place)
            );
        }
    }
    assert_eq!(most, 3);
}

#[test]
fn what_is_no_recording_is_no_tape() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    std::fs::write(&file, "Record Length,2500").expect("a file");
    let error = IndexedRecording::open(&file).err().expect("an error").to_string();
    assert!(error.contains("Record L") && error.contains("MCAP"), "{error}");
}

/// A model on a tape of three shots, with the first on screen.
fn on_tape(follow: bool) -> ScreenState {
    let mut model = ScreenState::new(TraceSet::default(), "lab".to_owned(), Palette::Colour);
    model.open_partial_recording(follow);
    model.apply_index(3, true, TraceSet::default());
    deliver(&mut model);
    model
}

/// Brings the shot that was asked for.
fn deliver(model: &mut ScreenState) -> Vec<usize> {
    let mut places = Vec::new();
    for request in model.take_requests() {
        let Request::Load(place) = request else { panic!("{request:?}") };
        model.apply_shot(place, shots(9).swap_remove(place));
        places.push(place);
    }
    places
}

fn number(model: &ScreenState) -> u32 {
    model.shot().expect("a shot").number
}

#[test]
fn a_shot_is_read_when_it_is_looked_at() {
    let mut model = on_tape(false);
    assert_eq!(number(&model), 1);
    for (action, place) in [
        (Action::Shot(TurnDirection::Up), 1),
        (Action::Ends(TurnDirection::Up), 2),
        (Action::Ends(TurnDirection::Down), 0),
    ] {
        update(&mut model, action);
        assert_eq!(deliver(&mut model), [place], "{action:?}");
    }
    // Of many steps only the last is read.
    update(&mut model, Action::Shot(TurnDirection::Up));
    update(&mut model, Action::Shot(TurnDirection::Up));
    assert_eq!(deliver(&mut model), [2]);
    assert_eq!(number(&model), 3);
}

#[test]
fn followed_the_newest_shot_is_shown_and_else_the_one_that_was() {
    let mut followed = on_tape(true);
    followed.apply_index(5, true, TraceSet::default());
    assert_eq!(deliver(&mut followed), [4]);
    let mut left_alone = on_tape(false);
    left_alone.apply_index(5, true, TraceSet::default());
    assert!(deliver(&mut left_alone).is_empty());
    assert_eq!((left_alone.shots(), number(&left_alone)), (5, 1));
}

#[test]
fn a_step_back_ends_following_until_the_last_shot_is_shown_again() {
    let mut model = on_tape(true);
    update(&mut model, Action::Shot(TurnDirection::Down));
    deliver(&mut model);
    assert!(
        model.notice.as_deref().is_some_and(|notice| notice.contains("End")),
        "{:?}",
        model.notice.as_deref()
    );
    let there = number(&model);
    model.apply_index(5, true, TraceSet::default());
    assert!(deliver(&mut model).is_empty(), "the newest shot is not shown");
    assert_eq!(number(&model), there);
    update(&mut model, Action::Ends(TurnDirection::Up));
    deliver(&mut model);
    model.apply_index(6, true, TraceSet::default());
    assert_eq!(deliver(&mut model), [5]);
}

#[test]
fn playing_shows_a_shot_a_second_at_speed_one_and_stops_at_the_end() {
    let flat = || vec![channel(1, 0.5, 0.0, |_| 0.0)];
    let model = model(recording(vec![flat(), flat(), flat()]));
    let mut model = after(model, &[Action::RunStop]);
    let seconds = |model: &mut ScreenState, count: usize| {
        for _ in 0..10 * count {
            update(model, Action::Tick(0.1001));
        }
    };
    seconds(&mut model, 1);
    assert_eq!(number(&model), 2);
    update(&mut model, Action::Speed(TurnDirection::Up));
    update(&mut model, Action::Speed(TurnDirection::Down));
    update(&mut model, Action::Speed(TurnDirection::Down));
    // At half the speed the third takes two seconds.
    seconds(&mut model, 1);
    assert_eq!(number(&model), 2);
    seconds(&mut model, 1);
    assert_eq!(number(&model), 3);
    assert!(model.is_playing());
    seconds(&mut model, 2);
    assert!(!model.is_playing());
    assert_eq!(number(&model), 3);
}

/// `--against` on a recording asked before there was a shot, and the question was lost.
#[test]
fn a_comparison_waits_for_the_first_shot() {
    let mut model = ScreenState::new(TraceSet::default(), "lab".to_owned(), Palette::Colour);
    model.open_partial_recording(false);
    model.compare_with("magnet-0.61g".to_owned());
    assert!(model.take_requests().is_empty());
    model.apply_index(3, true, TraceSet::default());
    assert!(matches!(model.take_requests().as_slice(), [Request::Load(0)]));
    model.apply_shot(0, shots(1).remove(0));
    let requests = model.take_requests();
    assert!(matches!(requests.as_slice(), [Request::Job(job)] if job.queue == Queue::Comparison));
}

fn flat(volts: f64, scale: f64) -> Vec<hertzscope::recording::Capture> {
    vec![channel(1, scale, 0.0, move |_| volts)]
}

/// The recordings behind stand on the axes of the one in front, whatever they were recorded with;
/// each keeps its shot.
#[test]
fn several_recordings_are_shown_on_the_same_axes() {
    let mut model = model(recording(vec![flat(1.0, 0.5)]));
    model.add_behind("yesterday".to_owned(), recording(vec![flat(-1.0, 1.0), flat(2.0, 1.0)]));
    let screen = draw(&model, 80, 24);
    // At 500 mV/div a volt is two divisions of two rows; the centre is row 10.
    assert_eq!(screen.rows_of(20, Color::Yellow), [6, 14]);
    assert!(screen.row(0).starts_with("steel chain  ┄ yesterday 1/2"), "{}", screen.row(0));
    let model = after(model, &[Action::NextRecording, Action::Shot(TurnDirection::Up)]);
    let screen = draw(&model, 80, 24);
    // At 1 V/div: two volts of the second shot in front, one volt of the other behind.
    assert_eq!(screen.rows_of(20, Color::Yellow), [6, 8]);
    assert!(screen.row(0).starts_with("yesterday  ┄ steel chain 1/1"), "{}", screen.row(0));
    assert!(screen.row(0).contains("Shot 2/2"), "{}", screen.row(0));
    let model = after(model, &[Action::NextRecording]);
    assert!(draw(&model, 80, 24).row(0).starts_with("steel chain  ┄ yesterday 2/2"));
    // A channel that is off is off behind, too.
    let off = draw(&after(model, &[Action::Channel(1)]), 80, 24);
    assert!(off.rows_of(20, Color::Yellow).is_empty());
}

/// What comes of a followed recording reaches it while another one is in front.
#[test]
fn a_recording_is_followed_behind_another() {
    let mut model = on_tape(true);
    model.add_behind("yesterday".to_owned(), recording(vec![flat(1.0, 0.5)]));
    update(&mut model, Action::NextRecording);
    assert_eq!((model.shots(), number(&model)), (1, 1));
    ScreenEvent::Read(5, true, Box::default()).apply(&mut model);
    assert!(matches!(model.take_requests().as_slice(), [Request::Load(4)]));
    let shot = Box::new((shots(5).swap_remove(4), ShotNotes::default(), Vec::new()));
    ScreenEvent::Shot(4, shot).apply(&mut model);
    assert_eq!((model.shots(), number(&model)), (1, 1));
    update(&mut model, Action::NextRecording);
    assert_eq!((model.shots(), number(&model)), (5, 5));
}

/// The messages between the neighbouring shots, from the file as from memory.
#[test]
fn remote_commands_are_listed_around_their_shot() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let none = std::collections::BTreeMap::new();
    let mut writer = RecordingWriter::create_live(&file, &none, &[]).expect("a recording");
    let line = |seconds: f64, direction, bytes: &[u8]| ScpiLine {
        timestamp_ns: (seconds * 1e9) as u64,
        peer: "raw 127.0.0.1:40001".to_owned(),
        direction,
        bytes: bytes.to_vec(),
    };
    // Before each shot a set-up, behind it the curve.
    for shot in &shots(3) {
        let number = f64::from(shot.number);
        let set_up = format!("CH1:SCA {number}");
        let (command, reply) = (Direction::Command, Direction::Reply);
        writer.add_line(&line(number - 0.5, command, set_up.as_bytes())).expect("written");
        writer.add(shot, &ShotNotes::default()).expect("written");
        writer.add_line(&line(number + 0.25, command, b"CURV?")).expect("written");
        writer.add_line(&line(number + 0.375, reply, b"#42500222\n")).expect("written");
        writer.flush().expect("written");
    }
    writer.finish().expect("finished");
    let whole = mcap::read(&file).expect("a recording");
    let step = [Action::Page(pages::remote::PAGE), Action::Shot(TurnDirection::Up)];
    let kept = whole.lines.clone();
    let in_memory = after(model(whole), &step);
    let mut tape = IndexedRecording::open(&file).expect("a tape");
    read_to_end(&mut tape);
    let read = tape.lines_around(1).expect("readable");
    // From behind the first shot to before the third: all but its own command and the last curve.
    assert_eq!(read.as_slice(), kept.get(1..7).expect("lines"));
    let screen = draw(&in_memory, 80, 24);
    // Of the shot before the curve, then this shot's own set-up and curve, and the next set-up.
    let rows: Vec<String> = (2..9).map(|y| screen.row(y).trim_end().to_owned()).collect();
    let expected = [
        "    -0.750 s > CURV?",
        "    -0.625 s < #42500… 10 bytes in all",
        "    -0.500 s > CH1:SCA 2",
        "         0 s ─── shot 2 ───",
        "    +0.250 s > CURV?",
        "    +0.375 s < #42500… 10 bytes in all",
        "    +0.500 s > CH1:SCA 3",
    ];
    assert_eq!(rows, expected);
    // The shot is selected; the next row stands below with its time of the day.
    let next = after(in_memory, &[Action::Scroll(TurnDirection::Down, 1)]);
    draw(&next, 80, 24).find("00:00:02.250 UTC, raw 127.0.0.1:40001: CURV?");
}

/// The first half of a shot is in the file and on the screen when the rest is written.
#[test]
fn a_followed_shot_is_shown_whole_in_the_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let (whole, grown) = (folder.path().join("whole.mcap"), folder.path().join("lab.mcap"));
    let mut shot = shots(1).remove(0);
    // Noise, which does not compress: longer than a chunk, so that the truth stands in chunks of
    // its own.
    let mut random = 1_u64;
    let mut noise = || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (random >> 11) as f64
    };
    shot.truth = (1..=4)
        .map(|contact| Trace {
            name: format!("contact/{contact}"),
            unit: "N".to_owned(),
            start: 0.0,
            interval: 1e-6,
            values: (0..40_000).map(|_| noise()).collect(),
        })
        .collect();
    let set = TraceSet { shots: vec![shot.clone()], ..TraceSet::default() };
    mcap::write(&whole, &set).expect("a recording");
    let bytes = std::fs::read(&whole).expect("a recording");
    let (first, rest) = bytes.split_at(bytes.len() / 2);
    std::fs::write(&grown, first).expect("half a recording");

    let mut model = ScreenState::new(TraceSet::default(), "lab".to_owned(), Palette::Colour);
    model.open_partial_recording(true);
    let (staff, news) = Workers::start(Some(IndexedRecording::open(&grown).expect("a tape")), true);
    let mut wait_for = |wanted: &dyn Fn(&Shot) -> bool| {
        while !model.shot().is_some_and(wanted) {
            let came = news.recv_timeout(Duration::from_secs(60)).expect("news");
            came.apply(&mut model);
            staff.serve(&mut model, Size { width: 80, height: 24 });
        }
    };
    wait_for(&|half| half.captures == shot.captures && half.truth.len() < 4);
    let mut file = std::fs::OpenOptions::new().append(true).open(&grown).expect("the file");
    file.write_all(rest).expect("the rest");
    wait_for(&|seen| seen.truth.len() == 4);
    let read = mcap::read(&whole).expect("a recording");
    assert_eq!(model.shot(), read.shots.first());
}

/// An hour of polling: commands and replies are counted, not kept, and of the log the last lines
/// are.
#[test]
fn a_long_session_is_followed_in_little_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("lab.mcap");
    let none = std::collections::BTreeMap::new();
    let mut writer = RecordingWriter::create_live(&file, &none, &[]).expect("a recording");
    let mut tape = IndexedRecording::open(&file).expect("a tape");
    let line = |number: u64, direction| ScpiLine {
        timestamp_ns: number,
        peer: format!("raw 127.0.0.1:{}", 40_000 + number % 7),
        direction,
        bytes: b"MEASU:IMM:VAL?".to_vec(),
    };
    for (number, shot) in (0..).zip(&shots(5)) {
        for poll in 0..20_000 {
            writer.add_line(&line(poll, Direction::Command)).expect("written");
            writer.add_line(&line(poll, Direction::Reply)).expect("written");
        }
        let log = (0..1000).map(|line| (false, format!("line {line}"))).collect();
        writer.add(shot, &ShotNotes { log, ..ShotNotes::default() }).expect("written");
        assert_eq!(read_to_end(&mut tape), ReadState::Open);
        let facts = tape.facts();
        assert_eq!((facts.lines.len(), facts.notes.len()), (0, 0));
        assert!(facts.log.len() < 2000, "{} lines", facts.log.len());
        assert_eq!(tape.traffic().commands, 20_000 * (number + 1));
        assert_eq!(tape.traffic().peers.len(), 7);
        let (found, notes) = tape.shot_and_notes(number).expect("readable").expect("a shot");
        assert_eq!((&found, notes.log.len()), (shot, 1000), "they are there when the shot is read");
    }
    writer.finish().expect("finished");
}

/// A new shot of a followed recording, which is behind, leaves what is chosen in the one in front
/// as it is: the selected trace, the time of the moving chain, the page, the row.
#[test]
fn a_shot_behind_changes_nothing_in_front() {
    let mut model = on_tape(true);
    let four = (1..=4).map(|number| channel(number, 0.5, 0.0, |_| 0.1)).collect();
    let mut front = shot(1, four);
    let force: Vec<f64> = (0..100).map(f64::from).collect();
    front.truth = vec![Trace {
        name: "contact/1: force in contact 1".to_owned(),
        unit: "N".to_owned(),
        start: 0.0,
        interval: 1e-5,
        values: force,
    }];
    let set = TraceSet { shots: vec![front], ..TraceSet::default() };
    model.add_behind("yesterday".to_owned(), set);
    let bench = Action::Page(pages::bench::PAGE);
    let forward = Action::Shot(TurnDirection::Up);
    let mut model = after(
        model,
        &[Action::NextRecording, Action::Channel(4), bench, forward, forward, forward],
    );
    let time = model.play.bench_time;
    ScreenEvent::Read(5, true, Box::default()).apply(&mut model);
    let new = Box::new((shots(5).swap_remove(4), ShotNotes::default(), Vec::new()));
    ScreenEvent::Shot(4, new).apply(&mut model);
    assert!(model.is_selected(hertzscope::scope::Source::Channel(4)));
    assert_eq!((model.play.bench_time, model.page), (time, Some(pages::bench::PAGE)));
    assert!(time > 0.0, "the chain has moved");
    // It is there when its recording comes to the front.
    let model = after(model, &[Action::NextRecording]);
    assert_eq!((model.shots(), number(&model)), (5, 5));
}
