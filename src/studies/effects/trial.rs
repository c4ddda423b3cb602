//! Runs with and without an effect, in turn: what it costs and what it changes.

use std::time::{Duration, Instant};

use serde::Serialize;

use crate::chain::Chain;
use crate::experiment::acquisition::signals;
use crate::experiment::bench::Bench;
use crate::experiment::bench::Grid;
use crate::experiment::outcome::{Reading, speeds};
use crate::experiment::run::Run;
use crate::experiment::{Integration, RunError, film_grid, method, sample_grid, scene_bench};
use crate::numeric::statistics::{median, quantile};
use crate::scene::{Scene, input_load};

/// Fewest pairs of runs that are timed.
const MIN_PAIRS: usize = 5;
/// Most pairs of runs that are timed.
const MAX_PAIRS: usize = 101;
/// Draws of an effect that chance decides.
pub const DRAWS: u64 = 100;
/// Time after which no more pairs than the fewest are timed.
const TIME_LIMIT: Duration = Duration::from_millis(150);

/// Relative changes, with the effect over without it, and what the scope would show of them. Each
/// is the largest of all places.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Change {
    /// Of pulse speeds between neighbouring sensors, by half-rise; none without two of them (1).
    pub speed: Option<f64>,
    /// Of first peaks (1).
    pub peak: Option<f64>,
    /// Of half-rises (1).
    pub arrival: Option<f64>,
    /// Of first peaks, in digitiser levels of their channels (1).
    pub peak_lsb: Option<f64>,
    /// Of half-rises, in sample intervals (1).
    pub arrival_samples: Option<f64>,
}

/// Wall times of whole runs, medians of runs in turn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct RunTimes {
    /// With the effect (s).
    pub with_s: f64,
    /// Without it (s).
    pub without_s: f64,
}

/// Measurement of an effect: times of whole runs, and what changes.
pub type EffectTrial = (Option<RunTimes>, Change);

/// The value farthest from zero; none of none (1).
pub fn largest(values: impl Iterator<Item = f64>) -> Option<f64> {
    values.reduce(|most, value| if value.abs() > most.abs() { value } else { most })
}

/// Runs `with` and `without` in turn, each of which returns its wall time (s).
fn run_times(
    mut with: impl FnMut() -> Option<f64>,
    mut without: impl FnMut() -> Option<f64>,
) -> Option<RunTimes> {
    let mut times = [Vec::new(), Vec::new()];
    let started = Instant::now();
    while times[0].len() < MIN_PAIRS
        || (times[0].len() < MAX_PAIRS && started.elapsed() < TIME_LIMIT)
    {
        times[0].push(with()?);
        times[1].push(without()?);
    }
    let [with_s, without_s] = times.map(median);
    Some(RunTimes { with_s, without_s })
}

impl Change {
    /// Between readings of forces.
    fn of_readings(scene: &Scene, on: &[Reading], off: &[Reading]) -> Self {
        let pairs = || on.iter().zip(off);
        let peak =
            |(a, b): (&Reading, &Reading)| Some((a.first_peak?.dynamic_n, b.first_peak?.dynamic_n));
        let rise = |(a, b): (&Reading, &Reading)| Some((a.half_rise_s?, b.half_rise_s?));
        let interval = scene.scope.model.sample_interval(scene.scope.time_base);
        let levels = pairs().enumerate().filter_map(|(index, pair)| {
            let (a, b) = peak(pair)?;
            Some((a - b) / newtons_a_level(scene, index)?)
        });
        Self {
            speed: None,
            peak: largest(pairs().filter_map(peak).map(|(a, b)| a / b - 1.0)),
            arrival: largest(pairs().filter_map(rise).map(|(a, b)| a / b - 1.0)),
            peak_lsb: largest(levels),
            arrival_samples: largest(pairs().filter_map(rise).map(|(a, b)| (a - b) / interval)),
        }
    }
}

/// Force that makes one digitiser level at sensor `index` (N).
fn newtons_a_level(scene: &Scene, index: usize) -> Option<f64> {
    let name = &scene.sensors.get(index)?.name;
    let mut channels = scene.scope.channels.iter().flatten();
    let channel = channels.find(|channel| channel.input.as_ref() == Some(name))?;
    let circuit = scene.sensors.get(index)?.sensor.connect(input_load(&scene.scope.model, channel));
    Some(scene.scope.model.level(channel.vertical.scale) / circuit.sensitivity)
}

