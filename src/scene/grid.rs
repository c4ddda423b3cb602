//! The file of a sweep: its scene, the values that are varied, and its runs.
//!
//! `[grid]` holds values of which every combination is run:
//! `["0.3 m/s", "0.6 m/s"]`, or `{ from = "1 N", to = "10 N", count = 5, spacing =
//! "logarithmic" }`.
//! `[random]` or `[latin_hypercube]` draws points between limits, `{ from = "1 N", to = "10 N"
//! }`, or
//! around a mean, `{ mean = "1.46 GPa", deviation = "5 %" }`. With both, all points are run at each
//! combination. Keys are the paths of the scene. Values and seed of a run follow from its number
//! alone.

use std::collections::BTreeMap;
use std::path::Path;

use rand_distr::{Distribution as _, StandardNormal, StandardUniform, Uniform};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng as _;
use sha2::{Digest, Sha256};

pub use super::adjust::number;

use super::adjust::is_whole;
use super::document::{Entries, Node, SourceLocation, Value, inline};
use super::library;
use super::problem::SceneError;
use super::problems::Problems;
use super::root::{ACCURACY, MAX_SEED};
use super::table::{Key, Keys, word, words};
use super::table::{Places, TableReader, any, count, quantity, table, table_of, text, texts};
use super::uncertainty::{SpreadAmount, spread_amount};
use crate::quantity::Dimension;

/// Most runs of a sweep: weeks of work, and gigabytes of results.
pub const MAX_RUNS: u64 = 100_000_000;
/// Most values of a range.
const MAX_VALUES: u64 = 10_000_000;
/// Most strata of a Latin hypercube, points by paths: they are in memory, 200 MB.
const MAX_STRATA: u64 = 50_000_000;

table! {
    /// The file.
    pub struct SweepKeys<'a> {
        title: &'a str = text(),
        /// an included scene, or a .toml file beside this one
        scene: &'a str =
            text().required().needs("the name of a scene, or the path of its file"),
        /// of first peaks and arrivals; default: the scene's own
        accuracy: f64 = quantity(Dimension::NONE, ACCURACY),
        /// of all that is drawn
        seed: u64 = count(0, MAX_SEED).or("0"),
        /// runs of each point, each with its own seed
        repeat: u64 = count(1, MAX_RUNS).or("1"),
        /// sensors whose forces are read; default: all in particles, and the wall
        watch: Places<'a> = texts(),
        /// every combination of these
        grid: &'a Node = any(&[]),
        random: TableReader<'a> = table_of(&[SampleKeys::KEYS]),
        latin_hypercube: TableReader<'a> = table_of(&[SampleKeys::KEYS]),
    }
}

table! {
    /// `[random]` or `[latin_hypercube]`.
    pub struct SampleKeys<'a> {
        count: u64 = count(1, MAX_RUNS).required(),
        over: &'a Node = any(&[]),
    }
}

/// A value with its unit, whose dimension the scene's key decides.
const NUMBER: Key = any(&[]).required().needs("a number with its unit");

table! {
    /// A range.
    struct RangeKeys<'a> {
        from: &'a Node = NUMBER,
        to: &'a Node = NUMBER,
        spacing: Law = word::<Law>().or("linear"),
    }
}

table! {
    /// A range of a grid beside its ends.
    struct CountKeys<'a> {
        count: u64 = count(2, MAX_VALUES).required(),
    }
}

table! {
    /// A normal distribution.
    struct NormalKeys<'a> {
        mean: &'a Node = NUMBER,
        deviation: &'a Node = NUMBER,
    }
}

/// A sweep as its file describes it.
#[derive(Debug)]
pub struct Design {
    /// The file as typed.
    pub text: String,
    /// The scene that is varied, as [`crate::scene::Scene::load`] takes it.
    pub scene: String,
    /// Accuracy of all runs; none where it is the scene's (1).
    pub accuracy: Option<f64>,
    /// Seed that all others follow from.
    pub seed: u64,
    /// Runs of each point, each with its own seed.
    pub repeat: u64,
    /// Names of the places that are watched; none for all.
    pub watch: Option<Vec<String>>,
    factors: Vec<Factor>,
    sample: Option<Sample>,
}

