//! A scene as plain equations in units of its own, so that one absolute tolerance suits positions
//! and velocities alike.
//!
//! Unit of length is the overlap that the impact will reach, of speed the striker's, of mass its
//! mass.
//! `m x_i'' = A_i max(d_i + x_(i-1) - x_i, 0)^1.5 - A_(i+1) max(d_(i+1) + x_i - x_(i+1), 0)^1.5 + load_i`.

use hertzscope::chain::ForceProbe;
use hertzscope::motion::force_segment::over_step;
use hertzscope::motion::ChainSystem;
use hertzscope::experiment::bench::start;
use hertzscope::experiment::pulse::PulseRecorder;
use hertzscope::chain::State;
use hertzscope::motion::{Method, System as _};
use serde_json::{Value, json};

use crate::common::scenes::Case;

/// Tolerance of the reference's steps (1).
const REFERENCE: f64 = 1e-15;

/// A scene in its own units (1).
#[derive(Debug, Clone)]
pub struct Problem {
    pub name: &'static str,
    pub inverse_mass: Vec<f64>,
    /// Of contact i above body i, the last one below the last body.
    pub stiffness: Vec<f64>,
    pub overlap: Vec<f64>,
    /// Constant accelerations.
    pub load: Vec<f64>,
    pub velocity: Vec<f64>,
    pub duration: f64,
    /// The same (s).
    pub seconds: f64,
    /// Bodies whose first peaks are compared, when they peak in the reference, and how high (N).
    pub peaks: Vec<(usize, f64, f64)>,
    /// Newtons in the unit of force.
    pub newton: f64,
    /// Metres in the unit of length.
    pub metre: f64,
}

impl Problem {
    pub fn of(case: &Case) -> Self {
        let bodies = case.chain.bodies();
        let metre = case.chain.impact_overlap(&case.velocities);
        let speed = case.velocities[0];
        let second = metre / speed;
        let mass = bodies[0].mass;
        let newton = mass * speed * speed / metre;
        let contacts = case.chain.contacts();
        let rest = vec![0.0; bodies.len()];
        // Statics balances all but what is left over at rest: the striker's weight.
        let mut left = rest.clone();
        ChainSystem::new(&case.chain, &case.velocities).accelerations(&rest, &rest, &mut left);
        // What a code that sums `A overlap^1.5` itself has to add.
        let load = (0..bodies.len()).map(|i| {
            let held = contacts[i + 1].static_force - contacts[i].static_force;
            (left[i] * bodies[i].mass + held) / newton * mass / bodies[i].mass
        });
        Self {
            name: case.name,
            inverse_mass: bodies.iter().map(|b| mass / b.mass).collect(),
            stiffness: contacts.iter().map(|c| c.stiffness * metre.powf(1.5) / newton).collect(),
            overlap: contacts.iter().map(|c| c.static_overlap / metre).collect(),
            load: load.collect(),
            velocity: case.velocities.iter().map(|v| v / speed).collect(),
            duration: case.duration / second,
            seconds: case.duration,
            peaks: reference(case).into_iter().map(|(i, t, f)| (i, t / second, f)).collect(),
            newton,
            metre,
        }
    }

    /// Accelerations at `x`.
    pub fn accelerations(&self, x: &[f64], a: &mut [f64]) {
        let n = x.len();
        let force = |j: usize, change: f64| {
            let closed = (self.overlap[j] + change).max(0.0);
            self.stiffness[j] * closed * closed.sqrt()
        };
        let mut above = force(0, -x[0]);
        for i in 0..n {
            let below = force(i + 1, if i + 1 < n { x[i] - x[i + 1] } else { x[i] });
            a[i] = (above - below) * self.inverse_mass[i] + self.load[i];
            above = below;
        }
    }

    pub fn to_json(&self) -> Value {
        json!({
            "name": self.name, "inverse_mass": self.inverse_mass, "stiffness": self.stiffness,
            "overlap": self.overlap, "load": self.load, "velocity": self.velocity,
            "duration": self.duration, "seconds": self.seconds, "newton": self.newton, "metre": self.metre,
            "peaks": self.peaks,
        })
    }
}

/// Body, time (s) and height (N) of each first peak, by hertzscope's Dormand-Prince 8(5,3), which
/// shares neither loops nor corrections with what is timed.
fn reference(case: &Case) -> Vec<(usize, f64, f64)> {
    let bodies = case.chain.bodies().len();
    let state = State { time: 0.0, position: vec![0.0; bodies], velocity: case.velocities.clone() };
    let method = Method::DormandPrince853 { tolerance: REFERENCE };
    let mut integrator = start(&case.chain, method, state);
    let probes: Vec<ForceProbe> = case.probes();
    let impact = case.chain.impact_force(&case.velocities);
    let follow = |probe| PulseRecorder::new(probe, impact, &case.velocities);
    let mut pulses: Vec<PulseRecorder> = probes.iter().map(follow).collect();
    while integrator.time() < case.duration {
        integrator.step(case.duration).expect("the reference runs");
        integrator.prepare_interpolation();
        for (pulse, probe) in pulses.iter_mut().zip(&probes) {
            pulse.process_step(over_step(probe, integrator.as_ref(), bodies));
        }
    }
    let first = |(particle, pulse): (&usize, &PulseRecorder)| {
        let peak = pulse.first_peak()?;
        Some((case.chain.body_of(*particle), peak.time_s, peak.dynamic_n))
    };
    case.particles.iter().zip(&pulses).filter_map(first).collect()
}
