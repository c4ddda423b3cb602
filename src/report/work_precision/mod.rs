//! The work-precision study as text and picture: errors of first peaks and of arrivals against force evaluations, on logarithmic axes.

mod picture;
mod terminal;

pub use picture::work_precision_svg;

use super::table;
use super::words::{COLUMNS, hanging, wrapped};
use crate::quantity::engineering;
use crate::studies::cost::{Chosen, Order, Point, Reference, Study};
use terminal::plot;

/// Letters and colours of the methods: the same in every study.
const MARKS: [Mark; 14] = [
    ("velocity-verlet", 'v', "#4477aa"),
    ("pefrl", 'p', "#66ccee"),
    ("blanes-moan", 'b', "#228833"),
    ("force-gradient", 'f', "#999933"),
    ("inner-force-gradient", 'i', "#ccbb44"),
    ("paced-force-gradient", 'g', "#00aa99"),
    ("runge-kutta-4", 'r', "#aa3377"),
    ("dormand-el-mikkawy-prince-64", '6', "#cc6600"),
    ("dormand-el-mikkawy-prince-64, kinks as they are", 'x', "#996633"),
    ("dormand-el-mikkawy-prince-86", '8', "#ee6677"),
    ("dormand-el-mikkawy-prince-86, kinks as they are", 'y', "#444444"),
    ("dormand-prince-54", '5', "#882255"),
    ("dormand-prince-853", 'd', "#332288"),
    ("rodas", 's', "#888888"),
];
/// Errors below this are rounding (1).
const LEAST: f64 = 1e-16;

/// A method with its letter and colour.
type Mark = (&'static str, char, &'static str);

/// What is plotted against work.
struct Kind {
    /// Of what the errors are.
    of: &'static str,
    error: fn(&Point) -> Option<f64>,
    chosen: fn(&Chosen) -> Option<f64>,
    /// What the scope can tell apart, and its name.
    limit: fn(&Study) -> Option<f64>,
    limit_name: &'static str,
}

const KINDS: [Kind; 4] = [
    Kind {
        of: "first peaks",
        error: |point| point.error_peak,
        chosen: |chosen| chosen.error_peak,
        limit: |study| study.level,
        limit_name: "one level of the scope's digitiser",
    },
    Kind {
        of: "arrivals",
        error: |point| point.error_arrival,
        chosen: |chosen| chosen.error_arrival,
        // A peak at the start is no time to measure by.
        limit: |study| Some(study.sample).filter(|sample| sample.is_finite()),
        limit_name: "one sample interval of the scope",
    },
    Kind {
        of: "traces",
        error: |point| point.error_trace,
        chosen: |chosen| chosen.error_trace,
        limit: |study| study.level,
        limit_name: "one level of the scope's digitiser",
    },
    Kind {
        of: "the energy in motion",
        error: |point| point.error_energy,
        chosen: |chosen| chosen.error_energy,
        limit: |_| None,
        limit_name: "",
    },
];
/// How many of these the terminal shows: the others are in the table of what `--accuracy` chooses.
const IN_TERMINAL: usize = 2;

impl Kind {
    /// Points that can be shown: evaluations and errors.
    fn shown<'a>(&'a self, study: &'a Study, method: &str) -> impl Iterator<Item = (u64, f64)> {
        let points = study.points.iter().filter(move |p| p.method == method && !p.failed);
        points.filter_map(|p| Some((p.force_evaluations, (self.error)(p)?)))
    }

    /// What `--accuracy` chooses: accuracy, evaluations and error.
    fn choices<'a>(&'a self, study: &'a Study) -> impl Iterator<Item = (f64, u64, f64)> {
        let all = study.chosen.iter();
        all.filter_map(|c| Some((c.accuracy, c.force_evaluations, (self.chosen)(c)?)))
    }
}

/// Decades spanned by a plot.
struct Axes {
    work: (f64, f64),
    error: (f64, f64),
}

