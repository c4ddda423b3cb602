//! The program on a real terminal: a pseudo-terminal with a parser behind it that keeps the screen.
//!
//! Every wait is for what is to appear, as long as a generous time-out allows; no test depends on
//! how long anything takes.

use std::io::{Read as _, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread;
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};

/// Far longer than anything takes.
const TIMEOUT: Duration = Duration::from_secs(60);
const SIZE: PtySize = PtySize { rows: 24, cols: 80, pixel_width: 0, pixel_height: 0 };
/// Puts the terminal on its other screen, and back.
const OTHER_SCREEN: &str = "\x1b[?1049h";
const OWN_SCREEN: &str = "\x1b[?1049l";
/// Asks for the mouse, and lets it go.
const MOUSE: &str = "\x1b[?1000h";
const NO_MOUSE: &str = "\x1b[?1000l";

/// A terminal with `hertzscope view` on it.
struct Terminal {
    master: Box<dyn MasterPty + Send>,
    keyboard: Box<dyn Write + Send>,
    child: Box<dyn Child + Send + Sync>,
    bytes: Receiver<Vec<u8>>,
    parser: vt100::Parser,
    all: String,
}

impl Terminal {
    fn open(arguments: &[&str], environment: &[(&str, &str)]) -> Self {
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_hertzscope"));
        command.arg("view");
        command.args(arguments);
        command.env_remove("NO_COLOR");
        for (name, value) in environment {
            command.env(name, value);
        }
        Self::start(command)
    }