/// Speeds between neighbouring sensors by half-rise (m/s).
fn speeds_of(scene: &Scene, readings: &[Reading]) -> Vec<((usize, usize), f64)> {
    let named = readings.iter().filter(|reading| reading.particle.is_some()).cloned();
    let named: Vec<Reading> = named.collect();
    let found = speeds(&scene.chain, &named);
    let found = found.into_iter().filter(|speed| speed.estimator == "half_rise");
    found
        .map(|speed| ((speed.from, speed.to), speed.m_per_s))
        .take(named.len().max(1) - 1)
        .collect()
}

/// A run of shot 1 of `scene` without frames, at `accuracy` (1).
///
/// # Errors
/// The run's error, in words.
fn bare_run(scene: &Scene, accuracy: f64) -> Result<Run<'_>, String> {
    let by = method(scene, Integration::Accuracy(accuracy)).map_err(|error| error.to_string())?;
    let run = Run::with_frames(scene, 1, (by, u64::MAX), Grid::NEVER, &mut |_| ());
    run.map_err(|error| error.to_string())
}

/// Runs of two scenes that differ in an effect of the chain, in turn, at the same accuracy.
///
/// # Errors
/// Why one of them cannot be run.
pub fn of_chain(with: &Scene, without: &Scene, accuracy: f64) -> Result<EffectTrial, String> {
    let (on, off) = (bare_run(with, accuracy)?, bare_run(without, accuracy)?);
    let wall = |scene: &Scene| bare_run(scene, accuracy).ok().map(|run| run.wall_s());
    let (on, off) = (on.readings(), off.readings());
    let times = run_times(|| wall(with), || wall(without));
    let (fast, slow) = (speeds_of(with, &on), speeds_of(without, &off));
    let ratios = fast.iter().filter_map(|(pair, speed)| {
        let (_, other) = slow.iter().find(|(same, _)| same == pair)?;
        Some(speed / other - 1.0)
    });
    let change = Change { speed: largest(ratios), ..Change::of_readings(with, &on, &off) };
    Ok((times, change))
}

/// Largest value of a signal around a pulse, and when it first reached half of that.
struct PulseReading {
    peak: f64,
    half_rise: f64,
}

/// Where to look for the first peak of each channel, by the force behind it: half a rise before and
/// after it.
fn windows(subject: &BaselineRun<'_>) -> Vec<Option<(usize, usize)>> {
    let BaselineRun { scene, bench, .. } = subject;
    let grid = bench.grid();
    let window = |channel: &crate::scope::ChannelSetup| {
        let place = scene.sensors.iter().position(|s| Some(&s.name) == channel.input.as_ref())?;
        let reading = Reading::of("", None, 0.0, &bench.watches().get(place)?.pulse);
        let (rise, peak) = (reading.half_rise_s?, reading.first_peak?.time_s);
        let width = peak - rise;
        Some((grid.samples_until(rise - width), grid.samples_until(peak + 0.5 * width) + 1))
    };
    scene.scope.channels.iter().map(|c| c.as_ref().and_then(window)).collect()
}

fn pulse_reading(signal: &[f64], (first, last): (usize, usize)) -> Option<PulseReading> {
    let part = signal.get(first..last)?;
    let peak = part.iter().copied().fold(f64::MIN, f64::max);
    let reached = part.iter().position(|value| *value >= 0.5 * peak)?;
    let before = reached.checked_sub(1)?;
    let share = (0.5 * peak - part[before]) / (part[reached] - part[before]);
    let half_rise = (first + before) as f64 + share;
    Some(PulseReading { peak, half_rise })
}

/// Results of two treatments of the same signals (V).
pub fn of_signals(subject: &BaselineRun<'_>, on: &ChannelVolts, off: &ChannelVolts) -> Change {
    let (scene, grid) = (subject.scene, subject.bench.grid());
    let places = windows(subject);
    let channels = scene.scope.channels.iter().zip(places).zip(on.iter().zip(off));
    let seen = channels.filter_map(|((channel, window), (on, off))| {
        let level = scene.scope.model.level(channel.as_ref()?.vertical.scale);
        let (on, off) =
            (pulse_reading(on.as_ref()?, window?)?, pulse_reading(off.as_ref()?, window?)?);
        Some((on, off, level))
    });
    let seen: Vec<(PulseReading, PulseReading, f64)> = seen.collect();
    let sample = scene.scope.model.sample_interval(scene.scope.time_base);
    let ratio = grid.interval / sample;
    let samples = || seen.iter().map(|(a, b, _)| ratio * (a.half_rise - b.half_rise));
    let time = |s: &PulseReading| grid.start + s.half_rise * grid.interval;
    Change {
        speed: None,
        peak: largest(seen.iter().map(|(a, b, _)| a.peak / b.peak - 1.0)),
        arrival: largest(seen.iter().map(|(a, b, _)| time(a) / time(b) - 1.0)),
        peak_lsb: largest(seen.iter().map(|(a, b, level)| (a.peak - b.peak) / level)),
        arrival_samples: largest(samples()),
    }
}

