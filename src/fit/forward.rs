//! Computes a scope's traces of a scene, without noise and without rounding: forces through sensor,
//! input and front end, at given times.

use crate::experiment::acquisition::volts;
use crate::experiment::bench::Grid;
use crate::experiment::{Integration, RunError, method, scene_bench};
use crate::scene::Scene;
use crate::scope::front_end::{condition, noise_stream};
use crate::scope::model::signal_samples;
use crate::scope::{ChannelSetup, Deviation, Setup, VerticalSetup};

/// Samples before the first that is wanted, and before the striker's contact.
const SPARE_SAMPLES: f64 = 20.0;
/// Longest simulation, in durations of the scene (1).
const MAX_DURATION_FACTOR: f64 = 10.0;

/// Evenly spaced times after the trigger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TimeAxis {
    /// Time of the first sample (s).
    pub start: f64,
    /// From one sample to the next (s).
    pub interval: f64,
    /// Number of samples.
    pub count: usize,
}

/// The traces at the scene's channels `wanted`, each by its place and its front panel, on `axis`,
/// whose zero is at `trigger` (s) after the striker's first contact (V). Every trace has one sample
/// more at either end. Sensors are what their data tell; the scope is without errors. None where
/// the record would end ten durations after the contact, or the trigger lies as far from it.
///
/// # Errors
/// [`RunError`] for states that stop being numbers.
pub fn forces_at(
    scene: &Scene,
    wanted: &[(usize, VerticalSetup)],
    axis: TimeAxis,
    trigger: f64,
    accuracy: f64,
) -> Result<Option<Vec<Vec<f64>>>, RunError> {
    let most = MAX_DURATION_FACTOR * scene.duration;
    // A search may try any trigger time, infinite ones too.
    if trigger.is_nan() || trigger.abs() > most {
        return Ok(None);
    }
    let first = trigger + axis.start - axis.interval;
    // The circuits start at rest, before anything has moved.
    let before = (first / axis.interval).max(0.0).ceil() + SPARE_SAMPLES;
    let stride = signal_samples(axis.interval);
    let grid = Grid { start: first - before * axis.interval, interval: axis.interval / stride };
    let (stride, count) = (stride as usize, axis.count + 2);
    let skip = before as usize * stride;
    let end = grid.time(skip + stride * count);
    if end > most {
        return Ok(None);
    }
    let method = method(scene, Integration::Accuracy(accuracy))?;
    let mut bench = scene_bench(scene, &scene.initial_velocities, method, grid, Grid::NEVER);
    bench.run_until(end, false, &mut |_| ())?;
    let setup = Setup { noise: 0.0, ..scene.scope.clone() };
    let trace = |(place, vertical): &(usize, VerticalSetup)| {
        let input = setup.channels.get(*place).cloned().flatten().and_then(|c| c.input);
        let channel = ChannelSetup {
            vertical: *vertical,
            input,
            offset: 0.0,
            deviation: Deviation::default(),
        };
        let at_probe = volts(scene, &bench, &channel);
        let mut silent = noise_stream(0, 0, 0);
        let shown = condition(&setup, &channel, grid.interval, &at_probe, &mut silent);
        let mut shown: Vec<f64> =
            shown.into_iter().skip(skip).step_by(stride).take(count).collect();
        // A record that ends before the contact holds nothing.
        shown.resize(count, 0.0);
        shown
    };
    Ok(Some(wanted.iter().map(trace).collect()))
}
