//! The inputs of the measurement equation: what impacts share, and what each striker did.

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

    /// Its name with that of `which` one, which is empty if there is only one.
    pub fn of(self, which: &str) -> String {
        if which.is_empty() { self.name().to_owned() } else { format!("{}, {which}", self.name()) }
    }
}

/// An input of the measurement equation.
#[derive(Debug, Clone, PartialEq)]
pub struct InputQuantity {
    /// Its kind.
    pub kind: InputKind,
    /// Which one, e.g. a striker's name or `impact 3`; empty where there is one only.
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
    /// Its name in a table.
    pub fn name(&self) -> String {
        self.kind.of(&self.which)
    }
}

impl SpeedSource {
    /// The reading and its unit.
    pub(super) fn quantity(self) -> (Uncertain, &'static str) {
        match self {
            Self::Speed(q) => (q, "m/s"),
            Self::Height(q) => (q, "m"),
            Self::GateTime(q) | Self::FlightTime(q) => (q, "s"),
        }
    }

    /// The speed where the reading is `raw`; a height or time below zero is none (m/s).
    pub fn of(self, raw: f64, gravity: f64, gates: f64) -> f64 {
        match self {
            Self::Speed(_) => raw,
            Self::Height(_) => (2.0 * gravity * raw.max(0.0)).sqrt(),
            Self::GateTime(_) => gates / raw,
            Self::FlightTime(_) => 0.5 * gravity * raw,
        }
    }
}

impl Common {
    /// Momentum that an impact of `duration` (s) hands over (N s).
    pub fn momentum(&self, motion: &StrikerMotion, duration: f64) -> f64 {
        let mass = self.strikers.get(motion.striker).map_or(f64::NAN, |(_, mass)| mass.value);
        let gates = self.gate_distance.map_or(f64::NAN, |gates| gates.value);
        let speed = |s: SpeedSource| s.of(s.quantity().0.value, self.gravity.value, gates);
        let sum = self.speed_scale.value * (speed(motion.incoming) + speed(motion.rebound));
        mass * (sum + self.gravity.value * duration) * (1.0 - self.above.value)
    }

    /// The shared inputs, in the places that the model looks for them.
    pub(super) fn inputs(&self) -> Vec<InputQuantity> {
        let none = Uncertain::normal(f64::NAN, 0.0);
        let one = |kind, quantity: Uncertain, unit| InputQuantity {
            kind,
            which: String::new(),
            value: quantity.value,
            u: quantity.u,
            is_even: quantity.half_width > 0.0,
            unit,
        };
        let mut inputs = vec![
            one(InputKind::Gain, self.gain, "1"),
            one(InputKind::SpeedScale, self.speed_scale, "1"),
            one(InputKind::Gravity, self.gravity, "m/s^2"),
            one(InputKind::GateDistance, self.gate_distance.unwrap_or(none), "m"),
            one(InputKind::TimeConstant, self.tau.unwrap_or(none), "s"),
            one(InputKind::Above, self.above, "1"),
        ];
        inputs.extend(self.strikers.iter().map(|(name, mass)| InputQuantity {
            which: name.clone(),
            ..one(InputKind::Mass, *mass, "kg")
        }));
        inputs
    }
}
