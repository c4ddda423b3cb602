//! `hertzscope transfer`: how one sensor's signal follows another's, over frequency.

use std::path::{Path, PathBuf};

use anyhow::{anyhow, bail};
use clap::Args;

use super::input::ReadingArguments;
use super::picture::PlotArguments;
use super::progress::JobProgress;
use super::signal::{WindowChoice, named};
use super::spectrum::chain_at;
use super::value::quantity;
use crate::analysis::gate::Gate;
use crate::analysis::transfer::{TransferSettings, transfer};
use crate::data;
use crate::experiment::{self, Integration, Outcome, facts};
use crate::quantity::{Dimension, engineering};
use crate::recording::TraceSet;
use crate::report::transfer::TransferPage;
use crate::scene::Scene;
use crate::scope::Waveform;

/// Shots of noise that a scene's drive plays.
const NOISE_SHOTS: u32 = 8;

/// Show the transfer function and coherence between two sensors, averaged over shots, with the band
/// gap
#[derive(Debug, Args)]
pub struct Arguments {
    /// Recordings (.mcap), a scope's files (.csv, .isf), or folders of them, to average over; or a
    /// scene, whose drive then plays noise
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
    ///
    /// [default: rectangular; of a scene's noise: hann]
    #[arg(long, value_enum, hide_default_value = true)]
    window: Option<WindowChoice>,
    /// Start, e.g. -200us: after the trigger, or for simulated signals after the striker's first
    /// contact; of a scene's noise its lowest frequency, e.g. 1kHz
    #[arg(long, value_name = "T|F", value_parser = bound, allow_hyphen_values = true)]
    from: Option<GateBound>,
    /// Stop at this time; or the noise's highest frequency
    #[arg(long, value_name = "T|F", value_parser = bound, allow_hyphen_values = true)]
    to: Option<GateBound>,
    /// Print as JSON, all bins included
    #[arg(long)]
    json: bool,
    /// No progress bar
    #[arg(long, short)]
    quiet: bool,
    #[command(flatten)]
    plot: PlotArguments,
}

/// A time (s) or a frequency (Hz).
#[derive(Debug, Clone, Copy)]
enum GateBound {
    Time(f64),
    Frequency(f64),
}

fn bound(text: &str) -> Result<GateBound, String> {
    if let Ok(frequency) = quantity(Dimension::FREQUENCY, 0.0.., "1kHz")(text) {
        return Ok(GateBound::Frequency(frequency));
    }
    quantity(Dimension::TIME, .., "200us")(text).map(GateBound::Time)
}

/// A bound of the part of records that is looked at (s); `none` where nothing is said.
fn time(bound: Option<GateBound>, none: f64) -> anyhow::Result<f64> {
    match bound {
        None => Ok(none),
        Some(GateBound::Time(time)) => Ok(time),
        Some(GateBound::Frequency(frequency)) => bail!(
            "found {} beside recordings, expected a time, e.g. 200us; a scene takes frequencies",
            engineering(frequency, "Hz", 4)
        ),
    }
}

impl Arguments {
    /// The scene that is to be measured, if it is one.
    fn scene(&self) -> anyhow::Result<Option<Scene>> {
        let is_included = |file: &Path| {
            data::instrument_names("scenes").iter().any(|name| Path::new(name) == file)
        };
        match self.files.as_slice() {
            [file] if file.extension().is_some_and(|e| e == "toml") || is_included(file) => {
                Ok(Some(Scene::load(file)?))
            }
            _ => Ok(None),
        }
    }

    /// Plays noise of the band that is asked for into the scene's chain, shot by shot, and records
    /// it.
    fn measure(&self, scene: &Scene) -> anyhow::Result<TraceSet> {
        let (Some(GateBound::Frequency(from)), Some(GateBound::Frequency(to))) = (self.from, self.to)
        else {
            let name = &scene.name;
            bail!("{name} is a scene: say the band that its drive is to play, e.g. --from 1kHz --to 20kHz");
        };
        if from >= to {
            bail!("--to: found {}, expected more than --from", engineering(to, "Hz", 4));
        }
        let integration = Integration::Accuracy(scene.accuracy);
        let mut progress = JobProgress::new(&scene.name, self.quiet);
        let outcomes = (1..=NOISE_SHOTS).map(|number| {
            let seed = scene.seed.wrapping_add(u64::from(number));
            let noisy = scene.with_noise((from, to), seed).map_err(|error| anyhow!(error))?;
            let share = |share: f64| (f64::from(number - 1) + share) / f64::from(NOISE_SHOTS);
            Ok(experiment::run(&noisy, integration, number, &mut |done| progress.at(share(done)))?)
        });
        let outcomes: anyhow::Result<Vec<Outcome>> = outcomes.collect();
        progress.done();
        Ok(facts::recording(scene, integration, outcomes?)?)
    }
}

pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.plot.check()?;
    let [from, to] = arguments.between.as_slice() else {
        bail!("--between: found {} signals, expected two, e.g. CH2,CH3", arguments.between.len());
    };
    let scene = arguments.scene()?;
    let (mut pairs, mut notes, mut chain) = (Vec::new(), Vec::new(), None);
    for file in &arguments.files {
        let set = match &scene {
            Some(scene) => arguments.measure(scene)?,
            None => arguments.reading.open(file)?,
        };
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
    // Nothing is played before the time 0, and the noise ends with the scene.
    let gate = match &scene {
        Some(scene) => Gate { from: 0.0, to: scene.duration },
        None => Gate {
            from: time(arguments.from, f64::NEG_INFINITY)?,
            to: time(arguments.to, f64::INFINITY)?,
        },
    };
    let window = match (arguments.window, &scene) {
        (Some(window), _) => window,
        (None, Some(_)) => WindowChoice::Hann,
        (None, None) => WindowChoice::Rectangular,
    };
    let settings = TransferSettings {
        segments: usize::try_from(arguments.segments).unwrap_or(usize::MAX),
        window: window.window(),
        gate,
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
