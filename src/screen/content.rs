//! Contents of the screen, as data.

use crate::instrument::Instrument;
use crate::instrument::acquisition::State;
use crate::recording::Capture;
use crate::scope::panel::{CursorFunction, DisplayFormat, DisplayStyle, TriggerType, View};
use crate::scope::word::Word as _;
use crate::scope::{AcquireMode, Panel, Slope, Source, TriggerSource, Waveform};

/// Everything that a picture of the screen shows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Screen {
    /// State and mode of the acquisition; empty if unknown.
    pub status: String,
    /// Waveforms in the order in which they are drawn.
    pub traces: Vec<Waveform>,
    /// Main time base (s/div).
    pub time_base: f64,
    /// Time base of the window, where it is shown (s/div).
    pub window: Option<f64>,
    /// Screen's centre after the trigger (s).
    pub position: f64,
    /// The trigger, where it is known.
    pub trigger: Option<TriggerReadout>,
    /// Title of the menu and its five entries, two lines each.
    pub menu: Vec<[String; 2]>,
    /// Dashed lines.
    pub bars: Vec<Bar>,
    /// Points instead of lines.
    pub dots: bool,
    /// Channel 2 against channel 1.
    pub xy: bool,
    /// How a spectrum is shown.
    pub zoom: Zoom,
    /// Dark on white instead of light on black.
    pub ink_saver: bool,
}

/// The trigger as the screen shows it.
#[derive(Debug, Clone, PartialEq)]
pub struct TriggerReadout {
    /// Where it looks.
    pub source: TriggerSource,
    /// Direction.
    pub slope: Slope,
    /// Level (V).
    pub level: f64,
    /// Whether it is not the edge trigger.
    pub other: Option<TriggerType>,
}

/// A dashed line across the graticule, from its left or lower edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bar {
    /// Upright, at a part of the width (1).
    Vertical(f64),
    /// Level, so far above the centre (div).
    Horizontal(f64),
}

/// How a spectrum is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zoom {
    /// Horizontally (1).
    pub across: f64,
    /// Part of the spectrum in the centre (1).
    pub centre: f64,
    /// Vertically (1).
    pub up: f64,
    /// Position (div).
    pub position: f64,
}

impl Default for Zoom {
    fn default() -> Self {
        Self { across: 1.0, centre: 0.5, up: 1.0, position: 0.0 }
    }
}

/// Every waveform that can be displayed, the first channel last, so that it is drawn on top.
pub(super) const SOURCES: [Source; 9] = [
    Source::Reference('D'),
    Source::Reference('C'),
    Source::Reference('B'),
    Source::Reference('A'),
    Source::Math,
    Source::Channel(4),
    Source::Channel(3),
    Source::Channel(2),
    Source::Channel(1),
];

impl Screen {
    /// The screen of an instrument.
    pub fn of(instrument: &Instrument) -> Self {
        let panel = &instrument.panel;
        let setup = instrument.setup();
        let (start, end) = setup.record_span();
        let across = |time: f64| (time - start) / (end - start);
        let math = &panel.math;
        let trigger = &panel.trigger;
        let other = (panel.trigger_type != TriggerType::Edge).then_some(panel.trigger_type);
        Self {
            status: status(instrument),
            traces: SOURCES
                .iter()
                .filter_map(|s| Some(instrument.waveform(*s).ok()?.into_owned()))
                .collect(),
            time_base: panel.horizontal.scale,
            window: (panel.horizontal.view != View::Main).then_some(panel.horizontal.delay_scale),
            position: setup.horizontal_position,
            trigger: Some(TriggerReadout {
                source: trigger.source,
                slope: trigger.slope,
                level: trigger.level,
                other,
            }),
            menu: super::menu::menu(instrument),
            bars: bars(panel, &across, instrument),
            dots: panel.display.style == DisplayStyle::Dots,
            xy: panel.display.format == DisplayFormat::Xy,
            zoom: Zoom {
                across: math.fft_horizontal_scale,
                centre: math.fft_horizontal_position / 100.0,
                up: math.fft_vertical_scale,
                position: math.fft_vertical_position,
            },
            ink_saver: instrument.service.hard_copy.ink_saver,
        }
    }

    /// The screen of captures alone: traces and scales.
    pub fn of_captures(captures: &[Capture]) -> Self {
        let find = |source| captures.iter().find(|capture| capture.waveform.source == source);
        let traces: Vec<Waveform> =
            SOURCES.iter().filter_map(|s| find(*s)).map(|c| c.waveform.clone()).collect();
        let timed = traces.iter().rev().find(|trace| trace.preamble.x_unit == "s");
        let position = timed.map_or(0.0, |trace| trace.time(trace.codes.len() / 2));
        let time_base = timed.map_or(0.0, |trace| trace.horizontal_scale);
        Self { traces, time_base, position, ink_saver: true, ..Self::default() }
    }
}

pub(super) fn status(instrument: &Instrument) -> String {
    let state = match instrument.state() {
        State::Armed => "Armed",
        State::Ready => "Ready",
        State::Trigger => "Trig'd",
        State::Auto => "Auto",
        State::Save if instrument.acquisitions() > 0 => "Acq Complete",
        State::Save => "Stop",
        State::Scan => "Scan",
    };
    match instrument.panel.acquire.mode {
        AcquireMode::Sample => state.to_owned(),
        AcquireMode::PeakDetect => format!("{state} Peak"),
        AcquireMode::Average => format!("{state} Avg {}", instrument.panel.acquire.averages),
    }
}

pub(super) fn bars(
    panel: &Panel,
    across: &dyn Fn(f64) -> f64,
    instrument: &Instrument,
) -> Vec<Bar> {
    let cursor = &panel.cursor;
    let horizontal = &panel.horizontal;
    let mut bars = match cursor.function {
        CursorFunction::Off => Vec::new(),
        CursorFunction::VerticalBars => {
            cursor.vertical.iter().map(|time| Bar::Vertical(across(*time))).collect()
        }
        CursorFunction::HorizontalBars => match instrument.waveform(cursor.source) {
            Ok(waveform) => {
                let divisions = |value: f64| waveform.height_of(value) / super::strokes::LEVELS;
                let bar = |value: &f64| Bar::Horizontal(divisions(*value));
                cursor.horizontal.iter().map(bar).collect()
            }
            Err(_) => Vec::new(),
        },
    };
    if horizontal.view == View::Zone {
        let half = 0.5 * instrument.model.horizontal_divisions * horizontal.delay_scale;
        let edges = [horizontal.delay_position - half, horizontal.delay_position + half];
        bars.extend(edges.iter().map(|time| Bar::Vertical(across(*time))));
    }
    bars
}

/// The name of a trigger's type on the screen.
pub(super) fn type_name(kind: TriggerType) -> &'static str {
    kind.word()
}
