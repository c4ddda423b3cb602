//! The design of a sweep as data.

use super::range::Range;
use crate::scene::document::Node;

/// A sweep as its file describes it.
#[derive(Debug)]
pub struct Design {
    /// The file's name.
    pub file: String,
    /// The file as typed.
    pub text: String,
    /// The scene that is varied, as [`crate::scene::Scene::load`] takes it.
    pub scene: String,
    /// Accuracy of all runs; none where it is the scene's (1).
    pub accuracy: Option<f64>,
    /// Seed that all others follow from.
    pub seed: u64,
    /// How often each point is run, with seeds of its own.
    pub repeat: u64,
    /// Names of the places that are watched; none for all.
    pub watch: Option<Vec<String>>,
    pub(super) factors: Vec<Factor>,
    pub(super) sample: Option<Sample>,
}

/// Values of which every one is run.
#[derive(Debug)]
pub(super) struct Factor {
    pub(super) path: String,
    pub(super) values: Vec<Node>,
}

/// Points that are drawn.
#[derive(Debug)]
pub(super) struct Sample {
    pub(super) count: u64,
    pub(super) over: Vec<(String, Range)>,
    /// Of a Latin hypercube: for each range the stratum of each point.
    pub(super) strata: Option<Vec<Vec<u32>>>,
}
