//! A shot's data from its scene: circuits, velocities, distances, and the scene with other settings
//! of the striker and the magnet.

use std::borrow::Cow;

use rand_distr::{Distribution as _, StandardNormal};

use super::distance::{PlatePlace, distance};
use super::{Scene, input_load};
use crate::chain::{Chain, ChainError, MagnetForce};
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

    /// Distance down the chain at rest between two plates, negative upward, and its standard
    /// uncertainty (m).
    pub fn distance(&self, from: PlatePlace, to: PlatePlace) -> Option<(f64, f64)> {
        distance(&self.chain, from, to)
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
