//! Chains for the hard cases, and runs of them.

use super::tally::CaseChecks;
use crate::chain::State;
use crate::chain::{Body, Chain, ChainSpec, EffectsSpec, Elasticity, End, ForceProbe};
use crate::experiment::bench::{Bench, Grid, start};
use crate::experiment::for_accuracy;
use crate::experiment::method_choice::method_for;
use crate::experiment::pulse::Peak;
use crate::motion::{Method, Work};

pub const PTFE: Elasticity = Elasticity { youngs_modulus: 1.46e9, poissons_ratio: 0.46 };
pub const STEEL: Elasticity = Elasticity { youngs_modulus: 193e9, poissons_ratio: 0.3 };
/// Mass of a PTFE sphere of the bench (kg).
pub const LIGHT: f64 = 0.1226e-3;
/// Mass of a steel cylinder of the bench (kg).
pub const HEAVY: f64 = 0.485e-3;
/// Tolerance of the steps of a reference by another family of methods (1).
const REFERENCE: f64 = 1e-13;
/// The same with losses, by a pair of lower order (1).
const LOSSY_REFERENCE: f64 = 1e-12;
/// Instants at which a lossy chain's energy is looked at.
const INSTANTS: u32 = 50;

/// A sphere of the bench's size, of any mass (kg).
pub fn sphere(mass: f64, elasticity: Elasticity) -> Body {
    let (length, curvature) = (4.76e-3, 1.0 / 2.38e-3);
    let name = "sphere".into();
    Body { name, mass, length, curvature, axis: None, elasticity, yield_strength: None }
}

/// Spheres of PTFE.
pub fn spheres(count: usize) -> Vec<Body> {
    vec![sphere(LIGHT, PTFE); count]
}

/// PTFE spheres and flat steel bodies of `heavy` (kg) in turn, sphere first.
pub fn diatomic(cells: usize, heavy: f64) -> Vec<Body> {
    let flat = Body { curvature: 0.0, ..sphere(heavy, STEEL) };
    (0..cells).flat_map(|_| [sphere(LIGHT, PTFE), flat.clone()]).collect()
}

/// Particles between `ends`.
pub fn between(particles: Vec<Body>, ends: (End, End)) -> Result<Chain, String> {
    let effects = EffectsSpec::default();
    assemble(&ChainSpec {
        striker: None,
        particles,
        top: ends.0,
        bottom: ends.1,
        wall_preload: 0.0,
        effects,
    })
}

/// Particles pressed together by `force` (N) from both ends; 0 leaves them free.
pub fn pressed(particles: Vec<Body>, force: f64) -> Result<Chain, String> {
    let end = if force > 0.0 { End::Force(force) } else { End::Free };
    between(particles, (end, end))
}

/// A chain, or why it could not be made.
pub fn assemble(spec: &ChainSpec) -> Result<Chain, String> {
    Chain::new(spec).map_err(|error| error.to_string())
}

/// One body moves, with `speed` (m/s).
pub fn set_moving(chain: &Chain, body: usize, speed: f64) -> Vec<f64> {
    let mut velocities = vec![0.0; chain.bodies().len()];
    if let Some(velocity) = velocities.get_mut(body) {
        *velocity = speed;
    }
    velocities
}

/// A chain set in motion.
pub struct MovingChain<'a> {
    /// The chain.
    pub chain: &'a Chain,
    /// Velocity of each body at the start (m/s).
    pub velocities: Vec<f64>,
}

/// Where a motion has come to.
pub struct FinalState {
    pub state: State,
    pub work: Work,
}

