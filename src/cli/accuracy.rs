//! `--accuracy`, as commands take it.

use super::value::quantity;
use crate::experiment::RunError;
use crate::experiment::accuracy::{ChosenAccuracy, of_scene, of_scope};
use crate::quantity::Dimension;
use crate::scene::{LOOSEST_ACCURACY, Scene, TIGHTEST_ACCURACY};

/// Keyword for the accuracy derived from the scope, in scenes too.
const AUTO: &str = "auto";

/// Options of accuracy.
#[derive(Debug, Clone, Copy)]
pub enum AccuracyArguments {
    /// The accuracy derived from the scope; the scene's own does not count.
    Auto,
    /// This relative error (1).
    Value(f64),
}

impl AccuracyArguments {
    /// Reads an accuracy, or `auto`.
    pub fn parse(text: &str) -> Result<Self, String> {
        if text == AUTO {
            return Ok(Self::Auto);
        }
        accuracy(text).map(Self::Value).map_err(|error| format!("{error}, or {AUTO}"))
    }

    /// The accuracy for `scene`: `asked`, or else the scene's own.
    pub fn of(asked: Option<Self>, scene: &Scene) -> Result<ChosenAccuracy, RunError> {
        match asked {
            Some(Self::Value(value)) => {
                Ok(ChosenAccuracy { value, reason: "asked for".to_owned() })
            }
            Some(Self::Auto) => of_scope(scene),
            None => of_scene(scene),
        }
    }
}

/// Reads an accuracy (1).
pub fn accuracy(text: &str) -> Result<f64, String> {
    quantity(Dimension::NONE, TIGHTEST_ACCURACY..=LOOSEST_ACCURACY, "1e-3")(text)
}
