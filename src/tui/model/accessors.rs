//! Read access to the model for the views.

use super::screen_state::ScreenState;
use super::shot_traces::MathMode;
use super::state::{Cursors, Palette, PersistedTraces, Popup, SidePanel, Visibility};
use crate::recording::{Capture, Shot};
use crate::scope::{Source, Waveform};
use crate::tui::axis::{Vertical, ViewWindow};

impl ScreenState {
    /// Whether colours may be used.
    pub fn palette(&self) -> Palette {
        self.palette
    }

    /// The shot on screen; `None` in an empty recording.
    pub fn shot(&self) -> Option<&Shot> {
        self.recordings.front().shown_shot()
    }

    /// The traces that can be shown: the shot's captures in channel order, math and references.
    pub fn captures(&self) -> &[Capture] {
        &self.traces
    }

    /// Earlier shots that stay on screen, the oldest first; none while they are not kept.
    pub fn persisted_traces(&self) -> Option<&PersistedTraces> {
        self.persisted_traces.as_ref()
    }

    /// Mode of the math trace.
    pub fn math(&self) -> MathMode {
        self.math
    }

    /// The selected capture.
    pub fn selected(&self) -> Option<&Capture> {
        self.find(self.selected?)
    }

    /// Whether `source` is the selected trace.
    pub fn is_selected(&self, source: Source) -> bool {
        self.selected == Some(source)
    }

    /// The visible part of the abscissa; `None` without a trace.
    pub fn window(&self) -> Option<ViewWindow> {
        self.window.or_else(|| self.recorded_window())
    }

    /// The window of the selected trace's recording; `None` without a trace.
    pub fn recorded_window(&self) -> Option<ViewWindow> {
        self.selected().map(|capture| ViewWindow::recorded(&capture.waveform))
    }

    /// Whether another part of the abscissa is shown than was recorded.
    pub fn is_zoomed(&self) -> bool {
        self.window.is_some()
    }

    /// How `waveform` stands on the screen.
    pub fn vertical(&self, waveform: &Waveform) -> Vertical {
        let recorded = Vertical::recorded(waveform);
        let adjustment = self.adjustment(waveform.source);
        Vertical {
            scale: adjustment.scale.unwrap_or(recorded.scale),
            position: adjustment.position.unwrap_or(recorded.position),
        }
    }

    /// Whether `waveform` is on the screen.
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

    /// The cursors.
    pub fn cursors(&self) -> &Cursors {
        &self.cursors
    }

    /// The open side panel.
    pub fn side(&self) -> SidePanel {
        self.side
    }

    /// The open popup.
    pub fn panel(&self) -> Popup {
        self.panel
    }

    /// The command line as typed so far.
    pub fn prompt(&self) -> &str {
        self.prompt.value()
    }

    /// The command line before and behind the cursor.
    pub fn prompt_parts(&self) -> (&str, &str) {
        let typed = self.prompt.value();
        let place =
            typed.char_indices().nth(self.prompt.cursor()).map_or(typed.len(), |(at, _)| at);
        typed.split_at(place)
    }

    /// How many lines of the panel have been scrolled past.
    pub fn scroll(&self) -> usize {
        self.scroll
    }
}
