//! What a contact costs: the stepper's time for each contact and force evaluation, all its arithmetic in, over that of a bare stream
//! of vector square roots in the same round; and what a whole process costs beside an empty one. Ratios count, times move with the
//! machine: `cargo bench --bench kernel`.
#![allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
#![allow(clippy::expect_used, reason = "a bench that cannot run has nothing to say")]

mod common;

use std::process::{Command, Stdio};
use std::time::Instant;

use common::clock::{median, time};
use common::ours::{self, Watching};
use common::scenes::{self, Case, shipped};
use hertzscope::chain::stepper::InstructionSet;
use hertzscope::experiment::ensemble::{self, Ensemble};
use hertzscope::experiment::{Integration, for_accuracy};
use hertzscope::integrate::{IntegrateError, Method};
use hertzscope::scene::Scene;
use nix::sys::resource::{UsageWho, getrusage};
use nix::sys::time::TimeValLike;

const ROUNDS: usize = 9;
/// CPU time of one measurement (s).
const SLICE: f64 = 0.05;
/// Runs of each whole process.
const PROCESSES: u16 = 200;
/// Arguments of this program as one of the processes that are compared: nothing, or a scene and its motion, with the scene's name and what
/// steps are held to behind it.
const EMPTY: &str = "--empty-process";
const BARE: &str = "--bare-process";
/// Doubles in the stream: they stay in the first-level cache.
const STREAM: usize = 1024;

fn main() {
    let asked = |what: &str| std::env::args().any(|argument| argument == what);
    if asked(EMPTY) {
        return;
    }
    if asked(BARE) {
        let (name, steps) = (std::env::args().nth(2), std::env::args().nth(3));
        let case = name.and_then(|name| Case::named(&name)).expect("a scene");
        let steps = steps.and_then(|steps| steps.parse().ok());
        let method = for_accuracy(steps.expect("what steps are held to"));
        ours::run(&case, method, Watching::Recorded).expect("a run");
        return;
    }
    kernels();
    quiet_part();
    ensembles();
    processes();
}

/// What is run.
type Run = fn(&Case, Method, InstructionSet) -> Result<u64, IntegrateError>;

