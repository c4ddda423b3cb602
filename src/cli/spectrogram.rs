//! `hertzscope spectrogram`: how a signal's frequencies change with time.

use clap::Args;

use super::picture::PlotArguments;
use super::signal::{SignalArguments, WindowChoice};
use super::value::quantity;
use crate::analysis::spectrum::{Analyser, SpectrumSettings};
use crate::analysis::time_frequency::{Pieces, Spectrogram};
use crate::measurement::metadata;
use crate::quantity::Dimension;
use crate::report::spectrogram::SpectrogramPage;
use crate::report::spectrum::shown_end;

/// Show how a signal's spectrum changes with time: spectra of short segments, one after the other
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    signal: SignalArguments,
    /// Length of a segment, e.g. 200us; the frequency resolution is 1/length
    /// [default: a sixteenth of the record, or what it takes to show the band gap]
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"))]
    segment: Option<f64>,
    /// Time from one segment to the next [default: 1/32 of a segment]
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"))]
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
    let highest = shown_end(&map.columns, chain.as_ref());
    let title = arguments.signal.title(&trace);
    let notes = arguments.signal.clipped(&set).into_iter().collect();
    let page = SpectrogramPage { title, map, chain, highest, pieces, notes };
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, SpectrogramPage::text)
}
