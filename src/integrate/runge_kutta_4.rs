//! The classical Runge-Kutta method: order 4, four force evaluations a step, which is fixed.

use super::runge_kutta::{RungeKutta, StepError};

/// The method's coefficients.
pub static RUNGE_KUTTA_4: RungeKutta = RungeKutta {
    name: "runge-kutta-4",
    source: "W. Kutta, Z. Math. Phys. 46, 435 (1901)",
    order: 4,
    stages: &[
        &[],
        &[(0, 0.5)],
        &[(1, 0.5)],
        &[(2, 1.0)],
        &[(0, 1.0 / 6.0), (1, 1.0 / 3.0), (2, 1.0 / 3.0), (3, 1.0 / 6.0)],
    ],
    error: StepError::None,
    dense: None,
    oscillation_reach: 2.828,
    decay_reach: 2.785,
};
