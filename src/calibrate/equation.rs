//! The measurement equation of a calibration and the propagation of its inputs' uncertainty.
//!
//! `S` is the weighted mean of the impacts' `gain * integral / momentum`, plus what scatter and
//! non-linearity leave open. What impacts share is one input, so that it does not average out.
//! `u^2 = sum of (c_i u_i)^2`, with the sensitivity coefficients `c_i` the derivatives at the
//! estimates. Source: JCGM 100:2008, 5.1.2 and 5.1.3. Valid where the result is nearly linear over
//! the uncertainties, which [`super::monte_carlo`] checks.

use serde::{Serialize, Serializer};

use super::error::CalibrationError;
use super::impact::Impact;
use super::tail::{Tail, mean};
use crate::numeric::intervals::effective_freedom;
use crate::quantity::Uncertain;

/// How a speed is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpeedSource {
    /// Directly (m/s).
    Speed(Uncertain),
    /// From the height that the striker falls from, or rises to: `sqrt(2 g h)` (m).
    Height(Uncertain),
    /// From the time between two light gates: their distance over it (s).
    GateTime(Uncertain),
    /// From the time until the striker comes back: `g t/2` (s).
    FlightTime(Uncertain),
}

impl SpeedSource {
    /// The reading and its unit.
    fn quantity(self) -> (Uncertain, &'static str) {
        match self {
            Self::Speed(q) => (q, "m/s"),
            Self::Height(q) => (q, "m"),
            Self::GateTime(q) | Self::FlightTime(q) => (q, "s"),
        }
    }

    /// Speed from the reading `raw`; a negative height counts as zero (m/s).
    pub fn of(self, raw: f64, gravity: f64, gates: f64) -> f64 {
        match self {
            Self::Speed(_) => raw,
            Self::Height(_) => (2.0 * gravity * raw.max(0.0)).sqrt(),
            Self::GateTime(_) => gates / raw,
            Self::FlightTime(_) => 0.5 * gravity * raw,
        }
    }
}

/// Mass and speeds of the striker of one impact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StrikerMotion {
    /// Which of the strikers, from 0.
    pub striker: usize,
    /// Before the contact.
    pub incoming: SpeedSource,
    /// After it, the other way.
    pub rebound: SpeedSource,
}

/// Inputs common to all impacts.
#[derive(Debug, Clone, PartialEq)]
pub struct Common {
    /// Name and mass of each striker (kg).
    pub strikers: Vec<(String, Uncertain)>,
    /// True voltage over what the scope shows (1).
    pub gain: Uncertain,
    /// True speed over what the set-up shows, the same for all speeds (1).
    pub speed_scale: Uncertain,
    /// Distance of the light gates, where there are any (m).
    pub gate_distance: Option<Uncertain>,
    /// Acceleration of free fall (m/s^2).
    pub gravity: Uncertain,
    /// Time constant, if it is not to be read off the records (s).
    pub tau: Option<Uncertain>,
    /// Mass above the plate over all that is set in motion: this part of the momentum stays above
    /// the plate (1).
    pub above: Uncertain,
}

/// Values of all inputs.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    gain: f64,
    speed_scale: f64,
    gravity: f64,
    gate_distance: f64,
    time_constant: f64,
    above: f64,
    zero: f64,
    bend: f64,
    masses: Vec<f64>,
    impacts: Vec<ImpactInputs>,
    scatter: f64,
    nonlinearity: f64,
}

/// Values of one impact's own inputs: readings of both speeds, and of its record what baseline,
/// integral and time constant are off, and the contact's duration.
#[derive(Debug, Clone, Copy, PartialEq)]
struct ImpactInputs {
    incoming: f64,
    rebound: f64,
    baseline: f64,
    noise: f64,
    duration: f64,
    tail: f64,
}

impl ImpactInputs {
    fn new(motion: &StrikerMotion, duration: f64) -> Self {
        let [incoming, rebound] = [motion.incoming, motion.rebound].map(|s| s.quantity().0.value);
        Self { incoming, rebound, baseline: 0.0, noise: 0.0, duration, tail: 0.0 }
    }
}

