//! The measurement equation with all its inputs in one vector, so that what impacts share is
//! shared.

use super::data::CalibrationError;
use super::impact::Impact;
pub use super::inputs::{Common, InputKind, InputQuantity, SpeedSource, StrikerMotion};
use super::tail::{Tail, mean};
use crate::numeric::intervals::effective_freedom;
use crate::quantity::Uncertain;
use std::ops::Range;

/// One impact within the model.
#[derive(Debug, Clone, PartialEq)]
struct ImpactModel {
    impact: Impact,
    motion: StrikerMotion,
    tail: Option<Tail>,
    tail_weight: f64,
    /// Weight in the mean.
    weight: f64,
    /// Own standard uncertainty (V/N).
    own: f64,
}

/// The measurement equation of a whole calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementEquation {
    inputs: Vec<InputQuantity>,
    parts: Vec<ImpactModel>,
    places: Vec<usize>,
    strikers: usize,
    fitted: bool,
}

/// Places of the shared inputs; masses come next, then [`INPUTS_PER_IMPACT`] inputs for each
/// impact, then scatter and non-linearity.
const GAIN: usize = 0;
const SCALE: usize = 1;
const GRAVITY: usize = 2;
const GATES: usize = 3;
const TAU: usize = 4;
const ABOVE: usize = 5;
const MASSES: usize = 6;
/// Step of a difference quotient over the estimate: its error is the square of this, or rounding
/// over this, 1e-8 and 1e-12 of the derivative (1).
const DIFFERENCE_SHARE: f64 = 1e-4;
/// Inputs of an impact's own: two speeds, baseline, noise, duration, tail.
const INPUTS_PER_IMPACT: usize = 6;

impl MeasurementEquation {
    /// Puts the impacts, each with its place in the plan, and what they share together; none
    /// without a time constant.
    pub(super) fn new<'a>(
        impacts: impl Iterator<Item = (usize, &'a Impact, &'a StrikerMotion, Option<&'a Tail>)>,
        common: &Common,
    ) -> Option<Self> {
        let mut model = Self {
            inputs: common.inputs(),
            parts: Vec::new(),
            places: Vec::new(),
            strikers: common.strikers.len(),
            fitted: common.tau.is_none(),
        };
        for (place, impact, motion, tail) in impacts {
            model.places.push(place);
            model.parts.push(ImpactModel {
                impact: impact.clone(),
                motion: *motion,
                tail: tail.copied(),
                tail_weight: 0.0,
                weight: 0.0,
                own: 0.0,
            });
        }
        model.weigh_tails();
        let tau = model.tau();
        if !(tau > 0.0 && tau.is_finite()) {
            return None;
        }
        for index in 0..model.parts.len() {
            model.add_own_inputs(index, tau);
        }
        for kind in [InputKind::Scatter, InputKind::NonLinearity] {
            let which = String::new();
            model.inputs.push(InputQuantity {
                kind,
                which,
                value: 0.0,
                u: 0.0,
                is_even: false,
                unit: "V/N",
            });
        }
        model.weigh_impacts();
        model.add_scatter();
        Some(model)
    }

    fn weigh_tails(&mut self) {
        let weight = |part: &ImpactModel| part.tail.map_or(0.0, |tail| tail.weight());
        let sum: f64 = self.parts.iter().map(weight).sum();
        for part in &mut self.parts {
            part.tail_weight = weight(part) / sum;
        }
    }

    fn add_own_inputs(&mut self, index: usize, tau: f64) {
        let Some(ImpactModel { impact, motion, tail, .. }) = self.parts.get(index) else { return };
        let which = format!("impact {}", self.places.get(index).map_or(0, |place| place + 1));
        let input = |kind, value, u, unit| InputQuantity {
            kind,
            which: which.clone(),
            value,
            u,
            is_even: false,
            unit,
        };
        let speed = |kind, speed: SpeedSource| {
            let (quantity, unit) = speed.quantity();
            input(kind, quantity.value, quantity.u, unit)
        };
        let tail_u = tail.map_or(0.0, |tail| tail.noise_u);
        let own = [
            speed(InputKind::Incoming, motion.incoming),
            speed(InputKind::Rebound, motion.rebound),
            // What the baseline may be off; the level itself has been taken away.
            input(InputKind::Baseline, 0.0, impact.baseline.uncertainty, "V"),
            input(InputKind::Noise, 0.0, impact.noise_u(tau), "V*s"),
            input(InputKind::Duration, impact.duration, impact.duration_u, "s"),
            input(InputKind::Tail, 0.0, if self.fitted { tail_u } else { 0.0 }, "1/s"),
        ];
        self.inputs.extend(own);
    }

