//! The effects ledger of a scene: what is on, why, what it costs, and what it changes.
//!
//! Cost and change are measured, by runs with and without the effect at the same accuracy, in turn; a change is that of what the user
//! reads: first peaks, arrivals and speeds of forces for effects of the chain, first peaks and half-rises of the scope's
//! signals for effects of sensors and scope. An effect that is off is no part of the system that is integrated, and costs nothing.
//!
//! That it does: `tests/it/effects.rs` demands the same bytes from the same number of evaluations whether an effect is off or absent.
//! Instructions, for a dashpot that is off against a scene without one, `valgrind --tool=callgrind hertzscope run S --accuracy 1e-3`: the
//! loops of the steps (`chain/stepper/passes.rs`) take the same number to the last one; the whole program 0.16 % more, to read the
//! longer file.

mod chain;
mod electronics;
mod numerics;
mod trial;

use serde::Serialize;

use crate::chain::Chain;
use crate::experiment::bench::{Bench, Grid};
use crate::experiment::{FRAMES, Integration, RunError, auto_effects, method, probes, sample_grid};
use crate::scene::Scene;
pub use trial::Change;
use trial::Cost;

/// Whether an effect is part of a run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// It is.
    On,
    /// It is not.
    Off,
    /// The program decides; the reason says how.
    Auto,
}

/// One line of the ledger.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Entry {
    /// Name; that of its table in a scene, where it has one.
    pub effect: &'static str,
    /// On, off, or decided by the program.
    pub state: State,
    /// Whether it is part of this run, whoever decided that.
    pub active: bool,
    /// The dimensionless number that tells whether it matters.
    pub criterion: &'static str,
    /// Its value; none where it needs a setting that nobody has made (1).
    pub value: Option<f64>,
    /// Why it is on or off.
    pub reason: String,
    /// Wall time it adds to a step, the median of runs in turn; for effects of sensors and scope, what they add to the whole over the
    /// steps (ns).
    pub cost_ns_per_step: Option<f64>,
    /// Its standard uncertainty, from the scatter of the runs; a cost below twice this is none that was seen (ns).
    pub cost_u_ns_per_step: Option<f64>,
    /// That time as a share of the run with it (1).
    pub cost_share: Option<f64>,
    /// What it changes, or would change; none where that was not to be measured.
    pub change: Option<Change>,
}

/// The ledger.
#[derive(Debug, Clone, PartialEq)]
pub struct Ledger {
    /// Scene name.
    pub scene: String,
    /// Accuracy of all runs (1).
    pub accuracy: f64,
    /// One line an effect.
    pub entries: Vec<Entry>,
}

/// What all entries look at: the scene as it is run, and that run.
struct Subject<'a> {
    /// The scene with `auto` decided.
    scene: &'a Scene,
    accuracy: f64,
    bench: Bench<'a>,
    grid: Grid,
    /// The smallest first peak; infinite where nothing was felt (N).
    wave: f64,
}

impl<'a> Subject<'a> {
    fn new(scene: &'a Scene, accuracy: f64) -> Result<Self, RunError> {
        let grid = sample_grid(scene, 1);
        let frames = Grid { start: 0.0, interval: scene.duration / FRAMES };
        let method = method(scene, Integration::Accuracy(accuracy))?;
        let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
        let mut bench = Bench::new(chain, velocities, method, &probes(scene), (grid, frames));
        bench.run_until(scene.duration, true, &mut |_| ())?;
        let peaks = bench.watches().iter().filter_map(|watch| watch.pulse.first_peak());
        let wave = peaks.map(|peak| peak.dynamic_n).fold(f64::INFINITY, f64::min);
        Ok(Self { scene, accuracy, bench, grid, wave })
    }

    /// The scene after `edit` of its spec, the chain put together again.
    fn rebuilt(&self, edit: impl FnOnce(&mut Scene)) -> Result<Scene, String> {
        let mut scene = self.scene.clone();
        edit(&mut scene);
        scene.chain = Chain::new(&scene.spec).map_err(|error| error.to_string())?;
        Ok(scene)
    }
}

/// What was found out about one effect, before it is written down.
struct Finding {
    state: State,
    value: Option<f64>,
    reason: String,
    trial: Option<(Cost, Change)>,
}

impl Finding {
    /// The ledger's line.
    fn entry(self, effect: &'static str, criterion: &'static str) -> Entry {
        let cost = self.trial.as_ref().and_then(|(cost, _)| cost.measured);
        Entry {
            effect,
            state: self.state,
            active: self.state == State::On,
            criterion,
            value: self.value.filter(|value| value.is_finite()),
            reason: self.reason,
            cost_ns_per_step: cost.map(|bill| bill.per_step),
            cost_u_ns_per_step: cost.map(|bill| bill.u),
            cost_share: cost.map(|bill| bill.share),
            change: self.trial.map(|(_, change)| change),
        }
    }
}

/// Makes the ledger of `scene`, with all runs held to `accuracy` (1); `progress` hears the share of the work done.
///
/// # Errors
/// [`RunError`] where the scene itself cannot be run.
pub fn ledger(
    scene: &Scene,
    accuracy: f64,
    progress: &mut dyn FnMut(f64),
) -> Result<Ledger, RunError> {
    type Make = fn(&Subject<'_>) -> Entry;
    const ENTRIES: [Make; 21] = [
        chain::striker_speed_spread,
        chain::gravity,
        chain::magnet_preload,
        chain::magnet_law,
        chain::dashpot,
        chain::kuwabara_kono,
        chain::power_law_loss,
        chain::linearised_contacts,
        chain::plasticity,
        chain::host_mass,
        numerics::kink_correction,
        numerics::force_form,
        numerics::quiet_part,
        electronics::sensor_offset,
        electronics::sensor_droop,
        electronics::sensor_tolerance,
        electronics::bandwidth,
        electronics::scope_offset,
        electronics::scope_errors,
        electronics::scope_noise,
        electronics::quantisation,
    ];
    let settled = auto_effects::settle(scene, Integration::Accuracy(accuracy));
    let subject = Subject::new(&settled, accuracy)?;
    let mut entries = Vec::with_capacity(ENTRIES.len());
    for (done, make) in ENTRIES.into_iter().enumerate() {
        #[allow(clippy::cast_precision_loss, reason = "a few dozen")]
        progress(done as f64 / ENTRIES.len() as f64);
        entries.push(make(&subject));
    }
    for entry in &mut entries {
        state_decision(scene, accuracy, entry);
    }
    Ok(Ledger { scene: scene.name.clone(), accuracy, entries })
}

/// Writes the decision on an effect with `state = "auto"` into its line of the ledger.
fn state_decision(scene: &Scene, accuracy: f64, entry: &mut Entry) {
    if scene.auto.contains(&entry.effect) {
        entry.state = State::Auto;
        let decided = auto_effects::decision(scene, entry.effect, accuracy);
        // A reason why nothing could be measured stays.
        entry.reason = match entry.change {
            Some(_) => decided,
            None => format!("{decided}; {}", entry.reason),
        };
    }
}
