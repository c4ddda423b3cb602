//! Blind tests through a forward model of their own: a force in closed form, the sensor's circuit integrated by Runge and Kutta at ten times the sampling, a gain,
//! a zero, noise, eight bits, and a scope's CSV files. Nothing here is what the analysis inverts.
//!
//! The suite runs one condition of each; `HERTZSCOPE_FULL` runs all: noise of 0.1, 0.35, 1 and 3 levels, with and without gain errors, at two time bases.
//! Of 200 intervals of 95 %, 190 ± 3.1 hold the truth; on quiet scopes more, since rounding errors have no tails.

use std::fmt::Write as _;
use std::path::Path;

use hertzscope::analysis::arrival::Estimator;
use hertzscope::analysis::pulse::{Conditions, Pulse};
use hertzscope::measurement::calibration;
use hertzscope::quantity::Uncertain;
use hertzscope::recording::format::open;
use hertzscope::recording::tek_csv::TableColumns;
use hertzscope::scene::plan;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

const TRIALS: u32 = 200;
/// One level at 1 V/div (V).
const LEVEL: f64 = 0.04;

/// How the scope is in one condition.
#[derive(Debug, Clone, Copy)]
struct Scope {
    /// Noise in levels (1).
    noise: f64,
    /// Whether gains are off, evenly within 3 %.
    gain_errors: bool,
    /// Seconds a sample (s).
    interval: f64,
}

fn conditions() -> Vec<Scope> {
    let one = |noise, gain_errors, interval| Scope { noise, gain_errors, interval };
    if std::env::var_os("HERTZSCOPE_FULL").is_none() {
        return vec![one(0.35, true, 0.4e-6), one(1.0, false, 1e-6)];
    }
    let mut all = Vec::new();
    for noise in [0.1, 0.35, 1.0, 3.0] {
        for gain_errors in [false, true] {
            for interval in [0.4e-6, 1e-6] {
                all.push(one(noise, gain_errors, interval));
            }
        }
    }
    all
}

struct Numbers(Pcg64);

impl Numbers {
    fn of(trial: u32, which: u64) -> Self {
        Self(Pcg64::new(u128::from(trial), u128::from(which) + 900))
    }

    fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    fn even(&mut self) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.0);
        2.0 * share - 1.0
    }
}

/// A force that starts at `start` (s), lasts `length` (s) and peaks at `peak` (N): `sin^2`.
#[derive(Debug, Clone, Copy)]
struct Force {
    start: f64,
    length: f64,
    peak: f64,
}

impl Force {
    fn rate(&self, time: f64) -> f64 {
        let along = (time - self.start) / self.length;
        if !(0.0..1.0).contains(&along) {
            return 0.0;
        }
        let angle = std::f64::consts::TAU * along;
        self.peak * std::f64::consts::PI / self.length * angle.sin()
    }

    fn impulse(&self) -> f64 {
        0.5 * self.peak * self.length
    }
}

/// Codes of a record whose trigger is at sample 500 and time 0: `V' = S N' - V/tau` by Runge and Kutta in ten steps a sample.
fn codes(force: Force, (s, tau): (f64, f64), scope: Scope, numbers: &mut Numbers) -> Vec<i32> {
    let gain = if scope.gain_errors { 1.0 + 0.03 * numbers.even() } else { 1.0 };
    let zero = 0.1 * 25.0 * numbers.even();
    let step = scope.interval / 10.0;
    let (mut volts, mut codes) = (0.0, Vec::new());
    for sample in 0..2500_i32 {
        let time = f64::from(sample - 500) * scope.interval;
        let shown = gain * volts / LEVEL + zero + scope.noise * numbers.normal();
        codes.push((shown.round() as i32).clamp(-128, 127));
        for part in 0..10 {
            let t = time + f64::from(part) * step;
            let rate = |t: f64, v: f64| s * force.rate(t) - v / tau;
            let a = rate(t, volts);
            let b = rate(t + 0.5 * step, volts + 0.5 * step * a);
            let c = rate(t + 0.5 * step, volts + 0.5 * step * b);
            let d = rate(t + step, volts + step * c);
            volts += step / 6.0 * (a + 2.0 * b + 2.0 * c + d);
        }
    }
    codes
}

