//! One statement on all peaks, delays and speeds of a comparison.
//!
//! Each normalised error alone is above 1 in 5 % of cases, so the largest of fourteen is in many
//! more. What the largest is for benches that are as stated is found from the drawn benches: each
//! takes the measurement's place, with errors of both records drawn anew, and its largest `E_n` is
//! noted. Their 95 % quantile is the limit: a bench that is as stated stays below it in 95 % of
//! cases, however its quantities go together and are distributed. Sources: P. H. Westfall, S. S.
//! Young, "Resampling-Based Multiple Testing" (1993), section 2.3 (the largest of several
//! statistics); G. A. Barnard, J. R. Stat. Soc. B 25, 294 (1963) (tests by simulation). Valid as
//! far as the scene's `[uncertainty]` and the records' own uncertainties are.

use std::collections::BTreeMap;

use rand_distr::{Distribution, StandardNormal, StandardUniform};
use rand_pcg::Pcg64;
use serde::Serialize;

use crate::numeric::statistics::quantile;

/// Benches that are as stated pass in this share of cases (1).
const LEVEL: f64 = 0.95;
/// Number of drawn measurements, at least: the limit's share is known to 0.4 %.
const MEASUREMENTS: usize = 4000;
/// Stream of the draws.
const ERROR_STREAM: u128 = 1 << 76;

/// A quantity in the test.
pub(super) struct JointQuantity {
    /// `|m - s|/sqrt(U_m^2 + U_s^2)` of the measurement (1).
    pub e_n: f64,
    /// `sqrt(U_m^2 + U_s^2)` (unit).
    pub expanded: f64,
    /// Each drawn bench less the middle of the prediction, none where it has no such output (unit).
    pub drawn: Vec<Option<f64>>,
    /// Errors of both records.
    pub own: Vec<OwnError>,
}

/// An error of one record; those of the same name are the same.
pub(super) struct OwnError {
    /// What errs: `CH2 arrival, measured`.
    pub name: String,
    /// Change of the difference with one standard score of the normal part (unit).
    pub normal: f64,
    /// Half-width of the even part (unit).
    pub half_width: f64,
}

/// The largest normalised error of peaks, delays and speeds, and what it is for benches that are as
/// stated.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct JointTest {
    /// Number of peaks, delays and speeds.
    pub quantities: usize,
    /// Largest `E_n` of them (1).
    #[serde(rename = "largest_E_n")]
    pub largest: f64,
    /// Benches that are as stated stay below this in 95 % of cases (1).
    #[serde(rename = "limit_E_n")]
    pub limit: f64,
    /// Share of benches as stated whose largest `E_n` is at least as large (1).
    pub probability: f64,
}

impl JointTest {
    /// The test of `quantities`, with errors drawn from `seed`; none without quantities or benches.
    pub(super) fn of(quantities: &[JointQuantity], seed: u64) -> Option<Self> {
        let benches = quantities.first()?.drawn.len();
        let mut numbers = Pcg64::new(u128::from(seed), ERROR_STREAM);
        let mut drawn = Vec::new();
        for _ in 0..MEASUREMENTS.div_ceil(benches.max(1)) {
            drawn.extend((0..benches).filter_map(|bench| largest(quantities, bench, &mut numbers)));
        }
        drawn.sort_unstable_by(f64::total_cmp);
        let largest = quantities.iter().map(|quantity| quantity.e_n).fold(0.0, f64::max);
        let beyond = drawn.len() - drawn.partition_point(|other| *other < largest);
        (!drawn.is_empty()).then(|| Self {
            quantities: quantities.len(),
            largest,
            limit: quantile(&drawn, LEVEL),
            // The measurement is one of the draws, if the bench is as stated.
            probability: (beyond + 1) as f64 / (drawn.len() + 1) as f64,
        })
    }

    /// What is asked, as a comparison's tolerance.
    pub fn tolerance(&self) -> String {
        format!("E_n of {} peaks, delays and speeds up to {:.2}", self.quantities, self.limit)
    }

    /// What was found, as a note.
    pub fn words(&self) -> String {
        format!(
            "largest E_n of peaks, delays and speeds {:.2}: {:.2} % of benches as stated have a larger one, 5 % one above {:.2}",
            self.largest,
            100.0 * self.probability,
            self.limit
        )
    }
}

/// The largest `E_n` if `bench` were measured, with errors from `numbers`; none where it has none
/// of the outputs.
fn largest(quantities: &[JointQuantity], bench: usize, numbers: &mut Pcg64) -> Option<f64> {
    let mut scores: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
    let mut largest: Option<f64> = None;
    for quantity in quantities {
        let Some(mut difference) = quantity.drawn[bench] else { continue };
        for own in &quantity.own {
            let [normal, even] = *scores.entry(&own.name).or_insert_with(|| {
                let even: f64 = StandardUniform.sample(numbers);
                [StandardNormal.sample(numbers), 2.0 * even - 1.0]
            });
            difference += own.normal * normal + own.half_width * even;
        }
        let e_n = difference.abs() / quantity.expanded;
        largest = Some(largest.map_or(e_n, |other| other.max(e_n)));
    }
    largest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numeric::intervals::NORMAL_95;

    /// A quantity of no bench's doing, with an error of standard uncertainty 1.
    fn noise(name: &str) -> JointQuantity {
        let own = OwnError { name: name.to_owned(), normal: 1.0, half_width: 0.0 };
        JointQuantity { e_n: 0.5, expanded: NORMAL_95, drawn: vec![Some(0.0); 100], own: vec![own] }
    }

    /// One quantity has the limit 1, and 0.5 is exceeded in `2 Phi(-0.98)` = 32.7 % of cases; of
    /// two independent ones the largest is below 2.2365/1.9600 in 95 % (Šidák: each in 97.47 %);
    /// the same error twice is one.
    #[test]
    fn limits_are_those_of_independent_quantities() {
        let test = |quantities: &[JointQuantity]| JointTest::of(quantities, 1).expect("a test");
        let (one, same) = (test(&[noise("a")]), test(&[noise("a"), noise("a")]));
        for found in [one, same] {
            assert!((found.limit - 1.0).abs() < 0.03, "{found:?}");
            assert!((found.probability - 0.327).abs() < 0.03, "{found:?}");
        }
        let two = test(&[noise("a"), noise("b")]);
        assert!((two.limit - 1.1411).abs() < 0.03, "{two:?}");
    }

    /// Benches go together, too: the same ones in two quantities are one, and those without an
    /// output count by what they have.
    #[test]
    fn benches_that_go_together_are_counted_once() {
        let even = |bench: usize| (bench as f64 + 0.5) / 50.0 - 1.0;
        let quantity = |without: usize| JointQuantity {
            e_n: 0.2,
            expanded: 1.0,
            drawn: (0..100).map(|bench| (bench >= without).then(|| even(bench))).collect(),
            own: Vec::new(),
        };
        let found = JointTest::of(&[quantity(0), quantity(30)], 1).expect("a test");
        assert!((found.limit - 0.95).abs() < 0.02, "{found:?}");
        assert!((found.probability - 0.8).abs() < 0.01, "{found:?}");
        assert_eq!(found.quantities, 2);
        assert_eq!(JointTest::of(&[], 1), None);
    }
}