impl MovingChain<'_> {
    /// At rest but for the velocities it starts with.
    pub fn start(&self) -> State {
        let position = vec![0.0; self.velocities.len()];
        State { time: 0.0, position, velocity: self.velocities.clone() }
    }

    /// The state after `time` (s), as `--accuracy` computes it.
    pub fn after(&self, time: f64, accuracy: f64) -> Result<FinalState, String> {
        self.by(for_accuracy(accuracy), time)
    }

    /// The state after `time` (s).
    pub fn by(&self, method: Method, time: f64) -> Result<FinalState, String> {
        let mut integrator = start(self.chain, method, self.start());
        integrator.advance(time).map_err(|error| error.to_string())?;
        Ok(FinalState { state: integrator.state(), work: integrator.work() })
    }

    /// First peaks of `probes` within `time` (s).
    pub fn peaks(
        &self,
        method: Method,
        probes: &[ForceProbe],
        time: f64,
    ) -> Result<Vec<Option<Peak>>, String> {
        let mut bench =
            Bench::new(self.chain, &self.velocities, method, probes, Grid::NEVER, Grid::NEVER);
        bench.run_until(time, true, &mut |_| ()).map_err(|error| error.to_string())?;
        Ok(bench.watches().iter().map(|watch| watch.pulse.first_peak()).collect())
    }

    /// First peaks of the contacts `contacts` as `--accuracy` finds them.
    pub fn contact_peaks(
        &self,
        contacts: &[usize],
        accuracy: f64,
        time: f64,
    ) -> Result<Vec<Peak>, String> {
        self.peaks(for_accuracy(accuracy), &self.probes(contacts), time)?
            .into_iter()
            .map(|peak| peak.ok_or_else(|| "no pulse arrived".to_owned()))
            .collect()
    }

    fn probes(&self, contacts: &[usize]) -> Vec<ForceProbe> {
        contacts.iter().filter_map(|j| ForceProbe::contact(self.chain, *j)).collect()
    }

    /// Holds first peaks at `contacts` by the first of two methods against those by the second.
    pub fn hold_peaks(
        &self,
        tally: &mut CaseChecks,
        what: &str,
        (contacts, accuracy, time): (&[usize], f64, f64),
        methods: [Method; 2],
    ) -> Result<(), String> {
        let probes = self.probes(contacts);
        let [found, exact] = methods.map(|method| self.peaks(method, &probes, time));
        check_readings(tally, what, &found?, &exact?, accuracy);
        Ok(())
    }

    /// Checks force and time of first peaks at `contacts` against another family of methods: no
    /// more than `accuracy` off at the loudest of them, by which the error control measures, and as
    /// much more as a pulse is weaker elsewhere; and the energy.
    pub fn check_peaks(
        &self,
        tally: &mut CaseChecks,
        what: &str,
        asked: (&[usize], f64, f64),
    ) -> Result<(), String> {
        let (_, accuracy, time) = asked;
        let reference = Method::DormandPrince853 { tolerance: REFERENCE };
        self.hold_peaks(tally, what, asked, [for_accuracy(accuracy), reference])?;
        let end = self.after(time, accuracy)?;
        tally.check(
            format!("{what}, energy"),
            self.drift(&end.state),
            drift_bound(end.work, accuracy),
        );
        Ok(())
    }

    /// Checks first peaks at `contacts` of a chain with losses against another family of methods,
    /// as [`MovingChain::check_peaks`] does, and the energy with what the losses have taken: that
    /// it is all there at the end, and never more than there was.
    pub fn check_lossy(
        &self,
        tally: &mut CaseChecks,
        what: &str,
        asked: (&[usize], f64, f64),
    ) -> Result<(), String> {
        let (_, accuracy, time) = asked;
        let reference = Method::DormandPrince54 { tolerance: LOSSY_REFERENCE };
        let method = method_for(self.chain, &self.velocities, accuracy);
        self.hold_peaks(tally, what, asked, [method, reference])?;
        let mut bench =
            Bench::new(self.chain, &self.velocities, method, &[], Grid::NEVER, Grid::NEVER);
        let mut most = 0.0_f64;
        let mut end = 0.0;
        for instant in 1..=INSTANTS {
            let until = time * f64::from(instant) / f64::from(INSTANTS);
            bench.run_until(until, false, &mut |_| ()).map_err(|error| error.to_string())?;
            let (before, now) = bench.energies();
            let impact = before.kinetic;
            most = most.max((now.total() - before.total()) / impact);
            end = (now.total() + bench.dissipated().total() - before.total()) / impact;
        }
        let bound = drift_bound(bench.work(), accuracy);
        tally.check(format!("{what}, energy gained"), most, bound);
        tally.check(format!("{what}, energy and losses"), end, bound);
        Ok(())
    }

    /// Change of the energy, relative to that of the impact (1).
    pub fn drift(&self, state: &State) -> f64 {
        let before = self.chain.energy_above_static(&self.start());
        self.chain.energy_above_static(state) / before - 1.0
    }
}

/// First peaks against exact ones: no more than `accuracy` off at the loudest contact (1), and as
/// much more as a pulse is weaker.
fn check_readings(
    tally: &mut CaseChecks,
    what: &str,
    found: &[Option<Peak>],
    exact: &[Option<Peak>],
    accuracy: f64,
) {
    let loudest = exact.iter().flatten().map(|peak| peak.dynamic_n).fold(0.0, f64::max);
    for (found, exact) in found.iter().zip(exact) {
        match (found, exact) {
            (Some(found), Some(exact)) => {
                let force = found.dynamic_n / exact.dynamic_n - 1.0;
                // A dashpot's force may be largest where the striker first touches.
                let late = found.time_s - exact.time_s;
                let arrival = if late == 0.0 { 0.0 } else { late / exact.time_s };
                let bound = accuracy * loudest / exact.dynamic_n;
                tally.check(format!("{what}, peak force"), force, bound);
                tally.check(format!("{what}, peak time"), arrival, bound);
            }
            (None, None) => {}
            _ => tally.check(format!("{what}, pulses lost"), f64::INFINITY, accuracy),
        }
    }
}

/// Bound of the energy drift: each step may be off by the accuracy in speed, twice that in energy,
/// as often one way as the other, or a method would make energy (1).
pub fn drift_bound(work: Work, accuracy: f64) -> f64 {
    2.0 * (work.steps as f64).sqrt() * accuracy
}
