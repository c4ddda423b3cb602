//! A forward model of its own for blind tests: a force as a function of time, the sensor's circuit
//! integrated by Runge and Kutta at ten times the sampling, a gain, a zero, noise, eight bits, and
//! a scope's CSV files. Nothing here is what the analysis inverts.

use std::fmt::Write as _;
use std::path::Path;

use hertzscope::quantity::Uncertain;
use hertzscope::recording::TraceSet;
use hertzscope::recording::format::open;
use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;

/// One level at 1 V/div (V).
pub const LEVEL: f64 = 0.04;
/// Limit of the data sheet's gain error at 1 V/div (1).
pub const GAIN_LIMIT: f64 = 0.03;
/// Samples of a record, and those before the trigger.
const RECORD: (i32, i32) = (2500, 500);

/// How the scope is in one condition.
#[derive(Debug, Clone, Copy)]
pub struct Condition {
    /// Noise in levels (1).
    pub noise: f64,
    /// Whether gains are off, evenly within the data sheet's limit.
    pub gain_errors: bool,
    /// Seconds a sample (s).
    pub interval: f64,
}

/// Trials of one condition: as many as it takes to tell 97 % from 99 %, and with `HERTZSCOPE_FULL`
/// from 98 %.
pub fn trials() -> u32 {
    if std::env::var_os("HERTZSCOPE_FULL").is_none() { 300 } else { 1000 }
}

/// The conditions of a test at two sample `intervals` (s): all with `HERTZSCOPE_FULL`, else two of
/// them.
pub fn conditions(intervals: [f64; 2]) -> Vec<Condition> {
    let one = |noise, gain_errors, interval| Condition { noise, gain_errors, interval };
    if std::env::var_os("HERTZSCOPE_FULL").is_none() {
        return vec![one(0.35, true, intervals[0]), one(1.0, false, intervals[1])];
    }
    let mut all = Vec::new();
    for noise in [0.1, 0.35, 1.0, 3.0] {
        for gain_errors in [false, true] {
            all.extend(intervals.map(|interval| one(noise, gain_errors, interval)));
        }
    }
    all
}

/// Random numbers of one trial.
pub struct Numbers(Pcg64);

impl Numbers {
    pub fn of(trial: u32, which: u64) -> Self {
        Self(Pcg64::new(u128::from(trial), u128::from(which) + 900))
    }

    pub fn normal(&mut self) -> f64 {
        StandardNormal.sample(&mut self.0)
    }

    pub fn even(&mut self) -> f64 {
        let share: f64 = StandardUniform.sample(&mut self.0);
        2.0 * share - 1.0
    }

    /// The gain of a channel under `condition`.
    pub fn gain(&mut self, condition: Condition) -> f64 {
        let off = GAIN_LIMIT * self.even();
        if condition.gain_errors { 1.0 + off } else { 1.0 }
    }
}

/// A pulse that starts at `start` (s), lasts `length` (s) and peaks at `peak` (N): `sin^2`.
#[derive(Debug, Clone, Copy)]
pub struct Pulse {
    pub start: f64,
    pub length: f64,
    pub peak: f64,
}

impl Pulse {
    pub fn force(&self, time: f64) -> f64 {
        let along = (time - self.start) / self.length;
        if !(0.0..1.0).contains(&along) {
            return 0.0;
        }
        self.peak * (std::f64::consts::PI * along).sin().powi(2)
    }

    pub fn impulse(&self) -> f64 {
        0.5 * self.peak * self.length
    }
}

