//! The pages over frequency: the selected trace's spectrum with the chain's band edges, and how it
//! changes with time.

use ratatui::Frame;
use ratatui::layout::Rect;
use ratatui::style::{Color, Modifier, Style};
use ratatui::text::{Line, Span};

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Analyser, Spectrum, SpectrumSettings, Window};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::measurement::metadata;
use crate::recording::Capture;
use crate::report::spectrum::shown_end;
use crate::trace::Trace;
use crate::tui::axis::{DIVISIONS_ACROSS, PRESSES_PER_DIVISION, Steps, TurnDirection};
use crate::tui::model::{Action, DerivedPart, Page, PageSpec, Palette, ScreenState};
use crate::tui::view::axes::put;
use crate::tui::view::colours::{colour, colour_of};
use crate::tui::view::diagram::{Diagram, DiagramAxis};
use crate::tui::view::layout::ScreenLayout;
use crate::tui::view::panel::message;
use crate::tui::view::readout::spelled;

/// Decibels from the top of the page to its bottom (dB).
const DECIBEL_RANGE: f64 = 80.0;
/// Decibels from one tone of the map to the next (dB).
const DECIBELS_PER_TONE: f64 = 10.0;
/// Tones of the map, from little to much.
const TONES: [&str; 5] = [" ", "░", "▒", "▓", "█"];

/// Spectra of records longer than this are made of every second, third, ... sample: a terminal
/// shows no more.
const MAX_SPECTRUM_SAMPLES: usize = 20_000;

/// Keys of both pages in the last line.
const HINTS: &[(&str, &str)] = &[
    ("?", "help"),
    ("Esc", "traces"),
    ("1-4", "channel"),
    ("← →", "Hz/div"),
    ("H L", "lower, higher"),
    ("z", "all"),
    ("F S", "spectrum, over time"),
    (", .", "shot"),
    ("w", "save"),
];

/// The spectrum of the selected trace.
pub const SPECTRUM: Page = Page(&PageSpec {
    name: "spectrum",
    key: 'F',
    help: "spectrum with the chain's band edges",
    hints: HINTS,
    act,
    derive: derive_spectrum,
    draw: draw_spectrum,
    ..PageSpec::PLAIN
});

/// Its spectrum over time.
pub const MAP: Page = Page(&PageSpec {
    name: "map",
    key: 'S',
    help: "spectrum over time",
    hints: HINTS,
    act,
    derive: derive_map,
    draw: draw_map,
    ..PageSpec::PLAIN
});

/// The knobs of the abscissa are those of the frequencies.
fn act(model: &mut ScreenState, action: Action) -> bool {
    match action {
        Action::TimePerDivision { turn, anchor } => model.zoom_band(turn, anchor),
        Action::Pan(turn) => model.pan_band(-turn.sign() / PRESSES_PER_DIVISION),
        Action::Reset => model.band = None,
        Action::Press { x, y } => model.grip = Some((x, y)),
        Action::Drag { x, y } => {
            if let Some((from, _)) = model.grip.replace((x, y)) {
                model.pan_band(from - x);
            }
        }
        _ => return false,
    }
    true
}

/// The selected trace over time, for a thread; and the chain around its sensor.
fn input(model: &ScreenState) -> (Result<Trace, String>, Option<DiatomicChain>) {
    let capture = model.selected();
    let site = capture.and_then(|capture| model.sensor(capture.waveform.source)?.site());
    let scene = model.recordings.front().scene.as_ref();
    let chain = site.zip(scene).and_then(|(site, scene)| metadata::cell(scene, site));
    let trace = capture.and_then(Capture::trace).map(thinned);
    (trace.ok_or_else(|| "this is a spectrum already: select a trace over time".to_owned()), chain)
}

fn derive_spectrum(model: &ScreenState) -> Option<DerivedPart> {
    let (trace, chain) = input(model);
    Some(Box::new(move |derived| {
        derived.chain = chain;
        derived.spectrum = Some(trace.and_then(|trace| spectrum(&trace)));
    }))
}