    fn start(mut command: CommandBuilder) -> Self {
        let pair = native_pty_system().openpty(SIZE).expect("a pseudo-terminal");
        command.cwd(env!("CARGO_MANIFEST_DIR"));
        command.env("TERM", "xterm");
        command.env_remove("COLORTERM");
        let child = pair.slave.spawn_command(command).expect("the program");
        drop(pair.slave);
        let mut reader = pair.master.try_clone_reader().expect("a reader");
        let (sender, bytes) = channel();
        thread::spawn(move || {
            let mut buffer = vec![0; 65536];
            while let Ok(count @ 1..) = reader.read(&mut buffer) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        let keyboard = pair.master.take_writer().expect("a writer");
        let parser = vt100::Parser::new(SIZE.rows, SIZE.cols, 0);
        Self { master: pair.master, keyboard, child, bytes, parser, all: String::new() }
    }

    fn press(&mut self, keys: &str) {
        self.keyboard.write_all(keys.as_bytes()).expect("keys");
        self.keyboard.flush().expect("keys");
    }

    fn screen(&self) -> String {
        self.parser.screen().contents()
    }

    /// Reads until the screen is as wanted.
    fn wait_for(&mut self, what: &str, wanted: impl Fn(&Self) -> bool) {
        let started = Instant::now();
        while !wanted(self) {
            let left = TIMEOUT.saturating_sub(started.elapsed());
            match self.bytes.recv_timeout(left) {
                Ok(bytes) => {
                    self.parser.process(&bytes);
                    self.all.push_str(&String::from_utf8_lossy(&bytes));
                }
                Err(RecvTimeoutError::Timeout) => {
                    panic!("{what} did not come in {TIMEOUT:?}:\n{}", self.screen())
                }
                Err(RecvTimeoutError::Disconnected) => {
                    assert!(wanted(self), "the program ended before {what}:\n{}", self.all);
                }
            }
        }
    }

    fn wait_for_text(&mut self, text: &str) {
        self.wait_for(text, |terminal| terminal.screen().contains(text));
    }

    /// Reads to the end; the exit code and everything that was written.
    fn end(mut self) -> (u32, String) {
        while let Ok(bytes) = self.bytes.recv_timeout(TIMEOUT) {
            self.parser.process(&bytes);
            self.all.push_str(&String::from_utf8_lossy(&bytes));
        }
        let status = self.child.wait().expect("an exit code");
        (status.exit_code(), self.all)
    }
}

/// The one recording that is shipped.
const RECORDING: &str = "recordings/gravity-0.61g.mcap";

/// Whether the last of two things that is found in `text` is the first one.
fn last_is(text: &str, this: &str, that: &str) -> bool {
    text.rfind(this) > text.rfind(that)
}

fn assert_restored(all: &str) {
    assert!(all.contains(OTHER_SCREEN) && all.contains(MOUSE), "the screen was never taken");
    assert!(last_is(all, OWN_SCREEN, OTHER_SCREEN), "still on the other screen");
    assert!(last_is(all, NO_MOUSE, MOUSE), "the mouse is still asked for");
    assert!(last_is(all, "\x1b[?25h", "\x1b[?25l"), "no cursor");
}

#[test]
fn it_starts_shows_the_recording_and_quits() {
    let mut terminal = Terminal::open(&[RECORDING], &[]);
    terminal.wait_for_text("CH1 ");
    terminal.wait_for_text("gravity-0.61g.mcap");
    terminal.press("q");
    let (code, all) = terminal.end();
    assert_eq!(code, 0);
    assert_restored(&all);
    // TERM says xterm and nothing says more: none of 256 colours, none of sixteen million.
    for richer in ["\x1b[38;2;", "\x1b[48;2;"] {
        assert!(!all.contains(richer), "a colour that not every terminal has");
    }
}

#[test]
fn keys_and_command_line_reach_it() {
    let mut terminal = Terminal::open(&[RECORDING], &[]);
    terminal.wait_for_text("CH1 ");
    terminal.press("?");
    terminal.wait_for_text("help on, off");
    // An escape alone, then as the beginning of an arrow key.
    terminal.press("\x1b");
    terminal.wait_for("no help", |t| !t.screen().contains("help on, off"));
    terminal.press("\x1b[C");
    terminal.wait_for("an overview", |t| t.screen().contains('[') && t.screen().contains('*'));
    terminal.press("z");
    terminal.wait_for("the whole record", |t| !t.screen().contains('*'));
    terminal.press(":goto 7\r");
    terminal.wait_for_text("there is one shot");
    terminal.press("F");
    terminal.wait_for_text("f3");
    terminal.press("b");
    terminal.wait_for_text("Forces along the chain");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
}

/// Two recordings of the same name are told apart by their paths; a scene is no recording.
#[test]
fn two_recordings_are_shown_side_by_side() {
    let folder = tempfile::tempdir().expect("a folder");
    let other = folder.path().join("gravity-0.61g.mcap");
    let recording = Path::new(env!("CARGO_MANIFEST_DIR")).join(RECORDING);
    std::fs::copy(recording, &other).expect("a copy");
    let mut terminal = Terminal::open(&[RECORDING, &other.display().to_string()], &[]);
    terminal.wait_for("both names", |t| {
        let row = t.parser.screen().rows(0, 80).next().unwrap_or_default();
        row.starts_with(&format!("{RECORDING}  ┄ /"))
    });
    terminal.press("O");
    terminal.wait_for_text("in front: /");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
    let (code, all) = Terminal::open(&[RECORDING, "magnet-0.61g"], &[]).end();
    assert_eq!(code, 2);
    assert!(all.contains("--against magnet-0.61g"), "{all}");
}

/// What the options of the same names say can be said later, and kept.
#[test]
fn commands_say_what_the_bench_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let table = folder.path().join("lab.csv");
    let row = |i: u32| format!("{:e},{},{}\n", f64::from(i) * 1e-6, f64::from(i % 7), 0.5);
    let rows: String = (0..100).map(row).collect();
    std::fs::write(&table, format!("Time (s),CH1 (V),CH2 (V)\n{rows}")).expect("a table");
    let kept = folder.path().join("kept.mcap");
    let mut terminal = Terminal::open(&[&table.display().to_string()], &[]);
    terminal.wait_for_text("CH1 ");
    terminal.press(":map CH1=p2\r");
    terminal.wait_for_text("no sensor `p2` is known");
    terminal.press(":scene magnet-0.61g\r");
    terminal.wait_for_text("noted");
    terminal.press(":distance CH1-CH9=5 cm\r");
    terminal.wait_for_text("no channel CH9");
    terminal.press(":map CH1=p14\r");
    terminal.wait_for_text("noted");
    terminal.press(&format!(":write {}\r", kept.display()));
    terminal.wait_for_text("wrote shot 1");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
    let set = hertzscope::recording::format::open(&kept).expect("a recording");
    let sensors = hertzscope::measurement::metadata::sensors(&set);
    let at = |name: &str| sensors.iter().find(|s| s.name == name).and_then(|s| s.channel.clone());
    assert_eq!((at("p14").as_deref(), at("p2")), (Some("CH1"), None));
}

#[test]
fn the_mouse_zooms_and_drags() {
    let mut terminal = Terminal::open(&[RECORDING], &[]);
    terminal.wait_for_text("CH1 ");
    // Wheel up at column 40, row 10, as SGR reports it.
    terminal.press("\x1b[<64;40;10M");
    terminal.wait_for("a zoom", |t| t.screen().contains('*'));
    let before = terminal.parser.screen().rows(0, 80).next().expect("a row");
    terminal.press("\x1b[<0;40;10M\x1b[<32;50;10M\x1b[<0;50;10m");
    terminal.wait_for("another position", |t| {
        t.parser.screen().rows(0, 80).next().is_some_and(|row| row != before)
    });
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
}

#[test]
fn it_follows_the_terminals_size() {
    let mut terminal = Terminal::open(&[RECORDING], &[]);
    terminal.wait_for_text("CH1 ");
    let large = PtySize { rows: 60, cols: 200, ..SIZE };
    terminal.parser.screen_mut().set_size(large.rows, large.cols);
    terminal.master.resize(large).expect("another size");
    // There is room for more hints now.
    terminal.wait_for_text("k y h accuracy");
    let small = PtySize { rows: 5, cols: 20, ..SIZE };
    terminal.parser.screen_mut().set_size(small.rows, small.cols);
    terminal.master.resize(small).expect("another size");
    terminal.wait_for_text("This terminal is");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
}

#[test]
fn without_colours_it_sends_none() {
    let mut terminal = Terminal::open(&[RECORDING], &[("NO_COLOR", "1")]);
    terminal.wait_for_text("CH1 ");
    terminal.press("kq");
    let (code, all) = terminal.end();
    assert_eq!(code, 0);
    let coloured =
        all.split("\x1b[").skip(1).filter_map(|part| part.split_once('m')).any(|(codes, _)| {
            let foreground =
                |code: &str| matches!(code.parse(), Ok(30..=38 | 40..=48 | 90..=97 | 100..=107));
            codes.bytes().all(|b| b.is_ascii_digit() || b == b';')
                && codes.split(';').any(foreground)
        });
    assert!(!coloured, "a colour was set");
}

/// Where the program of the terminal is this test binary, and what it does there.
const ON_TERMINAL: &str = "HERTZSCOPE_TEST_ON_TERMINAL";

/// Runs in a process of its own, on a pseudo-terminal: panics in the thread of the screen, or in
/// another one.
#[test]
fn panics_on_its_terminal() {
    let Ok(place) = std::env::var(ON_TERMINAL) else { return };
    let done = hertzscope::tui::on_terminal(|terminal| {
        terminal.draw(|_| ())?;
        assert_ne!(place, "screen", "provoked");
        assert!(thread::spawn(|| panic!("provoked")).join().is_err());
        println!("goes on");
        Ok(())
    });
    done.expect("a terminal");
}

/// [`panics_on_its_terminal`] with a panic in this `place`.
fn panicking(place: &str) -> Terminal {
    let mut command = CommandBuilder::new(std::env::current_exe().expect("this test binary"));
    command.args(["--exact", "tui::terminal::panics_on_its_terminal", "--nocapture"]);
    command.env(ON_TERMINAL, place);
    Terminal::start(command)
}

#[test]
fn a_panic_gives_the_terminal_back_before_it_tells() {
    let (code, all) = panicking("screen").end();
    assert_ne!(code, 0);
    assert_restored(&all);
    assert!(last_is(&all, "provoked", OWN_SCREEN), "the message is on the screen that is gone");
}

/// What [`hertzscope::tui::work`] makes of the panic is tested there.
#[test]
fn a_panic_behind_the_screen_leaves_the_terminal_alone() {
    let (code, all) = panicking("elsewhere").end();
    assert_eq!(code, 0);
    assert_restored(&all);
    assert!(last_is(&all, OWN_SCREEN, "goes on"), "the screen was given back");
}

/// The terminal's window is closed, and no signal tells: a program that goes on reading would read
/// for ever.
#[test]
fn it_ends_when_its_terminal_is_gone() {
    let pair = native_pty_system().openpty(SIZE).expect("a pseudo-terminal");
    let mut command = CommandBuilder::new("sh");
    let program = env!("CARGO_BIN_EXE_hertzscope");
    command.args(["-c", &format!("trap '' HUP; exec '{program}' view {RECORDING}")]);
    command.cwd(env!("CARGO_MANIFEST_DIR"));
    command.env("TERM", "xterm");
    let mut child = pair.slave.spawn_command(command).expect("the program");
    drop(pair.slave);
    let mut reader = pair.master.try_clone_reader().expect("a reader");
    let mut heard = String::new();
    let mut buffer = [0; 4096];
    while !heard.contains("CH4") {
        let count = reader.read(&mut buffer).expect("a picture");
        heard.push_str(&String::from_utf8_lossy(&buffer[..count]));
    }
    drop((pair.master, reader));
    let (sender, ended) = channel();
    let mut killer = child.clone_killer();
    thread::spawn(move || sender.send(child.wait()));
    if ended.recv_timeout(TIMEOUT).is_err() {
        killer.kill().expect("an end");
        panic!("it is still there");
    }
}

#[test]
fn a_bench_is_played_with_and_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let file: PathBuf = folder.path().join("tuned.toml");
    let mut terminal = Terminal::open(&["magnet-0.61g"], &[]);
    terminal.wait_for_text("Trig'd");
    terminal.press("B");
    terminal.wait_for_text("striker mass");
    terminal.press("n++++");
    terminal.wait_for_text("646 mm/s");
    terminal.press(&format!(":write {}\r", file.display()));
    terminal.wait_for_text("wrote the scene");
    terminal.press("q");
    assert_eq!(terminal.end().0, 0);
    let text = std::fs::read_to_string(file).expect("a scene");
    assert!(text.contains("[striker]\nspeed = "), "{text}");
}

