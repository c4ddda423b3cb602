//! Axes and marks of the diagram, on paper and in a terminal.

use crate::studies::cost::{Chosen, Point, Study};

/// Letters and colours of the methods: the same in every study.
pub(super) const MARKS: [Mark; 9] = [
    ("velocity-verlet", 'v', "#4477aa"),
    ("force-gradient", 'f', "#999933"),
    ("two-step-force-gradient", 'g', "#00aa99"),
    ("runge-kutta-4", 'r', "#aa3377"),
    ("dormand-el-mikkawy-prince-86", '8', "#ee6677"),
    ("dormand-el-mikkawy-prince-86, uncorrected", 'y', "#444444"),
    ("dormand-prince-54", '5', "#882255"),
    ("dormand-prince-853", 'd', "#332288"),
    ("rodas", 's', "#888888"),
];

/// Errors below this are rounding (1).
pub(super) const LEAST: f64 = 1e-16;

/// A method with its letter and colour.
pub(super) type Mark = (&'static str, char, &'static str);

/// What is plotted against work.
pub(super) struct Kind {
    /// Of what the errors are.
    pub(super) of: &'static str,
    pub(super) error: fn(&Point) -> Option<f64>,
    pub(super) chosen: fn(&Chosen) -> Option<f64>,
    /// What the scope can tell apart, and its name.
    pub(super) limit: fn(&Study) -> Option<f64>,
    pub(super) limit_name: &'static str,
}

pub(super) const KINDS: [Kind; 4] = [
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

impl Kind {
    /// Points that can be shown: evaluations and errors.
    pub(super) fn shown<'a>(
        &'a self,
        study: &'a Study,
        method: &str,
    ) -> impl Iterator<Item = (u64, f64)> {
        let points = study.points.iter().filter(move |p| p.method == method && !p.failed);
        points.filter_map(|p| Some((p.force_evaluations, (self.error)(p)?)))
    }

    /// What `--accuracy` chooses: accuracy, evaluations and error.
    pub(super) fn choices<'a>(&'a self, study: &'a Study) -> impl Iterator<Item = (f64, u64, f64)> {
        let all = study.chosen.iter();
        all.filter_map(|c| Some((c.accuracy, c.force_evaluations, (self.chosen)(c)?)))
    }
}

/// Decades spanned by a plot.
pub(super) struct Axes {
    pub(super) work: (f64, f64),
    pub(super) error: (f64, f64),
}

impl Axes {
    pub(super) fn of(study: &Study, kind: &Kind) -> Self {
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
    pub(super) fn place(&self, evaluations: u64, error: f64) -> (f64, f64) {
        let x = (decades(evaluations) - self.work.0) / (self.work.1 - self.work.0);
        let y = (self.error.1 - digits(error)) / (self.error.1 - self.error.0);
        (x.clamp(0.0, 1.0), y.clamp(0.0, 1.0))
    }

    /// Powers of ten along the work.
    pub(super) fn ticks(&self) -> impl Iterator<Item = f64> {
        let (few, many) = self.work;
        std::iter::successors(Some(few), |decade| Some(decade + 1.0))
            .take_while(move |decade| *decade <= many)
    }
}

/// Decimal logarithm of an error (1).
pub(super) fn digits(error: f64) -> f64 {
    error.max(LEAST).log10()
}

#[allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
pub(super) fn decades(evaluations: u64) -> f64 {
    (evaluations.max(1) as f64).log10()
}

/// Methods in order of appearance with their marks.
pub(super) fn marks(study: &Study) -> Vec<Mark> {
    let mut methods: Vec<&'static str> = Vec::new();
    for point in &study.points {
        if !methods.contains(&point.method) {
            methods.push(point.method);
        }
    }
    let mark = |method: &&str| MARKS.iter().find(|(name, _, _)| name == method).copied();
    methods.into_iter().map(|name| mark(&name).unwrap_or((name, '?', "#000000"))).collect()
}
