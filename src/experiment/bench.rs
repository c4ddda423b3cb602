//! The chain in motion with everything that watches it: pulses, scope samples, truth.

use crate::chain::State;
use crate::chain::{Chain, Dissipated, Energy, ForceProbe, Indentations};
use crate::motion::ChainSystem;
use crate::motion::kernel::{InstructionSet, VectorStepper};
use crate::motion::probe_step::ProbeTracker;
use crate::motion::{IntegrateError, Integrator, Method, Scheme, Work};

use super::extremes::Extremes;
use super::frames::Frames;
pub use super::grid::Grid;
pub use super::motion_record::{MotionRecord, Mover};
pub use super::probe_record::ProbeRecord;
use super::pulse::PulseRecorder;

/// Room is made for all samples that are due, up to so many at once.
const SAMPLES_CAPACITY: usize = 1 << 20;

/// The method at work on the chain.
enum Engine<'a> {
    /// A method for chains without losses, with a tracker for each watch.
    Vectors(Box<VectorStepper>, Vec<ProbeTracker>),
    /// A method for forces that depend on velocities.
    General(Box<dyn Integrator + 'a>),
}

/// A method at work on a chain, from any state.
pub fn start(chain: &Chain, method: Method, state: State) -> Box<dyn Integrator> {
    match method.scheme() {
        Scheme::Lossless(scheme) => {
            Box::new(VectorStepper::new(chain, &state, scheme, InstructionSet::best()))
        }
        Scheme::General(scheme) => {
            scheme.start(Box::new(ChainSystem::new(chain, &state.velocity)), state)
        }
    }
}

impl<'a> Engine<'a> {
    fn start(
        set: InstructionSet,
        chain: &Chain,
        velocities: &[f64],
        method: Method,
        probes: &[ForceProbe],
    ) -> Self {
        let state = chain.initial_state(velocities);
        match method.scheme() {
            Scheme::Lossless(scheme) => {
                let stepper = VectorStepper::new(chain, &state, scheme, set);
                let bodies = chain.bodies().len();
                let tracker = |probe| ProbeTracker::new(probe, &stepper, bodies);
                let trackers = probes.iter().map(tracker).collect();
                Self::Vectors(Box::new(stepper), trackers)
            }
            Scheme::General(scheme) => {
                Self::General(scheme.start(Box::new(ChainSystem::new(chain, velocities)), state))
            }
        }
    }

    fn integrator(&self) -> &(dyn Integrator + 'a) {
        match self {
            Self::Vectors(stepper, _) => stepper.as_ref(),
            Self::General(integrator) => integrator.as_ref(),
        }
    }
}

/// A running bench.
pub struct Bench<'a> {
    chain: &'a Chain,
    engine: Engine<'a>,
    grid: Grid,
    watches: Vec<ProbeRecord>,
    motions: Vec<MotionRecord>,
    film: Frames,
    /// Taken beside frames: none where there are no frames.
    extremes: Option<Extremes>,
    initial_velocities: Vec<f64>,
    most_evaluations: u64,
}

impl<'a> Bench<'a> {
    /// Sets the chain in motion; forces at `probes` are sampled at the times `samples`, frames
    /// taken at the times `frames`.
    pub fn new(
        chain: &'a Chain,
        initial_velocities: &[f64],
        method: Method,
        probes: &[ForceProbe],
        samples: Grid,
        frames: Grid,
    ) -> Self {
        let set = InstructionSet::best();
        Self::with_instructions(set, chain, initial_velocities, method, probes, samples, frames)
    }

    /// The same with the instructions of `set` on the vector path.
    pub fn with_instructions(
        set: InstructionSet,
        chain: &'a Chain,
        initial_velocities: &[f64],
        method: Method,
        probes: &[ForceProbe],
        grid: Grid,
        frames: Grid,
    ) -> Self {
        // Before the first contact nothing moves: those samples are known.
        let before = grid.samples_until(0.0);
        let impact = chain.impact_force(initial_velocities);
        let watch = |probe: &ForceProbe| ProbeRecord {
            probe: probe.clone(),
            pulse: PulseRecorder::new(probe, impact, initial_velocities),
            samples: vec![0.0; before],
        };
        Self {
            chain,
            engine: Engine::start(set, chain, initial_velocities, method, probes),
            grid,
            watches: probes.iter().map(watch).collect(),
            motions: Vec::new(),
            film: Frames::new(chain, frames, initial_velocities),
            extremes: (frames != Grid::NEVER).then(|| Extremes::new(chain, initial_velocities)),
            initial_velocities: initial_velocities.to_vec(),
            most_evaluations: u64::MAX,
        }
    }

