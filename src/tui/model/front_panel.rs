//! The scope's own knobs: on a recording they move the picture, on a running bench they set the
//! scope.

use super::knobs::{pending, typed};
use super::live_state::TunedSettings;
use super::screen_state::ScreenState;
use super::state::RunState;
use crate::scope::{AcquireMode, Slope, Source, TriggerMode, Waveform};
use crate::tui::axis::{PRESSES_PER_DIVISION, TurnDirection, Vertical, ViewWindow};

/// A turn of the position knob: a multiple of the scopes' steps of 0.04 div (div).
const POSITION_STEP: f64 = 0.4;
/// A turn of the trigger level (div).
const LEVEL_STEP: f64 = 0.1;

impl ScreenState {
    /// The other trigger mode.
    pub(super) fn other_mode(&mut self) {
        let mode = self.scope().map(|scope| scope.trigger.mode);
        if self.bench().is_some() {
            let word = if mode == Some(TriggerMode::Auto) { "normal" } else { "auto" };
            self.set_value("scope.trigger.mode".to_owned(), word.to_owned());
        }
    }

    /// The channel whose knobs are turned, as scenes name it: `scope.ch1`.
    pub(super) fn channel_path(&self) -> Option<String> {
        match self.selected? {
            Source::Channel(number) => Some(format!("scope.ch{number}")),
            _ => None,
        }
    }

    /// Settings changed in this session.
    pub(super) fn tuned(&self) -> TunedSettings {
        self.recordings
            .front()
            .live
            .as_ref()
            .map(|live| live.settings().clone())
            .unwrap_or_default()
    }

    /// The value set for `path`, before or after the next strike (unit).
    fn set_for(&self, path: &str) -> Option<f64> {
        pending(self.recordings.front().live.as_ref()?.settings(), path)
    }

    /// Whether the knobs set the scope and not the picture.
    pub(super) fn sets_the_scope(&self) -> bool {
        let runs = |live: &super::LiveBench| live.acquisition != RunState::Stopped;
        self.recordings.front().live.as_ref().is_some_and(runs)
    }

    /// The scope's setting of the selected channel; none while knobs move the picture only.
    fn scope_setting(&self, key: &str) -> Option<(String, Vertical)> {
        let path = self.channel_path().filter(|_| self.sets_the_scope() && !self.newtons)?;
        let waveform = &self.selected()?.waveform;
        Some((format!("{path}.{key}"), Vertical::recorded(waveform)))
    }

    /// The V/div knob.
    pub(super) fn turn_volts(&mut self, turn: TurnDirection) {
        let Some((path, vertical)) = self.scope_setting("scale") else {
            self.adjust(|waveform, vertical| Vertical {
                scale: vertical.turned(waveform, turn),
                ..vertical
            });
            return;
        };
        let probe = self.selected().map_or(1.0, |capture| capture.waveform.vertical.probe);
        let Some(scope) = self.scope() else { return };
        let scales = scope.model.vertical_scales.iter().map(|scale| scale * probe);
        let now = self.set_for(&path).unwrap_or(vertical.scale);
        match neighbour(scales, now, turn) {
            Some(scale) => self.set_value(path, typed(scale, "V/div")),
            None => self.notice = Some("the scope's V/div ends here".to_owned()),
        }
    }

    /// The position knob.
    pub(super) fn turn_position(&mut self, turn: TurnDirection) {
        let step = turn.sign() * POSITION_STEP;
        match self.scope_setting("position") {
            Some((path, vertical)) => {
                let now = self.set_for(&path).unwrap_or(vertical.position);
                self.set_value(path, typed(self.panel_position(now + step), "div"));
            }
            None => {
                self.adjust(|_, vertical| Vertical { position: vertical.moved(step), ..vertical });
            }
        }
    }

    /// The scope's vertical position nearest to `position` (div).
    pub(super) fn panel_position(&self, position: f64) -> f64 {
        let step = self.scope().map_or(0.0, |scope| scope.model.position_step);
        if step > 0.0 { (position / step).round() * step } else { position }
    }

    /// The s/div knob; what stands `anchor` divisions right of the centre stays there.
    pub(super) fn turn_time(&mut self, turn: TurnDirection, anchor: f64) {
        if !self.sets_the_scope() {
            self.look(|window, waveform| window.zoomed(waveform, turn, anchor));
            return;
        }
        let Some(scope) = self.scope() else { return };
        let bases = scope.model.time_bases.iter().copied();
        let now = self.set_for("scope.time_base").unwrap_or(scope.time_base);
        match neighbour(bases, now, turn) {
            Some(base) => self.set_value("scope.time_base".to_owned(), typed(base, "s/div")),
            None => self.notice = Some("the scope's s/div ends here".to_owned()),
        }
    }

