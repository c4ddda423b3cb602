//! How accurately a scene is integrated: `--accuracy`, or `--method` with a step or a tolerance.

use std::ops::RangeInclusive;

use clap::ValueEnum;

use super::value::quantity;
use crate::motion::Method;
use crate::quantity::Dimension;
use crate::scene::{LOOSEST_ACCURACY, TIGHTEST_ACCURACY};

/// Reads an accuracy (1).
pub fn accuracy(text: &str) -> Result<f64, String> {
    quantity(Dimension::NONE, TIGHTEST_ACCURACY..=LOOSEST_ACCURACY, "1e-3")(text)
}

/// Tolerances of a step's error: below them rounding dominates (1).
pub const TOLERANCES: RangeInclusive<f64> = 1e-15..=0.1;

/// Methods.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub enum ByHand {
    /// Order 2, symplectic; takes a step
    VelocityVerlet,
    /// Order 4, symplectic, uses force gradients; takes a step
    ForceGradient,
    /// The same with two step lengths, short while the stiffest contact is closed; takes a
    /// tolerance
    TwoStepForceGradient,
    /// Order 4, also for scenes with losses; takes a step
    #[value(name = "runge-kutta-4")]
    RungeKutta4,
    /// Orders 8(6); takes a tolerance
    #[value(name = "dormand-el-mikkawy-prince-86")]
    DormandElMikkawyPrince86,
    /// Orders 5(4), also for scenes with losses; takes a tolerance
    #[value(name = "dormand-prince-54")]
    DormandPrince54,
    /// Orders 8(5,3), also for scenes with losses; takes a tolerance
    #[value(name = "dormand-prince-853")]
    DormandPrince853,
    /// Orders 4(3), implicit, for scenes with losses only; takes a tolerance
    Rodas,
}

impl ByHand {
    /// The method with its setting.
    fn with(self, setting: f64) -> Method {
        let (step, tolerance) = (setting, setting);
        match self {
            Self::VelocityVerlet => Method::VelocityVerlet { step },
            Self::ForceGradient => Method::ForceGradient { step },
            Self::TwoStepForceGradient => Method::TwoStepForceGradient { tolerance },
            Self::RungeKutta4 => Method::RungeKutta4 { step },
            Self::DormandElMikkawyPrince86 => Method::DormandElMikkawyPrince86 { tolerance },
            Self::DormandPrince54 => Method::DormandPrince54 { tolerance },
            Self::DormandPrince853 => Method::DormandPrince853 { tolerance },
            Self::Rodas => Method::Rodas { tolerance },
        }
    }

    /// The method with the one of a step (s) and a tolerance (1) that it takes.
    pub fn method(self, step: Option<f64>, tolerance: Option<f64>) -> Result<Method, String> {
        let name = self.with(1.0).name();
        let is_fixed = self.with(1.0).fixed_step().is_some();
        match (step, tolerance) {
            (Some(step), None) if is_fixed => Ok(self.with(step)),
            (None, Some(tolerance)) if !is_fixed => Ok(self.with(tolerance)),
            _ if is_fixed => Err(format!(
                "found --method {name} without --step, expected one, e.g. --step 50ns: its steps are all of one length"
            )),
            _ => Err(format!(
                "found --method {name} without --tolerance, expected one, e.g. --tolerance 1e-8: it chooses its steps by the error it tolerates in each"
            )),
        }
    }
}