    /// Fails if the uncertainty of an input is not finite or exceeds its value. Offsets, whose
    /// estimate is zero, and inputs without uncertainty pass.
    pub(super) fn check_inputs(&self) -> Result<(), CalibrationError> {
        let is_unknown = |input: &&InputQuantity| {
            let known = Uncertain::normal(input.value, input.u).is_known();
            input.u != 0.0 && !known && (input.value != 0.0 || !input.u.is_finite())
        };
        match self.inputs.iter().find(is_unknown) {
            None => Ok(()),
            Some(input) => Err(CalibrationError::UnknownInput {
                input: input.name(),
                value: input.value,
                u: input.u,
                unit: input.unit,
            }),
        }
    }

    /// The mean takes each impact by what its own inputs leave uncertain.
    fn weigh_impacts(&mut self) {
        let estimates = self.estimates();
        let inverse_tau = self.inverse_tau(&estimates);
        let own: Vec<f64> = (0..self.parts.len())
            .map(|index| {
                let first = self.first_own(index);
                let alone = |values: &[f64]| self.one(index, values, inverse_tau);
                let parts = self.contributions(first..first + INPUTS_PER_IMPACT, &alone);
                parts.iter().map(|part| part * part).sum::<f64>().sqrt()
            })
            .collect();
        let floor = f64::EPSILON * self.one(0, &estimates, inverse_tau).abs();
        let weight = |own: f64| 1.0 / own.max(floor).powi(2);
        let sum: f64 = own.iter().map(|own| weight(*own)).sum();
        for (part, own) in self.parts.iter_mut().zip(own) {
            part.own = own;
            part.weight = weight(own) / sum;
        }
    }

    /// Where impacts differ more than their own inputs explain, the rest is an input of its own.
    fn add_scatter(&mut self) {
        let unexplained = self.birge_ratio().powi(2) - 1.0;
        if unexplained > 0.0 {
            let u = (unexplained * self.explained()).sqrt();
            self.set_u(InputKind::Scatter, u);
        }
    }

    /// Variance of the mean from the impacts' own inputs (V^2/N^2).
    fn explained(&self) -> f64 {
        self.parts.iter().map(|part| (part.weight * part.own).powi(2)).sum()
    }

    /// Gives one of the inputs at the end its standard uncertainty (V/N).
    pub(super) fn set_u(&mut self, kind: InputKind, u: f64) {
        if let Some(input) = self.inputs.iter_mut().find(|input| input.kind == kind) {
            input.u = u;
        }
    }

    /// Effective degrees of freedom of the sensitivity's standard uncertainty `u` (V/N): where the
    /// impacts scatter more than their own inputs explain, their part is known from that scatter
    /// alone (1).
    pub(super) fn freedom(&self, u: f64) -> f64 {
        let ratio = self.birge_ratio();
        if ratio <= 1.0 {
            return f64::INFINITY;
        }
        let own = (ratio * self.explained().sqrt(), (self.parts.len().max(2) - 1) as f64);
        let rest = (u * u - own.0 * own.0).max(0.0).sqrt();
        effective_freedom([own, (rest, f64::INFINITY)])
    }

    /// Root of chi squared over the degrees of freedom, of the impacts about their mean (1).
    pub fn birge_ratio(&self) -> f64 {
        let mean = self.sensitivity();
        let squares = self.each().into_iter().map(|(s, u)| ((s - mean) / u).powi(2));
        (squares.sum::<f64>() / (self.parts.len().max(2) - 1) as f64).sqrt()
    }

    /// The inputs.
    pub fn inputs(&self) -> &[InputQuantity] {
        &self.inputs
    }

    /// Places of the impacts in the plan.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// All inputs at their estimates (unit).
    pub fn estimates(&self) -> Vec<f64> {
        self.inputs.iter().map(|input| input.value).collect()
    }

    fn first_own(&self, index: usize) -> usize {
        MASSES + self.strikers + INPUTS_PER_IMPACT * index
    }

    /// `1/tau` (1/s): the one given, or the mean of what the records tell, each with its baseline.
    fn inverse_tau(&self, values: &[f64]) -> f64 {
        if !self.fitted {
            return values.get(TAU).map_or(f64::NAN, |tau| 1.0 / tau);
        }
        let part = |(index, part): (usize, &ImpactModel)| {
            let Some(tail) = &part.tail else { return 0.0 };
            let first = self.first_own(index);
            let at = |place: usize| values.get(first + place).copied().unwrap_or(0.0);
            // The noise of the contact's samples is in the integral and in what leaks away of it.
            let leaking = tail.per_baseline * at(2) + tail.per_integral * at(3);
            part.tail_weight * (tail.inverse_tau + leaking + at(5))
        };
        self.parts.iter().enumerate().map(part).sum()
    }

