//! What accuracy costs in time: the coarsest setting that meets a tolerance, as all finer ones do, and how long it takes; beside a
//! velocity Verlet in plain loops, and how much faster than the bench itself that is; and what `--accuracy` chooses, beside the best. `cargo bench --bench accuracy`; other people's solvers are in
//! `benches/peers`.
#![allow(clippy::expect_used, reason = "a bench that cannot run has nothing to say")]

mod common;

use common::clock::{median, time};
use common::ours::{self, Watching};
use common::scenes::{Case, shipped};
use hertzscope::chain::ChainSystem;
use hertzscope::chain::stepper::InstructionSet;
use hertzscope::experiment::Tried;
use hertzscope::integrate::{Method, State};
use hertzscope::scene::Scene;
use hertzscope::studies::cost::{Chosen, TIMED_RUNS, study};

const ROUNDS: usize = 9;
/// CPU time of one measurement (s).
const SLICE: f64 = 0.02;
const TOLERANCES: [f64; 3] = [1e-3, 1e-6, 1e-9];
const SCENES: [&str; 4] = ["P37", "G37", "P600", "bench"];
/// Tolerance of the reference's steps (1).
const REFERENCE: f64 = 1e-15;
/// Evaluations of a method with fixed steps beyond which nobody waits.
const MOST_EVALUATIONS: f64 = 1e6;

/// From rung to rung of a ladder of fixed steps, in powers of two: as fine in time as the pairs' half decades are (1).
const RUNG: f64 = 0.25;

type Make = fn(f64) -> Method;

/// The methods with fixed steps, by their step (s).
const FIXED: [Make; 5] = [
    |step| Method::VelocityVerlet { step },
    |step| Method::Pefrl { step },
    |step| Method::BlanesMoan { step },
    |step| Method::ForceGradient { step },
    |step| Method::InnerForceGradient { step },
];

fn main() {
    println!(
        "| scene | tolerance | method | setting | error | us | simulated / CPU time | peaks followed | recorded | velocity Verlet |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    for name in SCENES {
        let case = Case::named(name).expect("a scene");
        let exact = peaks(&case, Method::DormandPrince853 { tolerance: REFERENCE });
        let error = |method: Method| error(&peaks(&case, method), &exact);
        let controlled = |name: &'static str| -> Ladder {
            let settings = (2..=26).map(|k| 10f64.powf(-0.5 * f64::from(k)));
            let methods = settings.filter_map(|setting| ours::method(name, setting, &case));
            methods.map(|method| (method, error(method))).collect()
        };
        let mut ladders = ["rkn64", "rkn86", "paced-force-gradient"].map(controlled).to_vec();
        for make in FIXED {
            ladders.push(fixed_ladder(&case, make, &error));
        }
        let verlet = fixed_ladder(&case, FIXED[0], &error);
        for tolerance in TOLERANCES {
            row(&case, tolerance, &ladders, &verlet);
        }
    }
    println!("\nThe last three columns: time over that of the integration alone.\n");
    table_scenes();
    choices();
}

/// The eight scenes of the paper's tables as `--accuracy 1e-3` follows them for 2 ms, nothing recorded.
fn table_scenes() {
    println!(
        "| 2 ms at `--accuracy 1e-3` | method | force evaluations | us | simulated / CPU time |\n|---|---|---|---|---|"
    );
    for preload in ["magnet", "gravity"] {
        for striker in ["0.61g", "1.22g", "2.75g", "17.81g"] {
            let name = format!("{preload}-{striker}");
            let scene = shipped(&name);
            let Tried { method, .. } = ours::held(&scene, 1e-3);
            let case = Case::of("table", scene, 2e-3);
            let run = || ours::bare(&case, method, InstructionSet::best()).expect("a run");
            let evaluations = run();
            let mut times: Vec<f64> = (0..ROUNDS).map(|_| time(SLICE, || _ = run())).collect();
            let seconds = median(&mut times);
            let ratio = case.duration / seconds;
            println!("| {name} | {method} | {evaluations} | {:.1} | {ratio:.0} |", 1e6 * seconds);
        }
    }
}

/// What `--accuracy` chooses from 1e-3 to 1e-9, beside the best point of `hertzscope cost`: the quickest of the coarsest ones of each method that are
/// as accurate as asked, as all finer ones are. Of each the shortest of ten runs.
fn choices() {
    println!(
        "\n| `hertzscope cost`, 1e-3 to 1e-9 | error of what `--accuracy` chooses over the one asked for, at most | its time over the best point's, median | at most |\n|---|---|---|---|"
    );
    for name in Scene::names() {
        let scene = shipped(name);
        let study = study(&scene, TIMED_RUNS, &mut |_| ()).expect("a study");
        let asked = |chosen: &&Chosen| (0.9e-9..1.1e-3).contains(&chosen.accuracy);
        let (mut errors, mut times) = (Vec::new(), Vec::new());
        for chosen in study.chosen.iter().filter(asked) {
            errors.push(chosen.error.unwrap_or(f64::INFINITY) / chosen.accuracy);
            let points = study.accurate(chosen.accuracy);
            let best = points.map(|point| point.wall_s_min).fold(f64::INFINITY, f64::min);
            times.push(chosen.wall_s_min / best);
        }
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        println!(
            "| {name} | {:.2} | {:.2} | {:.2} |",
            most(&errors),
            median(&mut times),
            most(&times)
        );
    }
}