    /// The bench, which samples the velocities of these `movers`, too.
    pub fn following(mut self, movers: &[Mover]) -> Self {
        let before = self.grid.samples_until(0.0);
        let record = |mover: &Mover| {
            let velocity = match mover {
                Mover::Body(body) => self.initial_velocities.get(*body).copied(),
                Mover::Wall(_) => None,
            };
            MotionRecord { mover: *mover, samples: vec![velocity.unwrap_or(0.0); before] }
        };
        self.motions = movers.iter().map(record).collect();
        self
    }

    /// The bench, given up when it has taken more than `most` evaluations of all forces.
    pub fn within(mut self, most: u64) -> Self {
        self.most_evaluations = most;
        self
    }

    /// Moves on to time `end` (s), taking samples, and following pulses if `pulses`. Calls
    /// `progress` with the time.
    ///
    /// # Errors
    /// [`IntegrateError`] where the integrator cannot go on.
    pub fn run_until(
        &mut self,
        end: f64,
        pulses: bool,
        progress: &mut dyn FnMut(f64),
    ) -> Result<(), IntegrateError> {
        let Self { chain, engine, grid, watches, motions, film, extremes, .. } = self;
        let (bodies, most) = (chain.bodies().len(), self.most_evaluations);
        for watch in &mut *watches {
            let due = grid.samples_until(end).saturating_sub(watch.samples.len());
            watch.samples.reserve(due.min(SAMPLES_CAPACITY));
        }
        match engine {
            Engine::Vectors(stepper, trackers) => {
                while stepper.time() < end {
                    stepper.step(end)?;
                    stepper.work().within(most, stepper.time())?;
                    for (tracker, watch) in trackers.iter_mut().zip(&mut *watches) {
                        tracker.advance(stepper);
                        let set = stepper.instructions();
                        watch.take_step(set, tracker, stepper.time(), *grid, pulses);
                    }
                    for motion in &mut *motions {
                        motion.take(stepper.as_ref(), *grid);
                    }
                    film.take_step(chain, stepper);
                    if let Some(extremes) = extremes {
                        extremes.take_step(chain, stepper.as_ref());
                    }
                    progress(stepper.time());
                }
            }
            Engine::General(integrator) => {
                while integrator.time() < end {
                    integrator.step(end)?;
                    integrator.work().within(most, integrator.time())?;
                    integrator.prepare_interpolation();
                    for watch in &mut *watches {
                        watch.take(integrator.as_ref(), bodies, *grid, pulses);
                    }
                    for motion in &mut *motions {
                        motion.take(integrator.as_ref(), *grid);
                    }
                    film.follow(chain, integrator.as_ref());
                    if let Some(extremes) = extremes {
                        extremes.take_step(chain, integrator.as_ref());
                    }
                    progress(integrator.time());
                }
            }
        }
        Ok(())
    }

    /// The grid on which forces are sampled.
    pub fn grid(&self) -> Grid {
        self.grid
    }

    /// The watched forces, in the order of the probes.
    pub fn watches(&self) -> &[ProbeRecord] {
        &self.watches
    }

    /// The sampled velocities, in the order of the movers.
    pub fn motions(&self) -> &[MotionRecord] {
        &self.motions
    }

    /// The watched forces, the bench given up.
    pub fn into_watches(self) -> Vec<ProbeRecord> {
        self.watches
    }

    /// The film so far.
    pub fn film(&self) -> &Frames {
        &self.film
    }

    /// Largest forces and displacements so far; none where no frames are taken.
    pub fn extremes(&self) -> Option<&Extremes> {
        self.extremes.as_ref()
    }

    /// Energy at the start and now, without what contacts held at zero force will not give back.
    pub fn energies(&self) -> (Energy, Energy) {
        let (integrator, contacts) = (self.engine.integrator(), self.chain.contacts().len());
        let held = |contact: usize| !integrator.is_on(contacts + contact);
        let before = self.chain.energy(&self.chain.initial_state(&self.initial_velocities));
        (before, self.chain.free_energy(&integrator.state(), &held))
    }

    /// Energy dissipated so far.
    pub fn dissipated(&self) -> Dissipated {
        self.chain.dissipated(&self.engine.integrator().state(), &self.initial_velocities)
    }

    /// Indentations that the contacts have so far.
    pub fn indentations(&self) -> Indentations {
        self.chain.indentations(&self.state())
    }

    /// The present time (s).
    pub fn time(&self) -> f64 {
        self.engine.integrator().time()
    }

    /// The present state.
    pub fn state(&self) -> State {
        self.engine.integrator().state()
    }

    /// Steps tried in which contacts opened or closed; none where the method does not ask.
    pub fn contact_changes(&self) -> Option<u64> {
        match &self.engine {
            Engine::Vectors(stepper, _) => Some(stepper.contact_changes()),
            Engine::General(_) => None,
        }
    }

    /// Cost of the integration so far.
    pub fn work(&self) -> Work {
        self.engine.integrator().work()
    }
}
