//! The methods by name: an arm for each.

use std::fmt;

use super::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use super::integrator::{Integrator, Restart};
use super::rodas::{self, Rodas};
use super::runge_kutta::{RungeKutta, RungeKuttaIntegrator, StepError};
use super::splitting::{FORCE_GRADIENT, Splitting, VELOCITY_VERLET};
use super::switching::Switched;
use super::system::System;
use super::tableaus::{DORMAND_PRINCE_54, DORMAND_PRINCE_853, RUNGE_KUTTA_4};
use super::two_step;
use crate::chain::State;

/// A method and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Velocity Verlet with a fixed step: order 2, symplectic.
    VelocityVerlet {
        /// The step (s).
        step: f64,
    },
    /// Omelyan, Mryglod and Folk's splitting with force gradients: order 4, symplectic.
    ForceGradient {
        /// The step (s).
        step: f64,
    },
    /// The same in steps of two lengths, short while the stiffest contact is closed
    /// ([`super::two_step`]): order 4.
    TwoStepForceGradient {
        /// Error of what is read that steps are made for, relative to the system's scales (1).
        tolerance: f64,
    },
    /// Dormand, El-Mikkawy and Prince's Runge-Kutta-Nystrom pair of orders 8(6).
    DormandElMikkawyPrince86 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
    /// Dormand and Prince's Runge-Kutta pair of orders 5(4); forces may depend on velocity.
    DormandPrince54 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
    /// Dormand and Prince's Runge-Kutta pair of orders 8(5,3); forces may depend on velocity.
    DormandPrince853 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
    /// The classical Runge-Kutta method with a fixed step: order 4; forces may depend on velocity.
    RungeKutta4 {
        /// The step (s).
        step: f64,
    },
    /// Hairer and Wanner's linearly implicit method of orders 4(3), for systems that know their
    /// tangent: losses may be stiff.
    Rodas {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
}

/// A method by what it asks of forces, with its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// For forces that depend on positions alone.
    Lossless(LosslessScheme),
    /// For forces that may depend on velocities.
    General(GeneralScheme),
}

/// A method for forces that depend on positions alone, and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LosslessScheme {
    /// The Runge-Kutta-Nystrom pair of Dormand, El-Mikkawy and Prince, and the tolerated error of a
    /// step relative to the system's scales (1).
    Nystrom(f64),
    /// A splitting, and its step (s).
    Splitting(&'static Splitting, f64),
    /// A splitting in steps of two lengths, and the error that they are made for (1).
    TwoStep(&'static Splitting, f64),
}

/// A method for forces that may depend on velocities, and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum GeneralScheme {
    /// An explicit Runge-Kutta method, and its step (s) or the tolerated error of a step (1).
    RungeKutta(&'static RungeKutta, f64),
    /// Rodas, and the tolerated error of a step relative to the system's scales (1).
    Rodas(f64),
}

use GeneralScheme::{Rodas as Implicit, RungeKutta as Explicit};
use LosslessScheme::{Nystrom, Splitting as Split, TwoStep};
use Scheme::{General, Lossless};

impl GeneralScheme {
    /// Starts the method on `system` at `state`.
    pub fn start<'a>(self, system: Box<dyn System + 'a>, state: State) -> Box<dyn Integrator + 'a> {
        match self {
            Explicit(method, setting) => {
                watched(RungeKuttaIntegrator::new(method, system, state, setting))
            }
            Implicit(tolerance) => watched(Rodas::new(system, state, tolerance)),
        }
    }
}

impl Method {
    /// The method by what it asks of forces.
    pub fn scheme(self) -> Scheme {
        match self {
            Self::VelocityVerlet { step } => Lossless(Split(&VELOCITY_VERLET, step)),
            Self::ForceGradient { step } => Lossless(Split(&FORCE_GRADIENT, step)),
            Self::TwoStepForceGradient { tolerance } => {
                Lossless(TwoStep(&FORCE_GRADIENT, tolerance))
            }
            Self::DormandElMikkawyPrince86 { tolerance } => Lossless(Nystrom(tolerance)),
            Self::DormandPrince54 { tolerance } => General(Explicit(&DORMAND_PRINCE_54, tolerance)),
            Self::DormandPrince853 { tolerance } => {
                General(Explicit(&DORMAND_PRINCE_853, tolerance))
            }
            Self::RungeKutta4 { step } => General(Explicit(&RUNGE_KUTTA_4, step)),
            Self::Rodas { tolerance } => General(Implicit(tolerance)),
        }
    }

