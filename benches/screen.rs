//! What the terminal screen costs: `cargo bench --bench screen`.
//!
//! Time and bytes of a frame at 4 x 2500 and 4 x 100,000 points, drawn whole, after one key, and
//! after nothing; then on a pseudo-terminal with a recording of 1,000 triggers the time from the
//! start to the first picture, and from a key to the picture it changes. Medians and the slowest of
//! the runs; the terminal's own drawing is not in them.

#![allow(clippy::disallowed_macros, reason = "measurements are printed")]
use std::cell::Cell;
use std::collections::BTreeMap;
use std::io::{self, Read as _, Write};
use std::path::Path;
use std::rc::Rc;
use std::sync::mpsc::{Receiver, channel};
use std::thread;
use std::time::{Duration, Instant};

use hertzscope::recording::mcap::{RecordingWriter, ShotNotes};
use hertzscope::recording::{Capture, Origin, Shot, TraceSet};
use hertzscope::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use hertzscope::tui::axis::TurnDirection;
use hertzscope::tui::model::{Action, Palette, ScreenState, update};
use hertzscope::tui::view;
use portable_pty::{CommandBuilder, PtySize, native_pty_system};
use ratatui::backend::CrosstermBackend;
use ratatui::layout::Rect;
use ratatui::{Terminal, TerminalOptions, Viewport};

type Failed = Box<dyn std::error::Error>;

/// What a turn does; nothing where nothing is to change.
type Act = fn(TurnDirection) -> Option<Action>;

/// Frames of each kind.
const FRAMES: usize = 101;
/// Keys pressed on the pseudo-terminal.
const KEYS: usize = 101;
/// Triggers of the long recording.
const TRIGGERS: u32 = 1000;
/// After so long a picture will not come any more.
const TIMEOUT: Duration = Duration::from_secs(60);

/// A damped wave with noise, different for each channel and shot.
fn channel_of(number: u8, shot: u32, points: usize) -> Capture {
    let mut random = u64::from(number) * 7919 + u64::from(shot) * 104_729 + 1;
    let mut noise = || {
        random =
            random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 40) as f64 / f64::from(1_u32 << 24) - 0.5
    };
    let level = |index: usize| {
        let place = index as f64 / points as f64;
        let wave = (-3.0 * place).exp() * (place * 60.0 + f64::from(shot) * 0.1).sin();
        (80.0 * wave + 2.0 * noise()).round() as i16
    };
    let interval = 2.5e-3 / points as f64;
    let waveform = Waveform {
        source: Source::Channel(number),
        codes: (0..points).map(level).collect(),
        as_read: Vec::new(),
        preamble: Preamble {
            x_zero: -0.25e-3,
            x_incr: interval,
            pt_off: 0,
            x_unit: "s".to_owned(),
            y_mult: 0.04,
            y_zero: 0.0,
            y_off: 0.0,
            y_unit: "V".to_owned(),
            pt_fmt: PointFormat::Sample,
        },
        vertical: VerticalSetup {
            scale: 1.0,
            position: 0.0,
            coupling: Some(Coupling::Dc),
            bandwidth_limited: Some(false),
            inverted: Some(false),
            probe: 1.0,
        },
        horizontal_scale: 250e-6,
        trigger_point: points as f64 / 10.0,
    };
    Capture { waveform, instrument: None, notes: Vec::new() }
}

fn shot(number: u32, points: usize) -> Shot {
    Shot {
        number,
        origin: Origin::Measured,
        timestamp_ns: u64::from(number) * 1_000_000_000,
        captures: (1..=4).map(|channel| channel_of(channel, number, points)).collect(),
        truth: Vec::new(),
        trigger_time: None,
    }
}

/// Counts what a terminal would be sent.
#[derive(Clone, Default)]
struct Wire(Rc<Cell<usize>>);