fn derive_map(model: &ScreenState) -> Option<DerivedPart> {
    let (trace, chain) = input(model);
    Some(Box::new(move |derived| {
        let gap = chain.as_ref().map(|chain| chain.gap_top() - chain.gap_bottom());
        derived.map = Some(trace.and_then(|trace| map(&trace, gap)));
        derived.chain = chain;
    }))
}

/// Why there is no spectrum yet.
fn nothing(model: &ScreenState) -> &'static str {
    if model.derived().is_pending { "computing ..." } else { "there is no trace to transform" }
}

/// Keeps every n-th sample of a long record.
fn thinned(trace: Trace) -> Trace {
    let step = trace.values.len().div_ceil(MAX_SPECTRUM_SAMPLES).max(1);
    let interval = trace.interval * step as f64;
    Trace { interval, values: trace.values.into_iter().step_by(step).collect(), ..trace }
}

fn spectrum(trace: &Trace) -> Result<Spectrum, String> {
    let settings = SpectrumSettings { offset: mean(trace), ..SpectrumSettings::default() };
    Analyser::new().spectrum(trace, &settings).map_err(|error| error.to_string())
}

fn map(trace: &Trace, gap: Option<f64>) -> Result<Spectrogram, String> {
    let pieces = Pieces::of_record(trace.values.len(), trace.interval, gap);
    let settings = SpectrumSettings {
        offset: mean(trace),
        window: Window::Hann,
        ..SpectrumSettings::default()
    };
    Spectrogram::of(&mut Analyser::new(), trace, &settings, pieces).map_err(|e| e.to_string())
}

fn mean(trace: &Trace) -> f64 {
    trace.values.iter().sum::<f64>() / trace.values.len().max(1) as f64
}

impl ScreenState {
    /// The spectrum on screen, or the first one of the map.
    fn shown_spectrum(&self) -> Option<&Spectrum> {
        match self.page {
            Some(page) if page == MAP => {
                self.derived().map.as_ref()?.as_ref().ok()?.columns.first()
            }
            _ => self.derived().spectrum.as_ref()?.as_ref().ok(),
        }
    }

    /// Highest frequency that was sampled (Hz).
    fn highest(&self) -> Option<f64> {
        let spectrum = self.shown_spectrum()?;
        Some(spectrum.step * spectrum.amplitude.len() as f64)
    }

    /// Lowest and highest frequency on screen (Hz), by default those of the picture that the
    /// command `spectrum` draws.
    pub fn band(&self) -> Option<(f64, f64)> {
        let sampled = self.highest()?;
        let chain = self.derived().chain.as_ref();
        let whole = match self.page {
            Some(page) if page == MAP => {
                shown_end(&self.derived().map.as_ref()?.as_ref().ok()?.columns, chain)
            }
            _ => shown_end(std::slice::from_ref(self.shown_spectrum()?), chain),
        }
        .min(sampled);
        // What was chosen for another trace may lie beyond this one's.
        let chosen = self.band.filter(|(_, high)| *high <= sampled * (1.0 + 1e-9));
        Some(chosen.unwrap_or((0.0, whole)))
    }

    /// Whether another band is shown than by default.
    pub fn is_band_zoomed(&self) -> bool {
        self.band.is_some()
    }

    /// The Hz/div knob; what stands `anchor` divisions right of the centre stays there.
    pub(in crate::tui) fn zoom_band(&mut self, turn: TurnDirection, anchor: f64) {
        let (Some((low, high)), Some(spectrum), Some(sampled)) =
            (self.band(), self.shown_spectrum(), self.highest())
        else {
            return;
        };
        let divisions = f64::from(DIVISIONS_ACROSS);
        let scale = (high - low) / divisions;
        let (finest, coarsest) = (spectrum.step, sampled / divisions);
        let next = Steps::OneTwoAndHalfFive.next(scale, turn).clamp(finest.min(coarsest), coarsest);
        let centre = f64::midpoint(low, high) + anchor * (scale - next);
        self.put_band(centre, next * divisions, sampled);
    }