/// Values of which every one is run.
#[derive(Debug)]
struct Factor {
    path: String,
    values: Vec<Node>,
}

/// Points that are drawn.
#[derive(Debug)]
struct Sample {
    count: u64,
    over: Vec<(String, Range)>,
    /// Of a Latin hypercube: for each range the stratum of each point.
    strata: Option<Vec<Vec<u32>>>,
}

/// How values are spread between the ends of a range.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Law {
    Linear,
    Logarithmic,
    /// Around a mean, with a standard deviation.
    Normal,
}

words! { Law { "linear" => Linear, "logarithmic" => Logarithmic } }

/// Numbers between two ends, or around a mean.
#[derive(Debug, Clone)]
struct Range {
    place: SourceLocation,
    law: Law,
    /// Both ends, or mean and standard deviation.
    ends: [f64; 2],
    dimension: Dimension,
    /// Whether both ends are whole numbers.
    whole: bool,
    /// Whether its numbers are drawn: between whole ends they are whole.
    drawn: bool,
}

impl Design {
    /// Loads the sweep in `file`.
    ///
    /// # Errors
    /// [`SceneError`]: not readable, or every problem found in it.
    pub fn load(file: &Path) -> Result<Self, SceneError> {
        const WHAT: &str = "the sweep";
        let node = library::open_file(file, "a sweep, e.g. grid.toml")
            .map_err(|error| error.in_file(WHAT))?;
        let problems = Problems::default();
        let design = read(file, &node, &problems);
        problems.finish(design).map_err(|problems| SceneError::InFile { what: WHAT, problems })
    }

    /// Paths of all that is varied: the grid's, then the sample's.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        let sampled = self.sample.iter().flat_map(|sample| &sample.over);
        let factors = self.factors.iter().map(|factor| factor.path.as_str());
        factors.chain(sampled.map(|(path, _)| path.as_str()))
    }

    /// For each path the SI unit of its numbers; none where not all of its values are numbers of
    /// one kind.
    pub fn units(&self) -> Vec<Option<String>> {
        let factor = |factor: &Factor| {
            let mut numbers =
                factor.values.iter().map(|node| number(&factor.path, node).map(|(_, d)| d));
            let first = numbers.next().flatten()?;
            numbers.all(|other| other == Some(first)).then(|| first.unit())
        };
        let sampled = self.sample.iter().flat_map(|sample| &sample.over);
        let sampled = sampled.map(|(_, range)| Some(range.unit()));
        self.factors.iter().map(factor).chain(sampled).collect()
    }

    /// How many runs it has.
    pub fn count(&self) -> u64 {
        self.points().map_or(0, |points| points * self.repeat)
    }

    /// How many points; none if too many for the number's type.
    fn points(&self) -> Option<u64> {
        let grid = self
            .factors
            .iter()
            .try_fold(1_u64, |count, factor| count.checked_mul(factor.values.len() as u64))?;
        grid.checked_mul(self.sample.as_ref().map_or(1, |sample| sample.count))
    }
}

fn read(file: &Path, node: &Node, problems: &Problems) -> Option<Design> {
    let keys = SweepKeys::read(&TableReader::of(node, "", &[SweepKeys::KEYS], problems)?);
    let root = &keys.table;
    let mut factors = Vec::new();
    for (path, node) in leaves(keys.grid, "grid", problems) {
        let values = grid_values(&path, node, problems)?;
        factors.push(Factor { path, values });
    }
    let (tables, latin) = match (&keys.random, &keys.latin_hypercube) {
        (random, None) => (random, false),
        (None, latin) => (latin, true),
        (random, Some(_)) => {
            let expected = "one of [random] and [latin_hypercube]";
            root.problem("latin_hypercube", "a second sample", expected);
            (random, false)
        }
    };
    let sample = tables.as_ref().map(|table| sample(table, latin));
    if !["grid", "random", "latin_hypercube"].iter().any(|key| root.has(key)) {
        let expected = "[grid], [random] or [latin_hypercube] with values of the scene";
        root.problem("grid", "nothing that is varied", expected);
    }
    let watch = keys.watch.map(|names| names.iter().map(|(name, _)| (*name).to_owned()).collect());
    let repeat = keys.repeat?;
    let mut design = Design {
        text: node.place.text().to_string(),
        scene: beside(file, keys.scene?),
        accuracy: keys.accuracy,
        seed: keys.seed?,
        repeat,
        watch,
        factors,
        sample: match sample {
            Some(sample) => Some(sample?),
            None => None,
        },
    };
    let runs = design.points().and_then(|points| points.checked_mul(repeat));
    if runs.is_none_or(|runs| runs > MAX_RUNS) {
        problems.push(&node.place, "", "more runs", format!("at most {MAX_RUNS} runs"));
        return None;
    }
    let mut varied = BTreeMap::new();
    for path in design.paths() {
        *varied.entry(path).or_insert(0) += 1;
    }
    for (path, _) in varied.iter().filter(|(_, times)| **times > 1) {
        problems.push(
            &node.place,
            path,
            "a path that is varied twice",
            "either a grid or a sample",
        );
    }
    design.stratify();
    Some(design)
}

