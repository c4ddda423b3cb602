//! `hertzscope bands`: where a chain's band gap lies, and how it moves with the preload.

use std::path::PathBuf;

use anyhow::bail;
use clap::Args;

use super::picture::PlotArguments;
use super::value::{ABOVE_ZERO, quantity};
use crate::analysis::dispersion::DiatomicChain;
use crate::measurement::metadata;
use crate::quantity::Dimension;
use crate::report::dispersion::{BandsPage, PressedChain};
use crate::scene::{Scene, Site};

/// Points from the lowest to the highest preload.
const POINTS: u32 = 13;

/// Preloads closer than this are one row (1).
const SAME_PRELOAD: f64 = 1e-9;

/// Show a chain's band edges as a function of its preload: pass bands, gap, speed of sound
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// A particle in the periodic part of the chain to use [default: the first sensor's, else 2]
    #[arg(long, value_name = "N")]
    particle: Option<usize>,
    /// Lowest preload
    #[arg(long, value_name = "F", default_value = "0.1N", value_parser = quantity(Dimension::FORCE, ABOVE_ZERO, "2.38N"))]
    from: f64,
    /// Highest preload
    #[arg(long, value_name = "F", default_value = "100N", value_parser = quantity(Dimension::FORCE, ABOVE_ZERO, "2.38N"))]
    to: f64,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    if arguments.to <= arguments.from {
        bail!(
            "found a highest preload of {} N, expected more than the lowest, {} N",
            arguments.to,
            arguments.from
        );
    }
    let scene = Scene::load(&arguments.scene)?;
    let sensor = scene.sensors.iter().find_map(|sensor| match sensor.site {
        Site::Particle(particle) => Some(particle),
        Site::Wall => None,
    });
    let particle = arguments.particle.or(sensor).unwrap_or(2);
    let site = Site::Particle(particle);
    let own = metadata::cell_and_force(&scene, site).map(|(_, force)| force);
    let Some((chain, now)) = metadata::cell_under(&scene, site, arguments.from) else {
        bail!(
            "found no bands at particle {particle} of {}, expected two kinds in turn or equal particles",
            scene.name
        );
    };
    // Hertz: the stiffness goes with the cubic root of the force, the cell with what contacts give.
    let at = |force: f64| (force, chain.pressed(now, force));
    let step = (arguments.to / arguments.from).powf(1.0 / f64::from(POINTS - 1));
    let mut rows: Vec<(f64, DiatomicChain)> =
        (0..POINTS).map(|i| at(arguments.from * step.powf(f64::from(i)))).collect();
    let is_new = |force: &f64| rows.iter().all(|(row, _)| (row / force - 1.0).abs() > SAME_PRELOAD);
    let added = own.filter(is_new).map(at);
    rows.extend(added);
    rows.sort_by(|a, b| a.0.total_cmp(&b.0));
    let page = BandsPage {
        scene: scene.name,
        particle,
        preload: own,
        bands: rows.into_iter().map(|(force, chain)| PressedChain::new(force, chain)).collect(),
    };
    arguments.plot.save(&page, || page.picture())?;
    super::show(&page, arguments.json, BandsPage::text)
}
