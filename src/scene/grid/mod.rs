//! The file of a sweep: which scene, which of its values are varied, and how.
//!
//! `[grid]` holds values of which every combination is run; `[random]` or `[latin_hypercube]` draws
//! points between limits. With both, all points are run at each combination. Values stand at the
//! paths that they have in the scene.

mod design;
mod range;
mod runs;

pub use design::Design;
pub use range::{number, typed};
pub use runs::PlannedRun;

use std::collections::BTreeMap;
use std::path::Path;

use self::design::{Factor, Sample};
use super::document::{Node, Value};
use super::files::read_text;
use super::problem::{MISSING, Problem, SceneError, listed};
use super::reader::{Bound, Problems, TableReader};
use super::{LOOSEST_ACCURACY, MAX_SEED, TIGHTEST_ACCURACY};
use crate::quantity::Dimension;

/// Most runs of a sweep: weeks of work, and gigabytes of results.
pub const MAX_RUNS: u64 = 100_000_000;
/// Tables of a design of which there may be one.
const SAMPLES: [(&str, bool); 2] = [("random", false), ("latin_hypercube", true)];

/// Why there is no sweep.
#[derive(Debug, thiserror::Error)]
pub enum DesignError {
    /// The file could not be read.
    #[error(transparent)]
    Read(SceneError),
    /// No file of that name.
    #[error("found `{0}`, which is no file, expected the path of a sweep, e.g. grid.toml")]
    Unknown(String),
    /// It is wrong in at least one place.
    #[error("{}", listed(.0, "the sweep"))]
    Problems(Vec<Problem>),
}

impl Design {
    /// Loads the sweep in `file`.
    ///
    /// # Errors
    /// [`DesignError`]: not readable, or every problem found in it.
    pub fn load(file: &Path) -> Result<Self, DesignError> {
        let name = file.display().to_string();
        if !file.is_file() {
            return Err(DesignError::Unknown(name));
        }
        let text = read_text(file, &name).map_err(|error| match error {
            SceneError::Problems(problems) => DesignError::Problems(problems),
            error => DesignError::Read(error),
        })?;
        let node = Node::parse(&name, &text).map_err(DesignError::Problems)?;
        let problems = Problems::default();
        let design = read(file, &node, &problems);
        let problems = problems.into_sorted();
        match design {
            Some(design) if problems.is_empty() => Ok(design),
            _ => Err(DesignError::Problems(problems)),
        }
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
            let mut numbers = factor.values.iter().map(|node| number(node).map(|(_, d)| d));
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
    let root = TableReader::of(node, "", problems)?;
    let _ = root.text("title");
    let scene = root.required_text("scene", "the name of a scene, or the path of its file");
    let bound = Bound::Within(TIGHTEST_ACCURACY, LOOSEST_ACCURACY);
    let accuracy = root.quantity("accuracy", Dimension::NONE, bound);
    let seed = root.count("seed", 0, MAX_SEED).unwrap_or(0);
    let repeat = root.count("repeat", 1, MAX_RUNS).unwrap_or(1);
    let watch = root.has("watch").then(|| {
        root.texts("watch").into_iter().map(|(name, _)| name.to_owned()).collect::<Vec<_>>()
    });
    let mut factors = Vec::new();
    for (path, node) in leaves(root.node("grid"), "grid", problems) {
        let values = range::values(&path, node, problems)?;
        factors.push(Factor { path, values });
    }
    let sample = sample(&root, problems);
    let varies = ["grid", "random", "latin_hypercube"].iter().any(|key| root.has(key));
    if !varies {
        let expected = "[grid], [random] or [latin_hypercube] with values of the scene";
        root.problem("grid", "nothing that is varied", expected);
    }
    root.finish();
    let mut design = Design {
        file: file.display().to_string(),
        text: node.place.text().to_string(),
        scene: beside(file, scene?),
        accuracy,
        seed,
        repeat,
        watch,
        factors,
        sample,
    };
    let runs = design.points().and_then(|points| points.checked_mul(repeat));
    if runs.is_none_or(|runs| runs > MAX_RUNS) {
        let expected = format!("at most {MAX_RUNS} runs");
        problems.push(node.place.problem("", "more runs".to_owned(), expected));
        return None;
    }
    let mut varied = BTreeMap::new();
    for path in design.paths() {
        *varied.entry(path).or_insert(0) += 1;
    }
    for (path, _) in varied.iter().filter(|(_, times)| **times > 1) {
        let found = "a path that is varied twice".to_owned();
        problems.push(node.place.problem(path, found, "either a grid or a sample".to_owned()));
    }
    design.stratify();
    Some(design)
}

/// A scene that is a file lies beside the sweep's.
fn beside(file: &Path, scene: &str) -> String {
    let path = Path::new(scene);
    let is_file = scene.contains(['/', '\\']) || path.extension().is_some_and(|e| e == "toml");
    match file.parent().filter(|_| is_file && path.is_relative()) {
        Some(folder) => folder.join(path).display().to_string(),
        None => scene.to_owned(),
    }
}

fn sample(root: &TableReader<'_>, problems: &Problems) -> Option<Sample> {
    let mut tables = SAMPLES
        .iter()
        .filter_map(|(key, latin)| root.table(key).map(|table| (table, *key, *latin)));
    let (table, key, latin) = tables.next()?;
    if let Some((_, second, _)) = tables.next() {
        root.problem(second, "a second sample", "one of [random] and [latin_hypercube]");
    }
    let count = table.required_count("count", 1, MAX_RUNS);
    let mut over = Vec::new();
    if !table.has("over") {
        table.problem("over", MISSING, format!("[{key}.over] with limits of values"));
    }
    for (path, node) in leaves(table.node("over"), &format!("{key}.over"), problems) {
        over.push((path.clone(), range::limits(&path, node, latin, problems)?));
    }
    table.finish();
    Some(Sample { count: count?, over, strata: latin.then(Vec::new) })
}

/// Values and ranges in a tree of tables, each with its path in the scene.
fn leaves<'a>(node: Option<&'a Node>, key: &str, problems: &Problems) -> Vec<(String, &'a Node)> {
    let Some(node) = node else { return Vec::new() };
    let Value::Table(table) = &node.value else {
        problems.push(node.place.problem(key, node.describe(), "a table".to_owned()));
        return Vec::new();
    };
    let mut found = Vec::new();
    for (key, entry) in &**table {
        match &entry.node.value {
            Value::Table(inner) if !range::is_range(inner) => {
                let deeper = leaves(Some(&entry.node), key, problems);
                found.extend(deeper.into_iter().map(|(rest, n)| (format!("{key}.{rest}"), n)));
            }
            _ => found.push((key.to_string(), &entry.node)),
        }
    }
    found
}
