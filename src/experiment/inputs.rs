//! Signals of an impact at the scope's inputs, for a scope whose settings are not the scene's.

use super::acquisition::{external, truth, volts};
use super::auto_effects::resolve_auto_effects;
use super::{Integration, RunError, film_grid, free_grid, method, scene_bench};
use crate::chain::Indentations;
use crate::scene::Scene;
use crate::trace::Trace;

/// Longest simulation, in durations of the scene (1).
const MAX_DURATION_FACTOR: f64 = 10.0;
/// Most samples of a signal; most before the first contact are half of them.
const MAX_SAMPLES: usize = 2_000_000;

/// The sample grid that a scope wants its signals on, and how much of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct InputWindow {
    /// From one sample to the next (s).
    pub interval: f64,
    /// Time before the trigger that the record shows (s).
    pub before: f64,
    /// Time after the trigger that the record shows (s).
    pub after: f64,
}

/// Signals of one impact on a common grid.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Time of the first sample after the striker's first contact (s).
    pub start: f64,
    /// From one sample to the next (s).
    pub interval: f64,
    /// Index of the first sample after the striker's first contact.
    pub contact: usize,
    /// Signal at each channel's probe tip in order; empty for a channel that the scene leaves open
    /// (V).
    pub volts: Vec<Vec<f64>>,
    /// Signal at the external trigger input; empty if the scene leaves it open (V).
    pub external: Vec<f64>,
    /// Ground truth: forces and frames, thinned to fifty thousand samples a trace.
    pub truth: Vec<Trace>,
    /// Indentations that the contacts have at the end.
    pub indentations: Indentations,
}

/// Strikes the scene's chain and follows it for a trigger anywhere within the scene's duration, but
/// for no longer than ten durations and no more than two million samples. Probes are those of the
/// scene, whatever the scope takes them for.
///
/// # Errors
/// [`RunError`] for states that stop being numbers.
pub fn inputs(scene: &Scene, window: InputWindow, shot: u32) -> Result<Inputs, RunError> {
    let integration = Integration::Accuracy(scene.accuracy);
    let scene = &*resolve_auto_effects(scene, integration);
    let method = method(scene, integration)?;
    let longest_before = (MAX_SAMPLES / 2) as f64 * window.interval;
    let grid = free_grid(scene, shot, window.interval, window.before.min(longest_before));
    let mut bench = scene_bench(scene, &scene.velocities(shot), method, grid, film_grid(scene));
    let last = grid.time(MAX_SAMPLES - 1);
    let end = (scene.duration + window.after + 2.0 * grid.interval)
        .min(MAX_DURATION_FACTOR * scene.duration)
        .min(last);
    // In the two strides of a scene's own run, so that both take the same steps.
    bench.run_until(scene.duration.min(end), false, &mut |_| ())?;
    bench.run_until(end, false, &mut |_| ())?;
    let channels = scene.scope.channels.iter();
    let signal = |channel| volts(scene, &bench, channel);
    Ok(Inputs {
        start: grid.start,
        interval: grid.interval,
        contact: grid.samples_until(0.0),
        volts: channels.map(|c| c.as_ref().map(signal).unwrap_or_default()).collect(),
        external: external(scene, &bench),
        truth: truth(scene, &bench),
        indentations: bench.indentations(),
    })
}
