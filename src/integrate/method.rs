//! The methods by name: an arm for each.

use std::fmt;

use super::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use super::dormand_prince_54::DORMAND_PRINCE_54;
use super::dormand_prince_853::DORMAND_PRINCE_853;
use super::force_gradient::FORCE_GRADIENT;
use super::nystrom::NystromIntegrator;
use super::rodas::{self, Rodas};
use super::runge_kutta::{RungeKutta, RungeKuttaIntegrator, StepError};
use super::runge_kutta_4::RUNGE_KUTTA_4;
use super::scheme::Scheme;
use super::splitting::{Splitting, SplittingIntegrator};
use super::switches::Restart;
use super::switching::Switched;
use super::two_step;
use super::velocity_verlet::VELOCITY_VERLET;
use super::{Integrator, State, System};

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

/// What a method's arm leads to.
enum Kind {
    Splitting(&'static Splitting, f64),
    TwoStep(&'static Splitting, f64),
    Nystrom(f64),
    RungeKutta(&'static RungeKutta, f64),
    Rodas(f64),
}

impl Method {
    fn kind(self) -> Kind {
        match self {
            Self::VelocityVerlet { step } => Kind::Splitting(&VELOCITY_VERLET, step),
            Self::ForceGradient { step } => Kind::Splitting(&FORCE_GRADIENT, step),
            Self::TwoStepForceGradient { tolerance } => Kind::TwoStep(&FORCE_GRADIENT, tolerance),
            Self::DormandElMikkawyPrince86 { tolerance } => Kind::Nystrom(tolerance),
            Self::DormandPrince54 { tolerance } => Kind::RungeKutta(&DORMAND_PRINCE_54, tolerance),
            Self::DormandPrince853 { tolerance } => {
                Kind::RungeKutta(&DORMAND_PRINCE_853, tolerance)
            }
            Self::RungeKutta4 { step } => Kind::RungeKutta(&RUNGE_KUTTA_4, step),
            Self::Rodas { tolerance } => Kind::Rodas(tolerance),
        }
    }

    /// Name as written in scenes, options and recordings.
    pub fn name(&self) -> &'static str {
        match self.kind() {
            Kind::Splitting(method, _) => method.name,
            Kind::TwoStep(..) => two_step::NAME,
            Kind::Nystrom(_) => DORMAND_EL_MIKKAWY_PRINCE_86.name,
            Kind::RungeKutta(method, _) => method.name,
            Kind::Rodas(_) => Rodas::NAME,
        }
    }

    /// Publication that defines the method.
    pub fn source(&self) -> &'static str {
        match self.kind() {
            Kind::Splitting(method, _) | Kind::TwoStep(method, _) => method.source,
            Kind::Nystrom(_) => DORMAND_EL_MIKKAWY_PRINCE_86.source,
            Kind::RungeKutta(method, _) => method.source,
            Kind::Rodas(_) => Rodas::SOURCE,
        }
    }

    /// Order of convergence on smooth problems.
    pub fn order(&self) -> u8 {
        match self.kind() {
            Kind::Splitting(method, _) | Kind::TwoStep(method, _) => method.order,
            Kind::Nystrom(_) => DORMAND_EL_MIKKAWY_PRINCE_86.order,
            Kind::RungeKutta(method, _) => method.order,
            Kind::Rodas(_) => Rodas::ORDER,
        }
    }

    /// The fixed step (s), and how far it may reach: the longest stable step times the highest
    /// angular frequency (1). None for methods that choose their own steps.
    pub fn fixed_step(&self) -> Option<(f64, f64)> {
        match self.kind() {
            Kind::Splitting(method, step) => Some((step, method.stability)),
            Kind::RungeKutta(method @ RungeKutta { error: StepError::None, .. }, step) => {
                Some((step, method.oscillation_reach))
            }
            _ => None,
        }
    }

    /// Whether forces may depend on velocities.
    pub fn allows_losses(&self) -> bool {
        !matches!(self.kind(), Kind::Splitting(..) | Kind::TwoStep(..) | Kind::Nystrom(_))
    }

    /// Whether the method is one for systems with or without losses: some need to be without, and
    /// one needs the tangent that only those with losses tell.
    pub fn suits(&self, lossy: bool) -> bool {
        if lossy { self.allows_losses() } else { !matches!(self.kind(), Kind::Rodas(_)) }
    }

    /// Longest stable step times the fastest decay of a lossy system; none for methods that no
    /// decay limits, and for those that are not made for losses (1).
    pub fn decay_reach(&self) -> Option<f64> {
        match self.kind() {
            Kind::RungeKutta(method, _) => Some(method.decay_reach),
            Kind::Splitting(..) | Kind::TwoStep(..) | Kind::Nystrom(_) | Kind::Rodas(_) => None,
        }
    }

    /// The tolerated error of a step, or of what is read; none for fixed steps (1).
    pub fn tolerance(&self) -> Option<f64> {
        match self.kind() {
            Kind::Splitting(..)
            | Kind::RungeKutta(RungeKutta { error: StepError::None, .. }, _) => None,
            Kind::TwoStep(_, tolerance)
            | Kind::Nystrom(tolerance)
            | Kind::RungeKutta(_, tolerance)
            | Kind::Rodas(tolerance) => Some(tolerance),
        }
    }

    /// The method as the vector path takes it; none for methods whose forces may depend on
    /// velocities.
    pub fn scheme(&self) -> Option<Scheme> {
        match self.kind() {
            Kind::Nystrom(tolerance) => Some(Scheme::Nystrom(tolerance)),
            Kind::Splitting(method, step) => Some(Scheme::Splitting(method, step)),
            Kind::TwoStep(method, tolerance) => Some(Scheme::TwoStep(method, tolerance)),
            _ => None,
        }
    }

    /// Force evaluations of one step.
    pub fn stages(&self) -> u8 {
        let count = match self.kind() {
            Kind::Splitting(method, _) | Kind::TwoStep(method, _) => method.drifts.len(),
            Kind::Nystrom(_) => DORMAND_EL_MIKKAWY_PRINCE_86.nodes.len() - 1,
            Kind::RungeKutta(method, _) => method.stages.len() - 1,
            Kind::Rodas(_) => rodas::STAGES,
        };
        u8::try_from(count).unwrap_or(u8::MAX)
    }

    /// Starts the method on `system` at `state`.
    pub fn start<'a>(
        &self,
        system: Box<dyn System + 'a>,
        state: State,
    ) -> Box<dyn Integrator + 'a> {
        match self.kind() {
            Kind::Splitting(method, step) => {
                Box::new(SplittingIntegrator::new(method, system, state, step))
            }
            Kind::TwoStep(method, tolerance) => {
                Box::new(SplittingIntegrator::two_step(method, system, state, tolerance))
            }
            Kind::Nystrom(tolerance) => {
                let pair = &DORMAND_EL_MIKKAWY_PRINCE_86;
                Box::new(NystromIntegrator::new(pair, system, state, tolerance))
            }
            Kind::RungeKutta(method, setting) => {
                watched(RungeKuttaIntegrator::new(method, system, state, setting))
            }
            Kind::Rodas(tolerance) => watched(Rodas::new(system, state, tolerance)),
        }
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
        match self.kind() {
            Kind::Splitting(method, step) => write!(f, "{} (step {step:e} s)", method.name),
            Kind::RungeKutta(RungeKutta { error: StepError::None, name, .. }, step) => {
                write!(f, "{name} (step {step:e} s)")
            }
            Kind::TwoStep(_, tolerance) => write!(f, "{} (tolerance {tolerance:.1e})", self.name()),
            Kind::Nystrom(tolerance) | Kind::RungeKutta(_, tolerance) | Kind::Rodas(tolerance) => {
                write!(f, "{} (step tolerance {tolerance:.1e})", self.name())
            }
        }
    }
}