impl Inputs {
    /// The estimates of `common`, without any impact.
    fn new(common: &Common) -> Self {
        let or_none = |quantity: Option<Uncertain>| quantity.map_or(f64::NAN, |q| q.value);
        Self {
            gain: common.gain.value,
            speed_scale: common.speed_scale.value,
            gravity: common.gravity.value,
            gate_distance: or_none(common.gate_distance),
            time_constant: or_none(common.tau),
            above: common.above.value,
            zero: 0.0,
            bend: 0.0,
            masses: common.strikers.iter().map(|(_, mass)| mass.value).collect(),
            impacts: Vec::new(),
            scatter: 0.0,
            nonlinearity: 0.0,
        }
    }

    /// The value of input `kind`, of several that with this index; none if there is no such input.
    pub(super) fn get_mut(&mut self, kind: InputKind, index: usize) -> Option<&mut f64> {
        let own = self.impacts.get_mut(index);
        match kind {
            InputKind::Gain => Some(&mut self.gain),
            InputKind::SpeedScale => Some(&mut self.speed_scale),
            InputKind::Gravity => Some(&mut self.gravity),
            InputKind::GateDistance => Some(&mut self.gate_distance),
            InputKind::TimeConstant => Some(&mut self.time_constant),
            InputKind::Above => Some(&mut self.above),
            InputKind::Zero => Some(&mut self.zero),
            InputKind::ZeroBend => Some(&mut self.bend),
            InputKind::Mass => self.masses.get_mut(index),
            InputKind::Incoming => own.map(|own| &mut own.incoming),
            InputKind::Rebound => own.map(|own| &mut own.rebound),
            InputKind::Baseline => own.map(|own| &mut own.baseline),
            InputKind::Noise => own.map(|own| &mut own.noise),
            InputKind::Duration => own.map(|own| &mut own.duration),
            InputKind::Tail => own.map(|own| &mut own.tail),
            InputKind::Scatter => Some(&mut self.scatter),
            InputKind::NonLinearity => Some(&mut self.nonlinearity),
        }
    }

    /// Momentum that an impact hands over to the plate (N s).
    fn momentum(&self, motion: &StrikerMotion, own: &ImpactInputs) -> f64 {
        let mass = self.masses.get(motion.striker).copied().unwrap_or(f64::NAN);
        let speed =
            |source: SpeedSource, raw: f64| source.of(raw, self.gravity, self.gate_distance);
        let speeds = speed(motion.incoming, own.incoming) + speed(motion.rebound, own.rebound);
        mass * (self.speed_scale * speeds + self.gravity * own.duration) * (1.0 - self.above)
    }
}

impl Common {
    /// Momentum that an impact of `duration` (s) hands over, by all estimates (N s).
    pub fn momentum(&self, motion: &StrikerMotion, duration: f64) -> f64 {
        Inputs::new(self).momentum(motion, &ImpactInputs::new(motion, duration))
    }
}

/// Kind of an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum InputKind {
    /// The scope's gain.
    Gain,
    /// The scale of all speeds.
    SpeedScale,
    /// The acceleration of free fall.
    Gravity,
    /// The distance of the light gates.
    GateDistance,
    /// A given time constant.
    TimeConstant,
    /// The share of the momentum that stays above the plate.
    Above,
    /// The zero that all records of a quiet scope have in common, in standard uncertainties.
    Zero,
    /// What it does to the time constants beside a straight line, in standard uncertainties.
    ZeroBend,
    /// A striker's mass.
    Mass,
    /// A speed before the contact.
    Incoming,
    /// A speed after the contact.
    Rebound,
    /// A record's baseline, with what it does to a fitted time constant.
    Baseline,
    /// Noise and rounding in the integral.
    Noise,
    /// The contact's duration.
    Duration,
    /// Noise in the time constant's fit.
    Tail,
    /// Scatter of the impacts beyond all this.
    Scatter,
    /// How far the sensitivity is from its mean within the range of forces.
    NonLinearity,
}

