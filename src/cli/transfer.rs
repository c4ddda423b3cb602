//! `hertzscope transfer`: how one sensor's signal follows another's, over frequency.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::input::ReadingArguments;
use super::picture::PlotArguments;
use super::signal::{WindowChoice, named};
use super::spectrum::chain_at;
use super::value::quantity;
use crate::analysis::gate::Gate;
use crate::analysis::transfer::{TransferSettings, transfer};
use crate::quantity::Dimension;
use crate::report::transfer::TransferPage;
use crate::scope::Waveform;

/// Show the transfer function and coherence between two sensors, averaged over shots, with the band
/// gap
#[derive(Debug, Args)]
pub struct Arguments {
    /// Recordings (.mcap), a scope's files (.csv, .isf), or folders of them, to average over
    #[arg(required = true)]
    files: Vec<PathBuf>,
    /// The two signals, e.g. CH2,CH3; simulated ones by their names, e.g. p14,p27
    #[arg(long, value_name = "FROM,TO", value_delimiter = ',', num_args = 1, required = true)]
    between: Vec<String>,
    #[command(flatten)]
    reading: ReadingArguments,
    /// Cut each shot's record into this many segments
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    segments: u32,
    /// The window function of each segment
    #[arg(long, value_enum, default_value_t = WindowChoice::Rectangular)]
    window: WindowChoice,
    /// Start, e.g. -200us: after the trigger, or for simulated signals after the striker's first
    /// contact
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    from: Option<f64>,
    /// Stop at this time
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    to: Option<f64>,
    /// Print as JSON, all bins included
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let [from, to] = arguments.between.as_slice() else {
        bail!("--between: found {} signals, expected two, e.g. CH2,CH3", arguments.between.len());
    };
    let (mut pairs, mut notes, mut chain) = (Vec::new(), Vec::new(), None);
    for file in &arguments.files {
        let set = arguments.reading.open(file)?;
        for shot in &set.shots {
            let ((x, site, _), (y, ..)) = (named(&set, shot, from)?, named(&set, shot, to)?);
            if pairs.is_empty() {
                (chain, notes) = chain_at(&set, shot.number, site);
            }
            let clipped = |name: &str| {
                let named = shot.captures.iter().map(|c| &c.waveform);
                named
                    .filter(|w| w.source.to_string().eq_ignore_ascii_case(name))
                    .map(Waveform::clipped)
                    .sum::<usize>()
            };
            let clipped = clipped(from) + clipped(to);
            if clipped > 0 {
                notes.push(format!(
                    "{}, shot {}: {clipped} samples are clipped at the converter's ends, which no transfer function describes",
                    file.display(),
                    shot.number
                ));
            }
            pairs.push((x, y));
        }
    }
    let settings = TransferSettings {
        segments: usize::try_from(arguments.segments).unwrap_or(usize::MAX),
        window: arguments.window.window(),
        gate: Gate {
            from: arguments.from.unwrap_or(f64::NEG_INFINITY),
            to: arguments.to.unwrap_or(f64::INFINITY),
        },
    };
    let names = pairs.first().map(|(x, y)| format!("from {} to {}", x.name, y.name));
    let page = TransferPage {
        title: names.unwrap_or_default(),
        found: transfer(&pairs, settings)?,
        shots: pairs.len(),
        window: settings.window.to_string(),
        chain,
        notes,
    };
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, TransferPage::text)
}