impl Axes {
    fn of(study: &Study, kind: &Kind) -> Self {
        let shown = || study.points.iter().filter(|p| !p.failed);
        let choices = || kind.choices(study);
        // Failed points are shown beyond the errors.
        let taken = study.points.iter().map(|p| p.force_evaluations).filter(|n| *n > 0);
        let work = taken.chain(choices().map(|(_, n, _)| n));
        let errors = shown().filter_map(kind.error).chain(choices().map(|(_, _, error)| error));
        let (work, errors) = (work.map(decades), errors.map(digits));
        let limits = [Some(study.reference.error), (kind.limit)(study)];
        let limits = limits.into_iter().flatten().filter(|limit| *limit < 1.0).map(digits);
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
        };
        let (low, high) = range(&mut errors.chain(limits));
        let (few, many) = range(&mut work.into_iter());
        Self { work: (few.floor(), many.ceil()), error: (low.floor(), high.ceil().min(0.0)) }
    }

    /// Place of a number of evaluations (from the left) and an error (1, from the top), both from 0 to 1.
    fn place(&self, evaluations: u64, error: f64) -> (f64, f64) {
        let x = (decades(evaluations) - self.work.0) / (self.work.1 - self.work.0);
        let y = (self.error.1 - digits(error)) / (self.error.1 - self.error.0);
        (x.clamp(0.0, 1.0), y.clamp(0.0, 1.0))
    }

    /// Powers of ten along the work.
    fn ticks(&self) -> impl Iterator<Item = f64> {
        let (few, many) = self.work;
        std::iter::successors(Some(few), |decade| Some(decade + 1.0))
            .take_while(move |decade| *decade <= many)
    }
}

/// Decimal logarithm of an error (1).
fn digits(error: f64) -> f64 {
    error.max(LEAST).log10()
}

#[allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
fn decades(evaluations: u64) -> f64 {
    (evaluations.max(1) as f64).log10()
}

/// Methods in order of appearance with their marks.
fn marks(study: &Study) -> Vec<Mark> {
    let mut methods: Vec<&'static str> = Vec::new();
    for point in &study.points {
        if !methods.contains(&point.method) {
            methods.push(point.method);
        }
    }
    let mark = |method: &&str| MARKS.iter().find(|(name, _, _)| name == method).copied();
    methods.into_iter().map(|name| mark(&name).unwrap_or((name, '?', "#000000"))).collect()
}

