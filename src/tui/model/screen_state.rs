//! The state of the screen, and what all actions need of it.

use std::collections::{BTreeMap, VecDeque};

use super::live_state::LiveBench;
use super::math_mode::MathMode;
use super::recording_behind::RecordingBehind;
use super::state::{
    Adjustment, BackgroundJobs, Cursors, Derived, Overlay, Page, Palette, PartialRecording,
    PersistedTraces, Playback, Popup, PrintedTables, Request, SidePanel,
};
use crate::measurement::metadata;
use crate::recording::{Capture, TraceSet};
use crate::scene::Scene;
use crate::scope::Source;
use crate::tui::axis::ViewWindow;

/// The state of the screen.
#[derive(Debug, Clone)]
pub struct ScreenState {
    pub(super) set: TraceSet,
    /// Shots of a recording that is read as it is looked at, and whether there may come more; none
    /// where all are in `set`.
    pub(super) on_tape: Option<PartialRecording>,
    /// The bench that was recorded, or that is struck.
    pub(super) scene: Option<Scene>,
    pub(super) title: String,
    /// Recordings behind this one, from the next to come to the front.
    pub(super) behind: VecDeque<RecordingBehind>,
    /// Which of them is in front: 0 is the one that was opened first.
    pub(super) in_front: usize,
    pub(super) palette: Palette,
    pub(super) shot: usize,
    /// Counts the changes of `traces`.
    pub(super) version: u64,
    pub(super) traces: Vec<Capture>,
    pub(super) references: Vec<Capture>,
    pub(super) persisted_traces: Option<PersistedTraces>,
    pub(super) math: MathMode,
    pub(super) truth: bool,
    pub(super) newtons: bool,
    pub(super) selected: Option<Source>,
    pub(super) window: Option<ViewWindow>,
    /// Lowest and highest frequency on the pages of spectra, where they were chosen (Hz).
    pub(super) band: Option<(f64, f64)>,
    pub(super) adjustments: BTreeMap<Source, Adjustment>,
    pub(super) cursors: Cursors,
    pub(super) grip: Option<(f64, f64)>,
    pub(super) page: Page,
    pub(super) side: SidePanel,
    pub(super) panel: Popup,
    pub(super) prompt: String,
    /// Lines that were typed on the command line.
    pub(super) typed_lines: Vec<String>,
    /// Place in `typed_lines` of the line that was brought back.
    pub(super) recalled: usize,
    pub(super) scroll: usize,
    /// Place of the selected row on a page that is a list.
    pub(super) row: usize,
    pub(super) tables: Option<PrintedTables>,
    pub(super) play: Playback,
    pub(super) live: Option<LiveBench>,
    pub(super) compared_with: Option<String>,
    pub(super) overlay: Overlay,
    pub(super) questions: BackgroundJobs,
    pub(super) derived: Derived,
    pub(super) requests: Vec<Request>,
    pub(super) notice: Option<String>,
    pub(super) running: bool,
}

impl ScreenState {
    /// The first shot as recorded, its first trace selected.
    pub fn new(set: TraceSet, title: String, palette: Palette) -> Self {
        let mut model = Self {
            set,
            on_tape: None,
            scene: None,
            title,
            behind: VecDeque::new(),
            in_front: 0,
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
            side: SidePanel::Nothing,
            panel: Popup::Scope,
            prompt: String::new(),
            typed_lines: Vec::new(),
            recalled: 0,
            scroll: 0,
            row: 0,
            tables: None,
            play: Playback::default(),
            live: None,
            compared_with: None,
            overlay: Overlay::Both,
            questions: BackgroundJobs::default(),
            derived: Derived::default(),
            requests: Vec::new(),
            notice: None,
            running: true,
        };
        model.read_scene();
        model.reload_traces();
        model
    }

    /// Tells the user something.
    pub fn set_notice(&mut self, notice: String) {
        self.notice = Some(notice);
    }

    /// Takes the pending requests.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Whether the screen goes on.
    pub fn is_running(&self) -> bool {
        self.running
    }

    pub(super) fn find(&self, source: Source) -> Option<&Capture> {
        self.captures().iter().find(|capture| capture.waveform.source == source)
    }

    pub(super) fn adjustment(&self, source: Source) -> Adjustment {
        self.adjustments.get(&source).copied().unwrap_or_default()
    }

    /// After a change of shot: the same trace stays selected, or the first one is.
    pub(super) fn keep_selection(&mut self) {
        if self.selected().is_none() {
            self.selected = self.captures().first().map(|c| c.waveform.source);
        }
    }

    /// The scene that travels with the recording.
    pub(super) fn read_scene(&mut self) {
        self.scene = metadata::scene(&self.set).and_then(Result::ok);
    }

    /// The traces of another shot.
    pub(super) fn reload_traces(&mut self) {
        self.version += 1;
        self.rebuild();
    }
}