impl InputKind {
    /// Its name in a table.
    pub fn name(self) -> &'static str {
        match self {
            Self::Gain => "scope gain",
            Self::SpeedScale => "scale of all speeds",
            Self::Gravity => "free fall",
            Self::GateDistance => "distance of the gates",
            Self::TimeConstant => "time constant",
            Self::Above => "inertia above the plate",
            Self::Zero => "zero of all records",
            Self::ZeroBend => "rounding behind all contacts",
            Self::Mass => "striker's mass",
            Self::Incoming => "impact speed",
            Self::Rebound => "rebound speed",
            Self::Baseline => "baseline",
            Self::Noise => "noise and rounding",
            Self::Duration => "contact duration",
            Self::Tail => "time constant's fit",
            Self::Scatter => "unexplained scatter",
            Self::NonLinearity => "non-linearity",
        }
    }

    fn is_impacts_own(self) -> bool {
        (Self::Incoming..=Self::Tail).contains(&self)
    }

    /// Type of its evaluation by JCGM 100:2008, 4.2 and 4.3: A from series of readings, here the
    /// records' samples and the scatter of impacts, or B by other means, here as the plan says.
    pub fn evaluation(self) -> char {
        if self >= Self::Baseline { 'A' } else { 'B' }
    }
}

/// An input of the measurement equation.
#[derive(Debug, Clone, PartialEq)]
pub struct InputQuantity {
    /// Its kind.
    pub kind: InputKind,
    /// Which of several: a striker, or an impact among those used, from 0.
    pub index: usize,
    /// The same in words, e.g. a striker's name or `impact 3`; empty where there is one only.
    pub which: String,
    /// Its estimate (unit).
    pub value: f64,
    /// Its standard uncertainty (unit).
    pub u: f64,
    /// Whether it is evenly distributed within `sqrt(3) u`, instead of normally.
    pub is_even: bool,
    /// Its unit.
    pub unit: &'static str,
}

impl InputQuantity {
    /// The only input of its kind.
    fn single(kind: InputKind, quantity: Uncertain, unit: &'static str) -> Self {
        Self {
            kind,
            index: 0,
            which: String::new(),
            value: quantity.value,
            u: quantity.u,
            is_even: quantity.half_width > 0.0,
            unit,
        }
    }

    /// Its name in a table.
    pub fn name(&self) -> String {
        let kind = self.kind.name();
        if self.which.is_empty() { kind.to_owned() } else { format!("{kind}, {}", self.which) }
    }
}

/// An input with its part in the uncertainty: a line of the budget.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BudgetLine {
    /// The input's kind.
    #[serde(skip)]
    pub kind: InputKind,
    /// Its name, with which one of several.
    #[serde(rename = "input")]
    pub name: String,
    /// Its estimate (unit).
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// Its standard uncertainty (unit).
    pub u: f64,
    /// Its contribution to the sensitivity's uncertainty (V/N).
    #[serde(rename = "contribution_v_per_n")]
    pub contribution: f64,
    /// Its share of the variance (1).
    pub share: f64,
    /// Derivative of the sensitivity by the input, in V/N over its unit (unit).
    #[serde(rename = "coefficient")]
    pub coefficient: f64,
    /// Its distribution.
    pub distribution: &'static str,
    /// Type of its evaluation, A or B.
    #[serde(rename = "type")]
    pub evaluation: char,
    /// Degrees of freedom of its standard uncertainty; infinite where it counts as known. Those of
    /// impacts' own inputs and of their scatter are the scatter's (1).
    #[serde(rename = "degrees_of_freedom", serialize_with = "finite_or_null")]
    pub freedom: f64,
}

/// Writes an infinite number as `null`, which JSON has.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde's signature")]
pub(super) fn finite_or_null<S: Serializer>(
    number: &f64,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    Some(number).filter(|number| number.is_finite()).serialize(serializer)
}

/// One impact within the equation.
#[derive(Debug, Clone, PartialEq)]
struct WeighedImpact {
    impact: Impact,
    motion: StrikerMotion,
    tail: Option<Tail>,
    tail_weight: f64,
    /// Weight in the mean.
    weight: f64,
    /// Standard uncertainty from its own inputs (V/N).
    own: f64,
}

impl WeighedImpact {
    /// What the zero that all records have in common is off in this one (V).
    fn common_zero(&self, inputs: &Inputs) -> f64 {
        let Impact { has_common_zero, baseline, .. } = &self.impact;
        if *has_common_zero { inputs.zero * baseline.uncertainty } else { 0.0 }
    }
}

