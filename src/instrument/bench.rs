//! The bench behind the instrument as the remote interface controls it: requests, which the owner
//! of both carries out.
//!
//! Numbers are clamped into what can be simulated in reasonable time. An instrument without a bench
//! has none of this.

use super::fault::Faults;
use crate::trace::Trace;

/// Lightest and heaviest striker (kg).
const STRIKER_MASS_RANGE: (f64, f64) = (1e-5, 0.1);
/// Slowest and fastest striker (m/s).
const STRIKER_SPEED_RANGE: (f64, f64) = (1e-3, 10.0);
/// Weakest and strongest magnet (N).
const MAGNET_FORCE_RANGE: (f64, f64) = (0.0, 100.0);
/// Impacts that may wait to be carried out.
const MAX_QUEUED_IMPACTS: u32 = 1000;

/// A scene that the bench can be set up as, and what there is to turn in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BenchScene {
    /// Its name.
    pub name: String,
    /// Mass of the striker, where there is one (kg).
    pub striker_mass: Option<f64>,
    /// Speed of the striker at its first contact, before any spread (m/s).
    pub striker_speed: Option<f64>,
    /// Force of the magnet, where there is one (N).
    pub magnet_force: Option<f64>,
}

/// What clients may change of the bench.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BenchAccess {
    /// Everything.
    #[default]
    Full,
    /// Everything but faults.
    NoFaults,
    /// Nothing: they may look, and use the oscilloscope.
    ReadOnly,
}

/// The bench as the remote interface knows it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RemoteBench {
    /// The scene that it is set up as, with everything that was turned since.
    pub scene: BenchScene,
    /// Scenes that it can be set up as; none without a bench.
    pub scenes: Vec<BenchScene>,
    /// What clients may change.
    pub access: BenchAccess,
    /// Impacts so far.
    pub impacts: u32,
    /// Impacts asked for and not carried out.
    pub asked: u32,
    /// Faults on demand.
    pub faults: Faults,
    /// True force at the sensor of each channel in the last impact, over the time after the
    /// striker's first contact; none for a channel that has no sensor.
    pub forces: Vec<Option<Trace>>,
    /// Time of the scope's trigger in that impact after the striker's first contact, where it has
    /// triggered (s).
    pub triggered_at: Option<f64>,
}

impl RemoteBench {
    /// Asks for an impact; more than a thousand do not wait.
    pub fn ask_for_impact(&mut self) {
        self.asked = (self.asked + 1).min(MAX_QUEUED_IMPACTS);
    }

    /// Sets the bench up as one of its scenes, as that is. Whether there is one of this name.
    pub fn set_scene(&mut self, name: &str) -> bool {
        let known = self.scenes.iter().find(|known| known.name.eq_ignore_ascii_case(name));
        if let Some(known) = known {
            self.scene = known.clone();
        }
        known.is_some()
    }

    /// Sets the striker's mass (kg). Whether there is a striker.
    pub fn set_striker_mass(&mut self, mass: f64) -> bool {
        set(&mut self.scene.striker_mass, mass, STRIKER_MASS_RANGE)
    }

    /// Sets the striker's speed (m/s). Whether there is a striker.
    pub fn set_striker_speed(&mut self, speed: f64) -> bool {
        set(&mut self.scene.striker_speed, speed, STRIKER_SPEED_RANGE)
    }

    /// Sets the magnet's force (N). Whether there is a magnet.
    pub fn set_magnet_force(&mut self, force: f64) -> bool {
        set(&mut self.scene.magnet_force, force, MAGNET_FORCE_RANGE)
    }
}

fn set(setting: &mut Option<f64>, value: f64, (low, high): (f64, f64)) -> bool {
    if let Some(setting) = setting {
        *setting = value.clamp(low, high);
    }
    setting.is_some()
}
