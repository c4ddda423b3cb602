//! `hertzscope spectrogram`: how a signal's frequencies change with time.

use clap::Args;
use serde_json::json;

use super::picture::PlotArguments;
use super::signal::{SignalArguments, WindowChoice, time};
use crate::analysis::spectrum::{Analyser, SpectrumSettings};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::measurement::metadata;
use crate::report::spectrogram::{SpectrogramPage, svg, text};

/// Without a highest frequency or band edges, the map ends at this share of half the sampling
/// frequency (1).
const SHOWN_SHARE: f64 = 0.25;
/// With band edges it ends at this multiple of the highest (1).
const BAND_MARGIN: f64 = 1.5;

/// Show how a signal's spectrum changes with time: spectra of short segments, one after the other
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    signal: SignalArguments,
    /// Length of a segment, e.g. 200us; the frequency resolution is 1/length
    /// [default: a sixteenth of the record, or what it takes to show the band gap]
    #[arg(long, value_name = "T", value_parser = time)]
    segment: Option<f64>,
    /// Time from one segment to the next [default: a thirty-second part of a segment]
    #[arg(long, value_name = "T", value_parser = time)]
    hop: Option<f64>,
    /// The window function of each segment
    #[arg(long, value_enum, default_value_t = WindowChoice::Hann)]
    window: WindowChoice,
    /// Print as JSON, the whole map included
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let (set, (trace, site, offset)) = arguments.signal.read()?;
    let gate = arguments.signal.gate();
    let length = gate.range(&trace).len();
    let scene = metadata::scene_of(&set, arguments.signal.shot()).and_then(Result::ok);
    let chain = site.zip(scene).and_then(|(site, scene)| metadata::cell(&scene, site));
    let gap = chain.map(|chain| chain.gap_top() - chain.gap_bottom());
    let in_samples = |time: f64| (time / trace.interval).round() as usize;
    let mut pieces = Pieces::of_record(length, trace.interval, gap);
    if let Some(segment) = arguments.segment.map(in_samples) {
        pieces = Pieces::moving_on(segment);
    }
    pieces.hop = arguments.hop.map_or(pieces.hop, in_samples);
    let settings = SpectrumSettings {
        window: arguments.window.window(),
        gate,
        offset,
        ..SpectrumSettings::default()
    };
    let map = Spectrogram::of(&mut Analyser::new(), &trace, &settings, pieces)?;
    let highest =
        chain.map_or(SHOWN_SHARE * 0.5 / trace.interval, |chain| BAND_MARGIN * chain.cutoff());
    let title = arguments.signal.title(&trace);
    let page = SpectrogramPage { title, map, chain, highest };
    arguments.plot.save(|| svg(&page))?;
    let clipped = arguments.signal.clipped(&set);
    if !arguments.json {
        let note = clipped.map(|note| format!("  note  {note}"));
        let lines: Vec<String> = std::iter::once(text(&page)).chain(note).collect();
        return super::print(&lines.join("\n"));
    }
    let map = &page.map;
    let first = map.columns.first();
    super::print(&serde_json::to_string_pretty(&json!({
        "signal": page.title,
        "unit": first.map(|column| &column.unit),
        "convention": first.map(|column| column.convention.to_string()),
        "window": first.map(|column| column.window.to_string()),
        "segment_samples": pieces.segment,
        "hop_samples": pieces.hop,
        "step_hz": first.map(|column| column.step),
        "resolution_hz": first.map(|column| column.resolution),
        "f1_hz": page.chain.map(|chain| chain.gap_bottom()),
        "f2_hz": page.chain.map(|chain| chain.gap_top()),
        "f3_hz": page.chain.map(|chain| chain.cutoff()),
        "notes": clipped.into_iter().collect::<Vec<_>>(),
        "times_s": map.times,
        "ridge_hz": map.ridge(0.0, f64::INFINITY),
        "amplitude": map.columns.iter().map(|column| &column.amplitude).collect::<Vec<_>>(),
    }))?)
}
