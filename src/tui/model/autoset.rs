//! Autoset: the first pulses of all traces fill the screen. On a recording the picture changes; on
//! a bench that runs, the scope is set; a served scope has an autoset of its own.

use super::knobs::typed;
use super::screen_state::ScreenState;
use super::state::Visibility;
use crate::measurement::arrivals::Survey;
use crate::scope::{Setup, Source, Waveform};
use crate::tui::axis::{Steps, ViewWindow, is_spectrum};
use crate::tui::job::{Job, Queue};

/// Most that a trace takes of the eight divisions upward: half a division is left for rounding its
/// position (div).
const SWING: f64 = 7.5;
/// Most that the first pulses take of the ten divisions across (div).
const PULSES: f64 = 9.0;
/// Steps that positions are rounded to: half divisions are easier to read (div).
const POSITION_STEP: f64 = 0.5;
/// A clipped trace is larger than it is seen (1).
const CLIPPED_FACTOR: f64 = 2.0;
/// Widths of a first pulse before and behind the middle of its rise, between which all of it lies
/// (1).
const PULSE_WIDTHS: (f64, f64) = (1.0, 2.0);

/// `value` on the next of steps of `step` (unit).
fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

/// Lowest and highest value between two abscissae, of all values where none is between them (unit).
fn range(waveform: &Waveform, window: ViewWindow) -> (f64, f64) {
    let span = |inside: &dyn Fn(f64) -> bool| {
        let values = waveform.values().enumerate();
        let values = values.filter(|(index, _)| inside(waveform.time(*index)));
        let values = values.map(|(_, value)| value);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        })
    };
    let shown = span(&|time| (window.left()..=window.right()).contains(&time));
    if shown.0 <= shown.1 { shown } else { span(&|_| true) }
}

/// The first pulses of several traces.
struct FirstPulses {
    /// Before the earliest of them (s).
    from: f64,
    /// Behind the latest (s).
    to: f64,
    /// Middle of the rise of the earliest (s).
    earliest: f64,
    /// Its channel.
    channel: String,
    /// Its height (V).
    height: f64,
}

/// What autoset changes.
#[derive(Default)]
struct Autoset {
    /// Part of the abscissa on screen; none if it is as recorded.
    window: Option<ViewWindow>,
    /// Traces with their scales and positions on screen (div).
    traces: Vec<(Source, f64, f64)>,
    /// Settings of the scope, by the scene's keys.
    settings: Vec<(String, String)>,
    /// Whether a trace was clipped.
    clipped: bool,
}

impl ScreenState {
    /// Shows the first pulses of all traces as large as the screen allows.
    pub(super) fn autoset(&mut self) {
        if self.is_served() {
            self.send(":AUTOS EXEC");
            self.notice = Some("sent AUTOSet EXECute: the next record shows it".to_owned());
            return;
        }
        let sets_the_scope = self.sets_the_scope();
        let traces = match self.shot() {
            Some(shot) if sets_the_scope => &shot.captures,
            _ => &self.traces,
        };
        let shown: Vec<Waveform> = traces
            .iter()
            .map(|capture| capture.waveform.clone())
            .filter(|waveform| self.visibility(waveform) == Visibility::Shown)
            .filter(|waveform| !is_spectrum(waveform))
            .collect();
        let (Some(_), Some(survey)) = (shown.first(), self.survey_job()) else { return };
        let scope = self.scope().filter(|_| sets_the_scope).cloned();
        self.ask(Job::new(
            Queue::Key,
            move |_| {
                let pulses = first_pulses(&survey(), &shown);
                Ok(match scope {
                    Some(scope) => scope_settings(&scope, &shown, pulses),
                    None => picture(&shown, pulses),
                })
            },
            Self::apply_autoset,
        ));
    }

    fn apply_autoset(&mut self, found: Result<Autoset, String>) {
        let found = match found {
            Ok(found) => found,
            Err(problem) => return self.set_notice(problem),
        };
        let Some(((path, value), rest)) = found.settings.split_last() else {
            for (source, scale, position) in found.traces {
                let adjustment = self.adjustments.entry(source).or_default();
                (adjustment.scale, adjustment.position) = (Some(scale), Some(position));
            }
            self.window = found.window;
            return;
        };
        // The bench may have gone behind meanwhile.
        let Some(live) = &mut self.recordings.front_mut().live else { return };
        live.settings.extend(rest.iter().cloned());
        if found.clipped {
            self.notice = Some("a trace was clipped: a again fits it".to_owned());
        }
        self.set_value(path.clone(), value.clone());
    }
}