/// Volts of each channel that is on.
pub type ChannelVolts = Vec<Option<Vec<f64>>>;

/// What 95 % of [`DRAWS`] draws of an effect change at most, each of the scenes with another seed;
/// `redraw` draws what a scene holds drawn already.
pub fn of_draws(
    subject: &BaselineRun<'_>,
    (with, without): (&Scene, &Scene),
    redraw: fn(&mut Scene),
) -> Change {
    let draw = |number: u64| {
        let seed = subject.scene.seed.wrapping_add(number);
        let mut drawn = Scene { seed, ..with.clone() };
        redraw(&mut drawn);
        let plain = Scene { seed, ..without.clone() };
        let [on, off] = [&drawn, &plain].map(|scene| signals(scene, &subject.bench, 1));
        of_signals(subject, &on, &off)
    };
    let changes: Vec<Change> = (0..DRAWS).map(draw).collect();
    let most = |of: fn(&Change) -> Option<f64>| {
        let sizes: Option<Vec<f64>> = changes.iter().map(|c| of(c).map(f64::abs)).collect();
        let mut sizes = sizes?;
        sizes.sort_by(f64::total_cmp);
        Some(quantile(&sizes, 0.95))
    };
    Change {
        speed: None,
        peak: most(|change| change.peak),
        arrival: most(|change| change.arrival),
        peak_lsb: most(|change| change.peak_lsb),
        arrival_samples: most(|change| change.arrival_samples),
    }
}

/// Signals of one motion with and without an effect of sensors or scope.
pub fn of_electronics(subject: &BaselineRun<'_>, with: &Scene, without: &Scene) -> EffectTrial {
    let timed = |scene: &Scene| {
        let started = Instant::now();
        let found = signals(scene, &subject.bench, 1);
        (started.elapsed().as_secs_f64(), found)
    };
    let ((_, on), (_, off)) = (timed(with), timed(without));
    let motion = bare_run(subject.scene, subject.accuracy).map_or(0.0, |run| run.wall_s());
    // The motion is the same, and part of both times.
    let wall = |scene: &Scene| Some(timed(scene).0 + motion);
    (run_times(|| wall(with), || wall(without)), of_signals(subject, &on, &off))
}

/// The reference of all entries: the scene as it is run, and that run.
pub(super) struct BaselineRun<'a> {
    /// The scene with `auto` decided.
    pub(super) scene: &'a Scene,
    pub(super) accuracy: f64,
    pub(super) bench: Bench<'a>,
    /// The smallest first peak; infinite without any pulse (N).
    pub(super) wave: f64,
}

impl<'a> BaselineRun<'a> {
    pub(super) fn new(scene: &'a Scene, accuracy: f64) -> Result<Self, RunError> {
        let method = method(scene, Integration::Accuracy(accuracy))?;
        let mut bench = scene_bench(
            scene,
            &scene.initial_velocities,
            method,
            sample_grid(scene, 1),
            film_grid(scene),
        );
        bench.run_until(scene.duration, true, &mut |_| ())?;
        let peaks = bench.watches().iter().filter_map(|watch| watch.pulse.first_peak());
        let wave = peaks.map(|peak| peak.dynamic_n).fold(f64::INFINITY, f64::min);
        Ok(Self { scene, accuracy, bench, wave })
    }

    /// The scene after `edit` of its spec, the chain put together again.
    pub(super) fn rebuilt(&self, edit: impl FnOnce(&mut Scene)) -> Result<Scene, String> {
        let mut scene = self.scene.clone();
        edit(&mut scene);
        scene.chain = Chain::new(&scene.spec).map_err(|error| error.to_string())?;
        Ok(scene)
    }
}
