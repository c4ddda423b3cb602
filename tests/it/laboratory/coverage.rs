//! How often the program's 95 % intervals contain the truth, with disturbances that a laboratory
//! has.
//!
//! Each trial is a new truth, a new noise and new files: 1,000 trials of each condition with
//! `HERTZSCOPE_FULL`, else [`FEW`] of a few conditions. An interval that is too narrow is a fault, a
//! refusal is not.

use super::chain::{self, FORCES, first_peak};
use super::impact::{Impact, impact};
use super::scope::{POINTS, respond};
use super::{Channel, Disturbance, Random, Timing};
use hertzscope::calibrate;
use hertzscope::experiment::{Integration, facts};
use hertzscope::fit::{FitOptions, fit};
use hertzscope::measurement::arrivals::survey;
use hertzscope::measurement::compare::ComparedShot;
use hertzscope::measurement::metadata::RecordedDistance;
use hertzscope::quantity::Uncertain;
use hertzscope::recording::TraceSet;
use hertzscope::recording::format::open;
use hertzscope::recording::tek_csv::TableColumns;
use hertzscope::scene::adjust::Adjustable;
use hertzscope::scene::{Scene, plan};
use std::fmt::Write as _;
use std::sync::LazyLock;

/// Trials of a condition in the short run.
const FEW: u32 = 100;
/// First seed of the trials: others than those on which the analysis was tuned.
const FIRST_SEED: u64 = 640_000;

/// Distances between sensors of neighbouring channels along the chain at rest, without overlaps'
/// uncertainties (mm).
const DISTANCES_MM: [(usize, usize, f64); 3] =
    [(1, 2, 47.191223382780215), (2, 3, 51.12283568642917), (3, 4, 45.62939757955527)];

/// Share that an interval of 95 % must reach: what is lost to 95 % is for rounded results.
const LEAST_SHARE: f64 = 0.93;

/// Intervals of one quantity and how many of them contain the truth.
#[derive(Default)]
struct Count {
    quantity: String,
    inside: u32,
    all: u32,
}

impl Count {
    /// Whether so few inside have a probability below 1 in 200 where [`LEAST_SHARE`] is true: the
    /// binomial distribution's tail, by its ratio of neighbours.
    fn is_too_narrow(&self) -> bool {
        let odds = LEAST_SHARE / (1.0 - LEAST_SHARE);
        let (mut term, mut tail) = (f64::from(self.all) * (1.0 - LEAST_SHARE).ln(), 0.0);
        for inside in 0..=self.inside {
            tail += term.exp();
            term += (odds * f64::from(self.all - inside) / f64::from(inside + 1)).ln();
        }
        tail < 0.005
    }
}

/// Counts of all quantities of one condition.
#[derive(Default)]
struct Tally {
    counts: Vec<Count>,
    refused: u32,
}

impl Tally {
    fn add(&mut self, quantity: &str, truth: f64, value: f64, expanded: f64) {
        let place = self.counts.iter().position(|count| count.quantity == quantity);
        let place = place.unwrap_or_else(|| {
            self.counts.push(Count { quantity: quantity.to_owned(), ..Count::default() });
            self.counts.len() - 1
        });
        self.counts[place].all += 1;
        self.counts[place].inside += u32::from((value - truth).abs() <= expanded);
    }

    /// The counts of both.
    fn with(mut self, other: Self) -> Self {
        self.refused += other.refused;
        for count in other.counts {
            match self.counts.iter_mut().find(|own| own.quantity == count.quantity) {
                Some(own) => {
                    own.inside += count.inside;
                    own.all += count.all;
                }
                None => self.counts.push(count),
            }
        }
        self
    }

    /// Prints the shares, and lists those that are too small.
    fn judge(&self, condition: &str, trials: u32) -> Vec<String> {
        let mut faults = Vec::new();
        println!("{condition}: {} refused in {trials} trials", self.refused);
        for count in &self.counts {
            let name = format!("{condition}: {}", count.quantity);
            let share = f64::from(count.inside) / f64::from(count.all);
            println!("{name}: {share:.3} of {}", count.all);
            if count.is_too_narrow() {
                faults.push(format!("{name}: {share:.3} of {}", count.all));
            }
        }
        faults
    }
}

/// Value at a time (s) of samples that are `interval` (s) apart from zero on; zero before.
fn interpolate(samples: &[f64], interval: f64, time: f64) -> f64 {
    if time <= 0.0 {
        return 0.0;
    }
    let place = time / interval;
    let index = (place as usize).min(samples.len() - 2);
    samples[index] + (samples[index + 1] - samples[index]) * (place - index as f64)
}

