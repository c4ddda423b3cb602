//! `hertzscope dispersion`: the waves of a recording on the dispersion relation of its chain.

use std::ops::Bound;
use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::input::ReadingArguments;
use super::picture::PlotArguments;
use super::value::quantity;
use crate::analysis::dispersion::DiatomicChain;
use crate::analysis::gate::Gate;
use crate::analysis::wavenumber::spectral_lines;
use crate::measurement::metadata;
use crate::quantity::Dimension;
use crate::recording::TrueSignal;
use crate::report::dispersion::DispersionPage;
use crate::scene::Site;
use crate::trace::Trace;

/// Waves are looked for up to this multiple of the highest frequency that travels (1).
const FREQUENCY_MARGIN: f64 = 1.2;

/// Show frequency and wavenumber of the waves in a simulated recording, with the chain's dispersion
/// relation
#[derive(Debug, Args)]
pub struct Arguments {
    /// A simulated recording (.mcap): waves are found in the contact forces along the chain
    file: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
    /// A particle in the periodic part of the chain to use [default: the first sensor's, else 2]
    #[arg(long, value_name = "N")]
    particle: Option<usize>,
    /// Start, e.g. 200us, after the striker's first contact
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    from: Option<f64>,
    /// Stop at this time
    #[arg(long, value_name = "T", value_parser = quantity(Dimension::TIME, .., "200us"), allow_hyphen_values = true)]
    to: Option<f64>,
    /// Show waves whose amplitude reaches this share of the largest
    #[arg(long, value_name = "SHARE", default_value = "2%", value_parser = quantity(Dimension::NONE, (Bound::Excluded(0.0), Bound::Included(1.0)), "2%"))]
    min_amplitude: f64,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let page = page(arguments)?;
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, DispersionPage::text)
}

fn page(arguments: &Arguments) -> anyhow::Result<DispersionPage> {
    let (set, shot) = arguments.reading.open_single(&arguments.file)?;
    let Some(scene) = metadata::scene(&set) else {
        bail!(
            "found no scene in {}, expected a recording of a simulation: wavenumbers take the forces all along the chain",
            arguments.file.display()
        );
    };
    let scene = scene?;
    let sensor = scene.sensors.iter().find_map(|sensor| match sensor.site {
        Site::Particle(particle) => Some(particle),
        Site::Wall => None,
    });
    let particle = arguments.particle.or(sensor).unwrap_or(2);
    let cell = metadata::cell_and_force(&scene, Site::Particle(particle));
    let contacts = |chain: &DiatomicChain| {
        metadata::cells(&scene, particle, chain.beads_per_cell())
    };
    let found = cell.and_then(|(chain, preload)| Some((chain, preload, contacts(&chain)?)));
    let Some((chain, preload, contacts)) = found else {
        bail!(
            "found no bands at particle {particle} of {}, expected two kinds in turn or equal particles, and a preload",
            scene.name
        );
    };
    let gate = Gate {
        from: arguments.from.unwrap_or(f64::NEG_INFINITY),
        to: arguments.to.unwrap_or(f64::INFINITY),
    };
    let row = |contact: &usize| shot.true_signal(&TrueSignal::Contact(*contact));
    let Some(traces) = contacts.iter().map(row).collect::<Option<Vec<_>>>() else {
        bail!(
            "found no forces of all contacts in shot {}, expected /truth/contact/...",
            shot.number
        );
    };
    // What a force starts from is its static part.
    let dynamic = |trace: &&Trace| -> Vec<f64> {
        let rest = trace.values.first().copied().unwrap_or(0.0);
        let part = trace.values.get(gate.range(trace)).unwrap_or_default();
        part.iter().map(|force| force - rest).collect()
    };
    let rows: Vec<Vec<f64>> = traces.iter().map(dynamic).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let interval = traces.first().map_or(0.0, |trace| trace.interval);
    let (highest, nyquist) = (FREQUENCY_MARGIN * chain.cutoff(), 0.5 / interval);
    if nyquist < chain.cutoff() {
        bail!(
            "found forces along the chain every {interval:e} s, which resolve frequencies to {nyquist:.0} Hz, expected them to {:.0} Hz, above which nothing travels: run the scene for less time",
            chain.cutoff()
        );
    }
    let found = spectral_lines(&rows, interval, (highest, arguments.min_amplitude))?;
    let title =
        format!("{}: waves along the chain around particle {particle}", arguments.file.display());
    Ok(DispersionPage { title, chain, preload, found, cells: rows.len() })
}