/// The first pulses of these traces; none if no trace has one.
fn first_pulses(survey: &Survey, shown: &[Waveform]) -> Option<FirstPulses> {
    let is_shown = |name: &str| shown.iter().any(|waveform| waveform.source.to_string() == name);
    let channels = survey.channels.iter().filter(|channel| is_shown(&channel.channel));
    let pulses = channels.filter_map(|channel| {
        let half = channel.arrivals.iter().find(|arrival| arrival.estimator == "half_rise")?;
        let (time, width) = (half.time_s?.value, channel.width_s?.value);
        Some(FirstPulses {
            from: time - PULSE_WIDTHS.0 * width,
            to: time + PULSE_WIDTHS.1 * width,
            earliest: time,
            channel: channel.channel.clone(),
            height: channel.height_v?.value,
        })
    });
    pulses.reduce(|one, other| {
        let (from, to) = (one.from.min(other.from), one.to.max(other.to));
        let first = if other.earliest < one.earliest { other } else { one };
        FirstPulses { from, to, ..first }
    })
}

/// Changes of the picture.
fn picture(shown: &[Waveform], pulses: Option<FirstPulses>) -> Autoset {
    let Some(first) = shown.first() else { return Autoset::default() };
    let recorded = ViewWindow::recorded(first);
    let window = pulses.map_or(recorded, |FirstPulses { from, to, .. }| {
        ViewWindow::around(first, f64::midpoint(from, to), (to - from) / PULSES)
    });
    let fit = |waveform: &Waveform| {
        let (low, high) = range(waveform, window);
        if !(high - low).is_normal() {
            return None;
        }
        let scale = Steps::OneTwoFive.at_least((high - low) / SWING);
        let position = rounded(-f64::midpoint(low, high) / scale, POSITION_STEP);
        Some((waveform.source, scale, position))
    };
    Autoset {
        window: (!window.same_as(&recorded)).then_some(window),
        traces: shown.iter().filter_map(fit).collect(),
        ..Autoset::default()
    }
}

/// Time base, position, trigger, and each channel's scale and position of `scope`. The trigger is
/// at half the height of the earliest pulse.
fn scope_settings(scope: &Setup, shown: &[Waveform], pulses: Option<FirstPulses>) -> Autoset {
    let next = |steps: &[f64], least: f64| {
        let fitting = steps.iter().copied().filter(|step| *step >= least * (1.0 - 1e-9));
        fitting.reduce(f64::min).or_else(|| steps.iter().copied().reduce(f64::max))
    };
    let mut settings = Vec::new();
    let mut set = |key: &str, text: String| settings.push((format!("scope.{key}"), text));
    let mut window = shown.first().map(ViewWindow::recorded);
    if let Some(FirstPulses { from, to, earliest, channel, height }) = pulses
        && let Some(base) = next(&scope.model.time_bases, (to - from) / PULSES)
    {
        let after = rounded(f64::midpoint(from, to) - earliest, POSITION_STEP * base);
        set("time_base", typed(base, "s/div"));
        set("position", typed(after, "s"));
        set("trigger.source", channel);
        set("trigger.level", typed(height / 2.0, "V"));
        set("trigger.slope", if height > 0.0 { "rise" } else { "fall" }.to_owned());
        window = Some(ViewWindow { centre: earliest + after, scale: base });
    }
    let mut clipped = false;
    for waveform in shown {
        let (Source::Channel(number), Some(window)) = (waveform.source, window) else {
            continue;
        };
        let (low, high) = range(waveform, window);
        let is_clipped = waveform.clipped() > 0;
        clipped |= is_clipped;
        let factor = if is_clipped { CLIPPED_FACTOR } else { 1.0 };
        let probe = waveform.vertical.probe;
        let scales: Vec<f64> = scope.model.vertical_scales.iter().map(|s| s * probe).collect();
        let Some(scale) = next(&scales, factor * (high - low) / SWING) else { continue };
        let position = rounded(-f64::midpoint(low, high) / scale, POSITION_STEP);
        set(&format!("ch{number}.scale"), typed(scale, "V/div"));
        let step = scope.model.position_step;
        let position = if step > 0.0 { rounded(position, step) } else { position };
        set(&format!("ch{number}.position"), typed(position, "div"));
    }
    Autoset { settings, clipped, ..Autoset::default() }
}
