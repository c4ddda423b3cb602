//! The figures in the paper's arrangement.

use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::Spectrum;
use crate::quantity::engineering;
use crate::report::plot::{Axis, COLOURS, Plot, Series, Sheet, Stroke, whole_numbers};
use crate::studies::paper::tables::SpeedStudy;
use crate::studies::paper::{Figure, ForceSignal, Viscous};
use crate::trace::Trace;

/// Highest frequency of the spectra that are shown (Hz).
pub(super) const MAX_FREQUENCY: f64 = 20e3;
/// How much of the record is shown near the end of a chain and on the bench, and far from its end
/// (s).
const NEAR_SPAN: f64 = 2e-3;
const FAR_SPAN: f64 = 12e-3;
/// Where the inset of the far figures starts (s).
const INSET_START: f64 = 6e-3;
/// Signal of the inset: the middle one of three places.
const INSET_SIGNAL: usize = 1;
/// Width of panels, and heights of low and tall ones (pixels).
const PLOT_WIDTH: f64 = 430.0;
const LOW_HEIGHT: f64 = 150.0;
const TALL_HEIGHT: f64 = 430.0;
/// Points of a branch of the dispersion relation.
const BRANCH_POINTS: u32 = 200;
const MILLI: f64 = 1e3;
/// Room for a trace's name above it, as a share of all traces' swings (1).
const NAME_HEIGHT_SHARE: f64 = 0.07;

fn sheet(figure: &Figure, columns: usize, size: (f64, f64), panels: Vec<Plot>) -> Sheet {
    Sheet {
        title: format!("Fig. {}: {}", figure.number, figure.title),
        columns,
        size,
        panels,
        legend: Vec::new(),
        note: String::new(),
    }
}

fn line(name: &str, points: Vec<(f64, f64)>, colour: usize) -> Series {
    let colour = COLOURS[colour % COLOURS.len()];
    Series { name: name.to_owned(), points, colour, stroke: Stroke::Solid }
}

pub(super) fn dispersion_points(chain: &DiatomicChain) -> Vec<(f64, f64, f64)> {
    let phase = |index: u32| std::f64::consts::PI * f64::from(index) / f64::from(BRANCH_POINTS);
    (0..=BRANCH_POINTS).map(phase).map(|k| (k, chain.acoustic(k), chain.optical(k))).collect()
}

pub(super) fn dispersion(figure: &Figure) -> Sheet {
    let chain = &figure.chain;
    let x = Axis::linear("wave number ka/π", 0.0, 1.0);
    let mut panel = Plot::new("", x, Axis::linear("frequency (kHz)", 0.0, 18.0));
    let points = dispersion_points(chain);
    let share = |k: f64| k / std::f64::consts::PI;
    let branch = |of: &dyn Fn(&(f64, f64, f64)) -> f64| {
        points.iter().map(|point| (share(point.0), 1e-3 * of(point))).collect::<Vec<_>>()
    };
    panel.lines.push(line("optical branch", branch(&|p| p.2), 1));
    panel.lines.push(line("acoustic branch", branch(&|p| p.1), 0));
    for (name, frequency) in
        [("f1", chain.gap_bottom()), ("f2", chain.gap_top()), ("f3", chain.cutoff())]
    {
        let kilo = 1e-3 * frequency;
        panel.words.push((0.02, kilo + 0.25, format!("{name} = {kilo:.3} kHz")));
        let edge = line("", vec![(0.0, kilo), (1.0, kilo)], 6);
        panel.lines.push(Series { stroke: Stroke::Dashed, ..edge });
    }
    sheet(figure, 1, (520.0, 380.0), vec![panel])
}

/// The unit prefix that suits `largest`: its factor and its sign.
fn prefix(largest: f64) -> (f64, &'static str) {
    match largest {
        l if l >= 0.5 => (1.0, ""),
        l if l >= 0.5e-3 => (1e3, "m"),
        _ => (1e6, "µ"),
    }
}

fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most: f64, value| most.max(value.abs()))
}

/// Points of a trace from `from` to `to` (s), in milliseconds, times `factor`, moved by `offset`.
fn trace_points(
    trace: &Trace,
    (from, to): (f64, f64),
    factor: f64,
    offset: f64,
) -> Vec<(f64, f64)> {
    let points = trace.values.iter().enumerate().map(|(i, value)| (trace.time(i), value));
    let inside = points.filter(|(time, _)| (from..=to).contains(time));
    inside.map(|(time, value)| (MILLI * time, factor * value + offset)).collect()
}

fn spectrum_points(spectrum: &Spectrum, factor: f64) -> Vec<(f64, f64)> {
    let bins = spectrum.amplitude.iter().enumerate();
    let points = bins.map(|(bin, amplitude)| (1e-3 * spectrum.frequency(bin), factor * amplitude));
    points.take_while(|(kilo, _)| *kilo <= 1e-3 * MAX_FREQUENCY).collect()
}

