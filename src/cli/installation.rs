//! Whether the program does on this machine what it does on others: what ships is whole, and a run
//! known from outside comes out right, with every instruction set and down to the oscilloscope's
//! record.

use serde::Serialize;

use crate::data;
use crate::experiment::ensemble::{Case, Ensemble, Readout, places};
use crate::experiment::facts::recording;
use crate::experiment::pulse::{Peak, PulseRecorder};
use crate::experiment::{Integration, run};
use crate::motion::kernel::InstructionSet;
use crate::recording::Shot;
use crate::recording::mcap;
use crate::scene::Scene;

/// The scene that is run.
const SCENE: &str = "magnet-0.61g";
/// Total force at its first peak in newtons and its time in seconds, in particles 2, 14 and 27 and
/// at the wall (unit).
///
/// Source: `tests/golden`, solved by others with DOP853, restarted at each contact event, and by
/// extrapolation without events, which differ by less than 2e-12 N and 1e-17 s.
pub const GOLDEN: [[f64; 2]; 4] = [
    [6.701_987_908_021_472, 5.529_139_704_793_175e-5],
    [5.610_915_878_211_899, 3.565_147_377_611_143e-4],
    [5.051_851_269_131_889, 6.672_846_884_028_306e-4],
    [7.802_124_472_250_505, 9.517_025_433_042_373e-4],
];
/// Accuracy that the run is asked for and held to (1).
const ACCURACY: f64 = 1e-9;

/// One thing that was looked at.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Check {
    /// What.
    pub what: String,
    /// Whether it is as it should be.
    pub good: bool,
    /// The result.
    pub found: String,
}

/// Looks at everything.
pub fn examine() -> Vec<Check> {
    let mut checks = vec![shipped()];
    let Ok(scene) = Scene::load(SCENE) else { return checks };
    let case = Case::of(&scene, ACCURACY, &places(&scene));
    for set in InstructionSet::available() {
        let ensemble = Ensemble::new(ACCURACY).threads(1).instructions(set);
        let found = ensemble.run(std::slice::from_ref(&case), &|_| ()).into_iter().next();
        checks.push(held(format!("a run with {}", set.name()), found.and_then(Result::ok)));
    }
    checks.push(recorded(&scene));
    checks
}

/// Whether every scene that ships, with all it stands on, is sound.
fn shipped() -> Check {
    let names = Scene::names();
    let wrong: Vec<&str> =
        names.iter().copied().filter(|name| Scene::load(name).is_err()).collect();
    let good = wrong.is_empty() && data::recording("herbold-2009-tables.toml").is_some();
    let found = if wrong.is_empty() {
        format!("{} scenes with their instruments", names.len())
    } else {
        format!("cannot be read: {}", wrong.join(", "))
    };
    Check { what: "shipped files".to_owned(), good, found }
}

/// Holds a run against the golden.
fn held(what: String, readout: Option<Readout>) -> Check {
    let peaks = readout
        .map(|readout| readout.pulses.iter().map(PulseRecorder::first_peak).collect::<Vec<_>>());
    let Some(peaks) = peaks.filter(|peaks| peaks.len() == GOLDEN.len()) else {
        return Check { what, good: false, found: "the run could not go on".to_owned() };
    };
    let off = |(peak, [force, time]): (&Option<Peak>, &[f64; 2])| {
        peak.map_or(f64::INFINITY, |peak| {
            (peak.total_n / force - 1.0).abs().max((peak.time_s / time - 1.0).abs())
        })
    };
    let worst = peaks.iter().zip(&GOLDEN).map(off).fold(0.0, f64::max);
    let found = format!(
        "{SCENE}: largest relative difference from the reference {worst:.0e} (limit {ACCURACY:e})"
    );
    Check { what, good: worst <= ACCURACY, found }
}

/// Runs the scene down to the oscilloscope's record, writes that and reads it back.
fn recorded(scene: &Scene) -> Check {
    let what = "recording".to_owned();
    match round_trip(scene) {
        Ok((bytes, true)) => {
            let found = format!("{bytes} bytes written and read back");
            Check { what, good: true, found }
        }
        Ok((_, false)) => {
            let found = "other waveforms are read than were written".to_owned();
            Check { what, good: false, found }
        }
        Err(found) => Check { what, good: false, found },
    }
}

/// Bytes of the recording, and whether the waveforms that are read are those that were written.
fn round_trip(scene: &Scene) -> Result<(u64, bool), String> {
    let integration = Integration::Accuracy(scene.accuracy);
    let outcome = run(scene, integration, 1, &mut |_| ()).map_err(|error| error.to_string())?;
    let name = format!("hertzscope-doctor-{}.mcap", std::process::id());
    let file = std::env::temp_dir().join(name);
    let set = recording(scene, integration, [outcome]).map_err(|error| error.to_string())?;
    let read = mcap::write(&file, &set).map_err(|error| error.to_string()).and_then(|()| {
        let bytes = std::fs::metadata(&file).map_or(0, |file| file.len());
        let read = mcap::read(&file).map_err(|error| error.to_string())?;
        let waveforms = |shot: &Shot| {
            shot.captures.iter().map(|capture| capture.waveform.clone()).collect::<Vec<_>>()
        };
        let same = read.shots.first().map(waveforms) == Some(waveforms(&set.shots[0]));
        Ok((bytes, same && !set.shots[0].captures.is_empty()))
    });
    // The trial's files are of no further use.
    let _ = std::fs::remove_file(&file);
    read
}
