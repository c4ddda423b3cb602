//! What the screen knows, and how actions change it; the views read it and change nothing.
//!
//! The recording is never touched: scales and positions that the user turns are kept beside it, for each trace,
//! and shown as different from the recorded ones. The model does no input and no output: what it needs done it leaves as
//! [`Request`]s, and the answers come back as method calls.

mod accessors;
mod action;
pub mod background_jobs;
mod band;
pub mod command;
mod cursors;
pub mod derived;
pub mod features;
mod front_panel;
mod knob_actions;
pub mod knobs;
pub mod live;
mod replay;
mod selection;
pub mod served;
pub mod state;
pub mod traces;
mod update;

pub use action::Action;

use std::collections::BTreeMap;

use crate::measurement::metadata;
use crate::recording::{Capture, TraceSet};
use crate::scene::Scene;
use crate::scope::{Source, Waveform};
use crate::tui::axis::Window;

pub use background_jobs::Questions;
pub use cursors::CursorReading;
pub use derived::{Derived, Reading};
pub use live::{Live, Struck};
use state::Adjustment;
pub use state::{
    Acquisition, CursorKind, Cursors, Job, Overlay, Page, Palette, Panel, PersistedTraces, Play,
    Request, Side, Strike, Visibility,
};
pub use traces::MathMode;
pub use update::update;

/// Unit of a record's ordinate; some files write `Volts`.
pub fn ordinate_unit(waveform: &Waveform) -> &str {
    match waveform.preamble.y_unit.as_str() {
        "Volts" => "V",
        unit => unit,
    }
}

/// The state of the screen.
#[derive(Debug, Clone)]
pub struct Model {
    set: TraceSet,
    /// Shots of a recording that is read as it is looked at, and whether there may come more; none where all are in `set`.
    on_tape: Option<replay::OnTape>,
    /// The bench that was recorded, or that is struck.
    scene: Option<Scene>,
    title: String,
    palette: Palette,
    shot: usize,
    /// Counts the changes of `traces`.
    version: u64,
    traces: Vec<Capture>,
    references: Vec<Capture>,
    persisted_traces: Option<PersistedTraces>,
    math: MathMode,
    truth: bool,
    newtons: bool,
    selected: Option<Source>,
    window: Option<Window>,
    /// Lowest and highest frequency on the pages of spectra, where they were chosen (Hz).
    band: Option<(f64, f64)>,
    adjustments: BTreeMap<Source, Adjustment>,
    cursors: Cursors,
    grip: Option<(f64, f64)>,
    page: Page,
    side: Side,
    panel: Panel,
    prompt: String,
    scroll: usize,
    play: Play,
    live: Option<Live>,
    compared_with: Option<String>,
    overlay: Overlay,
    questions: Questions,
    derived: Derived,
    requests: Vec<Request>,
    notice: Option<String>,
    running: bool,
}

impl Model {
    /// The first shot as recorded, its first trace selected.
    pub fn new(set: TraceSet, title: String, palette: Palette) -> Self {
        let mut model = Self {
            set,
            on_tape: None,
            scene: None,
            title,
            palette,
            shot: 0,
            version: 0,
            traces: Vec::new(),
            references: Vec::new(),
            persisted_traces: None,
            math: MathMode::Off,
            truth: false,
            newtons: false,
            selected: None,
            window: None,
            band: None,
            adjustments: BTreeMap::new(),
            cursors: Cursors::default(),
            grip: None,
            page: Page::Scope,
            side: Side::Nothing,
            panel: Panel::Scope,
            prompt: String::new(),
            scroll: 0,
            play: Play::default(),
            live: None,
            compared_with: None,
            overlay: Overlay::Both,
            questions: Questions::default(),
            derived: Derived::default(),
            requests: Vec::new(),
            notice: None,
            running: true,
        };
        model.read_scene();
        model.fresh();
        model
    }

    /// Tells the user something.
    pub fn tell(&mut self, notice: String) {
        self.notice = Some(notice);
    }

    /// What is to be done outside; each is handed out once.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Whether the screen goes on.
    pub fn is_running(&self) -> bool {
        self.running
    }

    fn find(&self, source: Source) -> Option<&Capture> {
        self.captures().iter().find(|capture| capture.waveform.source == source)
    }

    fn adjustment(&self, source: Source) -> Adjustment {
        self.adjustments.get(&source).copied().unwrap_or_default()
    }

    /// After a change of shot: the same trace stays selected, or the first one is.
    fn keep_selection(&mut self) {
        if self.selected().is_none() {
            self.selected = self.captures().first().map(|c| c.waveform.source);
        }
    }

    /// The scene that travels with the recording.
    fn read_scene(&mut self) {
        self.scene = metadata::scene(&self.set).and_then(Result::ok);
    }

    /// The traces of another shot.
    fn fresh(&mut self) {
        self.version += 1;
        self.rebuild();
    }
}