/// Mass of the striker (kg) and heights of fall (m).
const MASS: f64 = 2.75e-3;
const HEIGHTS: [f64; 3] = [0.02, 0.01, 0.005];

/// The impact from each height.
static IMPACTS: LazyLock<[Impact; 3]> = LazyLock::new(|| {
    HEIGHTS.map(|height| impact(MASS, f64::sqrt(2.0 * 9.81 * height), 1.2e8, 2e-7, 9.81))
});

/// One calibration by two impacts from each height.
fn calibrate(
    time_base: f64,
    disturbance: Disturbance,
    one_zero: bool,
    seed: u64,
    tally: &mut Tally,
) {
    let random = &mut Random::new(seed);
    let folder = tempfile::tempdir().expect("a folder");
    let (s, tau) = (0.394 * random.uniform(0.9, 1.1), 1.017e-3 * random.uniform(0.9, 1.1));
    let (mass, mass_u) = (MASS, 5e-7);
    let mut plan = format!(
        "title = \"a laboratory\"\nchannel = \"CH1\"\ngravity = \"9.81 m/s^2\"\n\
         gravity_u = \"1e-4 m/s^2\"\ndraws = 30000\n[sensor]\nitem = \"plate\"\nname = \"plate\"\n[scope]\n\
         in_chain = true\ninput_resistance = \"1 MOhm\"\ninput_capacitance = \"20 pF\"\n\
         [traceability]\nmass = \"none\"\nspeed = \"none\"\nvoltage = \"none\"\n\
         [strikers.a]\nmass = \"{:.9e} kg\"\nmass_u = \"{mass_u:e} kg\"\n",
        mass + mass_u * random.normal()
    );
    let common_zero = random.uniform(-0.5, 0.5) / 25.0;
    for (index, height) in HEIGHTS.into_iter().flat_map(|height| [height; 2]).enumerate() {
        let timing = Timing { time_base, before: 500 };
        let found = &IMPACTS[index / 2];
        // Long enough for the slowest time base: zeros behind the contact, on a coarser grid.
        let step = 32;
        let end = (timing.interval() * POINTS as f64 / found.interval) as usize;
        let forces: Vec<f64> =
            (0..=end).step_by(step).map(|i| found.force.get(i).copied().unwrap_or(0.0)).collect();
        let interval = found.interval * step as f64;
        let volts = respond(&forces, interval, s, tau);
        let zero = if one_zero { common_zero } else { random.uniform(-0.5, 0.5) / 25.0 };
        let channel = Channel { scale: 5.0, position: -2.0, disturbance };
        // The trigger at 0.5 V.
        let crossing = volts.iter().position(|v| *v >= 0.5).expect("a pulse") as f64 * interval;
        let codes = channel.digitise(timing, random.uniform(0.0, 1.0), random, |time| {
            interpolate(&volts, interval, time + crossing) + zero * channel.scale
        });
        let shot = folder.path().join(index.to_string());
        channel.save(&shot, &[(1, codes)], timing);
        let height_u = 5e-5;
        let speed_u = 0.01 * found.rebound;
        write!(
            plan,
            "[[impacts]]\nrecording = \"{index}\"\nstriker = \"a\"\nheight = \"{:.9e} m\"\n\
             height_u = \"{height_u:e} m\"\nrebound_speed = \"{:.9e} m/s\"\n\
             rebound_speed_u = \"{speed_u:.9e} m/s\"\n",
            height + height_u * random.normal(),
            found.rebound + speed_u * random.normal(),
        )
        .expect("memory");
    }
    std::fs::write(folder.path().join("plan.toml"), plan).expect("written");
    let plan = plan::load(&folder.path().join("plan.toml")).expect("a plan");
    match calibrate::run(&plan, &TableColumns::default()) {
        Ok(report) if report.contradictions.is_empty() => {
            let found = report.result;
            tally.add("S", s, found.sensitivity, found.expanded);
            tally.add("tau", tau, found.tau, found.tau_expanded);
        }
        _ => tally.refused += 1,
    }
}