    /// The horizontal position knob.
    pub(super) fn turn_pan(&mut self, turn: TurnDirection) {
        let step = -turn.sign() / PRESSES_PER_DIVISION;
        if !self.sets_the_scope() {
            self.look(|window, waveform| window.panned(waveform, step));
            return;
        }
        let Some(scope) = self.scope() else { return };
        let base = self.set_for("scope.time_base").unwrap_or(scope.time_base);
        let now = self.set_for("scope.position").unwrap_or(scope.horizontal_position);
        let position = now + step * base;
        self.set_value("scope.position".to_owned(), typed(position, "s"));
    }

    /// The mouse drags the picture.
    pub(super) fn shift_picture(&mut self, right: f64, up: f64) {
        self.look(|window, waveform| window.panned(waveform, -right));
        if up != 0.0 {
            self.adjust(|_, vertical| Vertical { position: vertical.moved(up), ..vertical });
        }
    }

    /// The trigger level knob.
    pub(super) fn turn_level(&mut self, turn: TurnDirection) {
        if self.bench().is_none() {
            return;
        }
        let Some(scope) = self.scope() else { return };
        let source = scope.trigger.source;
        let channels = (1..).zip(&scope.channels);
        let scale = channels
            .filter(|(number, _)| Some(*number) == source.channel())
            .find_map(|(_, channel)| Some(channel.as_ref()?.vertical.scale));
        let now = self.set_for("scope.trigger.level").unwrap_or(scope.trigger.level);
        let level = now + turn.sign() * LEVEL_STEP * scale.unwrap_or(1.0);
        self.set_value("scope.trigger.level".to_owned(), typed(level, "V"));
    }

    /// The trigger's other edge.
    pub(super) fn other_slope(&mut self) {
        let slope = self.scope().map(|scope| scope.trigger.slope);
        if self.bench().is_some() {
            let word = if slope == Some(Slope::Rise) { "fall" } else { "rise" };
            self.set_value("scope.trigger.slope".to_owned(), word.to_owned());
        }
    }

    /// The selected channel's next coupling.
    pub(super) fn next_coupling(&mut self) {
        let recorded = self.selected().and_then(|capture| capture.waveform.vertical.coupling);
        if self.bench().is_none() {
            return;
        }
        let Some(path) = self.channel_path() else { return };
        let path = format!("{path}.coupling");
        // What was set and is not recorded yet counts.
        let set = self
            .recordings
            .front()
            .live
            .as_ref()
            .and_then(|live| live.settings().get(&path).cloned());
        let now = set.or(recorded.map(|coupling| coupling.to_string())).unwrap_or_default();
        let next = match now.as_str() {
            "DC" => "AC",
            "AC" => "GND",
            _ => "DC",
        };
        self.set_value(path, next.to_owned());
    }

    /// The selected channel's bandwidth limit, on or off.
    pub(super) fn switch_bandwidth_limit(&mut self) {
        let recorded =
            self.selected().and_then(|capture| capture.waveform.vertical.bandwidth_limited);
        if self.bench().is_none() {
            return;
        }
        let Some(path) = self.channel_path() else { return };
        let path = format!("{path}.bandwidth_limit");
        let set = self
            .recordings
            .front()
            .live
            .as_ref()
            .and_then(|live| live.settings().get(&path).cloned());
        let now = set.map_or(recorded == Some(true), |word| word == "true");
        self.set_value(path, (!now).to_string());
    }

    /// The next trigger source: the channels that are on, the external input where something is
    /// there, the mains.
    pub(super) fn next_trigger_source(&mut self) {
        if self.bench().is_none() {
            return;
        }
        let Some(scope) = self.scope() else { return };
        let channels = (1..).zip(&scope.channels).filter(|(_, channel)| channel.is_some());
        let mut sources: Vec<String> = channels.map(|(number, _)| format!("CH{number}")).collect();
        if scope.external.is_some() {
            sources.extend(["EXT".to_owned(), "EXT5".to_owned()]);
        }
        sources.push("LINE".to_owned());
        let path = "scope.trigger.source";
        let set = self
            .recordings
            .front()
            .live
            .as_ref()
            .and_then(|live| live.settings().get(path).cloned());
        let now = set.unwrap_or_else(|| scope.trigger.source.to_string());
        let next = sources.iter().position(|source| *source == now).map_or(0, |place| place + 1);
        if let Some(next) = sources.get(next % sources.len()).cloned() {
            self.notice = Some(format!("trigger source {next}"));
            self.set_value(path.to_owned(), next);
        }
    }