    /// Name as written in scenes, options and recordings.
    pub fn name(&self) -> &'static str {
        match self.scheme() {
            Lossless(Split(method, _)) => method.name,
            Lossless(TwoStep(..)) => two_step::NAME,
            Lossless(Nystrom(_)) => DORMAND_EL_MIKKAWY_PRINCE_86.name,
            General(Explicit(method, _)) => method.name,
            General(Implicit(_)) => Rodas::NAME,
        }
    }

    /// Publication that defines the method.
    pub fn source(&self) -> &'static str {
        match self.scheme() {
            Lossless(Split(method, _) | TwoStep(method, _)) => method.source,
            Lossless(Nystrom(_)) => DORMAND_EL_MIKKAWY_PRINCE_86.source,
            General(Explicit(method, _)) => method.source,
            General(Implicit(_)) => Rodas::SOURCE,
        }
    }

    /// Order of convergence on smooth problems.
    pub fn order(&self) -> u8 {
        match self.scheme() {
            Lossless(Split(method, _) | TwoStep(method, _)) => method.order,
            Lossless(Nystrom(_)) => DORMAND_EL_MIKKAWY_PRINCE_86.order,
            General(Explicit(method, _)) => method.order,
            General(Implicit(_)) => Rodas::ORDER,
        }
    }

    /// The fixed step (s), and how far it may reach: the longest stable step times the highest
    /// angular frequency (1). None for methods that choose their own steps.
    pub fn fixed_step(&self) -> Option<(f64, f64)> {
        match self.scheme() {
            Lossless(Split(method, step)) => Some((step, method.stability)),
            General(Explicit(method @ RungeKutta { error: StepError::None, .. }, step)) => {
                Some((step, method.oscillation_reach))
            }
            _ => None,
        }
    }

    /// Whether forces may depend on velocities.
    pub fn allows_losses(&self) -> bool {
        matches!(self.scheme(), General(_))
    }

    /// Whether the method is one for systems with or without losses: some need to be without, and
    /// one needs the tangent that only those with losses tell.
    pub fn suits(&self, lossy: bool) -> bool {
        if lossy { self.allows_losses() } else { !matches!(self.scheme(), General(Implicit(_))) }
    }

    /// Longest stable step times the fastest decay of a lossy system; none for methods that no
    /// decay limits, and for those that are not made for losses (1).
    pub fn decay_reach(&self) -> Option<f64> {
        match self.scheme() {
            General(Explicit(method, _)) => Some(method.decay_reach),
            Lossless(_) | General(Implicit(_)) => None,
        }
    }

    /// The tolerated error of a step, or of what is read; none for fixed steps (1).
    pub fn tolerance(&self) -> Option<f64> {
        match self.scheme() {
            Lossless(Split(..))
            | General(Explicit(RungeKutta { error: StepError::None, .. }, _)) => None,
            Lossless(TwoStep(_, tolerance) | Nystrom(tolerance))
            | General(Explicit(_, tolerance) | Implicit(tolerance)) => Some(tolerance),
        }
    }

    /// Force evaluations of one step.
    pub fn stages(&self) -> u8 {
        let count = match self.scheme() {
            Lossless(Split(method, _) | TwoStep(method, _)) => method.drifts.len(),
            Lossless(Nystrom(_)) => DORMAND_EL_MIKKAWY_PRINCE_86.nodes.len() - 1,
            General(Explicit(method, _)) => method.stages.len() - 1,
            General(Implicit(_)) => rodas::STAGES,
        };
        u8::try_from(count).unwrap_or(u8::MAX)
    }
}

/// The method, with its system's switches watched over if there are any.
fn watched<'a>(mut method: impl Restart + 'a) -> Box<dyn Integrator + 'a> {
    if method.system().switching().is_some() {
        Box::new(Switched::new(method))
    } else {
        Box::new(method)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.scheme() {
            Lossless(Split(method, step)) => write!(f, "{} (step {step:e} s)", method.name),
            General(Explicit(RungeKutta { error: StepError::None, name, .. }, step)) => {
                write!(f, "{name} (step {step:e} s)")
            }
            Lossless(TwoStep(_, tolerance)) => {
                write!(f, "{} (tolerance {tolerance:.1e})", self.name())
            }
            Lossless(Nystrom(tolerance))
            | General(Explicit(_, tolerance) | Implicit(tolerance)) => {
                write!(f, "{} (step tolerance {tolerance:.1e})", self.name())
            }
        }
    }
}