/// What it is, the scene's name, the method with its tolerance or its step in the scene's unit, and how it is run.
type Kernel = (&'static str, &'static str, &'static str, f64, Run);

/// With all that error control takes, contacts ahead of the wave left alone.
const CONTROLLED: [Kernel; 6] = [
    ("37 particles, preloaded (P37)", "P37", "rkn86", 1e-6, ours::bare),
    ("37 particles, gravity only (G37)", "G37", "rkn64", 1e-6, ours::bare),
    ("38 particles, the real bench", "bench", "rkn86", 1e-6, ours::bare),
    ("600 particles (P600)", "P600", "rkn86", 1e-6, ours::bare),
    ("600 particles (P600)", "P600", "rkn64", 1e-3, ours::bare),
    ("10,000 particles", "P10000", "rkn86", 1e-6, ours::bare),
];

/// In fixed steps, no contact left alone.
const FIXED: [Kernel; 13] = [
    ("37 particles, preloaded (P37)", "P37", "velocity-verlet", 0.1, ours::awake),
    ("37 particles, preloaded (P37)", "P37", "blanes-moan", 0.5, ours::awake),
    ("37 particles, preloaded (P37)", "P37", "force-gradient", 0.5, ours::awake),
    ("600 particles (P600)", "P600", "velocity-verlet", 0.1, ours::awake),
    ("600 particles (P600)", "P600", "blanes-moan", 0.5, ours::awake),
    ("the same, own A", "P600 own", "blanes-moan", 0.5, ours::awake),
    ("10,000 particles", "P10000", "blanes-moan", 0.5, ours::awake),
    ("the same, own A", "P10000 own", "blanes-moan", 0.5, ours::awake),
    ("eight P37 side by side", "P37", "velocity-verlet", 0.1, ours::eight),
    ("eight P37 side by side", "P37", "blanes-moan", 0.5, ours::eight),
    ("the same, own A", "P37 own", "blanes-moan", 0.5, ours::eight),
    ("eight P37 side by side", "P37", "force-gradient", 0.5, ours::eight),
    ("the real bench, eight side by side", "bench", "blanes-moan", 0.5, ours::eight),
];

fn kernels() {
    let values: Vec<f64> = (1..=STREAM).map(|i| i as f64).collect();
    let mut roots = vec![0.0; STREAM];
    let mut stream = || time(SLICE, || square_roots::stream(&values, &mut roots)) / STREAM as f64;
    let mut streams: Vec<f64> = (0..ROUNDS).map(|_| stream()).collect();
    let nanoseconds = 1e9 * median(&mut streams);
    println!("A stream of vector square roots takes {nanoseconds:.4} ns a contact.\n");
    table("with error control", &CONTROLLED, &mut stream);
    table("in fixed steps, all of the chain", &FIXED, &mut stream);
    short_chains();
}

/// What a short chain's evaluations are made of: arithmetic, waiting for each other's results, and the control of steps.
const SHORT: [Kernel; 5] = [
    ("its arithmetic: one of eight side by side", "P37", "blanes-moan", 0.5, ours::eight),
    ("its waiting: a chain of one row", "P7", "blanes-moan", 0.5, ours::awake),
    ("both, in fixed steps", "P37", "blanes-moan", 0.5, ours::awake),
    ("both, with error control", "P37", "rkn64", 1e-4, ours::awake),
    ("both, with error control", "P37", "rkn86", 1e-6, ours::awake),
];

fn short_chains() {
    println!("| an evaluation of 37 particles (P37) | method | ns |\n|---|---|---|");
    let best = InstructionSet::best();
    for (words, scene, name, setting, run) in SHORT {
        let case = Case::named(scene).expect("a scene");
        let method = ours::method(name, setting, &case).expect("a method");
        let cost = || {
            let mut evaluations = 0;
            let seconds = time(SLICE, || evaluations = run(&case, method, best).expect("a run"));
            1e9 * seconds / evaluations as f64
        };
        let mut costs: Vec<f64> = (0..ROUNDS).map(|_| cost()).collect();
        println!("| {words} | {name} | {:.1} |", median(&mut costs));
    }
    println!();
}

/// Times of contacts over the stream's, in the same round.
fn table(what: &str, kernels: &[Kernel], stream: &mut dyn FnMut() -> f64) {
    let sets = InstructionSet::available();
    print!("| time of a contact over the stream's, {what} | method |");
    for set in &sets {
        print!(" {} |", set.name());
    }
    println!("\n|---|---|{}", "---|".repeat(sets.len()));
    for (words, scene, name, setting, run) in kernels {
        let case = Case::named(scene).expect("a scene");
        let method = ours::method(name, *setting, &case).expect("a method");
        print!("| {words} | {name} |");
        for set in &sets {
            let mut costs = Vec::new();
            for _ in 0..ROUNDS {
                let stream = stream();
                let mut evaluations = 0;
                let seconds = time(SLICE, || {
                    evaluations = run(&case, method, *set).expect("a run");
                });
                costs.push(seconds / (evaluations as f64 * case.contacts() as f64) / stream);
            }
            print!(" {:.2} |", median(&mut costs));
        }
        println!();
    }
    println!();
}

/// What it saves to leave alone the contacts ahead of the wave.
fn quiet_part() {
    let best = InstructionSet::best();
    println!("| the quiet part ahead of the wave, left alone | times as fast |\n|---|---|");
    for name in ["P37", "P600", "P10000"] {
        let case = Case::named(name).expect("a scene");
        let method = ours::method("rkn86", 1e-6, &case).expect("a pair");
        let run = |whole: bool| {
            time(SLICE, || {
                let run = if whole { ours::awake } else { ours::bare };
                run(&case, method, best).expect("a run");
            })
        };
        let mut gains: Vec<f64> = (0..ROUNDS).map(|_| run(true) / run(false)).collect();
        println!("| {name}, {} ms | {:.2} |", 1e3 * case.duration, median(&mut gains));
    }
    println!();
}

/// Chains in an ensemble; eight share the lanes of a group. So many that starting threads costs nothing beside them.
const ENSEMBLE: u32 = 2048;
/// Rounds of one thread against two: the second processor has other work, now and then.
const THREAD_ROUNDS: usize = 25;
/// Streams of square roots that are shared out to threads.
const STREAMS: u32 = 20_000;

/// An ensemble, by its words.
type Named = (String, Vec<ensemble::Case>, Integration);

/// Throughput of ensembles over that of single chains, first peaks followed in both, and of two threads over one.
fn ensembles() {
    let case = |name| Case::named(name).expect("a scene");
    let held =
        [("P37", 1e-3), ("P37", 1e-6), ("G37", 1e-3), ("G37", 1e-6)].map(|(name, accuracy)| {
            let words = format!("{name} at {accuracy:.0e}");
            (words, members(&case(name)), Integration::Accuracy(accuracy))
        });
    let fixed = [
        ("P37", "force-gradient", 1.0),
        ("P37", "inner-force-gradient", 1.2),
        ("P37", "force-gradient", 0.3),
        ("G37", "velocity-verlet", 0.1),
    ]
    .map(|(name, method, step)| {
        let case = case(name);
        let method = ours::method(method, step, &case).expect("a method");
        let words = format!("{name}, {}, steps of {step} units", method.name());
        (words, members(&case), Integration::Method(method))
    });
    let all: Vec<Named> = held.into_iter().chain(fixed).collect();
    // One thread before there is a second: what several leave with the allocator takes one by itself a few per cent more time.
    let alone: Vec<[f64; 3]> = all.iter().map(over_single).collect();
    println!(
        "| throughput of {ENSEMBLE} chains of their own speeds | over single chains, one thread | were peaks found for nothing | two threads over one, wall time | us a chain |\n|---|---|---|---|---|"
    );
    for (named, [gain, unread, time]) in all.iter().zip(alone) {
        let threads = over(|| together(named, 1), || together(named, 2));
        println!("| {} | {gain:.2} | {unread:.2} | {threads:.2} | {time:.1} |", named.0);
    }
    println!("| a stream of square roots, shared out | | | {:.2} | |\n", second_processor());
}

/// How much sooner two threads are through with square roots than one: what a second processor is worth to arithmetic.
fn second_processor() -> f64 {
    let share = |streams: u32| {
        let values: Vec<f64> = (1..=STREAM).map(|i| i as f64).collect();
        let mut roots = vec![0.0; STREAM];
        (0..streams).for_each(|_| square_roots::stream(&values, &mut roots));
        std::hint::black_box(&roots);
    };
    over(
        || share(STREAMS),
        || {
            std::thread::scope(|scope| {
                scope.spawn(|| share(STREAMS / 2));
                share(STREAMS / 2);
            });
        },
    )
}

/// Wall time of `one` over that of `two`, the median of many rounds.
fn over(one: impl Fn(), two: impl Fn()) -> f64 {
    let wall = |work: &dyn Fn()| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    let mut ratios: Vec<f64> = (0..THREAD_ROUNDS).map(|_| wall(&one) / wall(&two)).collect();
    median(&mut ratios)
}

/// Chains like that of `case`, each of its own speed.
fn members(case: &Case) -> Vec<ensemble::Case> {
    let member = |index| {
        let speed = 1.0 + 0.2 * f64::from(index) / f64::from(ENSEMBLE);
        ensemble::Case {
            chain: case.chain.clone(),
            velocities: case.velocities.iter().map(|v| speed * v).collect(),
            probes: case.probes(),
            duration: case.duration,
        }
    };
    (0..ENSEMBLE).map(member).collect()
}

/// Runs them on so many threads.
fn together((words, cases, integration): &Named, threads: usize) {
    let found = Ensemble::by(*integration).threads(threads).run(cases, &|_| ());
    assert!(found.iter().all(Result::is_ok), "{words}");
}

/// Throughput over that of single chains, on one thread, the same of chains that nobody reads, while first peaks are followed in the single ones, and time of
/// a chain (us).
fn over_single(named: &Named) -> [f64; 3] {
    let (words, cases, integration) = named;
    let unread = |case: &ensemble::Case| ensemble::Case { probes: Vec::new(), ..case.clone() };
    let unread = (words.clone(), cases.iter().map(unread).collect(), *integration);
    let alone = || {
        for case in cases {
            case.run_alone(*integration).expect("a run");
        }
    };
    let mut found: [Vec<f64>; 3] = Default::default();
    for _ in 0..ROUNDS {
        let (single, group) = (time(SLICE, alone), time(SLICE, || together(named, 1)));
        let steps = time(SLICE, || together(&unread, 1));
        let all = [single / group, single / steps, 1e6 * group / f64::from(ENSEMBLE)];
        found.iter_mut().zip(all).for_each(|(found, value)| found.push(value));
    }
    found.each_mut().map(|found| median(found))
}

/// CPU time of whole processes, user and system: the middle one of many.
fn processes() {
    assert!(typed_is_p37(), "p37.toml is not the scene that solvers are compared on");
    let program = env!("CARGO_BIN_EXE_hertzscope");
    let folder = tempfile::tempdir().expect("a folder");
    let output = folder.path().join("run.mcap");
    let this = std::env::current_exe().expect("this program's place");
    let [mut empty, mut p37, mut bench] = [(); 3].map(|()| Command::new(&this));
    empty.arg(EMPTY);
    let steps = |scene: &Scene| ours::held(scene, 1e-6).steps.to_string();
    p37.args([BARE, "P37 typed", &steps(&scenes::p37())]);
    bench.args([BARE, "bench", &steps(&shipped("magnet-0.61g"))]);
    let mut run = Command::new(program);
    run.args(["run", "magnet-0.61g", "--accuracy", "1e-6", "--quiet", "--output"]);
    run.arg(output);
    let mut version = Command::new(program);
    version.arg("--version");
    let mut commands = [empty, p37, bench, version, run];
    let mut spent: [Vec<f64>; 5] = std::array::from_fn(|_| Vec::new());
    for _ in 0..PROCESSES {
        for (command, spent) in commands.iter_mut().zip(&mut spent) {
            spent.push(process_time(command));
        }
    }
    let [least, p37, bench, version, run] = spent.map(|mut spent| median(&mut spent));
    println!("An empty Rust process takes {:.2} ms of CPU time.\n", 1e3 * least);
    println!("| whole process | over an empty Rust process |\n|---|---|");
    for (name, alone) in [("P37 as a file", p37), ("magnet-0.61g", bench)] {
        let what =
            "5 ms as `--accuracy 1e-6` follows it with a sample each us, by the library alone";
        println!("| start, {name}, {what} | {:.2} |", alone / least);
    }
    println!("| `hertzscope --version` | {:.2} |", version / least);
    let what = "`hertzscope run magnet-0.61g --accuracy 1e-6`, written to disk";
    println!("| {what} | {:.2} |\n", run / least);
}

/// Whether the text of P37 comes to the chain that is put together from numbers, to round-off.
fn typed_is_p37() -> bool {
    let [typed, built] = ["P37 typed", "P37"].map(|name| Case::named(name).expect("a scene"));
    let numbers = |case: &Case| -> Vec<f64> {
        let bodies = case.chain.bodies().iter().map(|body| body.mass);
        let contacts = case.chain.contacts().iter().flat_map(|c| [c.stiffness, c.static_force]);
        bodies.chain(contacts).chain(case.velocities.iter().copied()).collect()
    };
    let (typed, built) = (numbers(&typed), numbers(&built));
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * b.abs();
    typed.len() == built.len() && typed.iter().zip(&built).all(near)
}

/// CPU time of one run of `command` (s).
fn process_time(command: &mut Command) -> f64 {
    let before = children_time();
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let status = command.status().expect("the process starts");
    assert!(status.success(), "{command:?} failed");
    children_time() - before
}

/// CPU time of this process's children so far, to the microsecond: the ticks of `/proc` are longer than many a process (s).
fn children_time() -> f64 {
    let usage = getrusage(UsageWho::RUSAGE_CHILDREN).expect("accounts of children");
    let spent = usage.user_time() + usage.system_time();
    1e-6 * spent.num_microseconds() as f64
}

/// Square roots as fast as the machine can: the yardstick.
mod square_roots {
    #![allow(
        unsafe_code,
        reason = "a stream of one instruction, chosen by hand, is what the library's loops are held against"
    )]

    /// `root[i] = sqrt(value[i])` with the widest vectors there are.
    pub fn stream(values: &[f64], roots: &mut [f64]) {
        #[cfg(target_arch = "x86_64")]
        {
            if is_x86_feature_detected!("avx512f") {
                // SAFETY: the machine has just been asked.
                return unsafe { avx512(values, roots) };
            }
            if is_x86_feature_detected!("avx") {
                // SAFETY: as above.
                return unsafe { avx(values, roots) };
            }
        }
        plain(values, roots);
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "each instruction set needs its own copy")]
    fn plain(values: &[f64], roots: &mut [f64]) {
        for (root, value) in roots.iter_mut().zip(values) {
            *root = value.sqrt();
        }
        std::hint::black_box(roots);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f")]
    fn avx512(values: &[f64], roots: &mut [f64]) {
        use std::arch::x86_64::{_mm512_loadu_pd, _mm512_sqrt_pd, _mm512_storeu_pd};
        for (root, value) in roots.chunks_exact_mut(8).zip(values.chunks_exact(8)) {
            // SAFETY: both chunks hold eight doubles.
            unsafe {
                _mm512_storeu_pd(
                    root.as_mut_ptr(),
                    _mm512_sqrt_pd(_mm512_loadu_pd(value.as_ptr())),
                );
            }
        }
        std::hint::black_box(roots);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx")]
    fn avx(values: &[f64], roots: &mut [f64]) {
        plain(values, roots);
    }
}
