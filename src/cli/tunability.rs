//! `hertzscope tunability`: band edges, speeds and what arrives, over preload, masses, modulus and
//! striker.

use std::path::PathBuf;

use std::sync::Mutex;

use anyhow::anyhow;
use clap::Args;
use serde_json::{Value, json};

use super::picture::PlotArguments;
use super::progress::JobProgress;
use crate::analysis::dispersion::DiatomicChain;
use crate::quantity::{Dimension, parse};
use crate::report;
use crate::scene::adjust::Adjustable;
use crate::studies::tunability::{TunedNumber, TunedPoint, Tuning, tune};

/// Bands of frequency that JSON tells of, each 500 Hz wide.
const BANDS: usize = 40;

/// Map pass bands and pulse speed over a chain's preload, masses, moduli and striker, or any number
/// of the scene
#[derive(Debug, Args)]
pub struct Arguments {
    /// An included scene, or the path of a scene file
    #[arg(default_value = "magnet-0.61g")]
    scene: PathBuf,
    /// Number of the scene to vary, by its path as in a sweep, e.g. particles.ptfe_sphere.mass; `*`
    /// varies all that it names by one ratio [default: preload, masses, moduli, striker]
    #[arg(long, value_name = "PATH", value_delimiter = ',')]
    vary: Vec<String>,
    /// Number of values of each parameter
    #[arg(long, value_name = "N", default_value_t = 33, value_parser = clap::value_parser!(u32).range(2..=1000))]
    points: u32,
    /// Vary each parameter from its value divided by this to its value times this
    #[arg(long, value_name = "RATIO", default_value = "10", value_parser = span)]
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

fn span(text: &str) -> Result<f64, String> {
    match parse(text, Dimension::NONE) {
        Ok(ratio) if ratio > 1.0 && ratio <= 1000.0 => Ok(ratio),
        Ok(_) => Err(format!("found {text}, expected a ratio above 1, 1000 at most")),
        Err(error) => Err(format!("{error}, expected a ratio, e.g. 10")),
    }
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
    arguments.plot.save(|| report::tunability_svg(&title, &found))?;
    if arguments.json {
        let tunings: Vec<Value> = found.iter().map(as_json).collect();
        super::print(&serde_json::to_string_pretty(
            &json!({ "scene": scene.name, "numbers": tunings }),
        )?)
    } else {
        super::print(&report::tunability(&title, &found))
    }
}

fn as_json(tuning: &Tuning) -> Value {
    let number = &tuning.number;
    json!({
        "path": number.path,
        "unit": number.unit,
        "now": number.now() / number.scale,
        "points": tuning.points.iter().map(|at| point(at, number.scale)).collect::<Vec<_>>(),
    })
}

fn point(point: &TunedPoint, scale: f64) -> Value {
    let of = |value: fn(&DiatomicChain) -> f64| point.chain.map(|chain| value(&chain));
    json!({
        "value": point.value / scale,
        "f1_hz": of(DiatomicChain::gap_bottom),
        "f2_hz": of(DiatomicChain::gap_top),
        "f3_hz": of(DiatomicChain::cutoff),
        "long_wave_speed_m_per_s": of(DiatomicChain::sound_speed),
        "pulse_speed_m_per_s": point.pulse_speed,
        "first_peak_ratio": point.transmission,
        "transmitted_db_per_500_hz": report::transmitted(point, BANDS),
    })
}