impl Write for Wire {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.set(self.0.get() + bytes.len());
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Median and largest.
fn spread<T: Copy + Ord>(mut values: Vec<T>) -> Option<(T, T)> {
    values.sort_unstable();
    Some((*values.get(values.len() / 2)?, *values.last()?))
}

fn frames(points: usize, (width, height): (u16, u16)) -> Result<(), Failed> {
    let wire = Wire::default();
    let viewport = Viewport::Fixed(Rect::new(0, 0, width, height));
    let backend = CrosstermBackend::new(wire.clone());
    let mut terminal = Terminal::with_options(backend, TerminalOptions { viewport })?;
    let set = TraceSet { shots: vec![shot(1, points), shot(2, points)], ..TraceSet::default() };
    let mut model = ScreenState::new(set, "bench".to_owned(), Palette::Colour);
    let other_way = |index: usize| {
        if index.is_multiple_of(2) { TurnDirection::Up } else { TurnDirection::Down }
    };
    let acts: [(&str, Act); 4] = [
        ("nothing has changed", |_| None),
        ("V/div of one trace", |turn| Some(Action::VoltsPerDivision(turn))),
        ("s/div", |turn| Some(Action::TimePerDivision { turn, anchor: 0.0 })),
        ("another shot", |turn| Some(Action::Shot(turn))),
    ];
    println!("4 x {points} points on {width} x {height}");
    for (name, act) in acts {
        let (mut times, mut bytes) = (Vec::new(), Vec::new());
        for index in 0..FRAMES {
            if let Some(action) = act(other_way(index)) {
                update(&mut model, action);
            }
            let before = wire.0.get();
            let started = Instant::now();
            terminal.draw(|frame| view::draw(&model, frame))?;
            times.push(started.elapsed());
            bytes.push(wire.0.get() - before);
        }
        if let (Some(time), Some(bytes)) = (spread(times), spread(bytes)) {
            println!(
                "  {name:<20} {:>10.2?} at most {:>10.2?}, {:>6} bytes at most {:>6}",
                time.0, time.1, bytes.0, bytes.1
            );
        }
    }
    Ok(())
}

/// The program on a pseudo-terminal.
struct Viewed {
    keyboard: Box<dyn Write + Send>,
    bytes: Receiver<Vec<u8>>,
    parser: vt100::Parser,
    child: Box<dyn portable_pty::Child + Send + Sync>,
}

impl Viewed {
    fn open(file: &Path) -> Result<Self, Failed> {
        let size = PtySize { rows: 24, cols: 80, pixel_width: 0, pixel_height: 0 };
        let pair = native_pty_system().openpty(size)?;
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_hertzscope"));
        command.arg("view");
        command.arg(file);
        command.env("TERM", "xterm-256color");
        let child = pair.slave.spawn_command(command)?;
        let mut reader = pair.master.try_clone_reader()?;
        let keyboard = pair.master.take_writer()?;
        let (sender, bytes) = channel();
        let master = pair.master;
        thread::spawn(move || {
            let mut buffer = vec![0; 65536];
            while let Ok(count @ 1..) = reader.read(&mut buffer) {
                let Some(read) = buffer.get(..count) else { break };
                if sender.send(read.to_vec()).is_err() {
                    break;
                }
            }
            drop(master);
        });
        Ok(Self { keyboard, bytes, parser: vt100::Parser::new(24, 80, 0), child })
    }

    /// Waits for `text` on the screen.
    fn wait_for(&mut self, text: &str) -> Result<(), Failed> {
        while !self.parser.screen().contents().contains(text) {
            self.hear()?;
        }
        Ok(())
    }

    /// What the program writes next.
    fn hear(&mut self) -> Result<(), Failed> {
        let bytes = self.bytes.recv_timeout(TIMEOUT)?;
        self.parser.process(&bytes);
        Ok(())
    }

    /// How many shots the screen says there are: `Shot 1/27+`.
    fn count(&self) -> usize {
        let screen = self.parser.screen().contents();
        let behind = screen.split_once("Shot ").and_then(|(_, rest)| rest.split_once('/'));
        let digits = behind.map(|(_, rest)| rest.split(|c: char| !c.is_ascii_digit()));
        digits.and_then(|mut digits| digits.next()?.parse().ok()).unwrap_or(0)
    }

    fn press(&mut self, keys: &str) -> io::Result<()> {
        self.keyboard.write_all(keys.as_bytes())?;
        self.keyboard.flush()
    }
}

fn terminal(file: &Path) -> Result<(), Failed> {
    let none = BTreeMap::new();
    let mut writer = RecordingWriter::create(file, &none, &[])?;
    for number in 1..=TRIGGERS {
        writer.add(&shot(number, 2500), &ShotNotes::default())?;
    }
    writer.finish()?;
    println!(
        "{TRIGGERS} triggers of 4 x 2500 points, {} MB",
        std::fs::metadata(file)?.len() / 1_000_000
    );
    let mut starts = Vec::new();
    for _ in 0..11 {
        let started = Instant::now();
        let mut viewed = Viewed::open(file)?;
        viewed.wait_for("CH4 1.00V")?;
        starts.push(started.elapsed());
        viewed.press("q")?;
        viewed.child.wait()?;
    }
    if let Some((median, most)) = spread(starts) {
        println!("  start to first picture     {median:>10.2?} at most {most:>10.2?}");
    }
    let mut viewed = Viewed::open(file)?;
    // As soon as so many shots are found; the rest of the file is still being read then.
    while viewed.count() < 2 + KEYS {
        viewed.hear()?;
    }
    keys(&mut viewed, "key to screen, still reading", 2)?;
    viewed.wait_for(&format!("/{TRIGGERS} "))?;
    keys(&mut viewed, "key to screen, all read", 2 + KEYS)?;
    viewed.press("q")?;
    viewed.child.wait()?;
    Ok(())
}

/// Next shot after next shot, from the one numbered `from`.
fn keys(viewed: &mut Viewed, name: &str, from: usize) -> Result<(), Failed> {
    let mut times = Vec::new();
    for number in from..from + KEYS {
        let started = Instant::now();
        viewed.press(".")?;
        viewed.wait_for(&format!("Shot {number}/"))?;
        times.push(started.elapsed());
    }
    if let Some((median, most)) = spread(times) {
        println!("  {name:<28} {median:>8.2?} at most {most:>10.2?}");
    }
    Ok(())
}

fn main() -> Result<(), Failed> {
    for points in [2500, 100_000] {
        frames(points, (80, 24))?;
        frames(points, (200, 60))?;
    }
    let folder = tempfile::tempdir()?;
    terminal(&folder.path().join("long.mcap"))
}
