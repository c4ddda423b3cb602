//! How well the gain of a scope's channel is known when its volts become newtons.
//!
//! A data sheet's limit `a` counts as a rectangular distribution, `u = a/sqrt(3)` (JCGM 100:2008, 4.3.7). A sensor that was calibrated with its
//! channel as one chain carries that channel's gain: at the same channel and range nothing is added, elsewhere both gains count.

use crate::scope::{Model, VerticalSetup};
use crate::sensor::InChain;

/// Relative standard uncertainty of the gain of channel `number`, set as `vertical`, for a sensor that was calibrated in `chain` (1).
pub fn gain_u(model: &Model, number: u8, vertical: &VerticalSetup, chain: Option<InChain>) -> f64 {
    let of = |scale: f64| model.accuracy.gain_at(scale / vertical.probe) / 3f64.sqrt();
    match chain {
        Some(chain) if chain.is(number, vertical.scale) => 0.0,
        Some(chain) => of(vertical.scale).hypot(of(chain.range)),
        None => of(vertical.scale),
    }
}
