//! One run of a scene: motion, trigger, record, summary.

use std::time::Instant;

use rand_distr::{Distribution, StandardUniform};

use super::acquisition::{record, signals, trigger};
use super::bench::{Bench, Grid, Mover, ProbeRecord};
use super::error::RunError;
use super::method_choice::Integration;
use super::outcome::EnergyLedger;
use super::outcome::{Outcome, Reading, Summary, TriggerReport};
use super::{auto_effects, method_choice, notes, outcome, paper_speeds};
use crate::chain::ForceProbe;
use crate::motion::{IntegrateError, Method, Work};
use crate::recording::Shot;
use crate::scene::{Scene, Site};
use crate::scope::acquire::TriggerPosition;
use crate::scope::front_end::noise_stream;
use crate::sensor::{MotionKind, MotionSensor};

/// Samples kept before the earliest that a record can need.
const SPARE_SAMPLES: f64 = 20.0;
/// Stream of the sample clock's phase; channels use 1 to 4.
const CLOCK_STREAM: u8 = 0;

/// Runs `scene` once, without an estimate of its error; `progress` is called with the share of the
/// work done, 0 to 1.
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
    let method = method_choice::method(scene, integration)?;
    let (_, span) = scene.scope.record_span();
    let expected_end = scene.duration.max(span);
    let mut report = |time: f64| progress((time / expected_end).min(1.0));
    let accuracy = match integration {
        Integration::Accuracy(accuracy) => Some(accuracy),
        Integration::Method(_) => None,
    };
    Run::new(scene, shot, method, &mut report)?.complete(accuracy, &mut report)
}

/// A scene's chain, moved to the end of the scene's duration.
pub struct Run<'a> {
    scene: &'a Scene,
    shot: u32,
    method: Method,
    bench: Bench<'a>,
    /// Computing time so far (s).
    wall_s: f64,
}

