//! `serve --record`: what was said and what was triggered, however the server ends.

use std::path::Path;
use std::process::Command;

use hertzscope::experiment::{Integration, facts, run};
use hertzscope::measurement::metadata;
use hertzscope::recording::mcap::{RecordingWriter, read};
use hertzscope::recording::{Direction, TraceSet, tek_csv};
use hertzscope::scene::Scene;
use hertzscope::server::ServerOptions;

use super::process::Process;
use super::{Client, IDENTITY, Server, connect, scene};

fn recorded(file: &Path) -> Server {
    let scene = scene();
    let known = facts::facts(&scene, Integration::Accuracy(scene.accuracy)).expect("stable");
    let writer = RecordingWriter::create_live(file, &known, &facts::scene_attachments(&scene));
    Server::serving(scene, ServerOptions::default(), Some(writer.expect("writable")))
}

/// The levels of channel 1 as a client reads them after an impact.
fn shot(server: &Server) -> Vec<i16> {
    strike(server.connect())
}

fn strike(mut client: Client) -> Vec<i16> {
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
    let log = ["shot 1: impact 1 on magnet-0.61g", "shot 2: impact 2 on magnet-0.61g"];
    assert_eq!(set.log, log);
}

/// A copy of the file while the server still writes is what a killed server leaves: its shots are
/// in it.
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

/// Trigger and truth of a served shot are those of the scene's own shot of the same number.
#[test]
fn the_truth_behind_a_served_shot_is_kept() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let server = recorded(&file);
    shot(&server);
    drop(server);
    let set = read(&file).expect("a recording");
    let scene = scene();
    let own = run(&scene, Integration::Accuracy(1e-3), 1, &mut |_| ()).expect("a run").shot;
    let served = &set.shots[0];
    let late = served.trigger_time.expect("a trigger") - own.trigger_time.expect("a trigger");
    assert!(late.abs() < 1e-12, "{late} s");
    let names = |shot: &hertzscope::recording::Shot| -> Vec<String> {
        let topic = |name: &str| name.split(": ").next().unwrap_or_default().to_owned();
        let mut names: Vec<String> = shot.truth.iter().map(|trace| topic(&trace.name)).collect();
        names.sort();
        names
    };
    assert_eq!(names(served), names(&own));
    for trace in own.truth.iter().filter(|trace| trace.name.starts_with("sensor/")) {
        let kept = served.truth.iter().find(|kept| kept.name == trace.name).expect("the sensor");
        assert_eq!((kept.start, kept.interval), (trace.start, trace.interval), "{}", trace.name);
        // Behind the duration the two go on for different times, in steps of their own.
        let within = |n: &u32| trace.start + f64::from(*n) * trace.interval < scene.duration;
        let length = (0..10_000).take_while(within).count();
        assert!(length > 1000);
        assert!(kept.values[..length] == trace.values[..length], "{}", trace.name);
    }
}

/// A shot of another bench than the one that is served carries that one: its scene with what was
/// turned of it, its sensors, and the front panel as it was set. The shots around it are the served
/// one's.
#[test]
fn a_shot_tells_its_own_bench() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let server = recorded(&file);
    let said = |settings: &str| {
        let mut client = server.connect();
        client.send(format!("{settings}\n").as_bytes());
        strike(client)
    };
    said("CH1:SCA 1");
    said(
        ":BENC:SCEN gravity-2.75g;:BENC:STRI:SPE 0.3;:BENC:CH1:FIN ON;:CH1:SCA 1.59;:ACQ:MOD PEAK",
    );
    said(":BENC:SCEN gravity-2.75g;:CH1:SCA 1;:ACQ:MOD SAM");
    said(":BENC:SCEN magnet-0.61g;:BENC:MAGN:FORC 1.19");
    said(":BENC:MAGN:FORC 2.38");
    drop(server);
    let set = read(&file).expect("a recording");
    assert_eq!((set.problems.len(), set.shots.len()), (0, 5));
    let scenes: Vec<_> = (1..=5)
        .map(|shot| metadata::scene_of(&set, shot).expect("a scene").expect("a sound one"))
        .collect();
    let names: Vec<&str> = scenes.iter().map(|scene| scene.name.as_str()).collect();
    let (served, other) = ("magnet-0.61g", "gravity-2.75g");
    assert_eq!(names, [served, other, other, served, served]);
    let speeds: Vec<_> = scenes.iter().map(Scene::striker_speed).collect();
    let own = |name: &str| Scene::load(name).expect("it ships").striker_speed();
    assert_eq!(speeds, [own(served), Some(0.3), own(other), own(served), own(served)]);
    let force = |scene: &Scene| scene.chain.magnet().map(|magnet| magnet.force);
    let forces: Vec<_> = scenes.iter().map(force).collect();
    assert_eq!(forces[1..], [None, None, Some(1.19), force(&scene())]);
    let mut attached: Vec<&str> = set.attachments.iter().map(|a| a.name.as_str()).collect();
    attached.sort_unstable();
    assert_eq!(attached, ["gravity-2.75g.toml", "magnet-0.61g.toml"]);
    for (shot, own) in [(1, false), (2, true), (3, true), (4, true), (5, false)] {
        assert_eq!(set.metadata.contains_key(&format!("hertzscope:shot/{shot}")), own, "{shot}");
        let sensors = metadata::sensors_of(&set, shot);
        assert_eq!(sensors.len(), scenes[shot as usize - 1].sensors.len(), "{shot}");
        assert!(sensors.iter().all(|sensor| sensor.sensitivity.is_some()), "{shot}");
    }
    let log = "shot 2: impact 2 on gravity-2.75g";
    assert_eq!(set.log[1], log);
    // The truth of a shot is that of its scene: the run of the same scene and number has the same
    // force at particle 2.
    let accuracy = Integration::Accuracy(scenes[1].accuracy);
    let run = run(&scenes[1], accuracy, 2, &mut |_| ()).expect("a run").shot;
    let force = |shot: &hertzscope::recording::Shot| {
        let trace = shot.truth.iter().find(|trace| trace.name.starts_with("sensor/p2:"));
        let trace = trace.expect("particle 2");
        let within = (0..).take_while(|n| trace.start + f64::from(*n) * trace.interval < 1e-3);
        within.zip(&trace.values).map(|(_, force)| *force).fold(0.0_f64, f64::max)
    };
    let (here, there) = (force(&set.shots[1]), force(&run));
    assert!((here / there - 1.0).abs() < 1e-3, "{here} N, {there} N");
    let panel = &set.notes[&2].set_up;
    assert!(
        panel.contains(":CH1:PROBE 1;SCALE 1.59E0") && panel.contains("MODE PEAKDETECT"),
        "{panel}"
    );
    // What `convert` saves beside the curves is the front panel of that shot.
    let target = folder.path().join("files");
    let mut convert = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    let done = convert.arg("convert").arg(&file).arg(&target).output().expect("a program");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let saved = |name: &str| std::fs::read_to_string(target.join(name)).expect("a file");
    assert!(saved("ALL0001/F0001TEK.SET").contains(":CH1:PROBE 1;SCALE 1.59E0"));
    assert!(saved("ALL0002/F0002TEK.SET").contains(":CH1:PROBE 1;SCALE 1.0E0"));
    assert!(saved("ALL0001/F0001CH1.CSV").contains("Vertical Scale,1.590000e+00"));
}

