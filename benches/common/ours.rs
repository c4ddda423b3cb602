//! hertzscope on a scene: the integration alone, with peaks followed, and with the forces recorded
//! as the scope would.

use hertzscope::experiment;
use hertzscope::experiment::bench::{Bench, Grid};
use hertzscope::motion::{IntegrateError, Method};

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
        bare(case, method)?;
        return Ok(Vec::new());
    }
    let grid =
        if watching == Watching::Peaks { NEVER } else { Grid { start: 0.0, interval: SAMPLE } };
    let mut bench = Bench::new(&case.chain, &case.velocities, method, &case.probes(), grid, NEVER);
    bench.run_until(case.duration, watching != Watching::Sampled, &mut |_| ())?;
    let first = |peak: hertzscope::experiment::pulse::Peak| peak.dynamic_n;
    Ok(bench.watches().iter().map(|watch| watch.pulse.first_peak().map(first)).collect())
}

/// Integrates alone: nothing is watched.
fn bare(case: &Case, method: Method) -> Result<(), IntegrateError> {
    let state = case.chain.initial_state(&case.velocities);
    experiment::bench::start(&case.chain, method, state).advance(case.duration)
}

/// A method by the short name that tables use, with its tolerance, or its step in units of the
/// scene's own.
pub fn method(name: &str, setting: f64, case: &Case) -> Option<Method> {
    let (tolerance, step) = (setting, setting * case.unit());
    Some(match name {
        "two-step-force-gradient" => Method::TwoStepForceGradient { tolerance },
        "rkn86" => Method::DormandElMikkawyPrince86 { tolerance },
        "dop853" => Method::DormandPrince853 { tolerance },
        "velocity-verlet" => Method::VelocityVerlet { step },
        "force-gradient" => Method::ForceGradient { step },
        _ => return None,
    })
}
