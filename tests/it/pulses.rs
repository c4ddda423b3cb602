//! Forces are looked at within those steps only in which they may peak or reach a new level: nobody can tell.

use hertzscope::chain::ForceProbe;
use hertzscope::experiment::bench::{Bench, Grid, Watch};
use hertzscope::integrate::Method;
use hertzscope::scene::Scene;

use super::splittings::METHODS;

/// Times nobody reaches.
const NEVER: Grid = Grid { start: 1e9, interval: 1.0 };
/// Shares of the first peak at which arrivals are compared (1).
const LEVELS: [f64; 4] = [0.03, 0.1, 0.5, 0.95];

/// First peaks (N, s) and first times of levels (s) at `probes`, to the last bit; none for steps that are too long.
fn readings(
    scene: &Scene,
    method: Method,
    probes: &[ForceProbe],
    grid: Grid,
) -> Option<Vec<Vec<u64>>> {
    let (chain, velocities) = (&scene.chain, &scene.initial_velocities);
    let mut bench = Bench::new(chain, velocities, method, probes, (grid, NEVER));
    bench.run_until(scene.duration, true, &mut |_| ()).ok()?;
    let bits = |watch: &Watch| {
        let pulse = &watch.pulse;
        let peak = pulse.first_peak().map(|peak| [peak.dynamic_n, peak.time_s]);
        let highest = peak.map_or(0.0, |[force, _]| force);
        let times = LEVELS.map(|level| pulse.first_reach(level * highest).unwrap_or(-1.0));
        let all = peak.unwrap_or_default().into_iter().chain(times);
        all.map(f64::to_bits).collect()
    };
    Some(bench.watches().iter().map(bits).collect())
}

/// In every particle, by steps from the edge of stability down.
#[test]
fn a_force_reads_the_same_wherever_its_steps_were_looked_into() {
    let mut compared = 0;
    for name in ["magnet-0.61g", "gravity-17.81g", "monatomic-vacuum"] {
        let scene = Scene::load(name).expect("a shipped scene");
        let inside = |particle| ForceProbe::inside(&scene.chain, particle, 0.0);
        let probes: Vec<ForceProbe> = (1..scene.chain.bodies().len()).filter_map(inside).collect();
        let pairs = [
            Method::DormandElMikkawyPrince64 { tolerance: 1e-1 },
            Method::DormandElMikkawyPrince64 { tolerance: 1e-3 },
            Method::DormandElMikkawyPrince86 { tolerance: 1e-5 },
        ];
        let steps = METHODS.into_iter().flat_map(|make| {
            let (_, reach) = make(1.0).fixed_step().expect("a method with a fixed step");
            let limit = scene.chain.stability_limit(&scene.initial_velocities, reach);
            let limit = limit.expect("contacts").step;
            [0.9, 0.2].map(|share| make(share * limit))
        });
        for method in pairs.into_iter().chain(steps) {
            // Nearly every step holds a sample, and is looked into for its sake.
            let every = Grid { start: 0.0, interval: 0.5e-6 };
            let everywhere = readings(&scene, method, &probes, every);
            let where_needed = readings(&scene, method, &probes, NEVER);
            assert_eq!(everywhere.is_some(), where_needed.is_some(), "{name}, {method}");
            let pairs = everywhere.iter().flatten().zip(where_needed.iter().flatten());
            for (index, (a, b)) in pairs.enumerate() {
                assert_eq!(a, b, "{name}, particle {}, {method}", index + 1);
                compared += 1;
            }
        }
    }
    println!("{compared} forces");
    assert!(compared > 900, "{compared}");
}