/// The measurement equation of a whole calibration.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasurementEquation {
    inputs: Vec<InputQuantity>,
    estimates: Inputs,
    parts: Vec<WeighedImpact>,
    /// Places of the impacts in the plan.
    places: Vec<usize>,
    is_tau_fitted: bool,
}

/// Step of a difference quotient over the estimate: its error is the square of this, or rounding
/// over this, 1e-8 and 1e-12 of the derivative (1).
const DIFFERENCE_SHARE: f64 = 1e-4;

impl MeasurementEquation {
    /// Joins the impacts, each with its place in the plan, and what they share.
    ///
    /// # Errors
    /// [`CalibrationError`] without a time constant, or for an input whose uncertainty exceeds its
    /// value.
    pub(super) fn new<'a>(
        impacts: impl Iterator<Item = (usize, &'a Impact, &'a StrikerMotion, Option<&'a Tail>)>,
        common: &Common,
    ) -> Result<Self, CalibrationError> {
        let mut equation = Self {
            inputs: Vec::new(),
            estimates: Inputs::new(common),
            parts: Vec::new(),
            places: Vec::new(),
            is_tau_fitted: common.tau.is_none(),
        };
        for (place, impact, motion, tail) in impacts {
            equation.places.push(place);
            equation.estimates.impacts.push(ImpactInputs::new(motion, impact.duration));
            equation.parts.push(WeighedImpact {
                impact: impact.clone(),
                motion: *motion,
                tail: tail.copied(),
                tail_weight: 0.0,
                weight: 0.0,
                own: 0.0,
            });
        }
        equation.weigh_tails();
        let tau = equation.tau();
        if !(tau > 0.0 && tau.is_finite()) {
            return Err(CalibrationError::NoTimeConstant);
        }
        equation.inputs = equation.quantities(common, tau);
        equation.check_inputs()?;
        equation.weigh_impacts();
        equation.add_scatter();
        Ok(equation)
    }

    fn weigh_tails(&mut self) {
        let weight = |part: &WeighedImpact| part.tail.map_or(0.0, |tail| tail.weight());
        let sum: f64 = self.parts.iter().map(weight).sum();
        for part in &mut self.parts {
            part.tail_weight = weight(part) / sum;
        }
    }

    /// All inputs, with their uncertainties; scatter and non-linearity have none yet.
    fn quantities(&self, common: &Common, tau: f64) -> Vec<InputQuantity> {
        let none = Uncertain::normal(f64::NAN, 0.0);
        let single = InputQuantity::single;
        let mut inputs = vec![
            single(InputKind::Gain, common.gain, "1"),
            single(InputKind::SpeedScale, common.speed_scale, "1"),
            single(InputKind::Gravity, common.gravity, "m/s^2"),
            single(InputKind::GateDistance, common.gate_distance.unwrap_or(none), "m"),
            single(InputKind::TimeConstant, common.tau.unwrap_or(none), "s"),
            single(InputKind::Above, common.above, "1"),
            single(InputKind::Zero, Uncertain::normal(0.0, self.common_zero_u()), "1"),
            single(InputKind::ZeroBend, Uncertain::normal(0.0, self.common_zero_u()), "1"),
        ];
        for (index, (name, mass)) in common.strikers.iter().enumerate() {
            let which = name.clone();
            inputs.push(InputQuantity { index, which, ..single(InputKind::Mass, *mass, "kg") });
        }
        for (index, (part, place)) in self.parts.iter().zip(&self.places).enumerate() {
            let WeighedImpact { impact, motion, tail, .. } = part;
            let speed = |kind, source: SpeedSource| {
                let (quantity, unit) = source.quantity();
                single(kind, quantity, unit)
            };
            let off = |kind, u: f64, unit| single(kind, Uncertain::normal(0.0, u), unit);
            let duration = Uncertain::normal(impact.duration, impact.duration_u);
            let is_own = !impact.has_common_zero;
            let baseline_u = if is_own { impact.baseline.uncertainty } else { 0.0 };
            let of_tail = |tail: &Tail| tail.noise_u.hypot(if is_own { tail.zero_u } else { 0.0 });
            let tail_u = tail.as_ref().filter(|_| self.is_tau_fitted).map_or(0.0, of_tail);
            let own = [
                speed(InputKind::Incoming, motion.incoming),
                speed(InputKind::Rebound, motion.rebound),
                // What the baseline may be off; the level itself has been taken away.
                off(InputKind::Baseline, baseline_u, "V"),
                off(InputKind::Noise, impact.noise_u(tau), "V*s"),
                single(InputKind::Duration, duration, "s"),
                off(InputKind::Tail, tail_u, "1/s"),
            ];
            let which = format!("impact {}", place + 1);
            inputs.extend(own.map(|input| InputQuantity { index, which: which.clone(), ..input }));
        }
        let later = |kind| single(kind, Uncertain::normal(0.0, 0.0), "V/N");
        inputs.extend([InputKind::Scatter, InputKind::NonLinearity].map(later));
        inputs
    }