    /// Moves the band by `divisions` to higher frequencies.
    pub(in crate::tui) fn pan_band(&mut self, divisions: f64) {
        let (Some((low, high)), Some(sampled)) = (self.band(), self.highest()) else { return };
        let shift = divisions * (high - low) / f64::from(DIVISIONS_ACROSS);
        self.put_band(f64::midpoint(low, high) + shift, high - low, sampled);
    }

    /// Shows `width` around `centre`, inside of what was sampled.
    fn put_band(&mut self, centre: f64, width: f64, sampled: f64) {
        let low = (centre - width / 2.0).clamp(0.0, (sampled - width).max(0.0));
        self.band = Some((low, low + width));
    }
}

/// The name of the signal, and the band edges; `what` it is in the words that fit into `width`
/// columns.
fn heading(model: &ScreenState, what: [&str; 2], width: u16) -> Line<'static> {
    let [long, short] = what.map(|what| heading_of(model, what));
    if long.width() <= usize::from(width) { long } else { short }
}

fn heading_of(model: &ScreenState, what: &str) -> Line<'static> {
    let bold = Style::new().add_modifier(Modifier::BOLD);
    let name = model.selected().map_or_else(String::new, |c| c.waveform.source.to_string());
    let sensor = model.selected().and_then(|c| model.sensor(c.waveform.source));
    let sensor = sensor.map_or_else(String::new, |sensor| format!(" ({})", sensor.name));
    let mut parts = vec![Span::styled(format!("{what} {name}{sensor}  "), bold)];
    match &model.derived().chain {
        Some(chain) => {
            let gap = Style::new().fg(colour(model.palette(), Color::LightRed));
            for (name, edge) in chain.edges() {
                parts.push(Span::styled(format!("{name} {}  ", spelled(edge, "Hz", 4)), gap));
            }
            let zoomed = model.is_band_zoomed();
            parts.push(Span::raw(match (zoomed, chain.has_gap()) {
                (true, _) => "z: all",
                (false, true) => "gap f1-f2",
                (false, false) => "no gap",
            }));
        }
        None => parts.push(Span::raw("no band edges: no chain known around this sensor")),
    }
    Line::from(parts)
}

/// The spectrum in decibels below its highest line.
fn draw_spectrum(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let spectrum = match &model.derived().spectrum {
        Some(Ok(spectrum)) => spectrum,
        Some(Err(problem)) => return message(problem, area, frame),
        None => return message(nothing(model), area, frame),
    };
    let palette = model.palette();
    let chain = model.derived().chain.as_ref();
    let top = spectrum.amplitude.iter().skip(1).copied().fold(0.0, f64::max);
    if !(top > 0.0 && top.is_finite()) {
        return message("this trace never changes: it has no spectrum", area, frame);
    }
    let level = 20.0 * top.log10();
    let high = (level / 10.0).ceil() * 10.0;
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let (lowest, highest) = model.band().unwrap_or_default();
    let frequency = DiagramAxis::linear(lowest, highest, "Hz");
    let grid = colour(palette, Color::DarkGray);
    let mut sheet =
        Diagram::new(below, frequency, DiagramAxis::linear(high - DECIBEL_RANGE, high, "dB"), grid);
    let edge_colour = colour(palette, Color::LightRed);
    if let Some(chain) = chain {
        sheet.shade(chain.gap_bottom(), chain.gap_top(), colour(palette, Color::Red));
    }
    let source = model.selected().map(|capture| capture.waveform.source);
    let line = source.map_or(Color::Reset, |source| colour_of(palette, source));
    let points = spectrum
        .amplitude
        .iter()
        .enumerate()
        .map(|(bin, amplitude)| (bin as f64 * spectrum.step, 20.0 * amplitude.log10()));
    sheet.line(points, line);
    for (_, edge) in chain.iter().flat_map(|chain| chain.edges()) {
        sheet.upright(edge, edge_colour);
    }
    sheet.draw(colour(palette, Color::Gray), frame);
    let bold = Style::new().fg(edge_colour).add_modifier(Modifier::BOLD);
    for (name, edge) in chain.iter().flat_map(|chain| chain.edges()) {
        sheet.write((edge, high), name, bold, frame);
    }
    let short = format!("|X|/M, dB re 1 {},", spectrum.unit);
    let head = heading(model, [&format!("Spectrum {short} of"), &short], area.width);
    frame.render_widget(head, Rect { height: 1, ..area });
}

