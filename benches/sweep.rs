//! What a sweep costs: for each scene, and how that grows with particles, time simulated, accuracy
//! and number of scenes, as exponents of power laws fitted by least squares; from these, what a
//! million scenes take. CPU time of one thread, medians of interleaved rounds; exponents and shares
//! count, times move with the machine: `cargo bench --bench sweep`.
#![allow(clippy::disallowed_macros, reason = "measurements are printed")]
#![allow(clippy::expect_used, reason = "a bench that cannot run has nothing to say")]

mod common;

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use common::clock::{cpu_time, median};
use hertzscope::motion::kernel::InstructionSet;
use hertzscope::sweep::gather::GatheredLogs;
use hertzscope::sweep::log::SweepLog;
use hertzscope::sweep::plan::SweepPlan;
use hertzscope::sweep::work::{SweepOptions, work};

const ROUNDS: usize = 5;
/// Scenes of a sweep where their number is not what is looked at.
const SCENES: u64 = 512;
/// What is measured against, as in `what`.
const PARTICLES: [u64; 5] = [10, 20, 38, 74, 146];
const MILLISECONDS: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];
const ACCURACIES: [f64; 5] = [1e-2, 1e-4, 1e-6, 1e-8, 1e-10];
const COUNTS: [u64; 5] = [64, 256, 1024, 4096, 16384];

fn main() {
    parts();
    println!(
        "\nOne run of it is the scene `magnet-0.61g`: 38 particles, 2 ms, to 1e-3, four places watched. Changing one of these:\n"
    );
    println!("| what | from | to | CPU time of a run | exponent |\n|---|---|---|---|---|");
    let particles = PARTICLES.map(|n| (n as f64, grid(n, 2.0, 1e-3, SCENES)));
    series("particles", &particles);
    series("ms simulated", &MILLISECONDS.map(|ms| (ms, grid(38, ms, 1e-3, SCENES))));
    series("1 / accuracy", &ACCURACIES.map(|a| (1.0 / a, grid(38, 2.0, a, SCENES / 4))));
    let counts = COUNTS.map(|n| (n as f64, grid(38, 2.0, 1e-3, n)));
    let each = series("scenes", &counts);
    extrapolate(each);
}

/// A sweep of `scenes` strikers' speeds; the sensors of short chains sit closer together.
fn grid(particles: u64, milliseconds: f64, accuracy: f64, scenes: u64) -> String {
    let mut text = format!("scene = \"magnet-0.61g\"\naccuracy = {accuracy:e}\n");
    let _ = writeln!(text, "[grid]\nchain.segments.2.repeat = {}", (particles - 2) / 2);
    let _ = writeln!(text, "duration = \"{milliseconds} ms\"");
    if particles < 38 {
        text.push_str("sensors.p14.particle = 4\nsensors.p27.particle = 7\n");
    }
    let _ = writeln!(text, "[latin_hypercube]\ncount = {scenes}\n[latin_hypercube.over]");
    text.push_str("striker.speed = { from = \"0.3 m/s\", to = \"0.6 m/s\" }\n");
    text.push_str("materials.ptfe.youngs_modulus = { from = \"1.4 GPa\", to = \"1.5 GPa\" }\n");
    text
}

/// What a sweep took: CPU time of planning and running it, wall time of running it (s), and what is
/// left of it.
struct Cost {
    cpu: f64,
    wall: f64,
    log: u64,
}

fn sweep(folder: &Path, text: &str, threads: usize) -> Cost {
    let file = folder.join("grid.toml");
    std::fs::write(&file, text).expect("a sweep's file");
    let started = cpu_time();
    let plan = SweepPlan::load(&file, None).expect("a plan");
    let best = InstructionSet::best();
    let path = folder.join("shard-1-of-1.log");
    let (mut log, ..) = SweepLog::open(&path, &plan, (None, best.name())).expect("a log");
    let job = SweepOptions { file, accuracy: None, instructions: best, threads };
    let pending: Vec<u64> = (0..plan.count()).collect();
    let wall = Instant::now();
    let tally = work(&job, &plan, &pending, &mut log, &|_| ()).expect("a sweep");
    assert_eq!((tally.done, tally.failed), (plan.count(), 0), "{:?}", tally.first_failed);
    let log = std::fs::metadata(&path).expect("a log").len();
    Cost { cpu: cpu_time() - started, wall: wall.elapsed().as_secs_f64(), log }
}

fn cost(text: &str, threads: usize) -> Cost {
    let folder = tempfile::tempdir().expect("a folder");
    sweep(folder.path(), text, threads)
}