type Ladder = Vec<(Method, f64)>;

/// Steps of `make` from the edge of stability down, with their errors.
fn fixed_ladder(case: &Case, make: Make, error: &dyn Fn(Method) -> f64) -> Ladder {
    let (_, reach) = make(1.0).fixed_step().expect("a method with a fixed step");
    let limit = case.chain.stability_limit(&case.velocities, reach).expect("contacts");
    let stages = f64::from(make(1.0).stages());
    let mut step = limit.step;
    let mut ladder = Vec::new();
    while case.duration / step * stages < MOST_EVALUATIONS {
        let found = error(make(step));
        ladder.push((make(step), found));
        if found < 1e-10 {
            break;
        }
        step *= 0.5_f64.powf(RUNG);
    }
    ladder
}

fn row(case: &Case, tolerance: f64, ladders: &[Ladder], verlet: &Ladder) {
    let found: Vec<(Method, f64)> = ladders.iter().filter_map(|l| coarsest(l, tolerance)).collect();
    let run = |method: Method, watching: Watching| {
        time(SLICE, || drop(std::hint::black_box(ours::run(case, method, watching))))
    };
    let quick = |(method, _): &(Method, f64)| run(*method, Watching::Bare);
    let best = found.iter().min_by(|a, b| quick(a).total_cmp(&quick(b)));
    let Some((method, error)) = best else {
        println!("| {} | {tolerance:.0e} | none | | | | | | | |", case.name);
        return;
    };
    let plain = coarsest(verlet, tolerance);
    let (mut bare, mut others) = (Vec::new(), [Vec::new(), Vec::new(), Vec::new()]);
    for _ in 0..ROUNDS {
        let alone = run(*method, Watching::Bare);
        bare.push(alone);
        others[0].push(run(*method, Watching::Peaks) / alone);
        others[1].push(run(*method, Watching::Recorded) / alone);
        if let Some((plain, _)) = plain {
            others[2].push(time(SLICE, || fixed(case, plain)) / alone);
        }
    }
    let seconds = median(&mut bare);
    let [peaks, recorded, plain] = others.map(|mut o| median(&mut o));
    let setting = match method.fixed_step() {
        Some((step, _)) => format!("{:.2} us", 1e6 * step),
        None => format!("{:.1e}", method.tolerance().unwrap_or(f64::NAN)),
    };
    let plain = if plain.is_nan() { "out of reach".to_owned() } else { format!("{plain:.1}") };
    println!(
        "| {} | {tolerance:.0e} | {} | {setting} | {error:.1e} | {:.1} | {:.1} | {peaks:.2} | {recorded:.2} | {plain} |",
        case.name,
        method.name(),
        1e6 * seconds,
        case.duration / seconds,
    );
}

/// Velocity Verlet in the plain loops of `integrate`, nothing watched.
fn fixed(case: &Case, method: Method) {
    let bodies = case.velocities.len();
    let state = State { time: 0.0, position: vec![0.0; bodies], velocity: case.velocities.clone() };
    let system = ChainSystem::new(&case.chain, &case.velocities);
    let mut integrator = method.start(Box::new(system), state);
    while integrator.time() < case.duration {
        integrator.step(case.duration).expect("a stable step");
    }
}

fn peaks(case: &Case, method: Method) -> Vec<Option<f64>> {
    ours::run(case, method, Watching::Peaks).unwrap_or_default()
}

/// Relative error of the worst first peak; infinite where one is missing.
fn error(found: &[Option<f64>], exact: &[Option<f64>]) -> f64 {
    if found.len() != exact.len() {
        return f64::INFINITY;
    }
    let off = found.iter().zip(exact).map(|(found, exact)| match (found, exact) {
        (Some(found), Some(exact)) => (found / exact - 1.0).abs(),
        _ => f64::INFINITY,
    });
    off.fold(0.0, f64::max)
}

/// The coarsest rung that meets `tolerance` as all finer ones do.
fn coarsest(ladder: &Ladder, tolerance: f64) -> Option<(Method, f64)> {
    ladder.iter().rev().take_while(|(_, error)| *error <= tolerance).last().copied()
}
