//! The chain in motion with everything that watches it: pulses, scope samples, truth.

use crate::chain::stepper::{ChainStepper, InstructionSet};
use crate::chain::{Chain, ChainSystem, Energy, ForceProbe};
use crate::integrate::{IntegrateError, Integrator, Interpolant, Method, State, Work};

use super::pulse::PulseRecorder;

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
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "`as` takes negative numbers to zero, and runs have far fewer than 2^53 samples"
    )]
    pub fn samples_until(&self, time: f64) -> usize {
        let mut count = ((time - self.start) / self.interval).floor() as usize;
        // The division may be off by its rounding; the samples' own times decide.
        while self.time(count) <= time {
            count += 1;
        }
        count
    }
}

/// One watched force.
#[derive(Debug, Clone)]
pub struct Watch {
    /// Its peaks and arrivals, up to the end of the scene's duration.
    pub pulse: PulseRecorder,
    /// Its dynamic force at the times of the sample grid (N).
    pub samples: Vec<f64>,
}

/// Contact forces at coarse, even times: the whole chain as a film.
#[derive(Debug, Clone)]
pub struct Film {
    /// When the frames were taken.
    pub grid: Grid,
    /// Force in each contact at each time, static part included (N).
    pub contact_forces: Vec<Vec<f64>>,
    /// Displacement of each body at each time (m).
    pub displacements: Vec<Vec<f64>>,
    frames: usize,
}

/// The method at work on the chain: Runge-Kutta-Nystrom pairs by the chain's own stepper.
#[must_use]
pub fn start(chain: &Chain, method: Method, state: State) -> Box<dyn Integrator> {
    if let Some(pair) = method.nystrom() {
        return Box::new(ChainStepper::from_state(chain, state, pair, InstructionSet::best()));
    }
    let system = ChainSystem::new(chain, &state.velocity);
    method.start(Box::new(system), state)
}

/// A running bench.
pub struct Bench<'a> {
    chain: &'a Chain,
    integrator: Box<dyn Integrator + 'a>,
    grid: Grid,
    watches: Vec<Watch>,
    film: Film,
    initial_energy: Energy,
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
        let bodies = chain.bodies().len();
        let state =
            State { time: 0.0, position: vec![0.0; bodies], velocity: initial_velocities.to_vec() };
        let initial_energy = chain.energy(&state);
        // Before the first contact nothing moves: those samples are known.
        let before = grid.samples_until(0.0);
        let watch = |probe: &ForceProbe| Watch {
            pulse: PulseRecorder::new(*probe),
            samples: vec![0.0; before],
        };
        let mut film = Film {
            grid: film_grid,
            contact_forces: vec![Vec::new(); chain.contacts().len()],
            displacements: vec![Vec::new(); bodies],
            frames: 0,
        };
        film.take(chain, &state.position);
        Self {
            chain,
            integrator: start(chain, method, state),
            grid,
            watches: probes.iter().map(watch).collect(),
            film,
            initial_energy,
        }
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
        let bodies = self.chain.bodies().len();
        while self.integrator.time() < end {
            self.integrator.step(end)?;
            self.integrator.prepare_interpolation();
            let now = self.integrator.time();
            for watch in &mut self.watches {
                watch.take(self.integrator.as_ref(), bodies, self.grid, pulses);
            }
            self.film.follow(self.chain, self.integrator.as_ref());
            progress(now);
        }
        Ok(())
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

    /// Energy at the start and now.
    #[must_use]
    pub fn energies(&self) -> (Energy, Energy) {
        (self.initial_energy, self.chain.energy(&self.integrator.state()))
    }

    /// The present time (s).
    #[must_use]
    pub fn time(&self) -> f64 {
        self.integrator.time()
    }

    /// The present state.
    #[must_use]
    pub fn state(&self) -> State {
        self.integrator.state()
    }

    /// What the integration has cost so far.
    #[must_use]
    pub fn work(&self) -> Work {
        self.integrator.work()
    }
}

impl Watch {
    fn take(&mut self, integrator: &dyn Integrator, bodies: usize, grid: Grid, pulses: bool) {
        let segment = if pulses {
            self.pulse.take(integrator, bodies)
        } else {
            self.pulse.probe().over_step(integrator, bodies)
        };
        let end = integrator.time();
        let mut time = grid.time(self.samples.len());
        while time <= end {
            self.samples.push(segment.force((time - segment.start) / segment.length));
            time = grid.time(self.samples.len());
        }
    }
}

impl Film {
    /// Takes every frame that falls into the integrator's last step.
    fn follow(&mut self, chain: &Chain, integrator: &dyn Integrator) {
        let (start, length) = integrator.last_step();
        let end = integrator.time();
        if self.grid.time(self.frames) > end {
            return;
        }
        let motion: Vec<Interpolant> =
            (0..chain.bodies().len()).map(|body| integrator.interpolant(body)).collect();
        while self.grid.time(self.frames) <= end {
            let theta = (self.grid.time(self.frames) - start) / length;
            let position: Vec<f64> = motion.iter().map(|m| m.position(theta)).collect();
            self.take(chain, &position);
        }
    }

    fn take(&mut self, chain: &Chain, position: &[f64]) {
        for (j, forces) in self.contact_forces.iter_mut().enumerate() {
            forces.push(chain.contact_force(position, j));
        }
        for (track, x) in self.displacements.iter_mut().zip(position) {
            track.push(*x);
        }
        self.frames += 1;
    }
}
