//! The state of the screen, the actions that change it, and the pages that it can show.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;

use ratatui::Frame;
use tui_input::{Input, InputRequest};

use super::comparison::OtherSide;
use super::recordings::Recordings;
use super::shot_traces::MathMode;
use super::state::{
    Adjustment, BackgroundJobs, BenchOption, Cursors, Derived, Overlay, Palette, PersistedTraces,
    Playback, Popup, SidePanel,
};
use crate::recording::{Capture, TraceSet};
use crate::scope::Source;
use crate::tui::axis::{TurnDirection, ViewWindow};
use crate::tui::job::{Job, JobState};
use crate::tui::key::KeyPress;
use crate::tui::view::layout::ScreenLayout;

/// An action of a key or the mouse.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Action {
    /// Leave the screen.
    Quit,
    /// Close the open panel; without one, leave.
    Back,
    /// Open a panel, or close it when it is open.
    Toggle(Popup),
    /// Move the text of a panel.
    Scroll(TurnDirection, usize),
    /// Select another row of a list, so many rows up or down.
    Row(TurnDirection, usize),
    /// Press a channel's button, counted from 1: selects it and turns it on; if it is selected,
    /// turns it off or on.
    Channel(u8),
    /// The same with any trace.
    Trace(Source),
    /// Select the next trace, or the one before.
    NextTrace(TurnDirection),
    /// Turn the selected trace off or on.
    OnOff,
    /// Turn the selected trace's V/div knob.
    VoltsPerDivision(TurnDirection),
    /// Turn the s/div knob.
    TimePerDivision {
        /// Up is more seconds a division.
        turn: TurnDirection,
        /// The fixed point of the zoom, to the right of the screen's centre (div).
        anchor: f64,
    },
    /// Move the selected trace down or up.
    Position(TurnDirection),
    /// Move the picture left or right.
    Pan(TurnDirection),
    /// The next of several recordings comes to the front.
    NextRecording,
    /// Show another shot.
    Shot(TurnDirection),
    /// Back to how everything was recorded.
    Reset,
    /// The first shot, or the last.
    Ends(TurnDirection),
    /// Play or stop a recording, run or stop a bench.
    RunStop,
    /// Play twice as fast, or half.
    Speed(TurnDirection),
    /// So many seconds have passed (s).
    Tick(f64),
    /// Open a page, or close it when it is open.
    Page(Page),
    /// Open what stands beside the page, or close it.
    Side(SidePanel),
    /// The next kind of cursors.
    Cursors,
    /// The other cursor moves now.
    OtherCursor,
    /// Move the active cursor.
    MoveCursor(TurnDirection),
    /// Move it to the next peak or edge.
    Snap(TurnDirection),
    /// Move it to the first arrival.
    SnapToArrival,
    /// A mouse button goes down.
    Press {
        /// To the right of the graticule's centre (div).
        x: f64,
        /// Above it (div).
        y: f64,
    },
    /// The mouse moves with its button down.
    Drag {
        /// To the right of the graticule's centre (div).
        x: f64,
        /// Above it (div).
        y: f64,
    },
    /// The next math trace.
    Math,
    /// Keep the selected trace as a reference, or empty the selected reference.
    Reference,
    /// Shows or hides the simulated forces at the sensors.
    Truth,
    /// Shows or hides where 95 % of the bench's traces lie.
    Bands,
    /// Volts or newtons.
    Unit,
    /// Earlier shots stay on screen, or not.
    Persistence,
    /// Scales and positions that show everything.
    Autoset,
    /// Wait for one trigger.
    Single,
    /// Take a record without a trigger.
    Force,
    /// Strike the chain.
    Impact,
    /// Turn the trigger level.
    TriggerLevel(TurnDirection),
    /// The trigger's other edge.
    TriggerSlope,
    /// The trigger's other mode.
    TriggerMode,
    /// The selected channel's next coupling.
    Coupling,
    /// The selected channel's next probe.
    Probe,
    /// Select the next knob or effect.
    NextKnob(TurnDirection),
    /// Turn the selected knob.
    TurnKnob(TurnDirection),
    /// Switch the selected effect.
    Switch,
    /// Open the command line, with these words typed already.
    Prompt(&'static str),
    /// Type a letter.
    Type(char),
    /// Delete the letter before the cursor.
    Erase,
    /// Move the cursor of what is typed, or delete there.
    Edit(InputRequest),
    /// Do what was typed.
    Submit,
    /// Complete the word that is being typed.
    Complete,
    /// Bring back the line that was typed before, or after.
    Recall(TurnDirection),
    /// Search the help.
    Search,
    /// Type a value for the selected knob.
    TypeKnob,
    /// The selected channel's bandwidth limit, on or off.
    Bandwidth,
    /// The next trigger source.
    TriggerSource,
    /// The next acquisition mode, or number of averages.
    Acquisition,
}

