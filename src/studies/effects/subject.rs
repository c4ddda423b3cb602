//! The scene that a ledger is made of, and its run.

use crate::chain::Chain;
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::{FRAMES_PER_RUN, Integration, RunError, method, probes, sample_grid};
use crate::scene::Scene;

/// The reference of all entries: the scene as it is run, and that run.
pub(super) struct BaselineRun<'a> {
    /// The scene with `auto` decided.
    pub(super) scene: &'a Scene,
    pub(super) accuracy: f64,
    pub(super) bench: Bench<'a>,
    pub(super) grid: Grid,
    /// The smallest first peak; infinite where nothing was felt (N).
    pub(super) wave: f64,
}

impl<'a> BaselineRun<'a> {
    pub(super) fn new(scene: &'a Scene, accuracy: f64) -> Result<Self, RunError> {
        let grid = sample_grid(scene, 1);
        let frames = Grid { start: 0.0, interval: scene.duration / FRAMES_PER_RUN };
        let method = method(scene, Integration::Accuracy(accuracy))?;
        let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
        let mut bench = Bench::new(chain, velocities, method, &probes(scene), (grid, frames));
        bench.run_until(scene.duration, true, &mut |_| ())?;
        let peaks = bench.watches().iter().filter_map(|watch| watch.pulse.first_peak());
        let wave = peaks.map(|peak| peak.dynamic_n).fold(f64::INFINITY, f64::min);
        Ok(Self { scene, accuracy, bench, grid, wave })
    }

    /// The scene after `edit` of its spec, the chain put together again.
    pub(super) fn rebuilt(&self, edit: impl FnOnce(&mut Scene)) -> Result<Scene, String> {
        let mut scene = self.scene.clone();
        edit(&mut scene);
        scene.chain = Chain::new(&scene.spec).map_err(|error| error.to_string())?;
        Ok(scene)
    }
}