/// The page that `cost` prints.
#[must_use]
pub fn work_precision(study: &Study) -> String {
    let mut lines = Vec::new();
    for kind in &KINDS[..IN_TERMINAL] {
        lines.extend(plot(study, kind));
        lines.push(String::new());
    }
    let heading = ["method", "mark", "nominal", "observed order", "failed", "given up"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (method, mark, _) in marks(study) {
        let order = study.orders.iter().find(|o| o.method == method);
        let of = |is: fn(&&Point) -> bool| {
            study.points.iter().filter(|p| p.method == method).filter(is).count()
        };
        let (failed, given_up) = (of(|p| p.failed), of(|p| p.given_up));
        // Pairs whose kinks are left as they are follow those whose are not.
        let name = method.split_once(", ").map(|(_, how)| format!("the same, {how}"));
        rows.push(vec![
            name.unwrap_or_else(|| method.to_owned()),
            mark.to_string(),
            order.map_or(String::new(), |o| o.nominal.to_string()),
            order.and_then(observed).unwrap_or_else(|| "-".to_owned()),
            failed.to_string(),
            given_up.to_string(),
        ]);
    }
    lines.extend(table::lines(&rows, &[0]));
    lines.push(String::new());
    lines.extend(sources(study));
    lines.push(String::new());
    lines.extend(choices(study));
    lines.extend(hanging("reference: ", &reference(study)));
    lines.join("\n")
}

/// An order as it was observed, with its standard error.
fn observed(order: &Order) -> Option<String> {
    let (observed, u) = order.observed.zip(order.observed_u)?;
    Some(format!("{observed:.1} ± {u:.1}"))
}

fn reference(study: &Study) -> String {
    let Reference { method, second, error, error_trace } = &study.reference;
    format!("{method}, {error:.1e} from {second}, in traces {error_trace:.1e}")
}

/// Where each method is from.
fn sources(study: &Study) -> Vec<String> {
    let mut all: Vec<(&str, &str)> = Vec::new();
    for order in &study.orders {
        let name = order.method.split(',').next().unwrap_or(order.method);
        if all.last().is_none_or(|(last, _)| *last != name) {
            all.push((name, order.source));
        }
    }
    let lines = |(name, source)| [vec![format!("  {name}")], hanging("    ", source)].concat();
    all.into_iter().flat_map(lines).collect()
}

/// Accuracies that were not reached, those of which the reference cannot tell, and those whose traces are not known to half of the digits.
fn doubts(study: &Study) -> Vec<String> {
    let own = study.reference.error;
    let named = |is: &dyn Fn(&Chosen) -> bool| {
        let those = study.chosen.iter().filter(|chosen| is(chosen));
        let names: Vec<String> = those.map(|chosen| format!("{:e}", chosen.accuracy)).collect();
        Some(names.join(", ")).filter(|names| !names.is_empty())
    };
    let error = |chosen: &Chosen| chosen.error.unwrap_or(f64::INFINITY);
    let missed = named(&|c| error(c) > c.accuracy + own);
    let unclear = named(&|c| error(c) > c.accuracy && error(c) <= c.accuracy + own);
    let late = named(&|c| c.error_trace.is_some_and(|error| error > c.accuracy.sqrt()));
    let missed = missed.map(|names| hanging("  not reached: ", &format!("{names}; a run says so")));
    let unclear = unclear.map(|names| {
        let own = format!("{names}; the reference itself may be {own:.1e} off");
        hanging("  not to be judged: ", &own)
    });
    let late = late.map(|names| {
        let when = format!("{names}; a run says from when on, or takes shorter steps");
        hanging("  traces off by more than half of the digits: ", &when)
    });
    missed.into_iter().chain(unclear).chain(late).flatten().collect()
}

fn choices(study: &Study) -> Vec<String> {
    let heading = ["--accuracy", "peaks, arrivals", "traces", "energy", "evaluations", "wall time"];
    let words = |error: Option<f64>| error.map_or("-".to_owned(), |e| format!("{e:.1e}"));
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for chosen in &study.chosen {
        rows.push(vec![
            format!("{:e}", chosen.accuracy),
            words(chosen.error),
            words(chosen.error_trace),
            words(chosen.error_energy),
            chosen.force_evaluations.to_string(),
            engineering(chosen.wall_s_median, "s", 2),
        ]);
    }
    // The method stands above what it was chosen for.
    let mut lines = Vec::new();
    let mut above = None;
    for (number, line) in table::lines(&rows, &[]).into_iter().enumerate() {
        let method = number.checked_sub(1).and_then(|i| study.chosen.get(i)).map(|c| c.method);
        if method != above {
            lines.extend(method.map(|method| format!("  {method}")));
            above = method;
        }
        lines.push(line);
    }
    let level = study.level.map(|level| format!("one scope level is {level:.1e} of a first peak"));
    let sample = (KINDS[1].limit)(study);
    let sample = sample.map(|sample| format!("one sample interval is {sample:.1e} of an arrival"));
    let limits: Vec<String> = level.into_iter().chain(sample).collect();
    if !limits.is_empty() {
        lines.extend(hanging("  ", &limits.join(", ")));
    }
    lines.extend(doubts(study));
    lines.extend(wrapped(
        "wall times are those of one run with all forces sampled as the scope would, without recording and without the runs that estimate its error",
        COLUMNS,
    ));
    lines
}