/// A page in place of the traces: a file in `pages`.
#[derive(Clone, Copy)]
pub struct Page(pub &'static PageSpec);

/// What a page is: its keys, how it changes the model, and how it is drawn.
pub struct PageSpec {
    /// Its name.
    pub name: &'static str,
    /// The key that opens and closes it.
    pub key: char,
    /// Text of the help on that key.
    pub help: &'static str,
    /// Keys that have another meaning on this page than on the traces.
    pub keys: &'static [(KeyPress, Action)],
    /// Keys that the last line names, in order of use.
    pub hints: &'static [(&'static str, &'static str)],
    /// Whether it needs all columns of a small terminal.
    pub is_wide: bool,
    /// Number of its rows, if it is a list.
    pub rows: Option<fn(&ScreenState) -> usize>,
    /// Called after it was opened.
    pub opened: fn(&mut ScreenState),
    /// Called after another shot has come while it is open.
    pub shot_changed: fn(&mut ScreenState),
    /// Called after another bench has come while it is open.
    pub bench_changed: fn(&mut ScreenState),
    /// Does an action that has another meaning on this page; whether it did.
    pub act: fn(&mut ScreenState, Action) -> bool,
    /// Work that its picture needs, for a thread.
    pub derive: fn(&ScreenState) -> Option<DerivedPart>,
    /// Draws it.
    pub draw: fn(&ScreenState, &ScreenLayout, &mut Frame),
}

/// Work whose result is a part of [`Derived`].
pub type DerivedPart = Box<dyn FnOnce(&mut Derived) + Send>;

impl PageSpec {
    /// A page that does nothing but to be drawn.
    pub const PLAIN: Self = Self {
        name: "",
        key: '\0',
        help: "",
        keys: &[],
        hints: &[],
        is_wide: false,
        rows: None,
        opened: |_| (),
        shot_changed: |_| (),
        bench_changed: |_| (),
        act: |_, _| false,
        derive: |_| None,
        draw: |_, _, _| (),
    };
}

impl PartialEq for Page {
    fn eq(&self, other: &Self) -> bool {
        self.0.name == other.0.name
    }
}

impl fmt::Debug for Page {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.0.name)
    }
}

/// A request of the model to the threads; it does no input and no output itself.
#[derive(Debug)]
pub enum Request {
    /// Read the shot at this place of the recording.
    Load(usize),
    /// Send this command to the served scope.
    Send(String),
    /// Write a file as its ending says.
    Save(PathBuf),
    /// Do this job.
    Job(Job<ScreenState>),
}

/// Notes in a recording what an option says of its bench; an error is a message.
pub type NoteOption = fn(&mut TraceSet, BenchOption, &str) -> Result<(), String>;

