//! Parameters of a scene that can be tuned.

use crate::chain::{Body, Chain, ChainError, End};
use crate::scene::{Scene, Site};

/// A parameter of a scene that can be tuned.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TuningParameter {
    /// The static force.
    Preload,
    /// Mass of the heavier kind of particles.
    HeavyMass,
    /// Mass of the lighter kind.
    LightMass,
    /// Young's modulus of the softer kind.
    Modulus,
    /// Mass of the striker.
    StrikerMass,
    /// Its speed.
    StrikerSpeed,
}

impl TuningParameter {
    /// All knobs.
    pub const ALL: [Self; 6] = [
        Self::Preload,
        Self::HeavyMass,
        Self::LightMass,
        Self::Modulus,
        Self::StrikerMass,
        Self::StrikerSpeed,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Preload => "preload",
            Self::HeavyMass => "heavy-mass",
            Self::LightMass => "light-mass",
            Self::Modulus => "modulus",
            Self::StrikerMass => "striker-mass",
            Self::StrikerSpeed => "striker-speed",
        }
    }

    /// Unit of its values.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Preload => "N",
            Self::HeavyMass | Self::LightMass | Self::StrikerMass => "kg",
            Self::Modulus => "Pa",
            Self::StrikerSpeed => "m/s",
        }
    }

    /// The knobs that `scene` has.
    pub fn of(scene: &Scene) -> Vec<Self> {
        Self::ALL.into_iter().filter(|knob| knob.value(scene).is_some()).collect()
    }

    /// Where `scene` has it, in its unit; none where it has none (unit).
    pub fn value(self, scene: &Scene) -> Option<f64> {
        let spec = &scene.spec;
        let value = match self {
            Self::Preload => match (scene.chain.magnet(), spec.top) {
                (Some(magnet), _) => Some(magnet.force),
                (None, End::Force(force)) => Some(force),
                (None, End::Wall(_)) => Some(spec.wall_preload),
                (None, End::Free) => None,
            },
            Self::HeavyMass => Some(kinds(scene)?.1.mass),
            Self::LightMass => Some(kinds(scene)?.0.mass),
            Self::Modulus => Some(softest(scene)?.elasticity.youngs_modulus),
            Self::StrikerMass => Some(spec.striker.as_ref()?.mass),
            Self::StrikerSpeed => {
                spec.striker.as_ref().and(scene.initial_velocities.first().copied())
            }
        };
        value.filter(|value| *value > 0.0)
    }

    /// `scene` with this knob at `value`, in its unit.
    ///
    /// # Errors
    /// [`ChainError`] where no chain is so.
    pub fn turn(self, scene: &Scene, value: f64) -> Result<Scene, ChainError> {
        if self == Self::Preload && scene.chain.magnet().is_some() {
            return scene.altered(None, None, Some(value));
        }
        let mut turned = scene.clone();
        let spec = &mut turned.spec;
        let name = |body: Option<&Body>| body.map(|body| body.name.clone());
        let meant = match self {
            Self::HeavyMass => name(kinds(scene).map(|kinds| kinds.1)),
            Self::LightMass => name(kinds(scene).map(|kinds| kinds.0)),
            Self::Modulus => name(softest(scene)),
            _ => None,
        };
        for body in spec.particles.iter_mut().filter(|body| Some(&body.name) == meant.as_ref()) {
            match self {
                Self::Modulus => body.elasticity.youngs_modulus = value,
                _ => body.mass = value,
            }
        }
        match self {
            Self::Preload => match spec.top {
                End::Force(_) => {
                    spec.top = End::Force(value);
                    if let End::Force(bottom) = &mut spec.bottom {
                        *bottom = value;
                    }
                }
                _ => spec.wall_preload = value,
            },
            Self::StrikerMass => spec.striker.iter_mut().for_each(|striker| striker.mass = value),
            Self::StrikerSpeed => {
                turned.initial_velocities.iter_mut().take(1).for_each(|speed| *speed = value);
            }
            _ => {}
        }
        turned.chain = Chain::new(&turned.spec)?;
        Ok(turned)
    }
}

/// The particles with sensors, from top to bottom.
pub(super) fn sensed(scene: &Scene) -> Vec<usize> {
    let particle = |site: Site| match site {
        Site::Particle(particle) => Some(particle),
        Site::Wall => None,
    };
    scene.sensors.iter().filter_map(|sensor| particle(sensor.site)).collect()
}

/// The lighter and the heavier of the two kinds of particles around the first sensor.
fn kinds(scene: &Scene) -> Option<(&Body, &Body)> {
    let first = *sensed(scene).first()?;
    let body = |particle: usize| scene.spec.particles.get(particle - 1);
    let (here, next) = (body(first)?, body(first + 1)?);
    // A taper has no mass of its kind.
    let is_tapered =
        |body: &Body| scene.spec.particles.iter().any(|b| b.name == body.name && !b.is_alike(body));
    if here.name == next.name || is_tapered(here) || is_tapered(next) {
        return None;
    }
    Some(if here.mass < next.mass { (here, next) } else { (next, here) })
}

fn softest(scene: &Scene) -> Option<&Body> {
    let modulus = |body: &&Body| body.elasticity.youngs_modulus;
    scene.spec.particles.iter().min_by(|a, b| modulus(a).total_cmp(&modulus(b)))
}
