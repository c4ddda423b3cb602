//! Axes and marks of the diagram, on paper and in a terminal.

use crate::quantity::engineering;
use crate::studies::cost::{ChosenMethod, CostStudy, Point};

/// Letters and colours of the methods, on paper and in a terminal (SGR codes): the same in every
/// study.
pub(super) const MARKS: [MethodMark; 8] = [
    ("velocity-verlet", 'v', "#4477aa", 34),
    ("force-gradient", 'f', "#999933", 33),
    ("runge-kutta-4", 'r', "#aa3377", 35),
    ("two-step-force-gradient", 'g', "#00aa99", 36),
    ("dormand-el-mikkawy-prince-86", '8', "#ee6677", 31),
    ("dormand-prince-54", '5', "#882255", 95),
    ("dormand-prince-853", 'd', "#332288", 94),
    ("rodas", 's', "#888888", 32),
];

/// Errors below this are rounding (1).
pub(super) const MIN_ERROR: f64 = 1e-16;

/// A method with its letter and colours.
pub(super) type MethodMark = (&'static str, char, &'static str, u8);

/// The abscissa: work or time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum WorkMeasure {
    /// Median wall time of a run.
    #[default]
    Time,
    /// Evaluations of all contact forces.
    Evaluations,
}

impl WorkMeasure {
    /// Of a point; none where its time was not measured (s, or 1) (unit).
    pub(super) fn of(self, point: &Point) -> Option<f64> {
        let work = match self {
            Self::Time => point.wall_s_median,
            Self::Evaluations => point.force_evaluations as f64,
        };
        (work > 0.0).then_some(work)
    }

    /// Of what an accuracy comes to (s, or 1) (unit).
    fn of_chosen(self, chosen: &ChosenMethod) -> f64 {
        match self {
            Self::Time => chosen.wall_s_median,
            Self::Evaluations => chosen.force_evaluations as f64,
        }
    }

    /// Its name on an axis.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Time => "time of one run",
            Self::Evaluations => "evaluations of all contact forces",
        }
    }

    /// A power of ten on its axis.
    pub(super) fn tick(self, decade: f64) -> String {
        match self {
            Self::Time => engineering(10_f64.powf(decade), "s", 3),
            Self::Evaluations => format!("1e{decade}"),
        }
    }
}

/// The ordinate: peaks, arrivals, energy or momentum.
pub(super) struct PlottedQuantity {
    /// Of what the errors are.
    pub(super) of: &'static str,
    pub(super) error: fn(&Point) -> Option<f64>,
    pub(super) chosen: fn(&ChosenMethod) -> Option<f64>,
    /// The scope's resolution, and its name.
    pub(super) limit: fn(&CostStudy) -> Option<f64>,
    pub(super) limit_name: &'static str,
}

pub(super) const PLOTTED_QUANTITIES: [PlottedQuantity; 4] = [
    PlottedQuantity {
        of: "first peaks",
        error: |point| point.error_peak,
        chosen: |chosen| chosen.error_peak,
        limit: |study| study.level,
        limit_name: "one level of the scope's digitiser",
    },
    PlottedQuantity {
        of: "arrivals",
        error: |point| point.error_arrival,
        chosen: |chosen| chosen.error_arrival,
        // A peak at the start is no time to measure by.
        limit: |study| Some(study.sample).filter(|sample| sample.is_finite()),
        limit_name: "one sample interval of the scope",
    },
    PlottedQuantity {
        of: "traces",
        error: |point| point.error_trace,
        chosen: |chosen| chosen.error_trace,
        limit: |study| study.level,
        limit_name: "one level of the scope's digitiser",
    },
    PlottedQuantity {
        of: "the energy in motion",
        error: |point| point.error_energy,
        chosen: |chosen| chosen.error_energy,
        limit: |_| None,
        limit_name: "",
    },
];

impl PlottedQuantity {
    /// Points that can be shown: work and errors.
    pub(super) fn shown<'a>(
        &'a self,
        study: &'a CostStudy,
        work: WorkMeasure,
        method: &str,
    ) -> impl Iterator<Item = (f64, f64)> {
        let points = study.points.iter().filter(move |p| p.method == method && !p.failed);
        points.filter_map(move |p| Some((work.of(p)?, (self.error)(p)?)))
    }

    /// Choice of `--accuracy`: accuracy, work and error.
    pub(super) fn choices<'a>(
        &'a self,
        study: &'a CostStudy,
        work: WorkMeasure,
    ) -> impl Iterator<Item = (f64, f64, f64)> {
        let all = study.chosen.iter();
        all.filter_map(move |c| Some((c.accuracy, work.of_chosen(c), (self.chosen)(c)?)))
    }
}

/// Decades spanned by a plot.
pub(super) struct Axes {
    pub(super) work: (f64, f64),
    pub(super) error: (f64, f64),
}

impl Axes {
    pub(super) fn of(study: &CostStudy, kind: &PlottedQuantity, work: WorkMeasure) -> Self {
        let shown = || study.points.iter().filter(|p| !p.failed);
        let choices = || kind.choices(study, work);
        // Failed points are shown beyond the errors.
        let taken = study.points.iter().filter_map(|point| work.of(point));
        let work = taken.chain(choices().map(|(_, work, _)| work));
        let errors = shown().filter_map(kind.error).chain(choices().map(|(_, _, error)| error));
        let (work, errors) = (work.map(f64::log10), errors.map(digits));
        let limits = [Some(study.reference.error), (kind.limit)(study)];
        let limits = limits.into_iter().flatten().filter(|limit| *limit < 1.0).map(digits);
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
        };
        let (low, high) = range(&mut errors.chain(limits));
        let (few, many) = range(&mut work.into_iter());
        Self { work: (few.floor(), many.ceil()), error: (low.floor(), high.ceil().min(0.0)) }
    }

    /// Place of an amount of work (from the left) and an error (1, from the top), both from 0 to 1.
    pub(super) fn place(&self, work: f64, error: f64) -> (f64, f64) {
        let x = (work.log10() - self.work.0) / (self.work.1 - self.work.0);
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
    error.max(MIN_ERROR).log10()
}

/// Methods in order of appearance with their marks.
pub(super) fn marks(study: &CostStudy) -> Vec<MethodMark> {
    let mut methods: Vec<&'static str> = Vec::new();
    for point in &study.points {
        if !methods.contains(&point.method) {
            methods.push(point.method);
        }
    }
    let mark = |method: &&str| MARKS.iter().find(|(name, ..)| name == method).copied();
    methods.into_iter().map(|name| mark(&name).unwrap_or((name, '?', "#000000", 37))).collect()
}