/// Path of a scene that is a file, which is relative to the sweep's.
fn beside(file: &Path, scene: &str) -> String {
    let path = Path::new(scene);
    let is_file = scene.contains(['/', '\\']) || path.extension().is_some_and(|e| e == "toml");
    match file.parent().filter(|_| is_file && path.is_relative()) {
        Some(folder) => folder.join(path).display().to_string(),
        None => scene.to_owned(),
    }
}

fn sample(table: &TableReader<'_>, latin: bool) -> Option<Sample> {
    let keys = SampleKeys::read(table);
    let path = table.path_of("over");
    if !table.has("over") {
        table.missing("over", format!("[{path}] with limits of values"));
    }
    let mut over = Vec::new();
    for (path, node) in leaves(keys.over, &path, table.problems()) {
        let range = limits(&path, node, latin, table.problems())?;
        over.push((path, range));
    }
    let count = keys.count?;
    let strata = count.saturating_mul(over.len() as u64);
    if latin && strata > MAX_STRATA {
        let found = format!("{count} points of {} values", over.len());
        table.problem("count", found, format!("at most {MAX_STRATA} values, or [random]"));
        return None;
    }
    Some(Sample { count, over, strata: latin.then(Vec::new) })
}

/// Values and ranges in a tree of tables, each with its path in the scene.
fn leaves<'a>(node: Option<&'a Node>, key: &str, problems: &Problems) -> Vec<(String, &'a Node)> {
    let Some(node) = node else { return Vec::new() };
    let Value::Table(table) = &node.value else {
        problems.push(&node.place, key, node.describe(), "a table");
        return Vec::new();
    };
    let mut found = Vec::new();
    for (key, entry) in &**table {
        match &entry.node.value {
            Value::Table(inner) if !is_range(inner) => {
                let deeper = leaves(Some(&entry.node), key, problems);
                found.extend(deeper.into_iter().map(|(rest, n)| (format!("{key}.{rest}"), n)));
            }
            _ => found.push((key.to_string(), &entry.node)),
        }
    }
    found
}

/// Whether a table of a sweep is a range and no table of the scene.
fn is_range(table: &Entries) -> bool {
    table.contains_key("from") || table.contains_key("mean")
}

/// A node as TOML has it, on one line; text without its quotes.
pub fn typed(node: &Node) -> String {
    node.as_text().map_or_else(|| inline(node), str::to_owned)
}

/// All values of a grid's entry; `None`, and a problem, if it is wrong.
fn grid_values(path: &str, node: &Node, problems: &Problems) -> Option<Vec<Node>> {
    match &node.value {
        Value::List(items) if items.is_empty() => {
            let expected = "values, or { from = ..., to = ..., count = ... }";
            problems.push(&node.place, path, "an empty list", expected);
            None
        }
        Value::List(items) => Some(items.to_vec()),
        Value::Table(_) => {
            let keys = &[RangeKeys::KEYS, CountKeys::KEYS];
            let table = TableReader::of(node, path, keys, problems)?;
            let range = range(path, &table, node, false);
            let count = CountKeys::read(&table).count;
            let (range, count) = (range?, count?);
            let share = |index: u64| index as f64 / (count - 1) as f64;
            let values: Vec<Node> = (0..count).map(|index| range.at(share(index))).collect();
            let fraction = |node: &&Node| !matches!(node.value, Value::Number { whole: true, .. });
            if let (true, Some(value)) = (is_whole(path), values.iter().find(fraction)) {
                let found = format!("a range with {}", typed(value));
                let expected = "whole numbers: another `count`, or a list of values";
                table.problem("count", found, expected);
                return None;
            }
            Some(values)
        }
        _ => Some(vec![node.clone()]),
    }
}

