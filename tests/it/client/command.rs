//! `hertzscope acquire`, and commands that take an address where they take a file.

use std::io::{BufRead as _, BufReader};
use std::path::Path;
use std::process::{Command, Output, Stdio};

use hertzscope::recording::mcap::read;
use hertzscope::recording::{Origin, Shot};
use serde_json::Value;

use super::{assert_recorded, struck};
use crate::server::Server;

fn hertzscope(at: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_hertzscope"));
    command.args(arguments).current_dir(at).output().expect("a program")
}

/// What it printed; it ended with one of `codes`.
fn printed(at: &Path, arguments: &[&str], codes: &[i32]) -> String {
    let output = hertzscope(at, arguments);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let code = output.status.code().expect("an exit code");
    assert!(codes.contains(&code), "{arguments:?}: {code}: {said}");
    String::from_utf8(output.stdout).expect("text")
}

/// What a client may find changed.
const SETTINGS: &str = ":ACQ:STOPA?;STATE?;:TRIG:MAI:MOD?;:DAT:SOU?;ENC?;WID?;STAR?;STOP?;:*ESR?";

#[test]
fn shots_are_recorded_and_the_scope_is_left_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let server = struck(&at.join("own.mcap"));
    let address = format!("tcp://{}", server.address);
    let mut lab = server.connect();
    lab.send(b"*CLS;:DAT:SOU CH2;ENC ASCI;WID 2;STAR 5;STOP 14;:TRIG:MAI:MOD AUTO\n");
    let before = lab.ask(SETTINGS);
    let text =
        printed(at, &["acquire", &address, "-o", "day.mcap", "--shots", "3", "--json", "-q"], &[0]);
    assert_eq!(lab.ask(SETTINGS), before);
    let told: Value = serde_json::from_str(&text).expect("JSON");
    assert_eq!((&told["shots"], &told["model"]), (&3.into(), &"TDS2014".into()));
    assert_eq!((&told["line_failures"], &told["dropped"]), (&0.into(), &0.into()));
    let text = printed(at, &["acquire", &address, "-o", "day.mcap", "--shots", "1"], &[0]);
    assert_eq!(text, "recorded    day-2.mcap: 1 shot\n");
    drop(server);
    let set = read(&at.join("day.mcap")).expect("a recording");
    assert_eq!(set.problems, [""; 0]);
    let numbers: Vec<u32> = set.shots.iter().map(|shot| shot.number).collect();
    assert_eq!(numbers, [1, 2, 3]);
    assert!(set.shots.windows(2).all(|pair| pair[0].timestamp_ns < pair[1].timestamp_ns));
    assert!(set.shots.iter().all(|shot| shot.origin == Origin::Measured));
    assert!(set.notes[&1].set_up.contains(":TRIGGER:MAIN:MODE NORMAL"), "{:?}", set.notes);
    assert_recorded(&set.shots, &at.join("own.mcap"));
    // The other commands take it.
    assert!(printed(at, &["info", "day.mcap"], &[0]).contains("shot 3, measured"));
    let arrivals = printed(at, &["arrivals", "day.mcap", "--scene", "magnet-0.61g"], &[0]);
    assert!(arrivals.contains("CH1 -> CH2"), "{arrivals}");
    let scores = printed(at, &["compare", "day.mcap", "magnet-0.61g", "--json", "-q"], &[0, 1]);
    let scores: Value = serde_json::from_str(&scores).expect("JSON");
    assert_eq!(scores["channels"].as_array().map(Vec::len), Some(4), "{scores}");
}

/// A scope that is given up by Ctrl-C is as it was, and the recording is whole.
#[test]
fn an_interrupted_acquisition_leaves_the_scope_as_it_was() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let server = Server::at_rest();
    let mut lab = server.connect();
    let before = lab.ask(SETTINGS);
    let mut child = Command::new(env!("CARGO_BIN_EXE_hertzscope"))
        .args(["acquire", &server.address.to_string(), "-o", "day.mcap"])
        .current_dir(at)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("a program");
    let mut said = BufReader::new(child.stderr.take().expect("a pipe")).lines();
    let mut wait_for =
        |words: &str| said.by_ref().map_while(Result::ok).any(|line| line.contains(words));
    assert!(wait_for("shot 1: waiting for a trigger"));
    lab.send(b":BENC:IMP\n");
    // While it grows, the file is read like one that was cut.
    assert!(wait_for("shot 2: waiting for a trigger"));
    let growing = read(&at.join("day.mcap")).expect("a recording");
    assert_eq!(growing.shots.len(), 1);
    assert!(lab.ask(":ACQ:STOPA?").starts_with("SEQUENCE"));
    let asked = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
    assert!(asked.expect("kill").success());
    let output = child.wait_with_output().expect("its end");
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stdout), "recorded    day.mcap: 1 shot\n");
    assert_eq!(lab.ask(SETTINGS), before);
    let set = read(&at.join("day.mcap")).expect("a recording");
    assert_eq!((set.problems.len(), set.shots.len()), (0, 1));
}

/// `compare`, `fit`, `arrivals` and others take one shot from an address; `calibrate` one for each
/// impact, and keeps it.
#[test]
fn an_address_stands_for_a_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let server = struck(&at.join("own.mcap"));
    let address = server.address.to_string();
    let text = printed(at, &["arrivals", &address, "--scene", "magnet-0.61g"], &[0]);
    assert!(text.contains("CH1 -> CH2"), "{text}");
    let text = printed(at, &["compare", &address, "magnet-0.61g", "--tolerance", "peak=20%"], &[0]);
    assert!(text.contains("pass"), "{text}");
    let visa = format!("TCPIP0::127.0.0.1::{}::SOCKET", server.address.port());
    let fit = ["fit", &visa, "magnet-0.61g", "--free", "striker.speed", "--starts", "1"];
    let text = printed(at, &[&fit[..], &["--json", "-q"]].concat(), &[0]);
    let found: Value = serde_json::from_str(&text).expect("JSON");
    let speed = &found["parameters"][0];
    // The served scene's own speed.
    let (value, expanded) = (speed["value"].as_f64(), speed["U95"].as_f64());
    let (value, expanded) = (value.expect("a speed"), expanded.expect("its uncertainty"));
    assert!((value - 0.44).abs() < 2.0 * expanded, "{speed}");
}

#[test]
fn a_calibration_records_its_impacts() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let server = struck(&at.join("own.mcap"));
    let head = "title = \"test\"\n[sensor]\nitem = \"plate\"\nname = \"plate\"\n[scope]\nin_chain = true\n\
        [strikers.ball]\nmass = \"0.61 g\"\nmass_u = \"0.1 %\"\n";
    let impact = format!(
        "[[impacts]]\nrecording = \"tcp://{}\"\nspeed = \"0.44 m/s\"\nspeed_u = \"1 %\"\nrebound_speed = \"0.1 m/s\"\nrebound_speed_u = \"1 %\"\n",
        server.address
    );
    std::fs::write(at.join("plan.toml"), format!("{head}{}", impact.repeat(3))).expect("a file");
    // Impacts on a chain are no momentum test: whatever is said of them, they are recorded.
    let output = hertzscope(at, &["calibrate", "plan.toml", "--force"]);
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(said.contains("impact 3 of 3, striker ball"), "{said}");
    drop(server);
    let shots = (1..=3).map(|number| {
        let set = read(&at.join(format!("plan-impact-{number}.mcap"))).expect("a recording");
        set.shots.first().cloned().expect("a shot")
    });
    let shots: Vec<Shot> = shots.collect();
    assert_recorded(&shots, &at.join("own.mcap"));
}
