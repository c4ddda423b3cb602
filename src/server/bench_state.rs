//! The bench as it is set up: the scene, and what clients have changed of it.

use std::sync::Arc;

use crate::instrument::bench;
use crate::instrument::{Event, Instrument};
use crate::scene::Scene;

/// The bench as it is set up.
pub struct BenchState {
    /// The scene that is served, and those that ship with the program.
    scenes: Vec<Arc<Scene>>,
    /// The scene with everything that clients have changed.
    pub scene: Arc<Scene>,
    applied: bench::BenchScene,
}

impl BenchState {
    /// The bench set up as the scene that is served.
    pub fn new(served: &Scene, instrument: &mut Instrument) -> Self {
        let mut scenes = vec![Arc::new(served.clone())];
        for name in Scene::names().into_iter().filter(|name| *name != served.name) {
            scenes.extend(Scene::load(name).map(Arc::new));
        }
        instrument.bench.scenes = scenes.iter().map(|scene| knobs(scene)).collect();
        let scene = Arc::new(served.clone());
        instrument.bench.scene = knobs(&scene);
        Self { scenes, scene, applied: instrument.bench.scene.clone() }
    }

    /// Whether the bench is as the scene that is served.
    pub fn is_as_served(&self) -> bool {
        self.is_served(&self.scene)
    }

    /// Whether `scene` is the one that is served, with nothing changed.
    pub fn is_served(&self, scene: &Scene) -> bool {
        self.scenes.first().is_some_and(|served| **served == *scene)
    }

    /// Applies the changes that clients have requested; an impossible one is reverted and reported
    /// as an event.
    pub fn apply_changes(&mut self, instrument: &mut Instrument) {
        let wanted = &instrument.bench.scene;
        if *wanted == self.applied {
            return;
        }
        let (mass, speed, force) = (wanted.striker_mass, wanted.striker_speed, wanted.magnet_force);
        let known = self.scenes.iter().find(|scene| scene.name == wanted.name);
        if let Some(Ok(scene)) = known.map(|scene| scene.altered(mass, speed, force)) {
            self.applied = wanted.clone();
            self.scene = Arc::new(scene);
            instrument.set_front_end(&self.scene.scope);
        } else {
            instrument.bench.scene = self.applied.clone();
            instrument.status.report(Event::SettingsConflict);
        }
    }
}

/// The adjustable numbers of a scene with their present values.
fn knobs(scene: &Scene) -> bench::BenchScene {
    bench::BenchScene {
        name: scene.name.clone(),
        striker_mass: scene.spec.striker.as_ref().map(|striker| striker.mass),
        striker_speed: scene.striker_speed(),
        magnet_force: scene.chain.magnet().map(|magnet| magnet.force),
    }
}
