//! hertzscope on a scene: the stepper alone, with peaks followed, and with the forces recorded as the scope would.

use hertzscope::chain::stepper::{ChainGroup, ChainStepper, InstructionSet, Member, Refinement};
use hertzscope::experiment::accuracy::run_held;
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::experiment::{self, Integration, Tried, methods_tried};
use hertzscope::integrate::{IntegrateError, Integrator, Method};
use hertzscope::scene::Scene;

use super::scenes::Case;

/// What is done besides the integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Watching {
    /// Nothing.
    Bare,
    /// First peaks and arrivals.
    Peaks,
    /// Samples every microsecond, as the scope at 250 us/div takes them.
    #[allow(dead_code, reason = "one of the benches that share this")]
    Sampled,
    /// Both.
    Recorded,
}

/// Times nobody reaches.
const NEVER: Grid = Grid { start: 1e9, interval: 1.0 };
/// The scope's sample interval at 250 us/div (s).
const SAMPLE: f64 = 1e-6;

/// Runs `case` and returns its first peaks, none where nothing is watched or felt (N).
pub fn run(
    case: &Case,
    method: Method,
    watching: Watching,
) -> Result<Vec<Option<f64>>, IntegrateError> {
    if watching == Watching::Bare {
        bare(case, method, InstructionSet::best())?;
        return Ok(Vec::new());
    }
    let grid =
        if watching == Watching::Peaks { NEVER } else { Grid { start: 0.0, interval: SAMPLE } };
    let mut bench =
        Bench::new(&case.chain, &case.velocities, method, &case.probes(), (grid, NEVER));
    bench.run_until(case.duration, watching != Watching::Sampled, &mut |_| ())?;
    let first = |peak: hertzscope::experiment::pulse::Peak| peak.dynamic_n;
    Ok(bench.watches().iter().map(|watch| watch.pulse.first_peak().map(first)).collect())
}

/// Runs the stepper alone with the instructions of `set`; returns the evaluations of all contact forces.
pub fn bare(case: &Case, method: Method, set: InstructionSet) -> Result<u64, IntegrateError> {
    to_end(stepper(case, method, set), case)
}

/// The same with the quiet part ahead of the wave computed like the rest.
#[allow(dead_code, reason = "one of the benches that share this")]
pub fn awake(case: &Case, method: Method, set: InstructionSet) -> Result<u64, IntegrateError> {
    to_end(stepper(case, method, set).without(Refinement::QuietPart, &case.chain), case)
}

/// Eight of them in the lanes of a group, the same to the end.
#[allow(dead_code, reason = "one of the benches that share this")]
pub fn eight(case: &Case, method: Method, set: InstructionSet) -> Result<u64, IntegrateError> {
    let Case { chain, velocities, duration, .. } = case;
    let members = [Member { chain, velocities, duration: *duration }; ChainGroup::LANES];
    let scheme = method.scheme().expect("a method for forces that depend on positions alone");
    let mut group = ChainGroup::new(&members, scheme, set);
    group.advance();
    (0..members.len()).map(|lane| group.outcome(lane).map(|work| work.force_evaluations)).sum()
}

fn stepper(case: &Case, method: Method, set: InstructionSet) -> ChainStepper {
    let scheme = method.scheme().expect("a method for forces that depend on positions alone");
    ChainStepper::new(&case.chain, &case.velocities, scheme, set)
}

fn to_end(mut stepper: ChainStepper, case: &Case) -> Result<u64, IntegrateError> {
    stepper.advance(case.duration)?;
    Ok(stepper.work().force_evaluations)
}

/// A method by the short name that tables use, with its tolerance, or its step in units of the scene's own.
pub fn method(name: &str, setting: f64, case: &Case) -> Option<Method> {
    let (tolerance, step) = (setting, setting * case.unit());
    Some(match name {
        "paced-force-gradient" => Method::PacedForceGradient { tolerance },
        "rkn64" => Method::DormandElMikkawyPrince64 { tolerance },
        "rkn86" => Method::DormandElMikkawyPrince86 { tolerance },
        "dop853" => Method::DormandPrince853 { tolerance },
        "velocity-verlet" => Method::VelocityVerlet { step },
        "pefrl" => Method::Pefrl { step },
        "blanes-moan" => Method::BlanesMoan { step },
        "force-gradient" => Method::ForceGradient { step },
        "inner-force-gradient" => Method::InnerForceGradient { step },
        _ => return None,
    })
}

/// What `--accuracy` comes to with this scene.
pub fn held(scene: &Scene, accuracy: f64) -> Tried {
    let held = run_held(scene, accuracy, 1, &mut |_| ()).expect("a run").summary;
    let same = |tried: &Tried| {
        let by = Integration::Tried { method: tried.method, accuracy };
        let run = experiment::run(scene, by, 1, &mut |_| ());
        run.is_ok_and(|run| run.summary.force_evaluations == held.force_evaluations)
    };
    methods_tried(scene, accuracy).find(same).expect("one of them")
}