/// The state of the screen.
#[derive(Debug)]
pub struct ScreenState {
    /// The open recordings.
    pub recordings: Recordings,
    pub(super) palette: Palette,
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
    pub(in crate::tui) band: Option<(f64, f64)>,
    pub(super) adjustments: BTreeMap<Source, Adjustment>,
    pub(super) cursors: Cursors,
    /// Where the mouse holds the picture, from the centre (div).
    pub(in crate::tui) grip: Option<(f64, f64)>,
    /// The page in place of the traces.
    pub page: Option<Page>,
    pub(super) side: SidePanel,
    pub(super) panel: Popup,
    /// What is typed on the command line, or searched in the help.
    pub(super) prompt: Input,
    /// Lines that were typed on the command line.
    pub(super) typed_lines: Vec<String>,
    /// Place in `typed_lines` of the line that was brought back.
    pub(super) recalled: usize,
    pub(super) scroll: usize,
    /// Place of the selected row on a page that is a list.
    pub row: usize,
    /// How the recording is played.
    pub play: Playback,
    /// What the shot on screen is compared with.
    pub(in crate::tui) compared_with: Option<String>,
    pub(in crate::tui) other_side: OtherSide,
    /// How the comparison is shown.
    pub overlay: Overlay,
    /// The background jobs.
    pub jobs: BackgroundJobs,
    pub(super) note_option: Option<NoteOption>,
    pub(super) derived: Derived,
    /// Requests to the threads.
    pub requests: Vec<Request>,
    /// The notice about the last action, if any.
    pub notice: Option<String>,
    pub(super) running: bool,
}

impl ScreenState {
    /// The first shot as recorded, its first trace selected.
    pub fn new(set: TraceSet, title: String, palette: Palette) -> Self {
        let mut model = Self {
            recordings: Recordings::new(title, set),
            palette,
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
            page: None,
            side: SidePanel::Nothing,
            panel: Popup::Scope,
            prompt: Input::default(),
            typed_lines: Vec::new(),
            recalled: 0,
            scroll: 0,
            row: 0,
            play: Playback::default(),
            compared_with: None,
            other_side: OtherSide::default(),
            overlay: Overlay::Both,
            jobs: BackgroundJobs::default(),
            note_option: None,
            derived: Derived::default(),
            requests: Vec::new(),
            notice: None,
            running: true,
        };
        model.reload_traces();
        model
    }

    /// Sets the notice.
    pub fn set_notice(&mut self, notice: String) {
        self.notice = Some(notice);
    }

    /// Sets what notes options that are typed as commands.
    pub fn note_with(&mut self, note_option: NoteOption) {
        self.note_option = Some(note_option);
    }

    /// Takes the pending requests.
    pub fn take_requests(&mut self) -> Vec<Request> {
        std::mem::take(&mut self.requests)
    }

    /// Has a job done; where its queue keeps the newest alone, in place of those that wait.
    pub(in crate::tui) fn ask(&mut self, job: Job<Self>) {
        if job.queue.keeps_newest() {
            let queue = job.queue;
            let is_stale = |request: &Request| matches!(request, Request::Job(waiting) if waiting.queue == queue);
            self.requests.retain(|request| !is_stale(request));
        }
        self.requests.push(Request::Job(job));
    }

    /// Whether the screen goes on.
    pub fn is_running(&self) -> bool {
        self.running
    }

    pub(super) fn find(&self, source: Source) -> Option<&Capture> {
        self.traces.iter().find(|capture| capture.waveform.source == source)
    }

    pub(super) fn adjustment(&self, source: Source) -> Adjustment {
        self.adjustments.get(&source).copied().unwrap_or_default()
    }

    /// After a change of shot: the same trace stays selected, or the first one is.
    pub(super) fn keep_selection(&mut self) {
        if self.selected().is_none() {
            self.selected = self.traces.first().map(|capture| capture.waveform.source);
        }
    }

    /// Makes the traces anew, after another shot.
    pub(super) fn reload_traces(&mut self) {
        self.version += 1;
        self.rebuild();
    }

    /// Opens a page, or closes it when it is open.
    pub fn open_page(&mut self, page: Page) {
        self.page = if self.page == Some(page) { None } else { Some(page) };
        self.play.running = false;
        self.row = 0;
        if self.page.is_some() {
            (page.0.opened)(self);
        }
        self.derive();
    }

    /// Another shot is on screen.
    pub(super) fn shot_changed(&mut self) {
        self.row = 0;
        if let Some(page) = self.page {
            (page.0.shot_changed)(self);
        }
    }

    /// Another bench is on screen: the studies of the one before are dropped.
    pub(super) fn invalidate_studies(&mut self) {
        self.jobs.study = JobState::Idle;
        self.jobs.ledger = JobState::Idle;
        if let Some(page) = self.page {
            (page.0.bench_changed)(self);
        }
    }
}