/// A number as C's `%.6e` writes it, with two digits of the exponent at least.
fn scientific(number: f64) -> String {
    let text = format!("{number:.6e}");
    let (mantissa, exponent) = text.split_once('e').expect("an exponent");
    let exponent: i32 = exponent.parse().expect("a number");
    let sign = if exponent < 0 { '-' } else { '+' };
    format!("{mantissa}e{sign}{:02}", exponent.abs())
}

/// A channel's file as the scope writes it.
fn csv(codes: &[i32], interval: f64) -> String {
    let horizontal = interval * 250.0;
    let header = [
        ("Record Length", "2.500000e+03".to_owned()),
        ("Sample Interval", scientific(interval)),
        ("Trigger Point", "5.000000000000e+02".to_owned()),
        ("", String::new()),
        ("", String::new()),
        ("", String::new()),
        ("Source", "CH1".to_owned()),
        ("Vertical Units", "V".to_owned()),
        ("Vertical Scale", "1.000000e+00".to_owned()),
        ("Vertical Offset", "0.000000e+00".to_owned()),
        ("Horizontal Units", "s".to_owned()),
        ("Horizontal Scale", scientific(horizontal)),
        ("Pt Fmt", "Y".to_owned()),
        ("Yzero", "0.000000e+00".to_owned()),
        ("Probe Atten", "1.000000e+00".to_owned()),
        ("Model Number", "TDS2014".to_owned()),
        ("Serial Number", "C012345".to_owned()),
        ("Firmware Version", "FV:v22.01".to_owned()),
    ];
    let mut text = String::new();
    let empty = ("", String::new());
    for (index, code) in codes.iter().enumerate() {
        let (key, value) = header.get(index).unwrap_or(&empty);
        let time = (index as f64 - 500.0) * interval;
        let volts = f64::from(*code) * LEVEL;
        writeln!(text, "{key},{value},,{time:018.12},{volts:10.5},").expect("text");
    }
    text
}

/// How many intervals held the truth.
#[derive(Debug, Default)]
struct Tally {
    inside: u32,
    all: u32,
}

impl Tally {
    fn count(&mut self, found: f64, expanded: f64, truth: f64) {
        self.all += 1;
        self.inside += u32::from((found - truth).abs() <= expanded);
    }

    /// 95 % within three binomial deviations below; above, where errors have tails.
    fn check(&self, what: &str, scope: Scope) {
        let share = f64::from(self.inside) / f64::from(self.all);
        println!("{what} {scope:?}: {share:.3} of {}", self.all);
        let deviation = (0.95 * 0.05 / f64::from(self.all)).sqrt();
        assert!(share >= 0.95 - 3.0 * deviation, "{what} {scope:?}: {share}");
    }
}

/// Heights in volts and delays between two sensors.
#[test]
fn heights_and_delays_are_covered() {
    for scope in conditions() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut heights, mut delays) = (Tally::default(), Tally::default());
        for trial in 0..TRIALS {
            let mut numbers = Numbers::of(trial, 1);
            let (s, tau) = (0.4 * (1.0 + 0.05 * numbers.even()), 1e-3);
            let plain = Scope { gain_errors: false, ..scope };
            let pulse = |name: &str, force: Force, numbers: &mut Numbers| {
                let file = folder.path().join(name);
                let text = csv(&codes(force, (s, tau), plain, numbers), scope.interval);
                std::fs::write(&file, text).expect("a file");
                let set = open(&file).expect("a capture");
                let trace = set.shots[0].captures[0].trace().expect("volts");
                let level = set.shots[0].captures[0].waveform.preamble.y_mult.abs();
                let conditions = Conditions { level, time_constant: Some(tau), baseline: None };
                Pulse::find(&trace, conditions).expect("a pulse")
            };
            let length = 90e-6;
            let peak = 6.0 * (1.0 + 0.2 * numbers.even());
            let start = 20e-6 + scope.interval * numbers.even();
            let delay = 250e-6 + scope.interval * numbers.even();
            let first = pulse("first.csv", Force { start, length, peak }, &mut numbers);
            let second = Force { start: start + delay, length, peak: 0.8 * peak };
            let second = pulse("second.csv", second, &mut numbers);
            let height = first.height().expect("a height");
            heights.count(height.value, height.expanded(), s * peak);
            let times = [&first, &second].map(|p| p.arrival(Estimator::HalfRise).expect("a time"));
            let between = Uncertain {
                value: times[1].value - times[0].value,
                u: times[0].u.hypot(times[1].u),
            };
            delays.count(between.value, between.expanded(), delay);
        }
        heights.check("height", scope);
        delays.check("delay", scope);
    }
}

