//! The methods by name: an arm for each.

use std::fmt;

use super::blanes_moan::BLANES_MOAN;
use super::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;
use super::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use super::nystrom::{NystromIntegrator, NystromPair};
use super::pefrl::PEFRL;
use super::splitting::{Splitting, SplittingIntegrator};
use super::velocity_verlet::VELOCITY_VERLET;
use super::{DormandPrince853, Integrator, State, System};

/// A method and its setting.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Method {
    /// Velocity Verlet with a fixed step: order 2, symplectic.
    VelocityVerlet {
        /// The step (s).
        step: f64,
    },
    /// Omelyan, Mryglod and Folk's optimised splitting: order 4, symplectic.
    Pefrl {
        /// The step (s).
        step: f64,
    },
    /// Blanes and Moan's splitting: order 6, symplectic.
    BlanesMoan {
        /// The step (s).
        step: f64,
    },
    /// Dormand, El-Mikkawy and Prince's Runge-Kutta-Nystrom pair of orders 6(4).
    DormandElMikkawyPrince64 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
    /// Dormand, El-Mikkawy and Prince's Runge-Kutta-Nystrom pair of orders 8(6).
    DormandElMikkawyPrince86 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
    /// Dormand and Prince's Runge-Kutta pair of orders 8(5,3); forces may depend on velocity.
    DormandPrince853 {
        /// Tolerated error of a step, relative to the system's scales (1).
        tolerance: f64,
    },
}

/// What a method's arm leads to.
enum Kind {
    Splitting(&'static Splitting, f64),
    Nystrom(&'static NystromPair, f64),
    DormandPrince853(f64),
}

impl Method {
    fn kind(self) -> Kind {
        match self {
            Self::VelocityVerlet { step } => Kind::Splitting(&VELOCITY_VERLET, step),
            Self::Pefrl { step } => Kind::Splitting(&PEFRL, step),
            Self::BlanesMoan { step } => Kind::Splitting(&BLANES_MOAN, step),
            Self::DormandElMikkawyPrince64 { tolerance } => {
                Kind::Nystrom(&DORMAND_EL_MIKKAWY_PRINCE_64, tolerance)
            }
            Self::DormandElMikkawyPrince86 { tolerance } => {
                Kind::Nystrom(&DORMAND_EL_MIKKAWY_PRINCE_86, tolerance)
            }
            Self::DormandPrince853 { tolerance } => Kind::DormandPrince853(tolerance),
        }
    }

    /// Name as written in scenes, options and recordings.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self.kind() {
            Kind::Splitting(method, _) => method.name,
            Kind::Nystrom(pair, _) => pair.name,
            Kind::DormandPrince853(_) => DormandPrince853::NAME,
        }
    }

    /// Publication that defines the method.
    #[must_use]
    pub fn source(&self) -> &'static str {
        match self.kind() {
            Kind::Splitting(method, _) => method.source,
            Kind::Nystrom(pair, _) => pair.source,
            Kind::DormandPrince853(_) => DormandPrince853::SOURCE,
        }
    }

    /// Order of convergence on smooth problems.
    #[must_use]
    pub fn order(&self) -> u8 {
        match self.kind() {
            Kind::Splitting(method, _) => method.order,
            Kind::Nystrom(pair, _) => pair.order,
            Kind::DormandPrince853(_) => 8,
        }
    }

    /// The fixed step (s), and how far it may reach: the longest stable step times the highest angular frequency (1). None for
    /// methods that choose their own steps.
    #[must_use]
    pub fn fixed_step(&self) -> Option<(f64, f64)> {
        match self.kind() {
            Kind::Splitting(method, step) => Some((step, method.stability)),
            Kind::Nystrom(..) | Kind::DormandPrince853(_) => None,
        }
    }

    /// The tolerated error of a step; none for fixed steps (1).
    #[must_use]
    pub fn tolerance(&self) -> Option<f64> {
        match self.kind() {
            Kind::Splitting(..) => None,
            Kind::Nystrom(_, tolerance) | Kind::DormandPrince853(tolerance) => Some(tolerance),
        }
    }

    /// The Runge-Kutta-Nystrom pair and the tolerated error of a step; none for other methods (1).
    #[must_use]
    pub fn nystrom(&self) -> Option<(&'static NystromPair, f64)> {
        match self.kind() {
            Kind::Nystrom(pair, tolerance) => Some((pair, tolerance)),
            Kind::Splitting(..) | Kind::DormandPrince853(_) => None,
        }
    }

    /// Force evaluations of one step.
    #[must_use]
    pub fn stages(&self) -> u8 {
        let count = match self.kind() {
            Kind::Splitting(method, _) => method.drifts.len(),
            Kind::Nystrom(pair, _) => pair.nodes.len() - 1,
            Kind::DormandPrince853(_) => 12,
        };
        u8::try_from(count).unwrap_or(u8::MAX)
    }

    /// Starts the method on `system` at `state`.
    #[must_use]
    pub fn start<'a>(
        &self,
        system: Box<dyn System + 'a>,
        state: State,
    ) -> Box<dyn Integrator + 'a> {
        match self.kind() {
            Kind::Splitting(method, step) => {
                Box::new(SplittingIntegrator::new(method, system, state, step))
            }
            Kind::Nystrom(pair, tolerance) => {
                Box::new(NystromIntegrator::new(pair, system, state, tolerance))
            }
            Kind::DormandPrince853(tolerance) => {
                Box::new(DormandPrince853::new(system, state, tolerance))
            }
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.kind() {
            Kind::Splitting(method, step) => write!(f, "{} (step {step:e} s)", method.name),
            Kind::Nystrom(_, tolerance) | Kind::DormandPrince853(tolerance) => {
                write!(f, "{} (step tolerance {tolerance:.1e})", self.name())
            }
        }
    }
}