/// What a recording of the bench states of its sensors and their distances, which are known
/// exactly: a speed's interval is that of its times.
static KNOWN: LazyLock<facts::Facts> = LazyLock::new(|| {
    let scene = Scene::load("magnet-0.61g").expect("a scene");
    let mut known = facts::facts(&scene, Integration::Accuracy(1e-6)).expect("facts");
    for (from, to, mm) in DISTANCES_MM {
        let (from, to) = (format!("CH{from}"), format!("CH{to}"));
        let distance = Uncertain::normal(1e-3 * mm, 0.0);
        known.extend([RecordedDistance { from, to, distance }.facts()]);
    }
    known
});

/// Sensitivity (V/N) and time constant (s) of a PZT-5A plate of 3 x 3 x 0.5 mm with 710 pF of
/// cable, 20 pF and one megohm of the scope.
fn sensor() -> (f64, f64) {
    let capacitance = 8.8541878128e-12 * 1800.0 * 9e-6 / 5e-4 + 730e-12;
    (400e-12 / capacitance, 1e6 * capacitance)
}

/// One record of the bench's four sensors.
fn record(disturbance: Disturbance, seed: u64) -> TraceSet {
    let random = &mut Random::new(seed);
    let folder = tempfile::tempdir().expect("a folder");
    let (s, tau) = sensor();
    let timing = Timing { time_base: 250e-6, before: 250 };
    let volts: Vec<Vec<f64>> =
        FORCES.iter().map(|forces| respond(forces, chain::INTERVAL, s, tau)).collect();
    let crossing = volts[0].iter().position(|v| *v >= 0.5).expect("a pulse") as f64;
    let trigger = crossing * chain::INTERVAL;
    let phase = random.uniform(0.0, 1.0);
    let channel = Channel { scale: 1.0, position: -1.0, disturbance };
    let mut records = Vec::new();
    for (index, volts) in volts.iter().enumerate() {
        let zero = random.uniform(-0.5, 0.5) / 25.0;
        let codes = channel.digitise(timing, phase, random, |time| {
            interpolate(volts, chain::INTERVAL, time + trigger) + zero
        });
        records.push((index + 1, codes));
    }
    channel.save(folder.path(), &records, timing);
    let mut set = open(folder.path()).expect("a recording");
    set.metadata = KNOWN.clone();
    set
}

/// Heights and speeds of one record.
fn arrivals(disturbance: Disturbance, seed: u64, tally: &mut Tally) {
    let set = record(disturbance, seed);
    let (s, _) = sensor();
    let found = survey(&set, &set.shots[0]);
    let peaks: Vec<_> = FORCES.iter().map(|forces| first_peak(forces)).collect();
    for (channel, (height, _, _)) in found.channels.iter().zip(&peaks) {
        match channel.height_v {
            Some(found) => tally.add("height", s * height, found.value, found.expanded()),
            None => tally.refused += 1,
        }
    }
    let number = |channel: &str| channel[2..].parse::<usize>().expect("a number") - 1;
    let tenth = |place: usize| chain::first_crossing(&FORCES[place], 0.1 * peaks[place].0);
    for speed in &found.speeds {
        let (from, to) = (number(&speed.from), number(&speed.to));
        // Where a channel is refused, speeds are over more than one distance.
        if to != from + 1 {
            continue;
        }
        let (quantity, delay) = match speed.estimator {
            "half_rise" => ("half rise to half rise", peaks[to].2 - peaks[from].2),
            "peak" => ("peak to peak", peaks[to].1 - peaks[from].1),
            "ten_percent" => ("10 % to 10 %", tenth(to) - tenth(from)),
            _ => continue,
        };
        let truth = 1e-3 * DISTANCES_MM[from].2 / delay;
        tally.add(quantity, truth, speed.m_per_s.value, speed.m_per_s.expanded());
    }
}

/// The striker's speed and PTFE's modulus as fitted to one record.
fn fitted(disturbance: Disturbance, seed: u64, tally: &mut Tally) {
    let set = record(disturbance, seed);
    let side = ComparedShot { name: "bench", set: &set, shot: &set.shots[0], scene: None };
    let mut scene = Adjustable::load("magnet-0.61g").expect("a scene");
    let freed = ["striker.speed", "materials.ptfe.youngs_modulus"];
    let knobs: Vec<_> = freed.iter().flat_map(|path| scene.knobs(path).expect("a knob")).collect();
    let options =
        FitOptions { starts: 1, accuracy: 1e-6, exact_inputs: true, ..FitOptions::default() };
    match fit((&scene, &knobs), side, &[], &options, &mut |_| ()) {
        Ok(found) if found.report.only_noise_is_left => {
            for found in &found.report.parameters {
                tally.add(&found.path, found.start, found.value, found.expanded);
            }
        }
        _ => tally.refused += 1,
    }
}