/// Sensitivity and time constant from six impacts as a plan and its CSV files.
#[test]
fn sensitivity_and_time_constant_are_covered() {
    for scope in conditions() {
        let folder = tempfile::tempdir().expect("a folder");
        let (mut sensitivities, mut constants) = (Tally::default(), Tally::default());
        for trial in 0..TRIALS {
            let mut numbers = Numbers::of(trial, 2);
            let s = 0.2 * (1.0 + 0.05 * numbers.even());
            let tau = 1e-3 * (1.0 + 0.05 * numbers.even());
            // One channel has one gain.
            let gain = if scope.gain_errors { 1.0 + 0.03 * numbers.even() } else { 1.0 };
            let plain = Scope { gain_errors: false, ..scope };
            let mass = 1.22e-3;
            let mut plan = format!(
                "title = \"blind\"\ngravity = \"9.81 m/s^2\"\ngravity_u = \"0.001 m/s^2\"\ndraws = 1000\n[sensor]\nitem = \"plate\"\n[scope]\n{}\n\
                 [strikers.ball]\nmass = \"{:e} kg\"\nmass_u = \"{:e} kg\"\n",
                if scope.gain_errors { "gain_u = \"1.7321 %\"" } else { "gain_u = 0.0" },
                mass + 0.5e-6 * numbers.normal(),
                0.5e-6
            );
            for (number, peak) in [20.0, 20.0, 14.0, 14.0, 9.0, 9.0].into_iter().enumerate() {
                let force =
                    Force { start: 20e-6 + scope.interval * numbers.even(), length: 130e-6, peak };
                let shown = codes(force, (gain * s, tau), plain, &mut numbers);
                let name = format!("impact-{number}.csv");
                std::fs::write(folder.path().join(&name), csv(&shown, scope.interval))
                    .expect("a file");
                let handed = force.impulse() / mass - 9.81 * 130e-6;
                let (came, left) = (0.55 * handed, 0.45 * handed);
                let (came_u, left_u) = (0.003 * came, 0.003 * left);
                write!(
                    plan,
                    "[[impacts]]\nrecording = \"{name}\"\nspeed = \"{:e} m/s\"\nspeed_u = \"{came_u:e} m/s\"\nrebound_speed = \"{:e} m/s\"\nrebound_speed_u = \"{left_u:e} m/s\"\n",
                    came + came_u * numbers.normal(),
                    left + left_u * numbers.normal()
                )
                .expect("text");
            }
            let file = folder.path().join("plan.toml");
            std::fs::write(&file, plan).expect("a plan");
            let report = calibrated(&file);
            sensitivities.count(report.sensitivity_v_per_n, report.expanded_v_per_n, s);
            constants.count(report.tau_s, report.tau_expanded_s, tau);
        }
        sensitivities.check("sensitivity", scope);
        constants.check("time constant", scope);
    }
}

fn calibrated(plan: &Path) -> calibration::CalibrationReport {
    let plan = plan::load(plan).expect("a plan");
    calibration::run(&plan, &TableColumns::default()).expect("a calibration").report
}
