//! Values of options: quantities with units, within bounds.

use std::ops::{Bound, RangeBounds};

use crate::quantity::{Dimension, parse};

/// Anything above zero.
pub const ABOVE_ZERO: (Bound<f64>, Bound<f64>) = (Bound::Excluded(0.0), Bound::Unbounded);

/// A parser of quantities of one dimension within `bounds` (unit); refusals show `example`.
pub fn quantity(
    dimension: Dimension,
    bounds: impl RangeBounds<f64> + Clone,
    example: &'static str,
) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| {
        let found = match parse(text, dimension) {
            Ok(value) if bounds.contains(&value) => return Ok(value),
            Ok(_) => text.to_owned(),
            Err(error) => error.to_string(),
        };
        let what = if dimension == Dimension::NONE {
            "a number".to_owned()
        } else {
            dimension.to_string()
        };
        Err(format!("found {found}, expected {what}{}, e.g. {example}", words(&bounds)))
    }
}

/// The bounds in words, with a leading space.
fn words(bounds: &impl RangeBounds<f64>) -> String {
    let number = |value: &f64| match value.abs() {
        0.0 => "zero".to_owned(),
        1e-3..1e6 => value.to_string(),
        _ => format!("{value:e}"),
    };
    let low = match bounds.start_bound() {
        Bound::Included(low) => format!(" from {}", number(low)),
        Bound::Excluded(low) => format!(" above {}", number(low)),
        Bound::Unbounded => String::new(),
    };
    match bounds.end_bound() {
        Bound::Included(high) => format!("{low} to {}", number(high)),
        Bound::Excluded(high) => format!("{low} to below {}", number(high)),
        Bound::Unbounded => low,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refusals_name_what_was_found_and_what_is_expected() {
        let force = quantity(Dimension::FORCE, ABOVE_ZERO, "2.38N");
        assert_eq!(force("2 mN"), Ok(2e-3));
        for (text, words) in [
            ("0N", "found 0N, expected a force (N) above zero, e.g. 2.38N"),
            ("2 s", "found `2 s` is a time (s), expected a force (N) above zero, e.g. 2.38N"),
        ] {
            assert_eq!(force(text), Err(words.to_owned()));
        }
        let share = quantity(Dimension::NONE, 0.0..1.0, "10%");
        assert_eq!(share("10 %"), Ok(0.1));
        let words = "found 1, expected a number from zero to below 1, e.g. 10%";
        assert_eq!(share("1"), Err(words.to_owned()));
    }
}
