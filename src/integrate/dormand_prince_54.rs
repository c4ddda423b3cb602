//! Dormand and Prince's explicit Runge-Kutta pair of orders 5(4): six force evaluations a step.

use super::runge_kutta::{RungeKutta, StepError};

/// The pair's coefficients.
pub static DORMAND_PRINCE_54: RungeKutta = RungeKutta {
    name: "dormand-prince-54",
    source: "J. R. Dormand, P. J. Prince, J. Comput. Appl. Math. 6, 19 (1980), RK5(4)7M",
    order: 5,
    #[rustfmt::skip]
    stages: &[
        &[],
        &[(0, 1.0 / 5.0)],
        &[(0, 3.0 / 40.0), (1, 9.0 / 40.0)],
        &[(0, 44.0 / 45.0), (1, -56.0 / 15.0), (2, 32.0 / 9.0)],
        &[(0, 19372.0 / 6561.0), (1, -25360.0 / 2187.0), (2, 64448.0 / 6561.0), (3, -212.0 / 729.0)],
        &[(0, 9017.0 / 3168.0), (1, -355.0 / 33.0), (2, 46732.0 / 5247.0), (3, 49.0 / 176.0), (4, -5103.0 / 18656.0)],
        &[(0, 35.0 / 384.0), (2, 500.0 / 1113.0), (3, 125.0 / 192.0), (4, -2187.0 / 6784.0), (5, 11.0 / 84.0)],
    ],
    #[rustfmt::skip]
    error: StepError::Embedded(
        &[(0, 71.0 / 57600.0), (2, -71.0 / 16695.0), (3, 71.0 / 1920.0), (4, -17253.0 / 339_200.0), (5, 22.0 / 525.0), (6, -1.0 / 40.0)],
        4,
    ),
    dense: None,
    oscillation_reach: 1.0,
    decay_reach: 3.306,
};