/// Runs in `text`.
fn count(text: &str) -> f64 {
    let line = text.lines().find_map(|line| line.strip_prefix("count = "));
    line.expect("a count").parse().expect("a number")
}

/// Where the time of a run goes.
fn parts() {
    let whole = grid(38, 2.0, 1e-3, SCENES);
    let blind = format!("watch = []\n{whole}");
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("grid.toml");
    std::fs::write(&file, &whole).expect("a sweep's file");
    let plan = SweepPlan::load(&file, None).expect("a plan");
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        let started = cpu_time();
        (0..SCENES).for_each(|run| drop(plan.scene(run).expect("a scene")));
        times[0].push(cpu_time() - started);
        times[1].push(cost(&blind, 1).cpu);
        times[2].push(cost(&whole, 1).cpu);
    }
    let [scene, blind, whole] = times.map(|mut times| 1e6 * median(&mut times) / SCENES as f64);
    println!("| of a run | us | share |\n|---|---|---|");
    let row = |what: &str, time: f64| {
        println!("| {what} | {time:.0} | {:.0} % |", 100.0 * time / whole);
    };
    row("its scene: values put in, checked, statics solved", scene);
    row("steps of its chain, in lanes, and its line of the log", blind - scene);
    row("forces at four places followed, peaks and arrivals found", whole - blind);
    row("all", whole);
}

/// Measures each of `sweeps`, prints a line, and returns the time of a run of the last (s).
fn series(what: &str, sweeps: &[(f64, String)]) -> f64 {
    let mut times = vec![Vec::new(); sweeps.len()];
    for _ in 0..ROUNDS {
        for ((_, text), times) in sweeps.iter().zip(&mut times) {
            times.push(cost(text, 1).cpu);
        }
    }
    let of_sweep = what == "scenes";
    let times: Vec<f64> = times.iter_mut().map(|times| median(times)).collect();
    let each: Vec<f64> = times.iter().zip(sweeps).map(|(t, (_, text))| t / count(text)).collect();
    let fitted = if of_sweep { &times } else { &each };
    let points: Vec<(f64, f64)> =
        sweeps.iter().zip(fitted).map(|((x, _), y)| (x.ln(), y.ln())).collect();
    let (exponent, error) = slope(&points);
    let shown = |time: &f64| format!("{:.0}", 1e6 * time);
    let list = each.iter().map(shown).collect::<Vec<_>>().join(", ");
    let ends = [sweeps.first(), sweeps.last()].map(|end| end.map_or(f64::NAN, |(x, _)| *x));
    println!("| {what} | {} | {} | {list} us | {exponent:.2} ± {error:.2} |", ends[0], ends[1]);
    each.last().copied().unwrap_or(f64::NAN)
}

/// Slope of the straight line through `points` and its standard error.
fn slope(points: &[(f64, f64)]) -> (f64, f64) {
    let n = points.len() as f64;
    let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
    let spread = n * mean(&|p| (p.0 - x).powi(2));
    let slope = n * mean(&|p| (p.0 - x) * (p.1 - y)) / spread;
    let rest = n * mean(&|p| (p.1 - y - slope * (p.0 - x)).powi(2));
    (slope, (rest / (n - 2.0) / spread).sqrt())
}

/// What a million scenes take, from a run of the largest sweep measured (s).
fn extrapolate(each: f64) {
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let last = COUNTS[COUNTS.len() - 1];
    let largest = grid(38, 2.0, 1e-3, last);
    let mut gains = Vec::new();
    for _ in 0..ROUNDS {
        gains.push(cost(&largest, 1).wall / cost(&largest, threads).wall);
    }
    let gain = median(&mut gains);
    let folder = tempfile::tempdir().expect("a folder");
    let bytes = sweep(folder.path(), &largest, 1).log as f64 / last as f64;
    let mut joins = Vec::new();
    for _ in 0..ROUNDS {
        let started = cpu_time();
        let gathered = GatheredLogs::read(folder.path()).expect("a log");
        gathered.write(&[folder.path().join("grid.csv")], &mut |_| ()).expect("a table");
        joins.push((cpu_time() - started) / last as f64);
    }
    let join = median(&mut joins);
    println!(
        "\n| scenes | CPU time | on {threads} processors, at {gain:.2} times one | log | table joined in |"
    );
    println!("|---|---|---|---|---|");
    for scenes in [1e5, 1e6] {
        println!(
            "| {scenes:.0} | {:.0} s | {:.0} s | {:.0} MB | {:.0} s |",
            scenes * each,
            scenes * each / gain,
            1e-6 * scenes * bytes,
            scenes * join
        );
    }
}