    /// Sensitivity of impact `index` alone.
    fn one(&self, index: usize, values: &[f64], inverse_tau: f64) -> f64 {
        let Some(ImpactModel { impact, motion, .. }) = self.parts.get(index) else {
            return f64::NAN;
        };
        let at = |place: usize| values.get(place).copied().unwrap_or(f64::NAN);
        let first = self.first_own(index);
        let (gravity, gates) = (at(GRAVITY), at(GATES));
        let speeds = motion.incoming.of(at(first), gravity, gates)
            + motion.rebound.of(at(first + 1), gravity, gates);
        let handed = at(MASSES + motion.striker) * (at(SCALE) * speeds + gravity * at(first + 4));
        let momentum = handed * (1.0 - at(ABOVE));
        let integral = impact.integral_off(inverse_tau, at(first + 2)) + at(first + 3);
        at(GAIN) * integral / momentum
    }

    /// The sensitivity (V/N) for given values of all inputs (V/N).
    pub fn evaluate(&self, values: &[f64]) -> f64 {
        let inverse_tau = self.inverse_tau(values);
        let parts = self.parts.iter().enumerate();
        let mean: f64 =
            parts.map(|(index, part)| part.weight * self.one(index, values, inverse_tau)).sum();
        mean + values.iter().rev().take(2).sum::<f64>()
    }

    /// The time constant for given values of all inputs (s).
    pub fn evaluate_tau(&self, values: &[f64]) -> f64 {
        1.0 / self.inverse_tau(values)
    }

    /// The sensitivity (V/N).
    pub fn sensitivity(&self) -> f64 {
        self.evaluate(&self.estimates())
    }

    /// The time constant (s).
    pub fn tau(&self) -> f64 {
        self.evaluate_tau(&self.estimates())
    }

    /// Standard uncertainty of the time constant (s).
    pub fn tau_u(&self) -> f64 {
        let parts = self.contributions(0..self.inputs.len(), &|values| self.evaluate_tau(values));
        parts.iter().map(|part| part * part).sum::<f64>().sqrt()
    }

    /// The time constant from the records' ends, with its standard uncertainty, used or not (s).
    pub fn tail_tau(&self) -> Option<(f64, f64)> {
        let (inverse, u) = mean(self.parts.iter().filter_map(|part| part.tail.as_ref()))?;
        Some((1.0 / inverse, u / (inverse * inverse)))
    }

    /// Each impact's sensitivity and its own standard uncertainty (V/N).
    pub fn each(&self) -> Vec<(f64, f64)> {
        let estimates = self.estimates();
        let inverse_tau = self.inverse_tau(&estimates);
        let parts = self.parts.iter().enumerate();
        parts.map(|(i, part)| (self.one(i, &estimates, inverse_tau), part.own)).collect()
    }

    /// Each input's contribution to the uncertainty of the sensitivity (V/N).
    pub fn contributions_to_sensitivity(&self) -> Vec<f64> {
        self.contributions(0..self.inputs.len(), &|values| self.evaluate(values))
    }

    /// Half-width of the largest contribution that is evenly distributed; all others count as
    /// normal (V/N).
    pub fn half_width(&self, contributions: &[f64]) -> f64 {
        let even = self.inputs.iter().zip(contributions).filter(|(input, _)| input.is_even);
        3f64.sqrt() * even.map(|(_, part)| part.abs()).fold(0.0, f64::max)
    }

    /// Contributions of the inputs `range` to the uncertainty of `output`: the standard uncertainty
    /// times the sensitivity coefficient, `output`'s derivative at the estimates (JCGM 100:2008,
    /// 5.1.3), by central differences over [`DIFFERENCE_SHARE`] of the estimate (unit).
    fn contributions(&self, range: Range<usize>, output: &dyn Fn(&[f64]) -> f64) -> Vec<f64> {
        let mut values = self.estimates();
        let inputs = self.inputs.iter().enumerate().take(range.end).skip(range.start);
        let contribution = |(index, input): (usize, &InputQuantity)| {
            if input.u == 0.0 {
                return 0.0;
            }
            // Inputs with an estimate of zero are offsets, in which the result is nearly straight.
            let size = if input.value == 0.0 { input.u } else { input.value.abs() };
            let step = DIFFERENCE_SHARE * size;
            let mut at = |value: f64| {
                values[index] = value;
                output(&values)
            };
            let difference = at(input.value + step) - at(input.value - step);
            at(input.value);
            difference / (2.0 * step) * input.u
        };
        inputs.map(contribution).collect()
    }
}
