//! Dormand, El-Mikkawy and Prince's Runge-Kutta-Nystrom pair of orders 6(4), "RKN 6(4) 6FM".
//!
//! The last stage stands at the new position and opens the next step, so a step costs 5 evaluations. Forces must not depend
//! on velocity. `tests/it/order.rs` measures the order; a mistyped digit would break it.

#![allow(clippy::unreadable_literal, reason = "digits as published, divided out")]

use super::nystrom::NystromPair;

/// The pair's coefficients: a constant, so that loops can be compiled for them.
pub const DORMAND_EL_MIKKAWY_PRINCE_64: NystromPair = NystromPair {
    name: "dormand-el-mikkawy-prince-64",
    source: "J. R. Dormand, M. E. A. El-Mikkawy, P. J. Prince, IMA J. Numer. Anal. 7, 235 (1987)",
    order: 6,
    error_order: 4,
    nodes: &[0.0, 0.1, 0.3, 0.7, 0.68, 1.0],
    #[rustfmt::skip]
    stages: &[
        &[],
        &[(0, 0.005)],
        &[(0, -0.00045454545454545455), (1, 0.045454545454545456)],
        &[(0, 0.09651515151515151), (1, -0.06363636363636363), (2, 0.21212121212121213)],
        &[(0, 0.11450768253968253), (1, -0.10692622222222223), (2, 0.23313422222222221), (3, -0.00951568253968254)],
        &[(0, 0.07049486461251167), (1, 0.04310344827586207), (2, 0.2814327485380117), (3, 0.3273809523809524), (4, -0.22241201380733783)],
    ],
    #[rustfmt::skip]
    position: &[(0, 0.07049486461251167), (1, 0.04310344827586207), (2, 0.2814327485380117), (3, 0.3273809523809524), (4, -0.22241201380733783)],
    #[rustfmt::skip]
    velocity: &[(0, 0.07049486461251167), (1, 0.04789272030651341), (2, 0.402046783625731), (3, 1.0912698412698412), (4, -0.6950375431479306), (5, 0.08333333333333333)],
    #[rustfmt::skip]
    position_error: &[(0, 0.061929785247432305), (1, -0.11435655172413793), (2, 0.06787830409356725), (3, 0.07896047619047619), (4, -0.09441201380733781)],
    #[rustfmt::skip]
    velocity_error: &[(0, 0.061929785247432305), (1, -0.12706283524904213), (2, 0.09696900584795322), (3, 0.2632015873015873), (4, -0.2950375431479307)],
};
