//! Blanes and Moan's Runge-Kutta-Nystrom splitting of order 6 in eleven stages ("SRKN 11 b").

#![allow(clippy::unreadable_literal, reason = "digits as published")]

use super::splitting::Splitting;

const A: [f64; 5] = [
    0.123229775946271,
    0.290553797799558,
    -0.127049212625417,
    -0.246331761062075,
    0.357208872795928,
];
const B: [f64; 5] = [
    0.0414649985182624,
    0.198128671918067,
    -0.0400061921041533,
    0.0752539843015807,
    -0.0115113874206879,
];
const A6: f64 = 1.0 - 2.0 * (A[0] + A[1] + A[2] + A[3] + A[4]);
const B6: f64 = 0.5 - (B[0] + B[1] + B[2] + B[3] + B[4]);

/// The method's fractions.
pub static BLANES_MOAN: Splitting = Splitting {
    name: "blanes-moan",
    source: "S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142, 313 (2002), Table 3, SRKN 11 b",
    order: 6,
    kicks: &[B[0], B[1], B[2], B[3], B[4], B6, B6, B[4], B[3], B[2], B[1], B[0]],
    drifts: &[A[0], A[1], A[2], A[3], A[4], A6, A[4], A[3], A[2], A[1], A[0]],
    gradients: &[],
    first_step: &[],
    stability: 3.1,
};
