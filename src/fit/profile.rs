//! How chi squared rises beside the minimum where one parameter is held and all others follow.
//!
//! A parameter whose profile is no parabola has no symmetric uncertainty: its 95 % interval ends
//! where `chi^2` has risen by `3.84 s^2`. Source: W. H. Press et al., "Numerical Recipes", 3rd ed.
//! (2007), section 15.6.5 (confidence limits by constant chi squared).

use serde::Serialize;

use super::model::TraceModel;
use crate::analysis::least_squares::{LeastSquaresProblem, Minimum, StopCriteria, minimise};
use crate::numeric::intervals::NORMAL_95;
use crate::scene::adjust::AdjustableNumber;

/// Where the parameter is held, in standard deviations from the minimum (1).
const PROFILE_POSITIONS: [f64; 6] = [-3.0, -2.0, -1.0, 1.0, 2.0, 3.0];
/// A larger relative standard uncertainty is called bad (1).
const BAD_UNCERTAINTY: f64 = 0.1;
/// A larger correlation with another parameter is called bad (1).
const BAD_CORRELATION: f64 = 0.95;

/// The profile of one number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Profile {
    /// The number's path.
    pub path: String,
    /// Values (SI units) and by how much chi squared is larger there, in residual variances.
    pub points: Vec<(f64, f64)>,
    /// Ends of the 95 % interval in SI units; none where chi squared does not rise enough within
    /// three standard deviations, or the scene allows no such value (unit).
    pub interval_95: [Option<f64>; 2],
}

/// Whether parameter `place` is badly determined.
pub fn is_bad(x: &[f64], covariance: &[Vec<f64>], place: usize) -> bool {
    let u = |j: usize| covariance[j][j].sqrt();
    let correlated = (0..x.len())
        .filter(|other| *other != place)
        .any(|other| (covariance[place][other] / (u(place) * u(other))).abs() > BAD_CORRELATION);
    correlated || u(place) > BAD_UNCERTAINTY * x[place].abs()
}

/// A problem with one parameter held.
struct FixedParameter<'a, 'b> {
    model: &'a mut TraceModel<'b>,
    place: usize,
    value: f64,
}

impl FixedParameter<'_, '_> {
    fn whole(&self, x: &[f64]) -> Vec<f64> {
        let mut whole = x.to_vec();
        whole.insert(self.place, self.value);
        whole
    }
}

impl LeastSquaresProblem for FixedParameter<'_, '_> {
    fn counted(&self, at: &[f64]) -> usize {
        self.model.counted(at)
    }

    fn residuals(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        self.model.residuals(&self.whole(x))
    }

    fn columns(&mut self, x: &[f64], at: &[f64]) -> Option<Vec<Vec<f64>>> {
        let mut columns = self.model.columns(&self.whole(x), at)?;
        columns.remove(self.place);
        Some(columns)
    }
}

/// The profile of the number `knob`, parameter `place`.
pub fn of(
    model: &mut TraceModel<'_>,
    (minimum, covariance): (&Minimum, &[Vec<f64>]),
    (place, knob): (usize, &AdjustableNumber),
    limits: StopCriteria,
) -> Profile {
    let variance = minimum.variance();
    let (middle, spread) = (minimum.x[place], covariance[place][place]);
    let mut points = vec![(middle, 0.0)];
    for at in PROFILE_POSITIONS {
        let value = middle + at * spread.sqrt();
        // The others start where the covariance says that they go.
        let along =
            |other: usize| minimum.x[other] + covariance[place][other] / spread * (value - middle);
        let start: Vec<f64> = (0..minimum.x.len()).filter(|j| *j != place).map(along).collect();
        let mut held = FixedParameter { model: &mut *model, place, value };
        if let Ok(found) = minimise(&mut held, &start, limits) {
            points.push((value, (found.chi_squared - minimum.chi_squared) / variance));
        }
    }
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let here =
        points.iter().position(|(value, _)| value.to_bits() == middle.to_bits()).unwrap_or(0);
    let above: Vec<(f64, f64)> = points[here..].to_vec();
    let below: Vec<(f64, f64)> = points[..=here].iter().rev().copied().collect();
    let si = |factor: f64| factor * knob.value;
    Profile {
        path: knob.path.clone(),
        interval_95: [crossing(&below).map(si), crossing(&above).map(si)],
        points: points.iter().map(|(value, rise)| (si(*value), *rise)).collect(),
    }
}

/// Where the root of the rise, which is straight for a parabola, reaches that of 95 %.
fn crossing(points: &[(f64, f64)]) -> Option<f64> {
    points.windows(2).find_map(|pair| {
        let [(near, low), (far, high)] =
            [pair[0], pair[1]].map(|(x, rise)| (x, rise.max(0.0).sqrt()));
        let reached = low <= NORMAL_95 && high >= NORMAL_95;
        reached.then(|| near + (far - near) * (NORMAL_95 - low) / (high - low))
    })
}
