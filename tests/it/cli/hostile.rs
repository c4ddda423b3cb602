//! Files that mean no good to the terminal, to documents and to memory.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use hertzscope::recording::mcap::write;
use hertzscope::recording::{TraceSet, mcap};

use super::{QUICK, hertzscope, printed, refused, says, temporary};

/// What a terminal would obey.
const ESCAPE: &str = "\u{1b}]0;pwn\u{7}\u{9b}31m\u{202e}";

fn is_plain(text: &str) -> bool {
    text.chars().all(|c| c == '\n' || !(c.is_control() || ('\u{202a}'..='\u{202e}').contains(&c)))
}

/// A recording whose title, metadata, units and notes hold [`ESCAPE`].
fn poisoned(path: &Path) {
    let scene =
        "base = \"magnet-0.61g\"\ntitle = \"\\u001b]0;pwn\\u0007<script>alert(1)</script>\"\n";
    std::fs::write(path.join("evil.toml"), scene).expect("a scene");
    printed(path, &[&["run", "-q", "-o", "run.mcap", "evil.toml"][..], &QUICK].concat());
    let mut set = mcap::read(&path.join("run.mcap")).expect("a recording");
    set.metadata.entry(ESCAPE.to_owned()).or_default().insert(ESCAPE.into(), ESCAPE.into());
    for capture in &mut set.shots[0].captures {
        capture.notes.push(ESCAPE.to_owned());
        ESCAPE.clone_into(&mut capture.waveform.preamble.y_unit);
    }
    set.log.push(ESCAPE.to_owned());
    write(&path.join("evil.mcap"), &set).expect("a recording");
}

#[test]
fn nothing_that_is_printed_commands_the_terminal() {
    let folder = temporary();
    let path = folder.path();
    poisoned(path);
    for arguments in [
        &["info", "evil.mcap"][..],
        &["info", "--json", "evil.mcap"],
        &["run", "evil.toml", "--accuracy", "1e-3", "-o", "x.mcap"],
        &["compare", "evil.mcap", "run.mcap"],
        &["compare", "evil.mcap", "run.mcap", "--json"],
        &["arrivals", "evil.mcap"],
        &["convert", "evil.mcap", "out"],
        &["spectrum", "evil.mcap", "--channel", "\u{1b}[31m"],
        &["info", "\u{1b}[31m.mcap"],
    ] {
        let done = hertzscope(path, arguments);
        assert!(is_plain(&done.stdout), "{arguments:?}: {:?}", done.stdout);
        assert!(is_plain(&done.stderr), "{arguments:?}: {:?}", done.stderr);
    }
    says(&printed(path, &["info", "evil.mcap"]), &["\\u001b]0;pwn\\u0007\\u009b31m\\u202e"]);
    // The same text, not another one, for scripts.
    let json: serde_json::Value =
        serde_json::from_str(&printed(path, &["info", "--json", "evil.mcap"])).expect("JSON");
    assert_eq!(json["metadata"][ESCAPE][ESCAPE], ESCAPE);
    let wrong = format!("mass = \"{}\"\n", "\\u001b[2J");
    std::fs::write(path.join("wrong.toml"), wrong).expect("a file");
    assert!(is_plain(&refused(path, &["run", "wrong.toml"])));
}

/// Pictures and documents hold no control characters, tags or links of their own.
#[test]
fn documents_hold_no_tags_of_a_files_own() {
    let folder = temporary();
    let path = folder.path();
    poisoned(path);
    printed(path, &["convert", "-q", "evil.mcap", "x.svg"]);
    for name in ["x.md", "x.html"] {
        hertzscope(path, &["compare", "run.mcap", "evil.toml", "-q", "-o", name]);
    }
    for name in ["x.svg", "x.md", "x.html"] {
        let text = std::fs::read_to_string(path.join(name)).expect(name);
        assert!(is_plain(&text), "{name}");
        assert!(!text.contains("<script"), "{name}");
    }
}

/// Values of any length are shown; they take no more memory than they have characters.
#[cfg(unix)]
#[test]
fn long_values_are_shown() {
    let folder = temporary();
    let path = folder.path();
    let long = "x".repeat(70_000);
    let mut facts: BTreeMap<String, String> =
        (0..2000).map(|number| (format!("key{number}"), "v".to_owned())).collect();
    facts.insert("long".to_owned(), long.clone());
    facts.insert(long.clone(), "v".to_owned());
    let metadata = BTreeMap::from([("facts".to_owned(), facts)]);
    write(&path.join("long.mcap"), &TraceSet { metadata, ..TraceSet::default() }).expect("written");
    let page = printed(path, &["info", "long.mcap"]);
    assert!(page.contains(&long) && page.contains("key1999"));
    assert!(page.len() < 1_000_000, "{} bytes", page.len());
}

/// A file that outgrows `ulimit -f` is an error, and leaves nothing behind that looks whole.
#[cfg(unix)]
#[test]
fn a_file_limit_is_told() {
    let folder = temporary();
    let path = folder.path();
    let script = "ulimit -f 20; exec \"$0\" run -q --accuracy 1e-3 -o x.mcap";
    let output = std::process::Command::new("sh")
        .args(["-c", script, env!("CARGO_BIN_EXE_hertzscope")])
        .current_dir(path)
        .output()
        .expect("a run");
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{said}");
    says(&said, &["x.mcap", "large"]);
    assert_eq!(super::files(path), [""; 0]);
}

#[test]
fn there_are_limits_with_a_message() {
    let folder = temporary();
    let path = folder.path();
    let mut scene = "base = \"magnet-0.61g\"\n".to_owned();
    for number in 0..8000 {
        let _ = write!(
            scene,
            "[sensors.s{number}]\nmodel = \"pzt-5a-710pf\"\nparticle = {}\n",
            number % 30 + 1
        );
    }
    std::fs::write(path.join("many.toml"), scene).expect("a scene");
    says(&refused(path, &["run", "many.toml"]), &["many.toml", "sensors", "at most 1000"]);
    printed(path, &[&["run", "-q", "-o", "run.mcap"][..], &QUICK].concat());
    let mut set = mcap::read(&path.join("run.mcap")).expect("a recording");
    set.shots[0].captures[0].waveform.codes = vec![0; 20_000_000];
    write(&path.join("long.mcap"), &set).expect("written");
    let error = refused(path, &["spectrum", "long.mcap"]);
    says(&error, &["expected at most 16777216", "--from"]);
}