/// A panel of spectra with the gap of the chain at rest.
fn spectra_panel(title: &str, chain: &DiatomicChain, spectra: &[(&str, &Spectrum)]) -> Plot {
    let shown = spectra.iter().map(|(_, s)| spectrum_points(s, 1.0));
    let heights: Vec<f64> = shown.flatten().map(|(_, amplitude)| amplitude).collect();
    let top = largest(&heights);
    let (factor, sign) = prefix(top);
    let x = Axis::linear("frequency (kHz)", 0.0, 1e-3 * MAX_FREQUENCY);
    let y = Axis::linear(&format!("|C| ({sign}N)"), 0.0, 1.08 * factor * top);
    let mut panel = Plot::new(title, x, y);
    let gap = (1e-3 * chain.gap_bottom(), 1e-3 * chain.gap_top(), "gap".to_owned());
    panel.bands.push(gap);
    for (index, (name, spectrum)) in spectra.iter().enumerate() {
        panel.lines.push(line(name, spectrum_points(spectrum, factor), index));
    }
    panel
}

pub(super) fn rows(figure: &Figure) -> Sheet {
    let letters = [("(a)", "(b)"), ("(c)", "(d)"), ("(e)", "(f)")];
    let mut panels = Vec::new();
    for (signal, (left, right)) in figure.signals.iter().zip(letters) {
        let shown = trace_points(&signal.trace, (0.0, NEAR_SPAN), 1.0, 0.0);
        let values: Vec<f64> = shown.iter().map(|(_, force)| *force).collect();
        let (factor, sign) = prefix(largest(&values));
        let reach = 1.15 * factor * largest(&values);
        let x = Axis::linear("time (ms)", 0.0, MILLI * NEAR_SPAN);
        let y = Axis::linear(&format!("force ({sign}N)"), -reach, reach);
        let mut panel = Plot::new(&format!("{left} {}", signal.trace.name), x, y);
        panel.lines.push(line("", trace_points(&signal.trace, (0.0, NEAR_SPAN), factor, 0.0), 0));
        panels.push(panel);
        panels.push(spectra_panel(
            &format!("{right} its spectrum"),
            &figure.chain,
            &[("", &signal.spectrum)],
        ));
    }
    sheet(figure, 2, (PLOT_WIDTH, LOW_HEIGHT), panels)
}

/// Traces above each other, a grid line each division.
fn stacked_panel(title: &str, traces: &[(String, &Trace)], to: f64) -> Plot {
    let shown: Vec<Vec<(f64, f64)>> =
        traces.iter().map(|(_, trace)| trace_points(trace, (0.0, to), 1.0, 0.0)).collect();
    let bounds = |points: &Vec<(f64, f64)>| {
        points.iter().fold((0.0_f64, 0.0_f64), |(low, high), (_, y)| (low.min(*y), high.max(*y)))
    };
    let bounds: Vec<(f64, f64)> = shown.iter().map(bounds).collect();
    let most = bounds.iter().fold(0.0, |most: f64, (_, high)| most.max(*high));
    let division = 10f64.powf(most.max(f64::MIN_POSITIVE).log10().floor());
    let (factor, sign) = prefix(division);
    let swing: f64 = bounds.iter().map(|(low, high)| (high - low) / division).sum();
    let room = (NAME_HEIGHT_SHARE * swing).ceil();
    let mut baseline = 0.0;
    let mut below = 0.0;
    let mut panel =
        Plot::new(title, Axis::linear("time (ms)", 0.0, MILLI * to), Axis::linear("", 0.0, 1.0));
    for (index, ((low, high), (name, trace))) in bounds.iter().zip(traces).enumerate() {
        // As many whole divisions down as keep it clear of the one above and of its name.
        let above = (high / division + 0.2).ceil();
        baseline -= below + above + room;
        below = (-low / division + 0.2).ceil();
        let points = trace_points(trace, (0.0, to), 1.0 / division, baseline);
        panel.words.push((0.01 * MILLI * to, baseline + above + 0.25, name.clone()));
        panel.lines.push(line("", points, index));
    }
    let bottom = baseline - below;
    panel.y = Axis {
        label: format!("dynamic force, {} {sign}N/div", factor * division),
        from: bottom,
        to: 0.0,
        logarithmic: false,
        ticks: whole_numbers(bottom, 0.0),
    };
    panel
}

fn names(signals: &[ForceSignal]) -> Vec<(String, &Trace)> {
    signals.iter().map(|signal| (signal.trace.name.clone(), &signal.trace)).collect()
}