/// The limits of a sample's entry; `None`, and a problem, if it is wrong.
fn limits(path: &str, node: &Node, latin: bool, problems: &Problems) -> Option<Range> {
    let Value::Table(entries) = &node.value else {
        let expected = "{ from = ..., to = ... }";
        problems.push(&node.place, path, node.describe(), expected);
        return None;
    };
    let is_normal = entries.contains_key("mean");
    let keys: Keys = if is_normal { &[NormalKeys::KEYS] } else { &[RangeKeys::KEYS] };
    let table = TableReader::of(node, path, keys, problems)?;
    let range =
        if is_normal { normal(path, &table, node) } else { range(path, &table, node, true) };
    if latin && is_normal {
        let expected = "from and to: a normal distribution has no strata of equal width";
        table.problem("mean", "a normal distribution", expected);
    }
    if let Some(range) = &range
        && is_whole(path)
        && !range.whole
    {
        table.problem("", "a range of other numbers", "from and to as whole numbers");
    }
    range
}

/// The number of `key` at `path` of the scene.
fn end(path: &str, table: &TableReader<'_>, key: &str, node: &Node) -> Option<(f64, Dimension)> {
    let found = number(path, node);
    if found.is_none() {
        table.problem(key, node.describe(), NUMBER.needs);
    }
    found
}

fn range(path: &str, table: &TableReader<'_>, node: &Node, drawn: bool) -> Option<Range> {
    let keys = RangeKeys::read(table);
    let first = keys.from.and_then(|node| end(path, table, "from", node));
    let second = keys.to.and_then(|node| end(path, table, "to", node));
    let ((first, dimension), (second, other)) = (first?, second?);
    if other != dimension {
        table.problem("to", other.to_string(), format!("{dimension}, as `from`"));
        return None;
    }
    let law = keys.spacing?;
    if law == Law::Logarithmic && !(first > 0.0 && second > 0.0) {
        table.problem("from", "an end that is not above zero", "both ends above zero");
        return None;
    }
    let is_whole = |node: Option<&Node>| {
        matches!(node.map(|node| &node.value), Some(Value::Number { whole: true, .. }))
    };
    let whole = is_whole(keys.from) && is_whole(keys.to);
    let ends = [first, second];
    Some(Range { place: node.place.clone(), law, ends, dimension, whole, drawn })
}

/// `{ mean = ..., deviation = ... }`; the deviation is read as uncertainties of scenes are.
fn normal(path: &str, table: &TableReader<'_>, node: &Node) -> Option<Range> {
    let keys = NormalKeys::read(table);
    let mean = keys.mean.and_then(|node| end(path, table, "mean", node));
    let deviation = keys.deviation?;
    let (mean, dimension) = mean?;
    let amount = match spread_amount(deviation) {
        Some(SpreadAmount::Absolute(_, found)) if found != dimension => None,
        amount => amount,
    };
    let Some(amount) = amount else {
        let expected =
            format!("{dimension} of zero or more, as `mean`, or a share of it, e.g. \"5 %\"");
        table.problem("deviation", deviation.describe(), expected);
        return None;
    };
    let ends = [mean, amount.of(mean)];
    let place = node.place.clone();
    Some(Range { place, law: Law::Normal, ends, dimension, whole: false, drawn: true })
}

impl Range {
    /// The value at `share` of the way from end to end, or `share` standard deviations from the
    /// mean (1), to twelve digits.
    fn at(&self, share: f64) -> Node {
        let [first, second] = self.ends;
        let (low, high) = (first.min(second), first.max(second));
        let value = match self.law {
            // Each of the whole numbers has an equal part of the interval from `low` to `high + 1`.
            Law::Linear if self.whole && self.drawn => {
                (low + (high - low + 1.0) * share).floor().min(high)
            }
            Law::Logarithmic if self.whole && self.drawn => {
                (low * ((high + 1.0) / low).powf(share)).floor().clamp(low, high)
            }
            Law::Linear => first + (second - first) * share,
            Law::Logarithmic => first * (second / first).powf(share),
            Law::Normal => first + second * share,
        };
        let value = format!("{value:.11e}").parse().unwrap_or(value);
        self.node(value)
    }