    /// The next way to take records: samples, peaks, averages of ever more shots.
    pub(super) fn next_acquisition(&mut self) {
        if self.bench().is_none() {
            return;
        }
        let Some(scope) = self.scope() else { return };
        let averages = scope.model.limits.averages.clone();
        let set = |path: &str| self.recordings.front().live.as_ref()?.settings().get(path).cloned();
        let mode = set("scope.acquisition").unwrap_or_else(|| {
            match scope.acquisition.mode {
                AcquireMode::Sample => "sample",
                AcquireMode::PeakDetect => "peak detect",
                AcquireMode::Average => "average",
            }
            .to_owned()
        });
        let now = set("scope.averages").and_then(|number| number.parse().ok());
        let now: u32 = now.unwrap_or(scope.acquisition.averages);
        let (mode, number) = match mode.as_str() {
            "sample" => ("peak detect", None),
            "peak detect" => ("average", averages.first().copied()),
            _ => match averages.into_iter().find(|number| *number > now) {
                Some(number) => ("average", Some(number)),
                None => ("sample", None),
            },
        };
        if let Some(number) = number {
            self.notice = Some(format!("average of {number}"));
            self.set_value("scope.averages".to_owned(), number.to_string());
        } else {
            self.notice = Some(mode.to_owned());
        }
        self.set_value("scope.acquisition".to_owned(), mode.to_owned());
    }

    /// The selected channel's next probe.
    pub(super) fn next_probe(&mut self) {
        let probe = self.selected().map(|capture| capture.waveform.vertical.probe);
        if self.bench().is_none() {
            return;
        }
        let probes = self.scope().map(|scope| scope.model.probes.clone());
        let (Some(path), Some(probes)) = (self.channel_path(), probes) else { return };
        let next = probes.iter().find(|p| Some(**p) > probe).or(probes.first());
        if let (Some(next), Some(now), Some(capture)) = (next, probe, self.selected()) {
            let scale = capture.waveform.vertical.scale * next / now;
            let scale = typed(scale, "V/div");
            if let Some(live) = &mut self.recordings.front_mut().live {
                live.set_quietly(format!("{path}.scale"), scale);
            }
            self.set_value(format!("{path}.probe"), typed(*next, ""));
        }
    }

    /// Changes how the selected trace stands on the screen; back at the recorded setting, nothing
    /// is kept.
    pub(super) fn adjust(&mut self, change: impl Fn(&Waveform, Vertical) -> Vertical) {
        let Some(waveform) = self.selected().map(|c| &c.waveform) else {
            return;
        };
        let source = waveform.source;
        let recorded = Vertical::recorded(waveform);
        let changed = change(waveform, self.vertical(waveform));
        let scale = Vertical { position: recorded.position, ..changed };
        let position = Vertical { scale: recorded.scale, ..changed };
        let adjustment = self.adjustments.entry(source).or_default();
        adjustment.scale = (!scale.same_as(&recorded)).then_some(changed.scale);
        adjustment.position = (!position.same_as(&recorded)).then_some(changed.position);
    }

    /// Changes what of the abscissa is on screen; back at the recorded window, nothing is kept.
    pub(super) fn look(&mut self, change: impl Fn(ViewWindow, &Waveform) -> ViewWindow) {
        if self.page.is_some() {
            self.notice =
                Some("zoom works on traces and spectra: Esc goes to the traces".to_owned());
            return;
        }
        let (Some(window), Some(capture)) = (self.window(), self.selected()) else {
            return;
        };
        let recorded = ViewWindow::recorded(&capture.waveform);
        let window = change(window, &capture.waveform);
        self.window = (!window.same_as(&recorded)).then_some(window);
    }
}

/// The step next to `value` among ascending ones.
fn neighbour(steps: impl Iterator<Item = f64>, value: f64, turn: TurnDirection) -> Option<f64> {
    const SAME: f64 = 1e-6;
    let mut steps: Vec<f64> = steps.collect();
    steps.sort_by(f64::total_cmp);
    match turn {
        TurnDirection::Up => steps.into_iter().find(|step| *step > value * (1.0 + SAME)),
        TurnDirection::Down => steps.into_iter().rev().find(|step| *step < value * (1.0 - SAME)),
    }
}
