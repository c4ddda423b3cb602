//! `hertzscope tunability`: band edges, speeds and what arrives, over preload, masses, modulus and
//! striker.

use std::ops::Bound;
use std::path::PathBuf;
use std::sync::Mutex;

use anyhow::anyhow;
use clap::Args;

use super::picture::PlotArguments;
use super::progress::JobProgress;
use super::value::quantity;
use crate::quantity::Dimension;
use crate::report::{self, TunabilityPage};
use crate::scene::adjust::Adjustable;
use crate::studies::tunability::{TunedNumber, tune};

/// Map pass bands and pulse speed over a chain's preload, masses, moduli and striker, or any number
/// of the scene
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Number of the scene to vary, by its path as in a sweep, e.g. `particles.ptfe_sphere.mass`;
    /// `*` varies all that it names by one ratio [default: preload, masses, moduli, striker]
    #[arg(long, value_name = "PATH", value_delimiter = ',')]
    vary: Vec<String>,
    /// Number of values of each parameter
    #[arg(long, value_name = "N", default_value_t = 33, value_parser = clap::value_parser!(u32).range(2..=1000))]
    points: u32,
    /// Vary each parameter from its value divided by this to its value times this
    #[arg(long, value_name = "RATIO", default_value = "10", value_parser = quantity(Dimension::NONE, (Bound::Excluded(1.0), Bound::Included(1000.0)), "10"))]
    span: f64,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    plot: PlotArguments,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let mut adjustable = Adjustable::load(&arguments.scene)?;
    let scene = adjustable.scene()?;
    let numbers = if arguments.vary.is_empty() {
        TunedNumber::defaults(&mut adjustable)?
    } else {
        let at = |path: &String| TunedNumber::at(&mut adjustable, path);
        arguments.vary.iter().map(at).collect::<Result<_, _>>()?
    };
    let progress = Mutex::new(JobProgress::new(&scene.name, arguments.quiet));
    let found = tune(&adjustable, numbers, arguments.points, arguments.span, &|share| {
        if let Ok(mut progress) = progress.lock() {
            progress.at(share);
        }
    });
    progress.into_inner().map_err(|_| anyhow!("a thread has failed"))?.done();
    let found = found?;
    let title = format!("{}: {}", scene.name, scene.title);
    let page = TunabilityPage { scene: scene.name, title, tunings: found };
    arguments.plot.save(&page, || report::tunability_picture(&page.title, &page.tunings))?;
    super::show(&page, arguments.json, |page| report::tunability(&page.title, &page.tunings))
}
