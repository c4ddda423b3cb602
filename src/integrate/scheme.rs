//! What the chain's own stepper makes of a method.

use super::dormand_el_mikkawy_prince_64::DORMAND_EL_MIKKAWY_PRINCE_64;
use super::dormand_el_mikkawy_prince_86::DORMAND_EL_MIKKAWY_PRINCE_86;
use super::nystrom::NystromPair;
use super::splitting::Splitting;

/// The Runge-Kutta-Nystrom pairs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pair {
    /// Orders 6(4).
    DormandElMikkawyPrince64,
    /// Orders 8(6).
    DormandElMikkawyPrince86,
}

impl Pair {
    /// Its coefficients.
    #[must_use]
    pub fn coefficients(self) -> &'static NystromPair {
        match self {
            Self::DormandElMikkawyPrince64 => &DORMAND_EL_MIKKAWY_PRINCE_64,
            Self::DormandElMikkawyPrince86 => &DORMAND_EL_MIKKAWY_PRINCE_86,
        }
    }

    /// Force evaluations of a step: the last one opens the next step.
    #[must_use]
    pub fn evaluations(self) -> usize {
        self.coefficients().nodes.len() - 1
    }
}

/// A method and its setting, of those for forces that depend on positions alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scheme {
    /// A Runge-Kutta-Nystrom pair, and the tolerated error of a step relative to the system's scales (1).
    Pair(Pair, f64),
    /// A splitting, and its step (s).
    Splitting(&'static Splitting, f64),
    /// A splitting in paced steps, and the error that they are made for (1).
    Paced(&'static Splitting, f64),
}
