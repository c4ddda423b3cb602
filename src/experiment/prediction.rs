//! What a scene predicts without noise and rounding: readings, speeds, and what the scope would
//! show.

use super::acquisition::{signals, trigger};
use super::auto_effects::resolve_auto_effects;
use super::bench::Grid;
use super::error::RunError;
use super::outcome::{Reading, Speed, speeds};
use super::{Integration, method, read_bench, sample_grid, scene_bench};
use crate::scene::Scene;
use crate::scope::ChannelSetup;
use crate::scope::acquire::volts_at_points;
use crate::trace::Trace;

/// A prediction of one bench.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// What each sensor inside a particle feels.
    pub readings: Vec<Reading>,
    /// What the wall feels.
    pub wall: Option<Reading>,
    /// Speeds between the sensors.
    pub speeds: Vec<Speed>,
    /// First peak at each channel with its sensor's droop undone, by the channel's name (V).
    pub heights: Vec<(String, f64)>,
    /// What the scope would show of each channel around the trigger, within its converter's range;
    /// empty where it is not triggered or none were asked for (V).
    pub traces: Vec<Trace>,
}

/// Predicts `scene` to `accuracy` (1), with traces if `traces`.
///
/// # Errors
/// [`RunError`] for states that stop being numbers.
pub fn predict(scene: &Scene, accuracy: f64, traces: bool) -> Result<Prediction, RunError> {
    let integration = Integration::Accuracy(accuracy);
    let mut scene = resolve_auto_effects(scene, integration).into_owned();
    scene.scope.noise = 0.0;
    let scene = &scene;
    let method = method(scene, integration)?;
    let mut grid = sample_grid(scene, 1);
    // The clock's phase is no property of the bench.
    grid.start = (grid.start / grid.interval).floor() * grid.interval;
    let mut bench = scene_bench(scene, &scene.initial_velocities, method, grid, Grid::NEVER);
    bench.run_until(scene.duration, true, &mut |_| ())?;
    let (all, wall) = read_bench(scene, &bench);
    let heights = heights(scene, &all);
    let mut shown = Vec::new();
    if traces {
        let (_, span) = scene.scope.record_span();
        let first = signals(scene, &bench, 1);
        if let Some(found) = trigger(scene, &bench, &first).filter(|found| found.crossed) {
            bench.run_until(
                grid.time(found.index) + span + 2.0 * grid.interval,
                false,
                &mut |_| (),
            )?;
            shown = shown_at(scene, &signals(scene, &bench, 1), found.index);
        }
    }
    Ok(Prediction {
        speeds: speeds(&scene.chain, &all),
        readings: all.into_iter().filter(|reading| reading.particle.is_some()).collect(),
        wall,
        heights,
        traces: shown,
    })
}

fn heights(scene: &Scene, readings: &[Reading]) -> Vec<(String, f64)> {
    let channels = (1..).zip(&scene.scope.channels);
    let height = |(number, channel): (u8, &Option<ChannelSetup>)| {
        let channel = channel.as_ref()?;
        let index = scene.sensors.iter().position(|s| Some(&s.name) == channel.input.as_ref())?;
        let peak = readings.get(index)?.first_peak?.dynamic_n;
        let circuit = scene.circuit(index, channel)?;
        let at_input = channel.vertical.scale / channel.vertical.probe;
        let gain = 1.0 + channel.deviation.gain * scene.scope.model.accuracy.gain_at(at_input);
        Some((format!("CH{number}"), peak * circuit.sensitivity * gain))
    };
    channels.filter_map(height).collect()
}

fn shown_at(scene: &Scene, signals: &[Option<Vec<f64>>], trigger: usize) -> Vec<Trace> {
    let setup = &scene.scope;
    let interval = setup.model.interval(setup.time_base);
    let channels = setup.channels.iter().zip(signals);
    let trace = |(number, (channel, signal)): (u8, (&Option<ChannelSetup>, &Option<Vec<f64>>))| {
        let vertical = channel.as_ref()?.vertical;
        Some(Trace {
            name: format!("CH{number}"),
            unit: "V".to_owned(),
            start: -setup.trigger_point() * interval,
            interval,
            values: volts_at_points(setup, &vertical, signal.as_ref()?, trigger),
        })
    };
    (1..).zip(channels).filter_map(trace).collect()
}