impl<'a> Run<'a> {
    /// Moves the chain of `scene`, whose effects are decided, by `method`, with samples at the
    /// scope's times and the scene's frames. `progress` is called with the time reached (s).
    ///
    /// # Errors
    /// [`IntegrateError`] if the integrator cannot go on.
    pub fn new(
        scene: &'a Scene,
        shot: u32,
        method: Method,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, IntegrateError> {
        Self::with_frames(scene, shot, (method, u64::MAX), film_grid(scene), progress)
    }

    /// Runs with other `frames` and a limit on the evaluations of all forces.
    ///
    /// # Errors
    /// [`IntegrateError`] if the integrator cannot go on.
    pub fn with_frames(
        scene: &'a Scene,
        shot: u32,
        (method, most_evaluations): (Method, u64),
        frames: Grid,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, IntegrateError> {
        let started = Instant::now();
        let (velocities, samples) = (scene.velocities(shot), sample_grid(scene, shot));
        let bench = scene_bench(scene, &velocities, method, samples, frames);
        let mut bench = bench.within(most_evaluations);
        bench.run_until(scene.duration, true, progress)?;
        Ok(Self { scene, shot, method, bench, wall_s: started.elapsed().as_secs_f64() })
    }

    /// The scene.
    pub fn scene(&self) -> &Scene {
        self.scene
    }

    /// Peaks and arrivals at each sensor, and last at the wall if there is one.
    pub fn readings(&self) -> Vec<Reading> {
        read_places(self.scene, &self.bench)
    }

    /// Dynamic force at each sensor at the scope's sample times (N).
    pub fn forces(&self) -> impl Iterator<Item = &[f64]> {
        let sensors = self.scene.sensors.len();
        self.bench.watches().iter().take(sensors).map(|watch| watch.samples.as_slice())
    }

    /// Time of a sample (s).
    pub fn sample_time(&self, sample: usize) -> f64 {
        self.bench.grid().time(sample)
    }

    /// Force that the impact raises at most (N).
    pub fn impact_force(&self) -> f64 {
        self.scene.chain.impact_force(&self.scene.velocities(self.shot))
    }

    /// The energy ledger so far.
    pub fn energy(&self) -> EnergyLedger {
        let (initial, last) = self.bench.energies();
        EnergyLedger::new(initial, last, self.bench.dissipated())
    }

    /// Cost of the integration so far.
    pub fn work(&self) -> Work {
        self.bench.work()
    }

    /// Computing time so far (s).
    pub fn wall_s(&self) -> f64 {
        self.wall_s
    }

    /// The method.
    pub fn method(&self) -> Method {
        self.method
    }

    /// Moves on to the end of the scope's record, and records. `accuracy` (1) is that of the run,
    /// none for a method by hand. `progress` is called with the time reached (s).
    ///
    /// # Errors
    /// [`RunError`] if the integrator cannot go on.
    pub fn complete(
        mut self,
        accuracy: Option<f64>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Outcome, RunError> {
        let (scene, started) = (self.scene, Instant::now());
        let found = trigger(scene, &self.bench, &signals(scene, &self.bench, self.shot));
        if let Some(found) = found {
            let (_, span) = scene.scope.record_span();
            let grid = self.bench.grid();
            let end = grid.time(found.index) + span + 2.0 * grid.interval;
            self.bench.run_until(end, false, progress)?;
        }
        self.wall_s += started.elapsed().as_secs_f64();
        let shot = record(scene, &self.bench, found, self.shot);
        let summary = self.summarise(&shot, accuracy, found);
        Ok(Outcome { summary, shot, indentations: self.bench.indentations() })
    }

    /// Velocities of all bodies now, where there are no sensors to look at (m/s).
    fn final_velocities(&self) -> Vec<f64> {
        let bodies = self.scene.chain.bodies().len();
        let is_alone = self.scene.sensors.is_empty() && self.scene.motion_sensors.is_empty();
        let velocity = self.bench.state().velocity;
        velocity.into_iter().take(if is_alone { bodies } else { 0 }).collect()
    }

    fn summarise(
        &self,
        shot: &Shot,
        accuracy: Option<f64>,
        found: Option<TriggerPosition>,
    ) -> Summary {
        let Self { scene, method, bench, wall_s, .. } = self;
        let (sensors, wall) = read_bench(scene, bench);
        let effects = outcome::effects(scene);
        let work = bench.work();
        Summary {
            scene: scene.name.clone(),
            title: scene.title.clone(),
            scene_hash: scene.texts.hash().to_owned(),
            seed: scene.seed,
            method: method.name().to_owned(),
            method_source: method.source().to_owned(),
            accuracy,
            error_estimate: None,
            horizon_s: None,
            step_s: method.fixed_step().map(|(step, _)| step),
            tolerance: method.tolerance(),
            force_evaluations: work.force_evaluations,
            steps: work.steps,
            rejected_steps: work.rejected,
            contact_changes: bench.contact_changes(),
            wall_s: *wall_s,
            wall_held_s: None,
            simulated_s: bench.time(),
            duration_s: scene.duration,
            effect_settings: effects.iter().map(|(name, set)| format!("{name}: {set}")).collect(),
            effects: effects.into_iter().map(|(name, _)| name).collect(),
            energy: self.energy(),
            final_velocities_m_per_s: self.final_velocities(),
            paper: paper_speeds::speed_of(scene),
            speeds: outcome::speeds(&scene.chain, &sensors),
            wall,
            notes: notes::notes(scene, &sensors, shot, found, bench.extremes()),
            sensors: sensors.into_iter().filter(|s| s.particle.is_some()).collect(),
            trigger: TriggerReport {
                recorded: found.is_some(),
                crossed: found.is_some_and(|f| f.crossed),
                time_s: shot.trigger_time,
            },
        }
    }
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
        .following(&movers(scene))
}

/// Readings at the places of [`scene_bench`].
pub(crate) fn read_places(scene: &Scene, bench: &Bench<'_>) -> Vec<Reading> {
    let places =
        scene.sensors.iter().map(|placed| (placed.name.as_str(), placed.site, placed.offset));
    let wall = scene.chain.wall_contact().map(|_| ("wall", Site::Wall, 0.0));
    let places = places.chain(wall).zip(bench.watches());
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
    sensors.chain(wall()).chain(motion_probes(scene)).collect()
}

/// What sensors of motion measure by a force: of accelerometers the net force on their particles,
/// of strain gauges that on their rods.
fn motion_probes(scene: &Scene) -> impl Iterator<Item = ForceProbe> {
    let chain = &scene.chain;
    scene.motion_sensors.iter().filter_map(|sensor| match sensor.kind {
        MotionKind::Vibrometer { .. } => None,
        MotionKind::Accelerometer { particle, .. } => ForceProbe::net(chain, particle),
        MotionKind::StrainGauge { end, .. } => {
            ForceProbe::contact(chain, if end == 0 { 0 } else { chain.bodies().len() })
        }
    })
}

/// What sensors of motion measure by a velocity.
fn movers(scene: &Scene) -> Vec<Mover> {
    let mover = |sensor: &MotionSensor| match sensor.kind {
        MotionKind::Vibrometer { particle, .. } => Some(Mover::Body(scene.chain.body_of(particle))),
        MotionKind::Accelerometer { .. } => None,
        MotionKind::StrainGauge { end, .. } => Some(Mover::Wall(end)),
    };
    scene.motion_sensors.iter().filter_map(mover).collect()
}
