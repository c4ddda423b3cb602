//! Results as JSON, and the check that every number of a result is finite.
//!
//! Every result passes this check before it is printed, drawn or written, as text or as JSON. A
//! value that is legitimately absent is an `Option`: `null` in JSON, `-` in text.

use ciborium::Value;
use serde::Serialize;

/// Error of a result that cannot be shown.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ResultError {
    /// A number is infinite or not a number.
    #[error(
        "found {value} for `{quantity}`, expected a finite number: an input is too large or too small for this result"
    )]
    NotFinite {
        /// Path of the quantity in the result, e.g. `places[0].force_n`.
        quantity: String,
        /// The value as text.
        value: String,
    },
    /// The result cannot be written as JSON.
    #[error("the result cannot be written as JSON: {0}")]
    Json(String),
}

/// Checks that every number in `result` is finite.
///
/// # Errors
/// [`ResultError::NotFinite`] with the path of the first number that is not.
pub fn check_finite<R: Serialize + ?Sized>(result: &R) -> Result<(), ResultError> {
    let value = Value::serialized(result).map_err(|error| ResultError::Json(error.to_string()))?;
    let Some((path, value)) = not_finite(&value, "") else { return Ok(()) };
    let quantity = if path.is_empty() { "the result" } else { path.trim_start_matches('.') };
    Err(ResultError::NotFinite { quantity: quantity.to_owned(), value: value.to_string() })
}

/// `result` as indented JSON.
///
/// # Errors
/// As [`check_finite`].
pub fn to_json<R: Serialize + ?Sized>(result: &R) -> Result<String, ResultError> {
    check_finite(result)?;
    serde_json::to_string_pretty(result).map_err(|error| ResultError::Json(error.to_string()))
}

/// The first number in `value` that is not finite, with its path.
fn not_finite(value: &Value, path: &str) -> Option<(String, f64)> {
    match value {
        Value::Float(number) if !number.is_finite() => Some((path.to_owned(), *number)),
        Value::Array(parts) => parts
            .iter()
            .enumerate()
            .find_map(|(index, part)| not_finite(part, &format!("{path}[{index}]"))),
        Value::Map(fields) => fields.iter().find_map(|(key, field)| {
            let key = key.as_text().unwrap_or("?");
            not_finite(field, &format!("{path}.{key}"))
        }),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde::Serialize;

    use super::{ResultError, check_finite, to_json};

    #[derive(Serialize)]
    struct Inner {
        force_n: f64,
        known: Option<f64>,
    }

    #[derive(Serialize)]
    struct Outer {
        title: &'static str,
        places: Vec<Inner>,
        #[serde(flatten)]
        more: BTreeMap<String, f64>,
    }

    fn outer(force_n: f64, known: Option<f64>, more: f64) -> Outer {
        let places = vec![Inner { force_n: 1.0, known: None }, Inner { force_n, known }];
        Outer { title: "inf", places, more: BTreeMap::from([("step_hz".to_owned(), more)]) }
    }

    #[test]
    fn a_number_that_is_not_finite_is_refused_with_its_path() {
        assert_eq!(check_finite(&outer(2.0, Some(3.0), 4.0)), Ok(()));
        for (result, quantity, value) in [
            (outer(f64::INFINITY, None, 1.0), "places[1].force_n", "inf"),
            (outer(1.0, Some(f64::NAN), 1.0), "places[1].known", "NaN"),
            (outer(1.0, None, f64::NEG_INFINITY), "step_hz", "-inf"),
        ] {
            let (quantity, value) = (quantity.to_owned(), value.to_owned());
            assert_eq!(check_finite(&result), Err(ResultError::NotFinite { quantity, value }));
            assert!(to_json(&result).is_err());
        }
        assert!(to_json(&outer(1.0, None, 1.0)).is_ok_and(|text| text.contains("\"known\": null")));
    }
}
