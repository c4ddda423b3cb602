//! The work-precision study as text and picture: peak error against force evaluations, both on logarithmic axes.

use std::fmt::Write as _;

use super::table;
use crate::experiment::cost::{Point, Study};
use crate::quantity::engineering;

/// Columns and rows of the terminal's plot.
const CELLS: (usize, usize) = (72, 22);
/// Size of the picture and margins around the plot.
const PICTURE: (f64, f64) = (860.0, 560.0);
const MARGIN: (f64, f64) = (80.0, 50.0);
/// Letters and colours of the methods in order of appearance.
const MARKS: [(char, &str); 10] = [
    ('v', "#4477aa"),
    ('p', "#66ccee"),
    ('b', "#228833"),
    ('6', "#ccbb44"),
    ('8', "#ee6677"),
    ('d', "#aa3377"),
    ('x', "#888888"),
    ('y', "#444444"),
    ('w', "#cc6600"),
    ('z', "#996633"),
];

/// Decades spanned by the plot.
struct Axes {
    work: (f64, f64),
    error: (f64, f64),
}

impl Axes {
    fn of(study: &Study) -> Self {
        let shown = || study.points.iter().filter(|p| !p.failed);
        let work = shown().map(|p| decades(p.force_evaluations));
        let errors = shown().filter_map(|p| p.error_peak).map(|e| e.max(1e-16).log10());
        let range = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
        };
        let (low, high) = range(&mut errors.chain([study.reference.error.max(1e-16).log10()]));
        let (few, many) = range(&mut work.into_iter());
        Self { work: (few.floor(), many.ceil()), error: (low.floor(), high.ceil().min(0.0)) }
    }

    /// Place of an error (1, from the top) and a number of evaluations (from the left), both from 0 to 1.
    fn place(&self, evaluations: u64, error: f64) -> (f64, f64) {
        let x = (decades(evaluations) - self.work.0) / (self.work.1 - self.work.0);
        let y = (self.error.1 - error.max(1e-16).log10()) / (self.error.1 - self.error.0);
        (x, y)
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts far below 2^53")]
fn decades(evaluations: u64) -> f64 {
    (evaluations.max(1) as f64).log10()
}

/// Methods in order of appearance with their marks.
fn marks(study: &Study) -> Vec<(&'static str, char, &'static str)> {
    let mut methods: Vec<&'static str> = Vec::new();
    for point in &study.points {
        if !methods.contains(&point.method) {
            methods.push(point.method);
        }
    }
    methods.into_iter().zip(MARKS).map(|(method, (mark, colour))| (method, mark, colour)).collect()
}

/// The page that `cost` prints.
#[must_use]
pub fn work_precision(study: &Study) -> String {
    let mut lines = vec![format!(
        "{}: largest relative error of first peaks against evaluations of all contact forces",
        study.scene
    )];
    lines.extend(plot(study));
    lines.push(String::new());
    let heading = ["method", "mark", "nominal order", "observed here", "failed points"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for (method, mark, _) in marks(study) {
        let order = study.orders.iter().find(|o| o.method == method);
        let failed = study.points.iter().filter(|p| p.method == method && p.failed).count();
        rows.push(vec![
            method.to_owned(),
            mark.to_string(),
            order.map_or(String::new(), |o| o.nominal.to_string()),
            order.and_then(|o| o.observed).map_or("-".to_owned(), |o| format!("{o:.1}")),
            failed.to_string(),
        ]);
    }
    lines.extend(table::lines(&rows, &[0]));
    lines.push(String::new());
    lines.extend(choices(study));
    lines.push(format!(
        "reference: {}, {:.1e} from a second tight solution by another method",
        study.reference.method, study.reference.error
    ));
    lines.join("\n")
}

fn choices(study: &Study) -> Vec<String> {
    let heading = ["--accuracy", "method chosen", "error reached", "evaluations", "wall time"];
    let mut rows = vec![heading.map(str::to_owned).to_vec()];
    for chosen in &study.chosen {
        // The nearest point of the same method that was timed.
        let distance = |p: &&Point| (p.setting / chosen.setting).ln().abs();
        let timed = study.points.iter().filter(|p| p.method == chosen.method && !p.failed);
        let nearest = timed.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        rows.push(vec![
            format!("{:e}", chosen.accuracy),
            chosen.method.to_owned(),
            chosen.error.map_or("-".to_owned(), |e| format!("{e:.1e}")),
            chosen.force_evaluations.to_string(),
            nearest.map_or("-".to_owned(), |p| {
                format!("about {}", engineering(p.wall_s_median, "s", 2))
            }),
        ]);
    }
    let mut lines = table::lines(&rows, &[1]);
    let level = study
        .level
        .map_or(String::new(), |l| format!("one scope level is {l:.1e} of a first peak, "));
    lines.push(format!("  {level}one sample interval {:.1e} of an arrival", study.sample));
    lines
}

#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "places on a screen of a few dozen cells"
)]
fn plot(study: &Study) -> Vec<String> {
    let axes = Axes::of(study);
    let (columns, rows) = CELLS;
    let mut cells = vec![vec![' '; columns]; rows];
    let row_of = |y: f64| (y.clamp(0.0, 1.0) * (rows - 1) as f64).round() as usize;
    let line = study.level.map(|level| row_of(axes.place(1, level).1));
    if let Some(row) = line.and_then(|line| cells.get_mut(line)) {
        row.fill('·');
    }
    for (method, mark, _) in marks(study) {
        for point in study.points.iter().filter(|p| p.method == method) {
            let Some(error) = point.error_peak.filter(|_| !point.failed) else { continue };
            let (x, y) = axes.place(point.force_evaluations, error);
            let column = (x.clamp(0.0, 1.0) * (columns - 1) as f64).round() as usize;
            if let Some(cell) = cells.get_mut(row_of(y)).and_then(|row| row.get_mut(column)) {
                *cell = mark;
            }
        }
    }
    let span = axes.error.1 - axes.error.0;
    let mut lines = Vec::new();
    let mut labelled = f64::NAN;
    for (index, row) in cells.iter().enumerate() {
        let exponent = (axes.error.1 - span * index as f64 / (rows - 1) as f64).round();
        let label =
            if (exponent - labelled).abs() < 0.5 { String::new() } else { format!("1e{exponent}") };
        labelled = exponent;
        let text: String = row.iter().collect();
        lines.push(format!("{label:>6} |{}", text.trim_end()));
    }
    lines.push(format!("{:>6} +{}", "", "-".repeat(columns)));
    let (few, many) = axes.work;
    let (left, right) = (format!("1e{few}"), format!("1e{many} evaluations"));
    lines.push(format!("{:>8}{left}{right:>width$}", "", width = columns - left.len()));
    if study.level.is_some() {
        lines.push("        · · · one level of the scope's digitiser".to_owned());
    }
    lines
}

