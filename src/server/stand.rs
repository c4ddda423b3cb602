//! The bench as it is set up: the scene, and what clients have changed of it.

use std::sync::Arc;

use crate::instrument::{Bench, Event, Instrument};
use crate::scene::Scene;

/// The bench as it is set up.
pub struct Stand {
    served: Arc<Scene>,
    /// The scene with everything that clients have changed.
    pub scene: Arc<Scene>,
    applied: Bench,
}

impl Stand {
    /// Set up as the scene that is served.
    pub fn new(scene: &Scene, instrument: &mut Instrument) -> Self {
        let served = Arc::new(scene.clone());
        let mut scenes: Vec<String> = Scene::names().into_iter().map(ToOwned::to_owned).collect();
        if !scenes.contains(&scene.name) {
            scenes.push(scene.name.clone());
        }
        instrument.bench.scenes = scenes;
        let scene = Arc::clone(&served);
        let mut stand = Self { served, scene, applied: Bench::default() };
        stand.set_up(instrument);
        stand
    }

    /// Whether the bench is as the scene that is served.
    pub fn is_as_served(&self) -> bool {
        Arc::ptr_eq(&self.served, &self.scene)
    }

    /// Carries out what clients want changed; what cannot be is an event, and stays as it was.
    pub fn settle(&mut self, instrument: &mut Instrument) {
        let wanted = &instrument.bench;
        if wanted.scene != self.applied.scene {
            let loaded = if wanted.scene == self.served.name {
                Ok(Arc::clone(&self.served))
            } else {
                Scene::load(&wanted.scene).map(Arc::new)
            };
            if let Ok(scene) = loaded {
                self.scene = scene;
                self.set_up(instrument);
            } else {
                self.refuse(instrument);
            }
            return;
        }
        let knobs = |bench: &Bench| (bench.striker_mass, bench.striker_speed, bench.magnet_force);
        if knobs(wanted) != knobs(&self.applied) {
            let (mass, speed, force) = knobs(wanted);
            match self.scene.altered(mass, speed, force) {
                Ok(scene) => {
                    self.scene = Arc::new(scene);
                    self.applied = instrument.bench.clone();
                }
                Err(_) => self.refuse(instrument),
            }
        }
    }

    /// Sets the instrument up for the scene: what its inputs are like, and what there is to turn.
    fn set_up(&mut self, instrument: &mut Instrument) {
        let scene = &self.scene;
        instrument.noise = scene.scope.noise;
        for (offset, channel) in instrument.offsets.iter_mut().zip(&scene.scope.channels) {
            *offset = channel.as_ref().map_or(0.0, |channel| channel.offset);
        }
        instrument.bench.scene.clone_from(&scene.name);
        instrument.bench.striker_mass = scene.spec.striker.as_ref().map(|striker| striker.mass);
        instrument.bench.striker_speed = scene.striker_speed();
        instrument.bench.magnet_force =
            scene.spec.effects.magnet_preload.map(|magnet| magnet.force);
        self.applied = instrument.bench.clone();
    }

    fn refuse(&mut self, instrument: &mut Instrument) {
        let bench = &mut instrument.bench;
        let (impacts, asked) = (bench.impacts, bench.asked);
        *bench = Bench { impacts, asked, ..self.applied.clone() };
        instrument.status.report(Event::SettingsConflict);
    }
}
