//! One run of a scene: motion, trigger, record, summary.

use std::time::Instant;

use rand_distr::{Distribution, StandardUniform};

use super::acquisition::{record, signals, trigger};
use super::bench::{Bench, Grid, ProbeRecord};
use super::error::RunError;
use super::method_choice::Integration;
use super::outcome::EnergyLedger;
use super::outcome::{Outcome, Reading, Summary, TriggerReport};
use super::{auto_effects, method_choice, notes, outcome, paper_speeds};
use crate::chain::ForceProbe;
use crate::integrate::Method;
use crate::recording::Shot;
use crate::scene::{Scene, Site};
use crate::scope::acquire::TriggerPosition;
use crate::scope::front_end::noise_stream;

/// Samples kept before the earliest that a record can need.
const SPARE_SAMPLES: f64 = 20.0;
/// Stream of the sample clock's phase; channels use 1 to 4.
const CLOCK_STREAM: u8 = 0;

/// Runs `scene`; `progress` is called with the share of the work done, 0 to 1.
///
/// # Errors
/// [`RunError`] for a step that cannot be stable and for states that stop being numbers.
pub fn run(
    scene: &Scene,
    integration: Integration,
    shot: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<Outcome, RunError> {
    let scene = &*auto_effects::resolve_auto_effects(scene, integration);
    let started = Instant::now();
    let method = method_choice::method(scene, integration)?;
    let velocities = scene.velocities(shot);
    let (samples, frames) = (sample_grid(scene, shot), film_grid(scene));
    let mut bench = scene_bench(scene, &velocities, method, samples, frames);
    let (_, span) = scene.scope.record_span();
    let expected_end = scene.duration.max(span);
    let mut report = |time: f64| progress((time / expected_end).min(1.0));
    bench.run_until(scene.duration, true, &mut report)?;
    let found = trigger(scene, &bench, &signals(scene, &bench, shot));
    if let Some(found) = found {
        let grid = bench.grid();
        let end = grid.time(found.index) + span + 2.0 * grid.interval;
        bench.run_until(end, false, &mut report)?;
    }
    let wall_s = started.elapsed().as_secs_f64();
    let shot = record(scene, &bench, found, shot);
    let finished = Finished { scene, integration, method, bench: &bench, found, wall_s };
    Ok(Outcome { summary: finished.summarise(&shot), shot })
}

/// The scope's sample times on the bench's clock, set as in the scene.
pub(crate) fn sample_grid(scene: &Scene, shot: u32) -> Grid {
    let setup = &scene.scope;
    let interval = setup.signal_interval();
    let (start, _) = setup.record_span();
    free_grid(scene, shot, interval, (-start).max(0.0))
}

/// Sample times every `interval` (s), from `before` (s) ahead of the first contact: the scope's own
/// clock runs freely, so the phase is drawn from the seed.
pub(crate) fn free_grid(scene: &Scene, shot: u32, interval: f64, before: f64) -> Grid {
    let phase: f64 = StandardUniform.sample(&mut noise_stream(scene.seed, shot, CLOCK_STREAM));
    let before = (before / interval).ceil() + SPARE_SAMPLES;
    Grid { start: (phase - before) * interval, interval }
}

/// The times of a scene's frames.
pub(crate) fn film_grid(scene: &Scene) -> Grid {
    Grid { start: 0.0, interval: scene.duration / f64::from(scene.frames) }
}

/// The bench of `scene`, its bodies let go at `velocities` (m/s): forces are watched at the
/// sensors, in their order, and last at the wall if there is one, and sampled at the times
/// `samples`; frames are taken at the times `frames`.
pub(crate) fn scene_bench<'a>(
    scene: &'a Scene,
    velocities: &[f64],
    method: Method,
    samples: Grid,
    frames: Grid,
) -> Bench<'a> {
    Bench::new(&scene.chain, velocities, method, &probes(scene), samples, frames)
}

/// Readings at the places of [`scene_bench`].
pub(crate) fn read_places(scene: &Scene, bench: &Bench<'_>) -> Vec<Reading> {
    let places =
        scene.sensors.iter().map(|placed| (placed.name.as_str(), placed.site, placed.offset));
    let places = places.chain([("wall", Site::Wall, 0.0)]).zip(bench.watches());
    let reading = |((name, site, offset), watch): ((&str, Site, f64), &ProbeRecord)| {
        let particle = match site {
            Site::Particle(particle) => Some(particle),
            Site::Wall => None,
        };
        Reading::of(name, particle, offset, &watch.pulse)
    };
    places.map(reading).collect()
}

/// The same, those of sensors and that of the wall apart.
pub(crate) fn read_bench(scene: &Scene, bench: &Bench<'_>) -> (Vec<Reading>, Option<Reading>) {
    let mut readings = read_places(scene, bench);
    let wall = readings.split_off(readings.len().min(scene.sensors.len())).pop();
    (readings, wall)
}

/// One probe a sensor, and the wall's contact.
fn probes(scene: &Scene) -> Vec<ForceProbe> {
    let chain = &scene.chain;
    let wall = || chain.wall_contact().and_then(|j| ForceProbe::contact(chain, j));
    let sensor = |site: Site, offset: f64| match site {
        Site::Particle(particle) => ForceProbe::inside(chain, particle, offset),
        Site::Wall => wall(),
    };
    let sensors = scene.sensors.iter().filter_map(|s| sensor(s.site, s.offset));
    sensors.chain(wall()).collect()
}

/// A run at its end, with all that its summary tells.
struct Finished<'a> {
    scene: &'a Scene,
    integration: Integration,
    method: Method,
    bench: &'a Bench<'a>,
    found: Option<TriggerPosition>,
    wall_s: f64,
}

impl Finished<'_> {
    fn summarise(&self, shot: &Shot) -> Summary {
        let Self { scene, integration, method, bench, found, wall_s } = *self;
        let (sensors, wall) = read_bench(scene, bench);
        let effects = outcome::effects(scene);
        let (initial, last) = bench.energies();
        let work = bench.work();
        let accuracy = match integration {
            Integration::Accuracy(accuracy) | Integration::Attempt { accuracy, .. } => {
                Some(accuracy)
            }
            Integration::Method(_) => None,
        };
        Summary {
            scene: scene.name.clone(),
            title: scene.title.clone(),
            scene_hash: scene.texts.hash().to_owned(),
            seed: scene.seed,
            method: method.name().to_owned(),
            method_source: method.source().to_owned(),
            accuracy,
            accuracy_reason: None,
            error_estimate: None,
            horizon_s: None,
            step_s: method.fixed_step().map(|(step, _)| step),
            tolerance: method.tolerance(),
            force_evaluations: work.force_evaluations,
            steps: work.steps,
            rejected_steps: work.rejected,
            contact_changes: bench.contact_changes(),
            wall_s,
            wall_held_s: None,
            simulated_s: bench.time(),
            duration_s: scene.duration,
            effect_settings: effects.iter().map(|(name, set)| format!("{name}: {set}")).collect(),
            effects: effects.into_iter().map(|(name, _)| name).collect(),
            energy: EnergyLedger::new(initial, last, bench.dissipated()),
            paper: paper_speeds::speed_of(scene),
            speeds: outcome::speeds(&scene.chain, &sensors),
            wall,
            notes: notes::notes(scene, &sensors, shot, found, bench.film()),
            sensors: sensors.into_iter().filter(|s| s.particle.is_some()).collect(),
            trigger: TriggerReport {
                recorded: found.is_some(),
                crossed: found.is_some_and(|f| f.crossed),
                time_s: shot.trigger_time,
            },
        }
    }
}
