//! A shot's data from its scene: circuits, velocities, distances, and the scene with other settings
//! of the striker and the magnet.

use std::borrow::Cow;
use std::collections::BTreeMap;

use rand_distr::{Distribution as _, StandardNormal};

use super::distance::{PlatePlace, Site, distance};
use super::{Scene, input_load};
use crate::chain::{Body, Chain, ChainError, MagnetForce};
use crate::quantity::Uncertain;
use crate::scope::ChannelSetup;
use crate::scope::front_end::noise_stream;
use crate::sensor::{Circuit, Load};

/// Stream of the striker's speed; channels use 1 to 4, the sample clock 0.
const STRIKER_STREAM: u8 = 5;

impl Scene {
    /// The circuit that sensor `index` forms with `channel`'s input, its tolerance included.
    pub fn circuit(&self, index: usize, channel: &ChannelSetup) -> Option<Circuit> {
        self.circuit_into(index, input_load(&self.scope.model, channel))
    }

    /// The same with any load.
    pub fn circuit_into(&self, index: usize, load: Load) -> Option<Circuit> {
        let sensor = &self.sensors.get(index)?.sensor;
        let number = u32::try_from(index).unwrap_or(u32::MAX);
        Some(match &self.sensor_tolerance {
            Some(tolerance) => tolerance.draw(sensor, self.seed, number).connect(load),
            None => sensor.connect(load),
        })
    }

    /// Distance down the chain at rest between two plates, in metres, negative upward.
    ///
    /// Its uncertainty is that of the plates' offsets and of the particles' lengths, from
    /// `[uncertainty]`: `u(d)^2 = sum (u_i dd/dx_i)^2` over inputs `x_i` that are independent of
    /// each other. All particles of a kind have one length, and inputs of a group vary together.
    pub fn distance(&self, from: PlatePlace, to: PlatePlace) -> Option<Uncertain> {
        let value = distance(&self.chain, from, to)?;
        let body = |particle| self.chain.bodies().get(self.chain.body_of(particle));
        let mut variance = 0.0;
        // What one standard uncertainty of an input changes.
        let mut changes = BTreeMap::<String, f64>::new();
        for (particle, scale) in (1..).zip(&self.length_scales) {
            let share = from.height_per_length(particle) - to.height_per_length(particle);
            let Some(body) = body(particle).filter(|_| share * scale != 0.0) else { continue };
            let path = format!("particles.{}.{}", body.name, length_key(body));
            let Some(input) = self.stated_uncertainty_of(&path) else { continue };
            let u = input.distribution.standard(body.length / scale);
            let name = input.group.clone().unwrap_or(path);
            *changes.entry(name).or_default() += share * scale * u;
        }
        for (place, sign) in [(from, -1.0), (to, 1.0)] {
            let Site::Particle(particle) = place.site else { continue };
            let change = sign * place.offset_u * body(particle)?.length;
            match self.group_of_offset(place) {
                Some(group) => *changes.entry(group.to_owned()).or_default() += change,
                None => variance += change * change,
            }
        }
        variance += changes.values().map(|change| change * change).sum::<f64>();
        Some(Uncertain::normal(value, variance.sqrt()))
    }

    /// The group whose inputs vary together with the offset of the plate at `place`, if any.
    fn group_of_offset(&self, place: PlatePlace) -> Option<&str> {
        let sensor = self.sensors.iter().find(|sensor| sensor.place() == place)?;
        let input = self.stated_uncertainty_of(&format!("sensors.{}.offset", sensor.name))?;
        input.group.as_deref()
    }

    /// The speed at which the striker first touches the chain, before any spread; none without a
    /// striker (m/s).
    pub fn striker_speed(&self) -> Option<f64> {
        self.spec.striker.as_ref().and_then(|_| self.initial_velocities.first().copied())
    }

    /// The same bench with another striker's mass (kg) and speed (m/s) and another force of the
    /// magnet (N), which is moved to where it pulls so hard, each where there is one; none leaves
    /// what is there. [`Scene::text`] still tells the bench as typed.
    ///
    /// # Errors
    /// [`ChainError`] where no such chain is at rest.
    pub fn altered(
        &self,
        mass: Option<f64>,
        speed: Option<f64>,
        force: Option<f64>,
    ) -> Result<Self, ChainError> {
        let mut scene = self.clone();
        if let Some(striker) = &mut scene.spec.striker {
            striker.mass = mass.unwrap_or(striker.mass);
            if let (Some(speed), Some(velocity)) = (speed, scene.initial_velocities.first_mut()) {
                *velocity = speed;
            }
        }
        let present = self.chain.magnet();
        if let (Some(magnet), Some(present), Some(force)) =
            (&mut scene.spec.effects.magnet_preload, present, force)
            && (force - present.force).abs() > 0.0
        {
            let place = present.pull.as_ref().map_or(0.0, |pull| pull.distance);
            magnet.force = match &magnet.force {
                MagnetForce::Constant(_) => MagnetForce::Constant(force),
                MagnetForce::Placed(placed) => {
                    let moved = placed.moved_to(force, place);
                    MagnetForce::Placed(moved.ok_or(ChainError::MagnetTooWeak { force })?)
                }
            };
        }
        scene.chain = Chain::new(&scene.spec)?;
        Ok(scene)
    }

    /// The scene whose striker comes at the speed of shot `shot`, whatever shot is taken of it.
    pub fn of_shot(&self, shot: u32) -> Cow<'_, Self> {
        if self.striker_speed_spread.is_none() {
            return Cow::Borrowed(self);
        }
        let mut own = self.clone();
        own.initial_velocities = self.velocities(shot);
        own.striker_speed_spread = None;
        Cow::Owned(own)
    }

    /// Velocity of each body at the first contact of shot `shot`: the striker's speed is drawn from
    /// the seed where the scene spreads it, from a log-normal distribution with the scene's speed
    /// as its mean (m/s).
    pub fn velocities(&self, shot: u32) -> Vec<f64> {
        let mut velocities = self.initial_velocities.clone();
        if let (Some(speed), Some(spread)) = (velocities.first_mut(), self.striker_speed_spread) {
            // Mean 1 and standard deviation `spread`: sigma^2 = ln(1 + spread^2), mu = -sigma^2/2.
            // Never backward.
            let variance = (spread * spread).ln_1p();
            let mut stream = noise_stream(self.seed, shot, STRIKER_STREAM);
            let draw: f64 = StandardNormal.sample(&mut stream);
            *speed *= (variance.sqrt() * draw - 0.5 * variance).exp();
        }
        velocities
    }
}

/// The key of a particle that is its length along the chain.
fn length_key(body: &Body) -> &'static str {
    let is_flat = body.curvature == 0.0;
    if is_flat { "height" } else { "diameter" }
}