/// What the scope displays beside its channels is saved with them: the spectrum as 1024 bins in dB,
/// the reference as the levels it was copied from. The files are the ones that the readers take.
#[test]
fn spectrum_and_reference_are_saved_beside_the_channels() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let server = recorded(&file);
    let first = shot(&server);
    let mut client = server.connect();
    client
        .send(b"SAVE:WAVE CH1,REFA;:SEL:REFA ON;:MATH:DEFINE \"FFT(CH2,HANNING)\";:SEL:MATH ON\n");
    let second = strike(client);
    let mut client = server.connect();
    let spectrum = client.ask("DATA:SOU MATH;STAR 1;STOP 2500;:CURVE?");
    drop(server);
    let set = read(&file).expect("a recording");
    let names = |shot: usize| -> Vec<String> {
        set.shots[shot].captures.iter().map(|c| c.waveform.source.to_string()).collect()
    };
    assert_eq!(names(0), ["CH1", "CH2", "CH3", "CH4"]);
    assert_eq!(names(1), ["CH1", "CH2", "CH3", "CH4", "MATH", "REFA"]);
    let target = folder.path().join("files");
    let mut convert = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    let done = convert.arg("convert").arg(&file).arg(&target).output().expect("a program");
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let saved = |name: &str| {
        let bytes = std::fs::read(target.join("ALL0001").join(name)).expect("a file");
        let capture = tek_csv::read(&bytes, name).expect("a native file");
        assert_eq!(tek_csv::write(&capture).expect("the same").into_bytes(), bytes, "{name}");
        capture.waveform
    };
    assert_eq!((saved("F0001RFA.CSV").codes, saved("F0001CH1.CSV").codes), (first, second));
    let bins = saved("F0001MTH.CSV");
    let told: Vec<i16> = spectrum.trim_end().split(',').map(|k| k.parse().expect("k")).collect();
    assert_eq!((bins.codes.len(), bins.preamble.y_unit.as_str()), (1024, "dB"));
    assert_eq!(bins.codes, told);
}

/// SIGKILL leaves no time to end the recording: what was triggered and said before is still read,
/// and analysed.
#[cfg(unix)]
#[test]
fn a_killed_server_leaves_what_was_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("session.mcap");
    let arguments = ["gravity-0.61g".as_ref(), "--record".as_ref(), file.as_os_str()];
    let server = Process::start(&arguments);
    let levels = [strike(connect(server.address)), strike(connect(server.address))];
    drop(server);
    let set = read(&file).expect("an unfinished recording");
    assert_eq!(set.problems, ["the file has no end: it was not finished, or cut"]);
    let kept: Vec<_> = set.shots.iter().map(|s| s.captures[0].waveform.codes.clone()).collect();
    assert_eq!(kept, levels);
    assert!(said(&set, Direction::Command).contains(&"*OPC?".to_owned()));
    let read = |command: &str| {
        let mut hertzscope = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
        hertzscope.arg(command).arg(&file).output().expect("a program")
    };
    for command in ["info", "arrivals"] {
        let output = read(command);
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success() && text.contains("shot 2"), "{command}: {text}");
    }
}