/// Codes of a record whose trigger is at time 0, behind a circuit of sensitivity `s` (V/N) and time
/// constant `tau` (s): `V = s N - q`, `q' = V/tau`, in ten steps a sample by Runge and Kutta.
pub fn codes(
    force: &dyn Fn(f64) -> f64,
    (s, tau): (f64, f64),
    (gain, condition): (f64, Condition),
    numbers: &mut Numbers,
) -> Vec<i32> {
    let zero = 0.1 * 25.0 * numbers.even();
    let step = condition.interval / 10.0;
    let (mut leaked, mut codes) = (0.0, Vec::new());
    let (samples, before) = RECORD;
    for sample in 0..samples {
        let time = f64::from(sample - before) * condition.interval;
        let volts = s * force(time) - leaked;
        let shown = gain * volts / LEVEL + zero + condition.noise * numbers.normal();
        codes.push((shown.round() as i32).clamp(-128, 127));
        for part in 0..10 {
            let t = time + f64::from(part) * step;
            let [now, middle, end] = [t, t + 0.5 * step, t + step].map(|t| s * force(t));
            let a = (now - leaked) / tau;
            let b = (middle - leaked - 0.5 * step * a) / tau;
            let c = (middle - leaked - 0.5 * step * b) / tau;
            let d = (end - leaked - step * c) / tau;
            leaked += step / 6.0 * (a + 2.0 * b + 2.0 * c + d);
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

/// The file of channel `source` as the scope writes it.
pub fn csv(source: &str, codes: &[i32], interval: f64) -> String {
    let horizontal = interval * 250.0;
    let header = [
        ("Record Length", "2.500000e+03".to_owned()),
        ("Sample Interval", scientific(interval)),
        ("Trigger Point", "5.000000000000e+02".to_owned()),
        ("", String::new()),
        ("", String::new()),
        ("", String::new()),
        ("Source", source.to_owned()),
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
        let time = (index as f64 - f64::from(RECORD.1)) * interval;
        let volts = f64::from(*code) * LEVEL;
        writeln!(text, "{key},{value},,{time:018.12},{volts:10.5},").expect("text");
    }
    text
}

/// The records of one shot, one a channel from CH1 on, through their files.
pub fn recorded(folder: &Path, channels: &[Vec<i32>], interval: f64) -> TraceSet {
    let mut all: Option<TraceSet> = None;
    for (number, codes) in (1..).zip(channels) {
        let source = format!("CH{number}");
        let file = folder.join(format!("{source}.csv"));
        std::fs::write(&file, csv(&source, codes, interval)).expect("a file");
        let mut set = open(&file).expect("a capture");
        match &mut all {
            Some(all) => all.shots[0].captures.append(&mut set.shots[0].captures),
            None => all = Some(set),
        }
    }
    all.expect("a channel")
}

/// Quantities whose intervals are known to be too wide up to so many levels of noise, with the
/// largest share that they held in 1000 trials of each condition: an open fault,
/// `docs/uncertainty.md`. Their lower ends are checked like all others.
const KNOWN_TOO_WIDE: [(&str, f64); 2] = [
    // 98.4 %: a single code before the pulse leaves open how quiet the scope is, and with it where
    // in that code the zero lies.
    ("height", 0.1),
    // 98.2 %: the same.
    ("time constant", 0.1),
];

/// How many intervals held the truth.
#[derive(Debug, Default)]
pub struct Tally {
    inside: u32,
    all: u32,
    sums: [f64; 2],
}

impl Tally {
    pub fn count(&mut self, found: f64, expanded: f64, truth: f64) {
        self.all += 1;
        self.inside += u32::from((found - truth).abs() <= expanded);
        let score = (found - truth) / expanded;
        self.sums = [self.sums[0] + score, self.sums[1] + score * score];
    }

    pub fn add(&mut self, found: Uncertain, truth: f64) {
        self.count(found.value, found.expanded(), truth);
    }

    /// A trial without an interval, which holds nothing.
    pub fn miss(&mut self) {
        self.all += 1;
    }

    /// Between 93 and 97 %, as far as so many trials tell: two binomial deviations beyond either
    /// end.
    pub fn check(&self, what: &str, condition: Condition) -> Result<(), String> {
        let all = f64::from(self.all);
        let share = f64::from(self.inside) / all;
        let deviation = |share: f64| (share * (1.0 - share) / all).sqrt();
        let [mean, square] = self.sums.map(|sum| sum / all);
        let Condition { noise, gain_errors, interval } = condition;
        let told = format!(
            "{what:18} {noise:4} LSB  gains {:3}  {:.1} us  {share:.3} ± {:.3} of {all}  mean {mean:+.3} U, rms {:.3} U",
            if gain_errors { "off" } else { "on" },
            1e6 * interval,
            1.96 * deviation(0.95),
            square.sqrt(),
        );
        println!("{told}");
        let is_wide =
            KNOWN_TOO_WIDE.iter().any(|(name, most_noise)| *name == what && noise <= *most_noise);
        let most = if is_wide { 1.0 } else { 0.97 + 2.0 * deviation(0.97) };
        let range = 0.93 - 2.0 * deviation(0.93)..=most;
        if range.contains(&share) { Ok(()) } else { Err(told) }
    }
}

/// Fails with what is not covered.
pub fn all_hold(checked: Vec<Result<(), String>>) {
    let failed: Vec<String> = checked.into_iter().filter_map(Result::err).collect();
    assert!(failed.is_empty(), "{}", failed.join("\n"));
}