pub(super) fn far(figure: &Figure) -> Sheet {
    let left = stacked_panel("(a) forces far from the end", &names(&figure.signals), FAR_SPAN);
    let parts: Vec<(&str, &Spectrum)> =
        figure.parts.iter().map(|(name, spectrum)| (name.as_str(), spectrum)).collect();
    let place = figure.signals.get(INSET_SIGNAL);
    let name = place.map_or("", |signal| signal.trace.name.as_str());
    let right = spectra_panel(&format!("(b) spectra {name}"), &figure.chain, &parts);
    let mut panels = vec![left, right];
    if let Some(signal) = place {
        let shown = trace_points(&signal.trace, (INSET_START, FAR_SPAN), 1.0, 0.0);
        let values: Vec<f64> = shown.iter().map(|(_, force)| *force).collect();
        let (factor, sign) = prefix(largest(&values));
        let reach = 1.15 * factor * largest(&values);
        let mut panel = Plot::new(
            &format!("inset of (a): from acoustic to optical, {name}"),
            Axis::linear("time (ms)", MILLI * INSET_START, MILLI * FAR_SPAN),
            Axis::linear(&format!("force ({sign}N)"), -reach, reach),
        );
        panel.lines.push(line(
            "",
            trace_points(&signal.trace, (INSET_START, FAR_SPAN), factor, 0.0),
            1,
        ));
        panels.push(panel);
    }
    sheet(figure, 2, (PLOT_WIDTH, 300.0), panels)
}

pub(super) fn sensors(figure: &Figure) -> Sheet {
    let left = stacked_panel("(c) forces at the sensors", &names(&figure.signals), NEAR_SPAN);
    // The reflection at the wall is left out of the spectra for clarity, as in the paper.
    let felt: Vec<(&str, &Spectrum)> = figure
        .signals
        .iter()
        .filter(|signal| signal.place.key() != "wall")
        .map(|signal| (signal.trace.name.as_str(), &signal.spectrum))
        .collect();
    let right = spectra_panel("(d) their spectra", &figure.chain, &felt);
    sheet(figure, 2, (PLOT_WIDTH, TALL_HEIGHT), vec![left, right])
}

pub(super) fn viscosity(viscosity: &[Viscous]) -> Sheet {
    let name = |v: &Viscous| format!("{} N s/m: {}", v.dashpot, engineering(v.frequency, "Hz", 3));
    let traces: Vec<(String, &Trace)> =
        viscosity.iter().map(|viscous| (name(viscous), &viscous.signal.trace)).collect();
    Sheet {
        title: "Incoming shock of Fig. 10 with a dashpot in every contact".to_owned(),
        columns: 1,
        size: (PLOT_WIDTH + 120.0, TALL_HEIGHT),
        panels: vec![stacked_panel(
            "inside particle 2; mean frequency of the first four periods",
            &traces,
            0.8e-3,
        )],
        legend: Vec::new(),
        note: String::new(),
    }
}

/// Speeds of one kind over the rows, each half a place after the one before.
pub(super) fn speeds(study: &SpeedStudy) -> Sheet {
    let rows = &study.rows;
    let ticks = rows.iter().enumerate().map(|(i, row)| (i as f64, row.paper.scene.clone()));
    let x = Axis {
        label: "scene".to_owned(),
        from: -0.6,
        to: rows.len() as f64 - 0.4,
        logarithmic: false,
        ticks: ticks.collect(),
    };
    let mut panel =
        Plot::new("", x, Axis::linear("speed from particle 14 to 27 (m/s)", 100.0, 200.0));
    let dashpot = format!("half-rise, dashpot {:.1} N s/m", study.dashpot);
    let columns: [(&str, &dyn Fn(usize) -> f64); 5] = [
        ("paper, experiment", &|i| rows[i].paper.experiment_m_per_s),
        ("paper, numerics", &|i| rows[i].paper.numerics_m_per_s),
        ("here, half-rise", &|i| rows[i].lossless.half_rise),
        ("here, peak to peak", &|i| rows[i].lossless.peak),
        (&dashpot, &|i| rows[i].with_dashpot.half_rise),
    ];
    for (index, (name, of)) in columns.into_iter().enumerate() {
        let shift = 0.12 * (index as f64 - 2.0);
        let points = (0..rows.len()).map(|i| (i as f64 + shift, of(i))).collect();
        let colour = [6, 0, 1, 4, 2][index];
        panel.lines.push(Series { stroke: Stroke::Dots, ..line(name, points, colour) });
    }
    Sheet {
        title: "Tables 1 and 2".to_owned(),
        columns: 1,
        size: (900.0, 400.0),
        panels: vec![panel],
        legend: Vec::new(),
        note: String::new(),
    }
}
