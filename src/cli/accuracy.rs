//! `--accuracy`, as commands take it.

use crate::quantity::{Dimension, parse};
use crate::scene::{LOOSEST_ACCURACY, TIGHTEST_ACCURACY};

/// Reads an accuracy (1).
pub fn accuracy(text: &str) -> Result<f64, String> {
    share(text, [TIGHTEST_ACCURACY, LOOSEST_ACCURACY])
}

/// Reads a small number within limits (1).
pub fn share(text: &str, [least, most]: [f64; 2]) -> Result<f64, String> {
    let found = match parse(text, Dimension::NONE) {
        Ok(value) if (least..=most).contains(&value) => return Ok(value),
        Ok(_) => text.to_owned(),
        Err(error) => error.to_string(),
    };
    Err(format!("found {found}, expected {least:e} to {most}"))
}
