//! What the screen knows, and how actions change it; the views read it and change nothing.
//!
//! The recording is never touched: scales and positions that the user turns are kept beside it, for each trace,
//! and shown as different from the recorded ones.

mod update;

use std::collections::BTreeMap;

use crate::recording::{Capture, Shot, TraceSet};
use crate::scope::{Source, Waveform};
use crate::tui::axis::{Vertical, Window};

pub use update::{Action, update};

/// What lies over the scope's screen.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Panel {
    /// Nothing.
    Scope,
    /// The keys.
    Help,
    /// Problems of the file and lines of its log.
    Log,
}

/// Whether the terminal shows colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Palette {
    /// The sixteen colours that every terminal has.
    Colour,
    /// None, as the environment variable `NO_COLOR` asks.
    Plain,
}

/// Whether a trace is on the screen, and if not, why.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Visibility {
    /// It is.
    Shown,
    /// It was turned off.
    Off,
    /// It belongs to another abscissa than the selected trace: a spectrum among signals, or the reverse.
    OtherAxis,
}

/// How a trace is shown differently from its recording.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
struct Adjustment {
    scale: Option<f64>,
    position: Option<f64>,
    off: bool,
}

/// The state of the screen.
#[derive(Debug, Clone)]
pub struct Model {
    set: TraceSet,
    title: String,
    palette: Palette,
    shot: usize,
    selected: Option<Source>,
    window: Option<Window>,
    adjustments: BTreeMap<Source, Adjustment>,
    panel: Panel,
    scroll: usize,
    notice: Option<String>,
    running: bool,
}

impl Model {
    /// The first shot as recorded, its first trace selected.
    #[must_use]
    pub fn new(set: TraceSet, title: String, palette: Palette) -> Self {
        let mut model = Self {
            set,
            title,
            palette,
            shot: 0,
            selected: None,
            window: None,
            adjustments: BTreeMap::new(),
            panel: Panel::Scope,
            scroll: 0,
            notice: None,
            running: true,
        };
        model.keep_selection();
        model
    }

    /// The recording.
    #[must_use]
    pub fn set(&self) -> &TraceSet {
        &self.set
    }

    /// The recording's name.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Whether colours may be used.
    #[must_use]
    pub fn palette(&self) -> Palette {
        self.palette
    }

    /// The shot on screen; `None` in an empty recording.
    #[must_use]
    pub fn shot(&self) -> Option<&Shot> {
        self.set.shots.get(self.shot)
    }

    /// The shot's place in the recording, from 0.
    #[must_use]
    pub fn shot_index(&self) -> usize {
        self.shot
    }

    /// The shot's captures, in channel order.
    #[must_use]
    pub fn captures(&self) -> &[Capture] {
        self.shot().map_or(&[], |shot| &shot.captures)
    }

    /// The selected capture; `None` where there is none.
    #[must_use]
    pub fn selected(&self) -> Option<&Capture> {
        self.find(self.selected?)
    }

    /// Whether `source` is the selected trace.
    #[must_use]
    pub fn is_selected(&self, source: Source) -> bool {
        self.selected == Some(source)
    }

    /// What of the abscissa is on screen; `None` without a trace.
    #[must_use]
    pub fn window(&self) -> Option<Window> {
        self.window.or_else(|| self.recorded_window())
    }

    /// The window of the selected trace's recording; `None` without a trace.
    #[must_use]
    pub fn recorded_window(&self) -> Option<Window> {
        self.selected().map(|capture| Window::recorded(&capture.waveform))
    }

    /// Whether another part of the abscissa is shown than was recorded.
    #[must_use]
    pub fn is_zoomed(&self) -> bool {
        self.window.is_some()
    }

    /// How `waveform` stands on the screen.
    #[must_use]
    pub fn vertical(&self, waveform: &Waveform) -> Vertical {
        let recorded = Vertical::recorded(waveform);
        let adjustment = self.adjustment(waveform.source);
        Vertical {
            scale: adjustment.scale.unwrap_or(recorded.scale),
            position: adjustment.position.unwrap_or(recorded.position),
        }
    }

    /// Whether `waveform` is on the screen.
    #[must_use]
    pub fn visibility(&self, waveform: &Waveform) -> Visibility {
        let same_axis = self
            .selected()
            .is_none_or(|selected| selected.waveform.preamble.x_unit == waveform.preamble.x_unit);
        if self.adjustment(waveform.source).off {
            Visibility::Off
        } else if same_axis {
            Visibility::Shown
        } else {
            Visibility::OtherAxis
        }
    }

    /// What lies over the screen.
    #[must_use]
    pub fn panel(&self) -> Panel {
        self.panel
    }

    /// How many lines of the panel have been scrolled past.
    #[must_use]
    pub fn scroll(&self) -> usize {
        self.scroll
    }

    /// What to tell about the last action, if anything.
    #[must_use]
    pub fn notice(&self) -> Option<&str> {
        self.notice.as_deref()
    }

    /// Whether the screen goes on.
    #[must_use]
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
}
