//! The runs of a sweep: values and seed of each follow from its number alone.

use rand_distr::{Distribution as _, StandardNormal, StandardUniform, Uniform};
use rand_pcg::Pcg64;
use rand_pcg::rand_core::SeedableRng as _;
use sha2::{Digest, Sha256};

use super::design::{Design, Sample};
use super::range::typed;
use crate::scene::document::Node;

/// One run.
#[derive(Debug, Clone)]
pub struct PlannedRun {
    /// Values of all paths, in the order of [`Design::paths`].
    pub values: Vec<Node>,
    /// Which of the repetitions of the same values, from 1.
    pub repeat: u64,
    /// Seed of everything random in it: the same wherever a run with these values stands, below
    /// 2^53.
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
