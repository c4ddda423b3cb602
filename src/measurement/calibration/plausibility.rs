//! A plan's numbers as the calibration takes them, and what in them cannot be.

use crate::analysis::calibration::model::{Common, SpeedSource};
use crate::analysis::calibration::{Calibration, Exclusion, ImpactResult};
use crate::quantity::Uncertain;
use crate::scene::plan::{CalibrationPlan, SpeedMethod};
/// What the impacts of `plan` share.
pub fn common(plan: &CalibrationPlan) -> Common {
    let number = |u: f64| Uncertain::normal(1.0, u);
    Common {
        strikers: plan.strikers.clone(),
        gain: plan.gain.unwrap_or(number(0.0)),
        speed_scale: number(plan.speed_scale_u),
        gate_distance: plan.gate_distance,
        gravity: plan.gravity,
        tau: plan.tau,
        above: plan.above,
    }
}

pub(super) fn speed((means, value): (SpeedMethod, Uncertain)) -> SpeedSource {
    match means {
        SpeedMethod::Speed => SpeedSource::Speed(value),
        SpeedMethod::Height => SpeedSource::Height(value),
        SpeedMethod::GateTime => SpeedSource::GateTime(value),
        SpeedMethod::FlightTime => SpeedSource::FlightTime(value),
    }
}

/// A scatter that many times what the inputs explain is no chance: with six impacts normal errors
/// exceed it in 2 of 10,000 calibrations (1).
const LARGEST_BIRGE_RATIO: f64 = 2.2;
/// Of so many impacts one may be left out as an outlier.
const MOST_OUTLIERS: usize = 4;
/// A sensitivity with a larger expanded uncertainty over its value is not determined (1).
const MAX_EXPANDED_SHARE: f64 = 0.5;
/// Local gravity at the surface, mountains included (m/s^2).
const GRAVITY: std::ops::RangeInclusive<f64> = 9.76..=9.84;

/// What in `plan` cannot be, or cannot be together.
pub(super) fn contradictions(plan: &CalibrationPlan, found: &Calibration) -> Vec<String> {
    let mut wrong = Vec::new();
    if found.birge_ratio >= LARGEST_BIRGE_RATIO {
        wrong.push(format!(
            "impacts scatter {:.1} times as much as their uncertainties explain: check heights, speeds, masses and their units",
            found.birge_ratio
        ));
    }
    let all = found.impacts.len();
    let is_outlier =
        |impact: &&ImpactResult| matches!(impact.exclusion, Some(Exclusion::Outlier { .. }));
    let outliers = found.impacts.iter().filter(is_outlier).count();
    if outliers * MOST_OUTLIERS > all {
        wrong.push(format!(
            "{outliers} of {all} impacts lie far from the others: check their heights, speeds, masses and units"
        ));
    }
    if !GRAVITY.contains(&plan.gravity.value) {
        wrong.push(format!(
            "free fall of {} m/s^2 is found nowhere on the ground, where it is 9.76 to 9.84 m/s^2",
            plan.gravity.value
        ));
    }
    let common = common(plan);
    for (number, impact) in (1..).zip(&plan.impacts) {
        let speeds = [impact.incoming, impact.rebound].map(|told| {
            let speed = speed(told);
            let (gravity, gates) = (common.gravity.value, common.gate_distance);
            let at = |reading| speed.of(reading, gravity, gates.map_or(f64::NAN, |g| g.value));
            (at(told.1.value), (at(told.1.value + told.1.u) - at(told.1.value)).abs())
        });
        let [(came, came_u), (left, left_u)] = speeds;
        if left - came > 2.0 * came_u.hypot(left_u) {
            wrong.push(format!(
                "impact {number}: the striker leaves at {left:.4} m/s, faster than it came at {came:.4} m/s"
            ));
        }
    }
    let is_determined = found.expanded() <= MAX_EXPANDED_SHARE * found.sensitivity.abs();
    if !is_determined {
        let share = 100.0 * found.expanded() / found.sensitivity.abs();
        wrong.push(format!("the sensitivity is known to {share:.0} % only: it is not determined"));
    }
    wrong
}