/// Runs the trials of all conditions with new seeds, in two threads, and fails with all faults.
fn all_hold<T: Fn(u64, &mut Tally) + Sync>(
    few: u32,
    conditions: impl IntoIterator<Item = (bool, String, T)>,
) {
    let is_long = std::env::var_os("HERTZSCOPE_FULL").is_some();
    let trials = if is_long { 1000 } else { few };
    let mut faults = Vec::new();
    for (is_short, name, trial) in conditions {
        if !(is_short || is_long) {
            continue;
        }
        let half = |first: u32| {
            let mut tally = Tally::default();
            for seed in (first..trials).step_by(2) {
                trial(FIRST_SEED + u64::from(seed), &mut tally);
            }
            tally
        };
        let (one, other) = std::thread::scope(|scope| {
            let other = scope.spawn(|| half(1));
            (half(0), other.join().expect("a thread"))
        });
        faults.extend(one.with(other).judge(&name, trials));
    }
    assert!(faults.is_empty(), "too narrow:\n  {}", faults.join("\n  "));
}

#[test]
fn calibrations_contain_the_truth_with_what_a_laboratory_has() {
    let white = Disturbance::white(0.02);
    let hum = |hum| Disturbance { hum, ..white };
    let sixty = Disturbance { hum: 0.2, hum_frequency: 60.0, ..white };
    let coupled = Disturbance { high_pass: 10.0, ..white };
    let drift = |drift| Disturbance { drift, ..white };
    let pink = |pink| Disturbance { pink, ..white };
    let zero = Disturbance { zero: 0.14, ..white };
    let quiet = |white| Disturbance::white(white);
    // What is marked runs with few trials, too.
    let rows = [
        (false, "white noise at 50 us/div", 50e-6, white, false),
        (false, "white noise at 250 us/div", 250e-6, white, false),
        (false, "white noise at 1 ms/div", 1e-3, white, false),
        (false, "white noise 0.04 div at 50 us/div", 50e-6, quiet(0.04), false),
        (false, "white noise 0.1 div at 50 us/div", 50e-6, quiet(0.1), false),
        (false, "a zero off by 3.5 levels at 50 us/div", 50e-6, zero, false),
        (false, "noise 0.002 div, one zero", 50e-6, quiet(0.002), true),
        (false, "noise 0.004 div, one zero", 50e-6, quiet(0.004), true),
        (false, "noise 0.004 div, one zero, 250 us/div", 250e-6, quiet(0.004), true),
        (false, "noise 0.008 div, one zero", 50e-6, quiet(0.008), true),
        (
            false,
            "noise 0.004 div, drift 0.1 div",
            50e-6,
            Disturbance { drift: 0.1, ..quiet(0.004) },
            false,
        ),
        (
            false,
            "noise 0.004 div, hum 0.05 div",
            250e-6,
            Disturbance { hum: 0.05, ..quiet(0.004) },
            false,
        ),
        (false, "noise 0.014 div, one zero", 50e-6, quiet(0.014), true),
        (false, "noise 0.004 div, a zero for each", 50e-6, quiet(0.004), false),
        (false, "noise 0.008 div, a zero for each", 50e-6, quiet(0.008), false),
        (false, "drift 0.1 div at 50 us/div", 50e-6, drift(0.1), false),
        (false, "drift 0.5 div at 50 us/div", 50e-6, drift(0.5), false),
        (false, "hum 0.05 div at 50 us/div", 50e-6, hum(0.05), false),
        (false, "hum 0.2 div at 50 us/div", 50e-6, hum(0.2), false),
        (false, "hum 0.2 div of 60 Hz at 50 us/div", 50e-6, sixty, false),
        (false, "hum 0.02 div at 250 us/div", 250e-6, hum(0.02), false),
        (false, "hum 0.05 div at 250 us/div", 250e-6, hum(0.05), false),
        (true, "hum 0.01 div at 1 ms/div", 1e-3, hum(0.01), false),
        (false, "hum 0.05 div at 1 ms/div", 1e-3, hum(0.05), false),
        (false, "1/f noise 0.02 div at 50 us/div", 50e-6, pink(0.02), false),
        (true, "1/f noise 0.05 div at 50 us/div", 50e-6, pink(0.05), false),
        (false, "1/f noise 0.1 div at 50 us/div", 50e-6, pink(0.1), false),
        (false, "AC coupled at 50 us/div", 50e-6, coupled, false),
        (false, "AC coupled at 250 us/div", 250e-6, coupled, false),
    ];
    let rows = rows.map(|(is_short, name, time_base, disturbance, one_zero)| {
        let trial = move |seed, tally: &mut Tally| {
            calibrate(time_base, disturbance, one_zero, seed, tally);
        };
        (is_short, format!("calibrate, {name}"), trial)
    });
    all_hold(FEW, rows);
}