    fn is_normal(&self) -> bool {
        self.law == Law::Normal
    }

    fn unit(&self) -> String {
        self.dimension.unit()
    }

    fn node(&self, value: f64) -> Node {
        let value = if self.dimension == Dimension::NONE {
            let whole = self.whole && value.fract() == 0.0;
            Value::Number { typed: value.to_string().into(), value, whole }
        } else {
            Value::Text(format!("{value:e} {}", self.dimension.unit()).into())
        };
        Node { place: self.place.clone(), value }
    }
}

/// One run.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// Values of all paths, in the order of [`Design::paths`].
    pub values: Vec<Node>,
    /// Which of the repetitions of the same values, from 1.
    pub repeat: u64,
    /// Seed of everything random in it: it follows from the values alone, below 2^53.
    pub seed: u64,
}

impl Design {
    /// Run number `index`, from 0: the last path of the grid changes fastest, the points of the
    /// sample within it, repetitions within them.
    pub fn run(&self, index: u64) -> PlannedRun {
        let (mut rest, repeat) = (index / self.repeat, index % self.repeat + 1);
        let mut values = Vec::new();
        if let Some(sample) = &self.sample {
            let point = rest % sample.count;
            rest /= sample.count;
            values.extend((0..sample.over.len()).rev().map(|i| self.drawn(sample, i, point)));
        }
        for factor in self.factors.iter().rev() {
            let count = factor.values.len() as u64;
            let place = usize::try_from(rest % count).unwrap_or_default();
            values.push(factor.values[place].clone());
            rest /= count;
        }
        values.reverse();
        let seed = self.seed_of(&values, repeat);
        PlannedRun { values, repeat, seed }
    }

    fn seed_of(&self, values: &[Node], repeat: u64) -> u64 {
        let mut key = Sha256::new();
        key.update(format!("{}\n{repeat}\n", self.seed));
        for (path, value) in self.paths().zip(values) {
            key.update(format!("{path} = {}\n", typed(value)));
        }
        let digest = key.finalize();
        // Eleven bits fewer than eight bytes hold.
        digest.iter().take(8).fold(0_u64, |seed, byte| seed << 8 | u64::from(*byte)) >> 11
    }

    /// The value of path number `place` at point number `point` of the sample.
    fn drawn(&self, sample: &Sample, place: usize, point: u64) -> Node {
        let (path, range) = &sample.over[place];
        let mut stream = stream(&format!("{}\n{path}\n{point}", self.seed));
        if range.is_normal() {
            return range.at(StandardNormal.sample(&mut stream));
        }
        let within: f64 = StandardUniform.sample(&mut stream);
        let stratum = sample
            .strata
            .as_ref()
            .and_then(|strata| strata.get(place)?.get(usize::try_from(point).ok()?));
        range.at(match stratum {
            Some(stratum) => (f64::from(*stratum) + within) / sample.count as f64,
            None => within,
        })
    }

    /// Draws the strata of a Latin hypercube: for each path every one of them once, in an order of
    /// its own.
    pub(super) fn stratify(&mut self) {
        let seed = self.seed;
        let Some(Sample { count, over, strata: Some(strata) }) = &mut self.sample else { return };
        for (path, _) in over {
            let mut stream = stream(&format!("{seed}\n{path}\nstrata"));
            let mut order: Vec<u32> = (0..u32::try_from(*count).unwrap_or(u32::MAX)).collect();
            // Fisher and Yates.
            for last in (1..order.len()).rev() {
                if let Ok(places) = Uniform::new_inclusive(0, last) {
                    order.swap(last, places.sample(&mut stream));
                }
            }
            strata.push(order);
        }
    }
}

/// Random numbers that follow from `key`.
fn stream(key: &str) -> Pcg64 {
    Pcg64::from_seed(Sha256::digest(key).into())
}
