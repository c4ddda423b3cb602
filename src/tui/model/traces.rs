//! The traces on screen: those of the shot, the math trace, references; which are selected and
//! shown, and how they stand.

use super::screen_state::ScreenState;
use super::shot_traces::{MathMode, shot_traces};
use super::state::{Cursors, Palette, PersistedTraces, Popup, SidePanel, Visibility};
use crate::recording::{Capture, Shot, TrueSignal};
use crate::scope::{Source, Waveform};
use crate::trace::Trace;
use crate::tui::axis::{TurnDirection, Vertical, ViewWindow};

impl ScreenState {
    /// Makes the list of traces again.
    pub(super) fn rebuild(&mut self) {
        self.recordings.rebuild_behind(self.newtons);
        let Some(shot) = self.shot() else {
            self.traces = self.references.clone();
            return;
        };
        let (mut traces, missing) = shot_traces(&self.recordings.front().set, shot, self.newtons);
        if missing.is_some() {
            self.notice = missing;
        }
        if let Some(math) = self.math.trace(&traces) {
            traces.retain(|trace| trace.waveform.source != Source::Math);
            traces.push(math);
        }
        let kept = |reference: &&Capture| {
            traces.iter().all(|trace| trace.waveform.source != reference.waveform.source)
        };
        let references: Vec<Capture> = self.references.iter().filter(kept).cloned().collect();
        traces.extend(references);
        self.traces = traces;
        self.keep_selection();
        self.derive();
    }

    /// The simulated force at the sensor of `waveform`, on the trace's own axis: as volts by the
    /// sensor's sensitivity, or newtons, without what pressed before.
    pub fn truth(&self, waveform: &Waveform) -> Option<Trace> {
        if !self.truth {
            return None;
        }
        let shot = self.shot()?;
        let sensor = self.sensor(waveform.source)?;
        let felt = shot.true_signal(&TrueSignal::Force(sensor.name.clone()))?;
        let rest = felt.values.first().copied().unwrap_or(0.0);
        let gain = match waveform.preamble.y_unit.as_str() {
            "N" => 1.0,
            _ => sensor.sensitivity?,
        };
        let values = felt.values.iter().map(|force| (force - rest) * gain).collect();
        Some(Trace { start: felt.start - shot.trigger_time?, values, ..felt.clone() })
    }

    /// Keeps the selected trace as the next reference.
    pub(super) fn keep_reference(&mut self) {
        let Some(capture) = self.selected().cloned() else { return };
        if let Source::Reference(letter) = capture.waveform.source {
            self.references.retain(|kept| kept.waveform.source != capture.waveform.source);
            self.rebuild();
            self.notice = Some(format!("REF{letter} is empty again"));
            return;
        }
        let taken = |letter: &char| {
            self.traces.iter().any(|kept| kept.waveform.source == Source::Reference(*letter))
        };
        let Some(letter) = ('A'..='D').find(|letter| !taken(letter)) else {
            self.notice = Some("all four references are taken: select one and press R".to_owned());
            return;
        };
        let from = capture.waveform.source;
        let waveform = Waveform { source: Source::Reference(letter), ..capture.waveform };
        self.references.push(Capture { waveform, ..capture });
        self.rebuild();
        self.notice = Some(format!("REF{letter} keeps this {from}"));
    }
}

pub(super) fn next_math(model: &mut ScreenState) {
    // Pairs whose channels were not recorded are passed over.
    for _ in 0..7 {
        model.math = model.math.next();
        model.reload_traces();
        let shown = model.find(Source::Math).is_some();
        if shown || model.math == MathMode::Off {
            break;
        }
    }
    model.notice = Some(format!("MATH {}", model.math.name()));
}

pub(super) fn truth(model: &mut ScreenState) {
    model.truth = !model.truth;
    let has = model.shot().is_some_and(|shot| !shot.truth.is_empty());
    let words = match (model.truth, has) {
        (true, true) => {
            "over each trace: what really happened at its sensor, before the electronics"
        }
        (true, false) => "this recording holds no truth: it was measured, or thinned",
        (false, _) => "truth off",
    };
    model.notice = Some(words.to_owned());
}

pub(super) fn unit(model: &mut ScreenState) {
    model.newtons = !model.newtons;
    for adjustment in model.adjustments.values_mut() {
        adjustment.scale = None;
        adjustment.position = None;
    }
    model.cursors.pair = None;
    let words = if model.newtons { "newtons: droop undone, baseline taken off" } else { "volts" };
    model.notice = Some(words.to_owned());
    model.reload_traces();
    model.place_cursors();
}

pub(super) fn reset(model: &mut ScreenState) {
    model.window = None;
    for adjustment in model.adjustments.values_mut() {
        adjustment.scale = None;
        adjustment.position = None;
    }
}

/// A press of a trace's button.
pub(super) fn press(model: &mut ScreenState, source: Source) {
    if model.find(source).is_none() {
        model.notice = Some(format!("{source} is not in this shot"));
        return;
    }
    let again = model.is_selected(source);
    let adjustment = model.adjustments.entry(source).or_default();
    adjustment.off = again && !adjustment.off;
    select(model, source);
}

/// Selects a trace; if it has another abscissa, the screen changes to that.
fn select(model: &mut ScreenState, source: Source) {
    let unit = |model: &ScreenState| model.selected().map(|c| c.waveform.preamble.x_unit.clone());
    let before = unit(model);
    model.selected = Some(source);
    if unit(model) != before {
        model.window = None;
    }
}

pub(super) fn next_trace(model: &mut ScreenState, turn: TurnDirection) {
    let captures = model.captures();
    let Some(last) = captures.len().checked_sub(1) else {
        return;
    };
    let here = captures.iter().position(|c| model.is_selected(c.waveform.source)).unwrap_or(0);
    let next = match turn {
        TurnDirection::Up if here == last => 0,
        TurnDirection::Up => here + 1,
        TurnDirection::Down => here.checked_sub(1).unwrap_or(last),
    };
    if let Some(source) = captures.get(next).map(|c| c.waveform.source) {
        select(model, source);
    }
}

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