/// By either way of writing its address; where nobody is, that is said before the screen is taken.
#[test]
#[cfg(feature = "server")]
fn a_served_scope_is_watched() {
    let server = crate::server::Server::at_rest();
    for address in [server.address.to_string(), format!("tcp://{}/", server.address)] {
        let mut terminal = Terminal::open(&[&address], &[]);
        terminal.wait_for_text("Ready");
        terminal.press("i");
        terminal.wait_for_text("CH4 2.00V");
        terminal.press("q");
        let (code, all) = terminal.end();
        assert_eq!(code, 0);
        assert_restored(&all);
    }
    let address = server.address.to_string();
    drop(server);
    let (code, all) = Terminal::open(&[&address], &[]).end();
    assert_eq!(code, 2);
    // On a terminal, what is wrong is marked.
    assert!(all.contains(&format!("\x1b[1;31merror:\x1b[0m tcp://{address}: ")), "{all}");
    assert!(!all.contains(OTHER_SCREEN), "the screen was taken");
}

#[test]
fn what_is_no_terminal_is_told_so() {
    let mut command = assert_cmd::Command::cargo_bin("hertzscope").expect("the program");
    let output =
        command.args(["view", RECORDING]).current_dir(Path::new(env!("CARGO_MANIFEST_DIR")));
    let output = output.output().expect("output");
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("found no terminal"));
}