/// Frequency upward, time to the right, tones by 10 dB.
fn draw_map(model: &ScreenState, layout: &ScreenLayout, frame: &mut Frame) {
    let area = layout.page;
    let map = match &model.derived().map {
        Some(Ok(map)) => map,
        Some(Err(problem)) => return message(problem, area, frame),
        None => return message(nothing(model), area, frame),
    };
    let (Some(start), Some(end)) = (map.times.first(), map.times.last()) else {
        return message("the record is too short for a map", area, frame);
    };
    let palette = model.palette();
    let chain = model.derived().chain.as_ref();
    let below = Rect { y: area.y + 1, height: area.height - 1, ..area };
    let (shown, grid) = (model.band().unwrap_or_default(), colour(palette, Color::DarkGray));
    let frequency = DiagramAxis::linear(shown.0, shown.1, "Hz");
    let sheet = Diagram::new(below, DiagramAxis::linear(*start, *end, "s"), frequency, grid);
    sheet.draw(colour(palette, Color::Gray), frame);
    let top =
        map.columns.iter().flat_map(|c| c.amplitude.iter().skip(1)).copied().fold(0.0, f64::max);
    let inner = sheet.inner();
    for column in 0..inner.width {
        let place = usize::from(column) * map.columns.len() / usize::from(inner.width.max(1));
        let Some(spectrum) = map.columns.get(place) else { continue };
        for row in 0..inner.height {
            let (low, high) = band(row, inner.height, shown);
            let amplitude = largest_amplitude(spectrum, low, high);
            let (tone, style) = tone(20.0 * (amplitude / top).log10(), palette);
            let at = Rect { x: inner.x + column, y: inner.y + row, width: 1, height: 1 };
            put(frame.buffer_mut(), at, at.y, tone, style);
        }
    }
    let edge = Style::new().fg(colour(palette, Color::LightRed)).add_modifier(Modifier::BOLD);
    for (name, frequency) in chain.iter().flat_map(|chain| chain.edges()) {
        let inside = (shown.0..=shown.1).contains(&frequency);
        if let Some((_, y)) = sheet.cell(*start, frequency).filter(|_| inside) {
            let line = format!("{name}{}", "╌".repeat(usize::from(inner.width / 8)));
            put(frame.buffer_mut(), inner, y, &line, edge);
        }
    }
    let words = ["Spectrum over time, 10 dB per shade, of", "10 dB/shade,"];
    let head = heading(model, words, area.width);
    frame.render_widget(head, Rect { height: 1, ..area });
}

/// Frequencies of a row of cells, from the top (Hz).
fn band(row: u16, rows: u16, (low, high): (f64, f64)) -> (f64, f64) {
    let edge = |row: u16| high - (high - low) * f64::from(row) / f64::from(rows.max(1));
    (edge(row + 1), edge(row))
}

/// The highest amplitude in a band (unit).
fn largest_amplitude(spectrum: &Spectrum, low: f64, high: f64) -> f64 {
    let bin = |frequency: f64| (frequency / spectrum.step).round() as usize;
    let (first, last) = (bin(low).max(1), bin(high).max(bin(low) + 1));
    let inside = spectrum.amplitude.iter().take(last + 1).skip(first);
    inside.copied().fold(0.0, f64::max)
}

/// A tone for decibels below the loudest.
fn tone(decibels: f64, palette: Palette) -> (&'static str, Style) {
    const COLOURS: [Color; 5] =
        [Color::Reset, Color::Blue, Color::Cyan, Color::Yellow, Color::LightRed];
    let steps = TONES.len() - 1;
    let below = (-decibels / DECIBELS_PER_TONE).clamp(0.0, 4.0) as usize;
    let place = steps - below.min(steps);
    let shade = TONES.get(place).copied().unwrap_or(" ");
    let wanted = COLOURS.get(place).copied().unwrap_or(Color::Reset);
    (shade, Style::new().fg(colour(palette, wanted)))
}