    /// One, if records have their zero in common (1).
    fn common_zero_u(&self) -> f64 {
        f64::from(self.parts.iter().any(|part| part.impact.has_common_zero))
    }

    /// Fails if the uncertainty of an input is not finite or exceeds its value. Offsets, whose
    /// estimate is zero, and inputs without uncertainty pass.
    fn check_inputs(&self) -> Result<(), CalibrationError> {
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
        let inverse_tau = self.inverse_tau(&self.estimates);
        let own = |index: usize| {
            let is_own =
                |input: &InputQuantity| input.kind.is_impacts_own() && input.index == index;
            let alone = |inputs: &Inputs| self.one(index, inputs, inverse_tau);
            root_of_squares(&self.contributions(&is_own, &alone))
        };
        let own: Vec<f64> = (0..self.parts.len()).map(own).collect();
        let floor = f64::EPSILON * self.one(0, &self.estimates, inverse_tau).abs();
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

    /// Gives an input that is found from the impacts its standard uncertainty (V/N).
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

    /// All inputs at their estimates.
    pub fn estimates(&self) -> &Inputs {
        &self.estimates
    }

    /// Places of the impacts in the plan.
    pub fn places(&self) -> &[usize] {
        &self.places
    }

    /// `1/tau` (1/s): the one given, or the mean of what the records tell, each with its baseline.
    fn inverse_tau(&self, inputs: &Inputs) -> f64 {
        if !self.is_tau_fitted {
            return 1.0 / inputs.time_constant;
        }
        let part = |(part, own): (&WeighedImpact, &ImpactInputs)| {
            let Some(tail) = &part.tail else { return 0.0 };
            // The noise of the contact's samples is in the integral and in what leaks away of it.
            let baseline = part.common_zero(inputs) + own.baseline;
            let bend = if part.impact.has_common_zero { inputs.bend * tail.zero_u } else { 0.0 };
            let leaking = tail.per_baseline * baseline + tail.per_integral * own.noise + bend;
            part.tail_weight * (tail.inverse_tau + leaking + own.tail)
        };
        self.parts.iter().zip(&inputs.impacts).map(part).sum()
    }

    /// Sensitivity of impact `index` alone (V/N).
    fn one(&self, index: usize, inputs: &Inputs, inverse_tau: f64) -> f64 {
        let (Some(part), Some(own)) = (self.parts.get(index), inputs.impacts.get(index)) else {
            return f64::NAN;
        };
        let baseline = part.common_zero(inputs) + own.baseline;
        let integral = part.impact.integral_off(inverse_tau, baseline) + own.noise;
        inputs.gain * integral / inputs.momentum(&part.motion, own)
    }

    /// The sensitivity for given values of all inputs (V/N).
    pub fn evaluate(&self, inputs: &Inputs) -> f64 {
        let inverse_tau = self.inverse_tau(inputs);
        let parts = self.parts.iter().enumerate();
        let mean: f64 =
            parts.map(|(index, part)| part.weight * self.one(index, inputs, inverse_tau)).sum();
        mean + inputs.scatter + inputs.nonlinearity
    }

    /// The sensitivity (V/N).
    pub fn sensitivity(&self) -> f64 {
        self.evaluate(&self.estimates)
    }

    /// The time constant (s).
    pub fn tau(&self) -> f64 {
        1.0 / self.inverse_tau(&self.estimates)
    }

    /// Standard uncertainty of the time constant (s).
    pub fn tau_u(&self) -> f64 {
        let tau = |inputs: &Inputs| 1.0 / self.inverse_tau(inputs);
        root_of_squares(&self.contributions(&|_| true, &tau))
    }

    /// The time constant from the records' ends, with its standard uncertainty, used or not (s).
    pub fn tail_tau(&self) -> Option<(f64, f64)> {
        let (inverse, u) = mean(self.parts.iter().filter_map(|part| part.tail.as_ref()))?;
        Some((1.0 / inverse, u / (inverse * inverse)))
    }

    /// Each impact's sensitivity and its own standard uncertainty (V/N).
    pub fn each(&self) -> Vec<(f64, f64)> {
        let inverse_tau = self.inverse_tau(&self.estimates);
        let parts = self.parts.iter().enumerate();
        parts.map(|(i, part)| (self.one(i, &self.estimates, inverse_tau), part.own)).collect()
    }

    /// The uncertainty budget: all inputs that are uncertain.
    pub fn budget(&self) -> Vec<BudgetLine> {
        let is_uncertain = |input: &InputQuantity| input.u > 0.0;
        let contributions = self.contributions(&is_uncertain, &|inputs| self.evaluate(inputs));
        let variance: f64 = contributions.iter().map(|part| part * part).sum();
        let inputs = self.inputs.iter().filter(|input| is_uncertain(input));
        let is_from_scatter = |kind: InputKind| {
            self.birge_ratio() > 1.0 && (kind.is_impacts_own() || kind == InputKind::Scatter)
        };
        let count = self.parts.len().max(2) as f64;
        let line = |(input, contribution): (&InputQuantity, f64)| BudgetLine {
            kind: input.kind,
            name: input.name(),
            value: input.value,
            u: input.u,
            unit: input.unit,
            contribution,
            share: contribution * contribution / variance,
            coefficient: contribution / input.u,
            distribution: if input.is_even { "rectangular" } else { "normal" },
            evaluation: input.kind.evaluation(),
            freedom: if is_from_scatter(input.kind) { count - 1.0 } else { f64::INFINITY },
        };
        inputs.zip(contributions).map(line).collect()
    }

    /// Half-width of the largest contribution that is evenly distributed; all others count as
    /// normal (V/N).
    pub fn half_width(&self) -> f64 {
        let is_even = |input: &InputQuantity| input.is_even;
        let even = self.contributions(&is_even, &|inputs| self.evaluate(inputs));
        3f64.sqrt() * even.iter().map(|part| part.abs()).fold(0.0, f64::max)
    }

    /// Contributions of `chosen` inputs to the uncertainty of `output`: the standard uncertainty
    /// times the sensitivity coefficient, by central differences over [`DIFFERENCE_SHARE`] of the
    /// estimate (unit).
    fn contributions(
        &self,
        chosen: &dyn Fn(&InputQuantity) -> bool,
        output: &dyn Fn(&Inputs) -> f64,
    ) -> Vec<f64> {
        let mut inputs = self.estimates.clone();
        let contribution = |input: &InputQuantity| {
            if input.u == 0.0 {
                return 0.0;
            }
            // Inputs with an estimate of zero are offsets, in which the result is nearly straight.
            let size = if input.value == 0.0 { input.u } else { input.value.abs() };
            let step = DIFFERENCE_SHARE * size;
            let mut at = |value: f64| {
                if let Some(place) = inputs.get_mut(input.kind, input.index) {
                    *place = value;
                }
                output(&inputs)
            };
            let difference = at(input.value + step) - at(input.value - step);
            at(input.value);
            difference / (2.0 * step) * input.u
        };
        self.inputs.iter().filter(|input| chosen(input)).map(contribution).collect()
    }
}

/// Root of the sum of squares (unit).
pub(super) fn root_of_squares(parts: &[f64]) -> f64 {
    parts.iter().map(|part| part * part).sum::<f64>().sqrt()
}
