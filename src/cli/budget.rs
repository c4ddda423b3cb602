//! `hertzscope budget`: which input of an uncertain scene carries how much of each prediction's
//! uncertainty.

use std::path::{Path, PathBuf};

use clap::Args;

use super::picture::PlotArguments;
use super::progress::JobProgress;
use crate::predict::{SampleOptions, UncertainPrediction, uncertain_prediction};
use crate::report;
use crate::scene::adjust::Adjustable;

/// Show how much each uncertain input contributes to the uncertainty of each prediction
#[derive(Debug, Args)]
pub struct Arguments {
    /// A scene with an `[uncertainty]` table: an included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    #[command(flatten)]
    draws: DrawArguments,
    #[command(flatten)]
    plot: PlotArguments,
    /// Print as JSON
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(short, long)]
    quiet: bool,
}

/// How an uncertain scene is sampled.
#[derive(Debug, Clone, Copy, Args)]
pub struct DrawArguments {
    /// Number of Monte Carlo runs over the scene's uncertain inputs (Latin hypercube)
    /// [default: 1000; of `compare` 300, for a fast answer]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(20..=1_000_000))]
    samples: Option<u32>,
    /// Random seed of these runs
    #[arg(long, value_name = "N", default_value_t = 1)]
    sample_seed: u64,
}

impl DrawArguments {
    /// The same with `samples` runs if no number of them is asked for.
    pub fn or(self, samples: u32) -> Self {
        Self { samples: self.samples.or(Some(samples)), ..self }
    }

    /// The prediction of `scene` with its uncertainty.
    pub fn predict(
        self,
        scene: impl AsRef<Path>,
        bands: bool,
        quiet: bool,
    ) -> anyhow::Result<UncertainPrediction> {
        let mut adjustable = Adjustable::load(scene)?;
        let progress = std::sync::Mutex::new(JobProgress::new("samples", quiet));
        let report = |share: f64| {
            if let Ok(mut progress) = progress.lock() {
                progress.at(share);
            }
        };
        let default = SampleOptions::default().samples;
        let samples =
            self.samples.map_or(default, |count| usize::try_from(count).unwrap_or(usize::MAX));
        let options = SampleOptions { samples, seed: self.sample_seed };
        let found = uncertain_prediction(&mut adjustable, options, bands, &report);
        if let Ok(progress) = progress.into_inner() {
            progress.done();
        }
        Ok(found?)
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let found = arguments.draws.predict(&arguments.scene, false, arguments.quiet)?;
    arguments.plot.save(&found, || report::budget_picture(&found))?;
    super::show(&found, arguments.json, report::uncertainty_budget)
}
