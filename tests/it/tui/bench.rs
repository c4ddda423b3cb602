//! Recordings made up for the screen, and a terminal to show them on.

use hertzscope::recording::{Capture, InstrumentIdentity, Origin, Shot, TraceSet};
use hertzscope::scope::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use hertzscope::tui::job::{Change, Queue};
use hertzscope::tui::model::{Action, Palette, Request, ScreenState, update};
use hertzscope::tui::view;
use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::buffer::{Buffer, Cell};

/// 2500 points, 1 µs apart, from 250 µs before the trigger: 250 µs/div with the centre at 1 ms.
pub fn channel(number: u8, scale: f64, position: f64, volts: impl Fn(f64) -> f64) -> Capture {
    let y_mult = scale / 25.0;
    let y_off = position * 25.0;
    let codes = (0..2500)
        .map(|index| {
            let time = -250e-6 + f64::from(index) * 1e-6;
            (volts(time) / y_mult + y_off).round().clamp(-128.0, 127.0) as i16
        })
        .collect();
    Capture {
        waveform: Waveform {
            source: Source::Channel(number),
            codes,
            as_read: Vec::new(),
            preamble: Preamble {
                x_zero: -250e-6,
                x_incr: 1e-6,
                pt_off: 0,
                x_unit: "s".to_owned(),
                y_mult,
                y_zero: 0.0,
                y_off,
                y_unit: "V".to_owned(),
                pt_fmt: PointFormat::Sample,
            },
            vertical: VerticalSetup {
                scale,
                position,
                coupling: Some(Coupling::Dc),
                bandwidth_limited: Some(false),
                inverted: Some(false),
                probe: 10.0,
            },
            horizontal_scale: 250e-6,
            trigger_point: 250.0,
        },
        instrument: Some(InstrumentIdentity {
            model: "TDS2014".to_owned(),
            serial: "0".to_owned(),
            firmware: "FV:v4.12".to_owned(),
        }),
        notes: Vec::new(),
    }
}

/// A volt from the trigger on, at 500 mV/div with ground in the centre.
pub fn step() -> Capture {
    channel(1, 0.5, 0.0, |time| if time < 0.0 { 0.0 } else { 1.0 })
}

/// An FFT with a line of 10 dB at bin 512 over a floor 40 dB lower, as the instrument gives it at 1
/// V/div.
pub fn spectrum() -> Capture {
    let mut capture = channel(1, 10.0, 0.0, |_| 0.0);
    let waveform = &mut capture.waveform;
    waveform.source = Source::Math;
    waveform.codes = (0..1024).map(|bin| if bin == 512 { 0 } else { -100 }).collect();
    waveform.preamble.x_zero = 0.0;
    waveform.preamble.x_incr = 1e6 / 2048.0;
    "Hz".clone_into(&mut waveform.preamble.x_unit);
    "dB".clone_into(&mut waveform.preamble.y_unit);
    waveform.preamble.y_mult = 0.4;
    waveform.preamble.y_zero = 10.0;
    waveform.horizontal_scale = 50e3;
    capture
}

pub fn shot(number: u32, captures: Vec<Capture>) -> Shot {
    Shot {
        number,
        origin: Origin::Simulated,
        timestamp_ns: 0,
        captures,
        truth: Vec::new(),
        trigger_time: None,
    }
}

/// A recording of as many shots as there are lists of captures.
pub fn recording(shots: Vec<Vec<Capture>>) -> TraceSet {
    TraceSet {
        shots: (1..).zip(shots).map(|(n, captures)| shot(n, captures)).collect(),
        ..TraceSet::default()
    }
}

pub fn model(set: TraceSet) -> ScreenState {
    ScreenState::new(set, "steel chain".to_owned(), Palette::Colour)
}

/// Four channels: a step, two flat lines, one flat line above the screen's top.
pub fn four_channels() -> ScreenState {
    let captures = vec![
        step(),
        channel(2, 1.0, -1.0, |_| 0.0),
        channel(3, 0.2, -2.0, |_| 0.0),
        channel(4, 0.5, -3.0, |_| 0.0),
    ];
    model(recording(vec![captures]))
}

/// `model` after `actions`, and after the threads have computed what it shows.
pub fn after(mut model: ScreenState, actions: &[Action]) -> ScreenState {
    for action in actions {
        update(&mut model, *action);
        compute(&mut model);
    }
    model
}

/// Does the jobs that readings, pages and keys wait for; leaves the other requests.
pub fn compute(model: &mut ScreenState) {
    loop {
        let is_quick = |request: &Request| matches!(request, Request::Job(job) if matches!(job.queue, Queue::Reading | Queue::Key));
        let (quick, others) = model.take_requests().into_iter().partition(is_quick);
        model.requests = others;
        let quick: Vec<Request> = quick;
        if quick.is_empty() {
            return;
        }
        for request in quick {
            let Request::Job(job) = request else { continue };
            let changes = std::cell::RefCell::new(Vec::<Change<ScreenState>>::new());
            let last = job.run(&|change| changes.borrow_mut().push(change));
            changes.into_inner().into_iter().chain([last]).for_each(|change| change(model));
        }
    }
}

/// A picture of a terminal.
pub struct Screen(Buffer);

/// Draws `model` on a terminal of `width` x `height`.
pub fn draw(model: &ScreenState, width: u16, height: u16) -> Screen {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("a test terminal");
    terminal.draw(|frame| view::draw(model, frame)).expect("drawing in memory");
    Screen(terminal.backend().buffer().clone())
}

impl Screen {
    /// The text of a row.
    pub fn row(&self, y: u16) -> String {
        (0..self.0.area.width).map(|x| self.0[(x, y)].symbol()).collect()
    }

    pub fn text(&self) -> String {
        (0..self.0.area.height).map(|y| self.row(y) + "\n").collect()
    }

    pub fn cell(&self, x: u16, y: u16) -> &Cell {
        &self.0[(x, y)]
    }

    /// The rows of column `x` in which a cell with dots has `colour`.
    pub fn rows_of(&self, x: u16, colour: ratatui::style::Color) -> Vec<u16> {
        (0..self.0.area.height)
            .filter(|y| {
                let cell = self.cell(x, *y);
                cell.fg == colour && ('\u{2801}'..='\u{28ff}').contains(&first(cell))
            })
            .collect()
    }

    /// The cell at which `text` begins; it must be on the screen.
    pub fn find(&self, text: &str) -> (u16, u16) {
        for y in 0..self.0.area.height {
            let row = self.row(y);
            if let Some(at) = row.find(text) {
                let x = row[..at].chars().count();
                return (u16::try_from(x).expect("a column"), y);
            }
        }
        panic!("no `{text}` on\n{}", self.text());
    }

    pub fn has(&self, text: &str) -> bool {
        (0..self.0.area.height).any(|y| self.row(y).contains(text))
    }
}

fn first(cell: &Cell) -> char {
    cell.symbol().chars().next().unwrap_or(' ')
}