/// The study as an SVG picture.
#[must_use]
pub fn work_precision_svg(study: &Study) -> String {
    let axes = Axes::of(study);
    let ((width, height), (left, top)) = (PICTURE, MARGIN);
    let (across, down) = (width - left - 250.0, height - 2.0 * top);
    let at = |x: f64, y: f64| (left + x * across, top + y * down);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n\
         <text x=\"{left}\" y=\"28\" font-size=\"15\">{}: error of first peaks against work</text>\n",
        study.scene
    );
    grid(&mut svg, &axes, &at);
    if let Some(level) = study.level {
        let ((x0, y), (x1, _)) = (at(0.0, axes.place(1, level).1), at(1.0, 0.0));
        let _ = writeln!(
            svg,
            "<path d=\"M{x0:.1} {y:.1}H{x1:.1}\" stroke=\"#555\" stroke-dasharray=\"6 4\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"#555\">one scope level</text>",
            x1 - 4.0,
            y - 5.0
        );
    }
    for (index, (method, _, colour)) in marks(study).into_iter().enumerate() {
        curve(&mut svg, study, (method, colour), &|evaluations, error| {
            let (x, y) = axes.place(evaluations, error);
            at(x, y.clamp(0.0, 1.0))
        });
        let observed = study.orders.iter().find(|o| o.method == method).and_then(|o| o.observed);
        let order = observed.map_or(String::new(), |o| format!(", order {o:.1}"));
        let y = top + 20.0 * f64::from(u8::try_from(index).unwrap_or(0)) + 10.0;
        let x = left + across + 16.0;
        let _ = writeln!(
            svg,
            "<text x=\"{x}\" y=\"{y}\" fill=\"{colour}\" font-size=\"11\">{method}{order}</text>"
        );
    }
    svg.push_str("</svg>\n");
    svg
}

fn grid(svg: &mut String, axes: &Axes, at: &dyn Fn(f64, f64) -> (f64, f64)) {
    let ((few, many), (low, high)) = (axes.work, axes.error);
    let (corner, end) = (at(0.0, 0.0), at(1.0, 1.0));
    let mut decade = few;
    while decade <= many {
        let (x, _) = at((decade - few) / (many - few), 0.0);
        let _ = writeln!(
            svg,
            "<path d=\"M{x:.1} {:.1}V{:.1}\" stroke=\"#ddd\"/><text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\">1e{decade}</text>",
            corner.1,
            end.1,
            end.1 + 18.0
        );
        decade += 1.0;
    }
    let mut decade = low;
    while decade <= high {
        let (_, y) = at(0.0, (high - decade) / (high - low));
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>",
            corner.0,
            end.0,
            corner.0 - 6.0,
            y + 4.0
        );
        decade += 1.0;
    }
    let _ = writeln!(
        svg,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">evaluations of all contact forces</text>",
        0.5 * (corner.0 + end.0),
        end.1 + 38.0
    );
}

fn curve(
    svg: &mut String,
    study: &Study,
    (method, colour): (&str, &str),
    at: &dyn Fn(u64, f64) -> (f64, f64),
) {
    let mut path = String::new();
    for point in study.points.iter().filter(|p| p.method == method && !p.failed) {
        let Some(error) = point.error_peak else { continue };
        let (x, y) = at(point.force_evaluations, error);
        let _ = write!(path, "{}{x:.1} {y:.1}", if path.is_empty() { 'M' } else { 'L' });
        let _ = writeln!(svg, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3\" fill=\"{colour}\"/>");
    }
    let _ = writeln!(svg, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\"/>");
    for point in study.points.iter().filter(|p| p.method == method && p.failed) {
        let (x, y) = at(point.force_evaluations.max(1), 1.0);
        if point.force_evaluations > 0 {
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\" stroke=\"{colour}\"/>",
                x - 4.0,
                y - 4.0
            );
        }
    }
}
