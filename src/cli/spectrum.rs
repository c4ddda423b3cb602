//! `hertzscope spectrum`: the frequencies in a recording's signal.

use clap::{Args, ValueEnum};

use super::picture::PlotArguments;
use super::signal::{SignalArguments, WindowChoice};
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::spectrum::{Analyser, Convention, SpectrumSettings};
use crate::measurement::metadata;
use crate::recording::TraceSet;
use crate::report::spectrum::{ListedPeak, SpectrumPage};
use crate::scene::Site;

/// Maxima lower than this share of the highest are not listed (1).
const MIN_LISTED_SHARE: f64 = 0.05;
/// Said wherever band edges are shown.
const SMALL_SIGNAL_NOTE: &str =
    "band edges are those of small signals about the static force at the sensor";
/// At most this many maxima are listed.
const MAX_LISTED: usize = 12;

/// Show the spectrum of a signal: its main peaks, and where the chain's band gap lies
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    signal: SignalArguments,
    /// Amplitude to show
    #[arg(long, value_enum, default_value_t = ConventionChoice::Paper)]
    convention: ConventionChoice,
    /// The window function
    #[arg(long, value_enum, default_value_t = WindowChoice::Rectangular)]
    window: WindowChoice,
    /// Print as JSON, all bins included
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum ConventionChoice {
    /// |X|/M, M samples padded to 5 M with zeros: Herbold et al. (2009), Eq. (11)
    Paper,
    /// One-sided amplitude spectral density, per root hertz
    Density,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let (set, (trace, site, offset)) = arguments.signal.read()?;
    let settings = SpectrumSettings {
        convention: match arguments.convention {
            ConventionChoice::Paper => Convention::Paper,
            ConventionChoice::Density => Convention::Density,
        },
        window: arguments.window.window(),
        gate: arguments.signal.gate(),
        offset,
        ..SpectrumSettings::default()
    };
    let spectrum = Analyser::new().spectrum(&trace, &settings)?;
    let mut peaks = spectrum.peaks(MIN_LISTED_SHARE);
    peaks.truncate(MAX_LISTED);
    let (chain, mut notes) = chain_at(&set, arguments.signal.shot(), site);
    notes.extend(arguments.signal.clipped(&set));
    let peaks = peaks.iter().map(|peak| ListedPeak::new(peak, chain.as_ref())).collect();
    let title = arguments.signal.title(&trace);
    let page = SpectrumPage { title, spectrum, peaks, chain, offset, notes };
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, SpectrumPage::text)
}

/// The chain around the sensor, or why it is not known.
pub fn chain_at(
    set: &TraceSet,
    shot: u32,
    site: Option<Site>,
) -> (Option<DiatomicChain>, Vec<String>) {
    let Some(site) = site else {
        return (
            None,
            vec![
                "no band edges: the sensor's place in the chain is not known; --scene gives it"
                    .to_owned(),
            ],
        );
    };
    match metadata::scene_of(set, shot) {
        Some(Ok(scene)) => match metadata::cell(&scene, site) {
            Some(cell) => (Some(cell), vec![SMALL_SIGNAL_NOTE.to_owned()]),
            None => (
                None,
                vec![
                    "no band edges: the chain is not periodic there, or nothing presses".to_owned(),
                ],
            ),
        },
        Some(Err(error)) => (None, vec![format!("no band edges: {error}")]),
        None => (
            None,
            vec!["no band edges: the file carries no scene; give one with --scene".to_owned()],
        ),
    }
}
