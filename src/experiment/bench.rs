//! The chain in motion with everything that watches it: pulses, scope samples, truth.

use crate::chain::stepper::{ChainStepper, InstructionSet, ROOM_BEHIND, Refinement, Trail};
use crate::chain::{Chain, Dissipated, Energy, ForceProbe};
use crate::integrate::{IntegrateError, Integrator, Method, State, Work};

use super::film::Film;
use super::pulse::PulseRecorder;
pub use super::watch::Watch;
use super::watch::follow;

/// Evenly spaced times at which something is sampled: `start + i * interval`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// Time of sample 0 (s).
    pub start: f64,
    /// From one sample to the next (s).
    pub interval: f64,
}

impl Grid {
    /// Time of sample `index` (s).
    #[must_use]
    #[allow(clippy::cast_precision_loss, reason = "runs have far fewer than 2^53 samples")]
    pub fn time(&self, index: usize) -> f64 {
        self.start + index as f64 * self.interval
    }

    /// Number of samples at or before `time` (s).
    #[must_use]
    pub fn samples_until(&self, time: f64) -> usize {
        self.samples_at(time, 1.0 / self.interval)
    }

    /// The same, where the sampling `rate` is known (1/s).
    #[must_use]
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` cuts off, takes negative numbers to zero, and runs have far fewer than 2^53 samples"
    )]
    pub(super) fn samples_at(&self, time: f64, rate: f64) -> usize {
        let mut count = ((time - self.start) * rate) as usize;
        // The product may be off by its rounding; the samples' own times decide.
        while self.time(count) <= time {
            count += 1;
        }
        count
    }
}

/// Room is made for all samples that are due, up to so many at once.
const ROOM_FOR_SAMPLES: usize = 1 << 20;

/// The method at work on the chain.
#[allow(
    clippy::large_enum_variant,
    reason = "one for each bench; rows of eight in a box of their own take an allocation with alignment, a hundredth of a short run"
)]
enum Engine<'a> {
    /// Where contacts and constant loads are all there is, methods made for that run on the chain's own stepper; with a trail of all watches.
    Stepper(ChainStepper, Trail),
    /// Everything else.
    General(Box<dyn Integrator + 'a>),
}

/// A method at work on a lossless chain, from any state; on the chain's own stepper where that takes its forces.
#[must_use]
pub fn start(chain: &Chain, method: Method, state: State) -> Box<dyn Integrator> {
    if let (Some(scheme), true) = (method.scheme(), chain.is_plain()) {
        return Box::new(ChainStepper::from_state(chain, &state, scheme, InstructionSet::best()));
    }
    method.start(chain.system(&state.velocity), state)
}

impl<'a> Engine<'a> {
    fn start(chain: &Chain, velocities: &[f64], method: Method, probes: &[ForceProbe]) -> Self {
        match method.scheme() {
            Some(scheme) if chain.is_plain() => {
                let set = InstructionSet::best();
                let stepper = ChainStepper::new(chain, velocities, scheme, set);
                let trail = stepper.trail(probes);
                Self::Stepper(stepper, trail)
            }
            _ => {
                let state = chain.initial_state(velocities);
                Self::General(method.start(chain.system(velocities), state))
            }
        }
    }

    fn integrator(&self) -> &(dyn Integrator + 'a) {
        match self {
            Self::Stepper(stepper, _) => stepper,
            Self::General(integrator) => integrator.as_ref(),
        }
    }
}

/// A running bench.
pub struct Bench<'a> {
    chain: &'a Chain,
    engine: Engine<'a>,
    grid: Grid,
    watches: Vec<Watch>,
    film: Film,
    initial_velocities: Vec<f64>,
    method: Method,
    most_evaluations: u64,
}

impl<'a> Bench<'a> {
    /// Sets the chain in motion; forces at `probes` are sampled on `grid`, the film has a frame every `frame_interval` (s).
    #[must_use]
    pub fn new(
        chain: &'a Chain,
        initial_velocities: &[f64],
        method: Method,
        probes: &[ForceProbe],
        grids: (Grid, Grid),
    ) -> Self {
        let (grid, film_grid) = grids;
        // Before the first contact nothing moves: those samples are known.
        let before = grid.samples_until(0.0);
        let impact = chain.impact_force(initial_velocities);
        let watch = |probe: &ForceProbe| Watch {
            probe: probe.clone(),
            pulse: PulseRecorder::new(probe, impact, initial_velocities),
            samples: vec![0.0; before],
        };
        Self {
            chain,
            engine: Engine::start(chain, initial_velocities, method, probes),
            grid,
            watches: probes.iter().map(watch).collect(),
            film: Film::new(chain, film_grid, initial_velocities),
            initial_velocities: initial_velocities.to_vec(),
            method,
            most_evaluations: u64::MAX,
        }
    }

    /// The bench, given up when it has taken more than `most` evaluations of all forces.
    #[must_use]
    pub fn within(mut self, most: u64) -> Self {
        self.most_evaluations = most;
        self
    }

    /// Moves on to time `end` (s), taking samples, and following pulses if `pulses`. Calls `progress` with the time.
    ///
    /// # Errors
    /// [`IntegrateError`] where the integrator cannot go on.
    pub fn run_until(
        &mut self,
        end: f64,
        pulses: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), IntegrateError> {
        let Self { chain, engine, grid, watches, film, most_evaluations, .. } = self;
        let (bodies, most) = (chain.bodies().len(), *most_evaluations);
        for watch in &mut *watches {
            let due = grid.samples_until(end).saturating_sub(watch.samples.len());
            watch.samples.reserve(due.min(ROOM_FOR_SAMPLES) + ROOM_BEHIND);
        }
        match engine {
            Engine::Stepper(stepper, trail) => {
                let mut goes_on = Ok(stepper.time() < end);
                let mut step = || {
                    stepper.follow(trail, [end, film.next()])?;
                    stepper.work().within(most, stepper.time())?;
                    if trail.steps() == Trail::STEPS {
                        follow(stepper, trail, (watches, *grid), pulses);
                    }
                    film.follow_stepper(chain, stepper);
                    progress(stepper.time());
                    Ok(stepper.time() < end)
                };
                while let Ok(true) = goes_on {
                    goes_on = step();
                }
                // Steps are followed eight by eight; those left over, also where the chain is given up.
                if trail.steps() > 0 {
                    follow(stepper, trail, (watches, *grid), pulses);
                }
                goes_on.map_err(|failed| self.as_one_by_one(end, failed))?;
            }
            Engine::General(integrator) => {
                while integrator.time() < end {
                    integrator.step(end)?;
                    integrator.work().within(most, integrator.time())?;
                    integrator.prepare_interpolation();
                    for watch in &mut *watches {
                        watch.take(integrator.as_ref(), bodies, *grid, pulses);
                    }
                    film.follow(chain, integrator.as_ref());
                    progress(integrator.time());
                }
            }
        }
        Ok(())
    }

    /// What `failed` in steps that were taken several at once: one by one it is found which body was lost first, and when.
    fn as_one_by_one(&self, end: f64, failed: IntegrateError) -> IntegrateError {
        if !matches!(failed, IntegrateError::NotFinite { .. }) {
            return failed;
        }
        let state = self.chain.initial_state(&self.initial_velocities);
        let mut alone = start(self.chain, self.method, state);
        let mut lost = None;
        while alone.time() < end && lost.is_none() {
            lost = alone.step(end).err();
        }
        lost.unwrap_or(failed)
    }

    /// The bench, not yet run, without one of the stepper's refinements; what runs on no stepper has none.
    #[must_use]
    pub fn without(mut self, refinement: Refinement) -> Self {
        if let Engine::Stepper(stepper, _) = self.engine {
            let stepper = stepper.without(refinement, self.chain);
            let probe = |watch: &Watch| watch.probe.clone();
            let probes: Vec<ForceProbe> = self.watches.iter().map(probe).collect();
            let trail = stepper.trail(&probes);
            self.engine = Engine::Stepper(stepper, trail);
        }
        self
    }

    /// The watched forces, in the order of the probes.
    #[must_use]
    pub fn watches(&self) -> &[Watch] {
        &self.watches
    }

    /// The film so far.
    #[must_use]
    pub fn film(&self) -> &Film {
        &self.film
    }

    /// Energy at the start and now, without what contacts held at zero force will not give back.
    #[must_use]
    pub fn energies(&self) -> (Energy, Energy) {
        let (integrator, contacts) = (self.engine.integrator(), self.chain.contacts().len());
        let held = |contact: usize| !integrator.is_on(contacts + contact);
        let before = self.chain.energy(&self.chain.initial_state(&self.initial_velocities));
        (before, self.chain.free_energy(&integrator.state(), &held))
    }

    /// What the losses have taken so far.
    #[must_use]
    pub fn dissipated(&self) -> Dissipated {
        self.chain.dissipated(&self.engine.integrator().state(), &self.initial_velocities)
    }

    /// The present time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.engine.integrator().time()
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> State {
        self.engine.integrator().state()
    }

    /// Whether forces are computed without cancellation, for waves far below the preload.
    #[must_use]
    pub fn has_exact_forces(&self) -> bool {
        match &self.engine {
            Engine::Stepper(stepper, _) => stepper.is_exact(),
            Engine::General(_) => true,
        }
    }

    /// Steps tried in which contacts opened or closed; none where the method does not ask.
    #[must_use]
    pub fn contact_changes(&self) -> Option<u64> {
        match &self.engine {
            Engine::Stepper(stepper, _) => stepper.events(),
            Engine::General(_) => None,
        }
    }

    /// What the integration has cost so far.
    #[must_use]
    pub fn work(&self) -> Work {
        self.engine.integrator().work()
    }
}
