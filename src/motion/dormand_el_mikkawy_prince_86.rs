//! Dormand, El-Mikkawy and Prince's Runge-Kutta-Nystrom pair of orders 8(6), "RKN 8(6) 9FM".
//!
//! Stages are at `x + c h v + h^2 sum a f`; the step ends at `x + h v + h^2 sum b f`,
//! `v + h sum b' f`. The error estimate is the difference from the embedded solution, in position
//! and in velocity. The last stage is at the new position and opens the next step, so a step costs
//! 8 evaluations. Forces must not depend on velocity. `tests/it/order.rs` measures the order; a
//! mistyped digit would break it.

#![allow(clippy::unreadable_literal, reason = "digits as published, divided out")]

use super::runge_kutta::Row;

/// Coefficients of a pair whose last stage opens the next step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NystromPair {
    /// Name as written in scenes, options and recordings.
    pub name: &'static str,
    /// Publication that defines the method.
    pub source: &'static str,
    /// Order of the solution that is continued.
    pub order: u8,
    /// Order of the embedded solution.
    pub error_order: u8,
    /// Times of the stages, fractions of a step (1).
    pub nodes: &'static [f64],
    /// Position weights of each stage's argument.
    pub stages: &'static [Row],
    /// Position weights of the solution.
    pub position: Row,
    /// Velocity weights of the solution.
    pub velocity: Row,
    /// Position weights of the error.
    pub position_error: Row,
    /// Velocity weights of the error.
    pub velocity_error: Row,
}

/// The pair's coefficients: a constant, so that loops can be compiled for them.
pub const DORMAND_EL_MIKKAWY_PRINCE_86: NystromPair = NystromPair {
    name: "dormand-el-mikkawy-prince-86",
    source: "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, IMA J. Numer. Anal. 7, 423 (1987)",
    order: 8,
    error_order: 6,
    nodes: &[0.0, 0.05, 0.1, 0.3, 0.5, 0.7, 0.9, 1.0, 1.0],
    #[rustfmt::skip]
    stages: &[
        &[],
        &[(0, 0.00125)],
        &[(0, 0.0016666666666666668), (1, 0.0033333333333333335)],
        &[(0, 0.045), (1, -0.09), (2, 0.09)],
        &[(0, -0.3379798532571243), (1, 0.8611516478170984), (2, -0.48613644655235316), (3, 0.0879646519923791)],
        &[(0, 0.7461462641043086), (1, -1.804347430246737), (2, 1.2761518285888953), (3, -0.031220932716737166), (4, 0.05827027027027027)],
        &[(0, -1.2551623461807584), (1, 3.257463187064823), (2, -2.068866619575089), (3, 0.4206478455603251), (4, -0.018382978723404254), (5, 0.06930091185410335)],
        &[(0, 3.772901830095941), (1, -9.669613121677195), (2, 6.7991544547851674), (3, -0.8490343907823893), (4, 0.4671734865470852), (5, -0.04939742152466368), (6, 0.028815162556053812)],
        &[(0, 0.028092718568909044), (2, 0.1457093253968254), (3, 0.1529431216931217), (4, 0.09151785714285714), (5, 0.06554705215419501), (6, 0.01618992504409171)],
    ],
    #[rustfmt::skip]
    position: &[(0, 0.028092718568909044), (2, 0.1457093253968254), (3, 0.1529431216931217), (4, 0.09151785714285714), (5, 0.06554705215419501), (6, 0.01618992504409171)],
    #[rustfmt::skip]
    velocity: &[(0, 0.028092718568909044), (2, 0.1618992504409171), (3, 0.2184901738473167), (4, 0.18303571428571427), (5, 0.2184901738473167), (6, 0.1618992504409171), (7, 0.028092718568909044)],
    #[rustfmt::skip]
    position_error: &[(0, -0.044557986852984274), (2, 0.10965442077101599), (3, -0.14620589436135464), (4, 0.1315853049252192), (5, -0.06265966901200913), (6, 0.012183824530112887)],
    #[rustfmt::skip]
    velocity_error: &[(0, -0.044557986852984274), (2, 0.12183824530112887), (3, -0.2088655633733638), (4, 0.2631706098504384), (5, -0.2088655633733638), (6, 0.12183824530112887), (7, 0.10544201314701572), (8, -0.15)],
};
