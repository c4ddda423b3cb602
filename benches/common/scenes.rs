//! The scenes that speed is measured on, put together through the library's public types.

use hertzscope::chain::{
    Body, Chain, ChainSpec, EffectsSpec, Elasticity, End, ForceProbe, Gravity,
};
use hertzscope::scene::Scene;

const PTFE: Elasticity = Elasticity { youngs_modulus: 1.46e9, poissons_ratio: 0.46 };
const STEEL: Elasticity = Elasticity { youngs_modulus: 193e9, poissons_ratio: 0.3 };
/// Radius of every sphere (m).
const RADIUS: f64 = 2.38e-3;
/// Speed of the striker (m/s).
const SPEED: f64 = 0.44;
/// The magnet's pull on particle 1 (N).
const PRELOAD: f64 = 2.38;

/// A scene and what of it is compared.
pub struct Case {
    /// Short name.
    pub name: &'static str,
    pub chain: Chain,
    /// Velocities at the first contact (m/s).
    pub velocities: Vec<f64>,
    /// Time that is simulated (s).
    pub duration: f64,
    /// Particles whose first peaks are compared.
    pub particles: Vec<usize>,
}

impl Case {
    /// P37, G37, P600, P10000, the first row of P37 as P7, P37 read from a scene's text as
    /// `P37 typed`, or the shipped scene magnet-0.61g as `bench`. With ` own` behind them, spheres
    /// of the first four are up to 1 % larger from the top down, so that every contact has a
    /// stiffness of its own.
    pub fn named(name: &str) -> Option<Self> {
        let (kind, growth) = match name.strip_suffix(" own") {
            Some(kind) => (kind, 0.01),
            None => (name, 0.0),
        };
        Some(match kind {
            "P7" => alternating("P7", (7, growth), (PRELOAD, true), 5e-3, vec![4]),
            "P37" => alternating("P37", (37, growth), (PRELOAD, true), 5e-3, vec![14]),
            "G37" => alternating("G37", (37, growth), (0.0, true), 5e-3, vec![14]),
            "P600" => alternating("P600", (600, growth), (PRELOAD, false), 15e-3, vec![14, 400]),
            "P10000" => alternating("P10000", (10_000, growth), (PRELOAD, false), 1e-3, vec![14]),
            "P37 typed" => Self::of("P37 typed", p37(), 5e-3),
            "bench" => Self::of("bench", shipped("magnet-0.61g"), 5e-3),
            _ => return None,
        })
    }

    /// The chain of `scene` over `duration` (s).
    pub fn of(name: &'static str, scene: Scene, duration: f64) -> Self {
        let Scene { chain, initial_velocities: velocities, .. } = scene;
        Self { name, chain, velocities, duration, particles: vec![14] }
    }

    /// Places where forces are compared.
    pub fn probes(&self) -> Vec<ForceProbe> {
        let inside = |particle: &usize| ForceProbe::inside(&self.chain, *particle, 0.0);
        self.particles.iter().filter_map(inside).collect()
    }

    /// Time in which the striker goes as far as its contact is pressed: what fixed steps are
    /// measured by (s).
    pub fn unit(&self) -> f64 {
        let fastest = self.velocities.iter().fold(0.0, |most: f64, v| most.max(v.abs()));
        self.chain.impact_overlap(&self.velocities) / fastest
    }

    /// Contacts that can close.
    pub fn contacts(&self) -> usize {
        self.chain.contacts().iter().filter(|contact| contact.stiffness > 0.0).count()
    }
}

fn body(mass: f64, sphere: bool, radius: f64) -> Body {
    Body {
        name: if sphere { "ptfe_sphere" } else { "steel_cylinder" }.into(),
        mass,
        length: if sphere { 2.0 * radius } else { 3.12e-3 },
        curvature: if sphere { 1.0 / radius } else { 0.0 },
        elasticity: if sphere { PTFE } else { STEEL },
        axis: None,
        yield_strength: None,
    }
}

/// PTFE spheres and steel cylinders in turn, a sphere last, so that every contact is PTFE on flat
/// steel; the striker's face is what particle 1 is not. Radii grow by the share `growth` from the
/// first to the last.
fn alternating(
    name: &'static str,
    (count, growth): (usize, f64),
    (force, gravity): (f64, bool),
    duration: f64,
    particles: Vec<usize>,
) -> Case {
    let is_sphere = |particle: usize| (count - particle).is_multiple_of(2);
    let mass = |sphere: bool| if sphere { 0.1226e-3 } else { 0.485e-3 };
    let radius = |particle: usize| RADIUS * (1.0 + growth * particle as f64 / count as f64);
    let particle = |index: usize| {
        let sphere = is_sphere(index);
        body(mass(sphere), sphere, radius(index))
    };
    let spec = ChainSpec {
        striker: Some(body(0.61e-3, !is_sphere(1), RADIUS)),
        particles: (1..=count).map(particle).collect(),
        top: if force > 0.0 { End::Force(force) } else { End::Free },
        bottom: End::Wall(STEEL),
        wall_preload: 0.0,
        effects: EffectsSpec {
            gravity: gravity.then_some(Gravity { acceleration: 9.81 }),
            ..EffectsSpec::default()
        },
    };
    let chain = Chain::new(&spec).expect("every contact has a curved face and is pressed");
    let mut velocities = vec![0.0; chain.bodies().len()];
    velocities[0] = SPEED;
    Case { name, chain, velocities, duration, particles }
}

/// P37 as a user types it.
pub fn p37() -> Scene {
    Scene::from_text("p37", "p37.toml", include_str!("p37.toml")).expect("a scene")
}

/// The shipped scene `name`.
pub fn shipped(name: &str) -> Scene {
    Scene::load(name).expect("this scene ships with the program")
}