#[test]
fn arrivals_contain_the_truth_with_what_a_laboratory_has() {
    let white = Disturbance::white(0.02);
    let quiet = Disturbance::white(0.004);
    let rows = [
        (false, "white noise 0.02 div", white),
        (false, "white noise 0.06 div", Disturbance::white(0.06)),
        (true, "white noise 0.08 div", Disturbance::white(0.08)),
        (false, "white noise 0.12 div", Disturbance::white(0.12)),
        (false, "white noise 0.2 div", Disturbance::white(0.2)),
        (false, "noise 0.002 div", Disturbance::white(0.002)),
        (false, "noise 0.004 div", quiet),
        (false, "noise 0.008 div", Disturbance::white(0.008)),
        (false, "noise 0.014 div", Disturbance::white(0.014)),
        (true, "noise 0.004 div, drift 0.2 div", Disturbance { drift: 0.2, ..quiet }),
        (false, "noise 0.004 div, hum 0.2 div", Disturbance { hum: 0.2, ..quiet }),
        (false, "noise 0.004 div, 1/f noise 0.05 div", Disturbance { pink: 0.05, ..quiet }),
        (false, "a zero off by 3.5 levels", Disturbance { zero: 0.14, ..white }),
        (false, "drift 0.2 div", Disturbance { drift: 0.2, ..white }),
        (false, "hum 0.05 div", Disturbance { hum: 0.05, ..white }),
        (true, "hum 0.2 div", Disturbance { hum: 0.2, ..white }),
        (false, "1/f noise 0.02 div", Disturbance { pink: 0.02, ..white }),
        (false, "1/f noise 0.05 div", Disturbance { pink: 0.05, ..white }),
        (false, "1/f noise 0.1 div", Disturbance { pink: 0.1, ..white }),
        (false, "drift, hum, 1/f", Disturbance { drift: 0.1, hum: 0.1, pink: 0.02, ..white }),
        (false, "AC coupled", Disturbance { high_pass: 10.0, ..white }),
    ];
    let rows = rows.map(|(is_short, name, disturbance)| {
        let trial = move |seed, tally: &mut Tally| arrivals(disturbance, seed, tally);
        (is_short, format!("arrivals, {name}"), trial)
    });
    all_hold(FEW, rows);
}

/// Of records with hum, drift or 1/f noise a fit that takes noise for white says that more than
/// noise is left: it did so in 20 of 20 each.
#[test]
fn fits_contain_the_truth_with_what_a_laboratory_has() {
    let white = Disturbance::white(0.02);
    let rows = [
        (true, "white noise 0.02 div", white),
        (true, "hum 0.2 div", Disturbance { hum: 0.2, ..white }),
        (true, "drift 0.5 div", Disturbance { drift: 0.5, ..white }),
        (false, "hum 0.02 div", Disturbance { hum: 0.02, ..white }),
        (true, "1/f noise 0.02 div", Disturbance { pink: 0.02, ..white }),
        (false, "1/f noise 0.05 div", Disturbance { pink: 0.05, ..white }),
        (false, "AC coupled", Disturbance { high_pass: 10.0, ..white }),
    ];
    let rows = rows.map(|(is_short, name, disturbance)| {
        let trial = move |seed, tally: &mut Tally| fitted(disturbance, seed, tally);
        (is_short, format!("fit, {name}"), trial)
    });
    all_hold(20, rows);
    // Of 1/f noise that is stronger than white noise, 90 % of the intervals would hold the truth.
    let strong = Disturbance { pink: 0.05, ..white };
    let followed = [Disturbance { hum: 0.2, ..white }, Disturbance { pink: 0.02, ..white }];
    for (disturbance, refused) in followed.map(|one| (one, 0)).into_iter().chain([(strong, 5)]) {
        let mut tally = Tally::default();
        for seed in FIRST_SEED..FIRST_SEED + 5 {
            fitted(disturbance, seed, &mut tally);
        }
        assert_eq!(tally.refused, refused, "{disturbance:?}");
    }
}
