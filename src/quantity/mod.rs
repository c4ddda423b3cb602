//! Physical quantities at the border: text with a unit in, plain SI `f64` inside.
//!
//! `scene` reads `"0.61 g"` through [`parse`], `report` and `tui` write numbers through
//! [`engineering`]. Inside the program every `f64` is in SI units; only this module converts
//! grams or microseconds.
//!
//! A [`Dimension`] is a vector of exponents over kilogram, metre, second, ampere, kelvin and the
//! oscilloscope's division. Exponents are counted in halves, because a Hertz contact's stiffness
//! has the unit N/m^1.5.

mod dimension;
mod error;
mod printable;
mod unit;

pub use dimension::Dimension;
pub use error::QuantityError;
pub use printable::{printable, printable_line};

use std::fmt;
use std::str::FromStr;

use crate::numeric::intervals::expanded_95;
use serde::ser::{Serialize, SerializeStruct, Serializer};
use unit::Unit;

/// A number with its standard uncertainty; JSON has `value`, `u`, and `U95`, the expanded
/// uncertainty that is printed behind `±`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Uncertain {
    /// The number (unit).
    pub value: f64,
    /// Its standard uncertainty (unit).
    pub u: f64,
    /// Half-width of the evenly distributed part in that, such as a gain within a data sheet's
    /// limits; the rest is normal (unit).
    pub half_width: f64,
}

impl Uncertain {
    /// A normally distributed quantity.
    pub fn normal(value: f64, u: f64) -> Self {
        Self { value, u, half_width: 0.0 }
    }

    /// Expanded uncertainty for 95 % of a quantity whose standard uncertainty is known well (unit).
    pub fn expanded(self) -> f64 {
        expanded_95(self.u, self.half_width)
    }

    /// True if both numbers are finite and the standard uncertainty is no larger than the value:
    /// beyond that a measurement says nothing of the quantity, and propagation of uncertainty does
    /// not hold.
    pub fn is_known(self) -> bool {
        self.value.is_finite() && self.u >= 0.0 && self.u <= self.value.abs()
    }

    /// This over another, independent of it.
    pub fn over(self, other: Self) -> Self {
        let value = self.value / other.value;
        Self::normal(value, (value * (self.u / self.value).hypot(other.u / other.value)).abs())
    }
}

impl Serialize for Uncertain {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("Uncertain", 3)?;
        fields.serialize_field("value", &self.value)?;
        fields.serialize_field("u", &self.u)?;
        fields.serialize_field("U95", &self.expanded())?;
        fields.end()
    }
}

/// An absolute value read from text, whatever its dimension: `20 °C` is 293.15 K.
///
/// The number may use `_` between digits; white space between number and unit is free. A unit is a
/// product of symbols with optional SI prefix and exponent, joined by `*`, `·` or `/`:
/// `kg`, `mm`, `m/s^2`, `N/m^1.5`, `pC/N`, `mV/div`, `%/°C`. A dimensionless value needs no unit;
/// `%` and `ppm` are understood.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Value in SI units (unit).
    pub value: f64,
    /// Dimension of the unit.
    pub dimension: Dimension,
}

/// A difference of two values read from text: `5 °C` is 5 K, because the zero of the unit cancels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Value in SI units (unit).
    pub value: f64,
    /// Dimension of the unit.
    pub dimension: Dimension,
}

impl FromStr for Quantity {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let (value, dimension) = read(text, Unit::to_si)?;
        Ok(Self { value, dimension })
    }
}

impl FromStr for Difference {
    type Err = QuantityError;

    fn from_str(text: &str) -> Result<Self, QuantityError> {
        let (value, dimension) = read(text, Unit::scaled)?;
        Ok(Self { value, dimension })
    }
}

/// Reads `text` as a value of `dimension` in SI units.
///
/// ```
/// use hertzscope::quantity::{parse, Dimension};
/// assert_eq!(parse("0.61 g", Dimension::MASS), Ok(0.61e-3));
/// assert!(parse("0.61 g", Dimension::LENGTH).is_err());
/// ```
///
/// # Errors
/// [`QuantityError`] when there is no number, the number is not finite, a unit symbol is unknown,
/// or the unit measures something other than `dimension`.
pub fn parse(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    let Quantity { value, dimension: found } = text.parse()?;
    of_dimension(text, (value, found), dimension)
}

/// Reads `text` as a difference of two values of `dimension` in SI units.
///
/// # Errors
/// As [`parse`].
pub fn parse_difference(text: &str, dimension: Dimension) -> Result<f64, QuantityError> {
    let Difference { value, dimension: found } = text.parse()?;
    of_dimension(text, (value, found), dimension)
}

/// The value that was read from `text`, if it has the wanted dimension.
fn of_dimension(
    text: &str,
    (value, found): (f64, Dimension),
    dimension: Dimension,
) -> Result<f64, QuantityError> {
    if found == dimension {
        Ok(value)
    } else {
        Err(QuantityError::WrongDimension { text: text.trim().to_owned(), found })
    }
}

/// Number and unit of `text`, both without white space around them.
pub fn split(text: &str) -> (&str, &str) {
    let text = text.trim();
    let (number, unit) = text.split_at(number_length(text));
    (number, unit.trim())
}

fn read(text: &str, to_si: fn(Unit, f64) -> f64) -> Result<(f64, Dimension), QuantityError> {
    // Documents print U+2212 as the sign of negative numbers.
    let plain = text.replace('\u{2212}', "-");
    let (number, unit) = split(&plain);
    let value: f64 = number
        .replace('_', "")
        .parse()
        .map_err(|_| QuantityError::NoNumber { text: text.trim().to_owned() })?;
    let unit = unit::parse(unit)?;
    let si = to_si(unit, value);
    if si.is_finite() {
        Ok((si, unit.dimension))
    } else {
        Err(QuantityError::NotFinite { text: text.trim().to_owned() })
    }
}

/// Length of the longest prefix that reads as a decimal number; `nan` and `inf` count, so that they
/// can be refused by name instead of as a missing number.
fn number_length(text: &str) -> usize {
    let sign = usize::from(text.starts_with(['+', '-']));
    let unsigned = &text[sign..];
    for word in ["nan", "inf", "infinity"] {
        let Some((head, tail)) = unsigned.split_at_checked(word.len()) else { break };
        if head.eq_ignore_ascii_case(word) && !tail.starts_with(|c: char| c.is_alphanumeric()) {
            return sign + word.len();
        }
    }
    let bytes = text.as_bytes();
    let digits = |mut at: usize| {
        while bytes.get(at).is_some_and(|b| b.is_ascii_digit() || *b == b'_') {
            at += 1;
        }
        at
    };
    let mut end = digits(sign);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let start = end + 1 + sign;
        if digits(start) > start {
            end = digits(start);
        }
    }
    end
}

/// A number in engineering notation: mantissa of `digits` significant digits, an SI prefix, the
/// unit. A thousand `g` or more have no prefix: as an acceleration they are no kilogram.
///
/// ```
/// use hertzscope::quantity::engineering;
/// assert_eq!(engineering(5.529e-5, "s", 4), "55.29 µs");
/// assert_eq!(engineering(0.0, "N", 3), "0 N");
/// ```
pub fn engineering(value: f64, unit: &str, digits: usize) -> String {
    const PREFIXES: [(&str, i32); 11] = [
        ("f", -15),
        ("p", -12),
        ("n", -9),
        ("µ", -6),
        ("m", -3),
        ("", 0),
        ("k", 3),
        ("M", 6),
        ("G", 9),
        ("T", 12),
        ("P", 15),
    ];
    let digits = digits.max(1);
    if value == 0.0 || !value.is_finite() {
        let number = if value == 0.0 { "0".to_owned() } else { value.to_string() };
        return join(&number, "", unit);
    }
    // Round first: 999.96 to four digits is 1.000 k, not 1000.
    let rounded: f64 = format!("{:.*e}", digits - 1, value).parse().unwrap_or(value);
    let exponent = decimal_exponent(rounded);
    let group = exponent.div_euclid(3) * 3;
    let Some((prefix, power)) = PREFIXES.iter().find(|(_, power)| *power == group) else {
        return join(&format!("{:.*e}", digits - 1, value), "", unit);
    };
    if group > 0 && (unit == "g" || unit.starts_with("g/")) {
        return join(&format!("{value:.0}"), "", unit);
    }
    let before = usize::try_from(exponent - power).unwrap_or(0) + 1;
    let mantissa = rounded / 10f64.powi(*power);
    join(&format!("{:.*}", digits.saturating_sub(before), mantissa), prefix, unit)
}

fn join(number: &str, prefix: &str, unit: &str) -> String {
    if prefix.is_empty() && unit.is_empty() {
        number.to_owned()
    } else {
        format!("{number} {prefix}{unit}")
    }
}

/// Decimal exponent of a finite, non-zero number: the `e` in its scientific notation, free of the
/// rounding a logarithm would add.
fn decimal_exponent(value: f64) -> i32 {
    format!("{value:e}").rsplit('e').next().and_then(|e| e.parse().ok()).unwrap_or(0)
}

/// A number with C's `%.{decimals}e`: two exponent digits at least, always signed (`2.500000e+03`).
/// This is how the TDS2000 family writes its file headers.
pub fn c_exponential(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$e}");
    match text.split_once('e') {
        Some((mantissa, exponent)) => {
            let (sign, digits) = match exponent.strip_prefix('-') {
                Some(digits) => ('-', digits),
                None => ('+', exponent),
            };
            format!("{mantissa}e{sign}{digits:0>2}")
        }
        None => text,
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.name() {
            Some(name) => write!(f, "{name}"),
            None => write!(f, "a quantity in {}", self.base_units()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::dimension::whole;
    use super::*;

    #[test]
    fn units_scale_to_si() {
        for (text, dimension, si) in [
            ("4.76 mm", Dimension::LENGTH, 4.76e-3),
            ("9.525mm", Dimension::LENGTH, 9.525e-3),
            ("10 us", Dimension::TIME, 10e-6),
            ("10 µs", Dimension::TIME, 10e-6),
            ("1.46 GPa", Dimension::PRESSURE, 1.46e9),
            ("9.81 m/s^2", Dimension::ACCELERATION, 9.81),
            ("119.4 MN/m^1.5", Dimension::HERTZ_STIFFNESS, 119.4e6),
            ("400 pC/N", Dimension::CHARGE_PER_FORCE, 400e-12),
            ("500 mV/div", Dimension::VOLTAGE_PER_DIVISION, 0.5),
            ("1 kN*s/m", Dimension::DAMPING, 1e3),
            ("20 °C", Dimension::TEMPERATURE, 293.15),
            ("5 %", Dimension::NONE, 0.05),
            ("1_000", Dimension::NONE, 1000.0),
            ("-4 div", Dimension::DIVISION, -4.0),
            ("1 MOhm", Dimension::RESISTANCE, 1e6),
            ("10 kΩ", Dimension::RESISTANCE, 1e4),
            ("20 pF", Dimension::CAPACITANCE, 20e-12),
            ("1 min", Dimension::TIME, 60.0),
            // U+2126 OHM SIGN, as character maps and PDF files have it, and U+2212 MINUS SIGN.
            ("10 k\u{2126}", Dimension::RESISTANCE, 1e4),
            ("\u{2212}4 div", Dimension::DIVISION, -4.0),
            ("1e\u{2212}3 V", Dimension::VOLTAGE, 1e-3),
            // Temperature coefficients as data sheets print them.
            ("-0.12 %/°C", Dimension::PER_TEMPERATURE, -1.2e-3),
            ("-0.12 %/degC", Dimension::PER_TEMPERATURE, -1.2e-3),
            ("0.003 /K", Dimension::PER_TEMPERATURE, 3e-3),
            ("0.003 / °C", Dimension::PER_TEMPERATURE, 3e-3),
            ("30 ppm/K", Dimension::PER_TEMPERATURE, 3e-5),
            ("2 mV/°C", whole([1, 2, -3, -1, -1, 0]), 2e-3),
        ] {
            let value = parse(text, dimension).expect(text);
            assert!(
                (value - si).abs() <= 2.0 * f64::EPSILON * si.abs(),
                "{text}: {value} is not {si}"
            );
        }
    }

    /// Values of the SI brochure (BIPM, 9th edition, table 7).
    #[test]
    fn every_prefix_has_its_si_value() {
        for (prefix, power) in [
            ("f", "e-15"),
            ("p", "e-12"),
            ("n", "e-9"),
            ("u", "e-6"),
            ("\u{b5}", "e-6"),
            ("\u{3bc}", "e-6"),
            ("m", "e-3"),
            ("c", "e-2"),
            ("", "e0"),
            ("k", "e3"),
            ("M", "e6"),
            ("G", "e9"),
            ("T", "e12"),
            ("P", "e15"),
        ] {
            let text = format!("3 {prefix}V");
            let si: f64 = format!("3{power}").parse().expect("a number");
            assert_eq!(parse(&text, Dimension::VOLTAGE), Ok(si), "{text}");
        }
        for unknown in ["3 dV", "3 KV", "3 xV"] {
            assert!(parse(unknown, Dimension::VOLTAGE).is_err(), "{unknown}");
        }
    }

    #[test]
    fn what_engineering_notation_prints_can_be_read() {
        for exponent in -15..18 {
            let value = 1.234 * 10f64.powi(exponent);
            let text = engineering(value, "V", 4);
            let read = parse(&text, Dimension::VOLTAGE).expect(&text);
            assert!((read / value - 1.0).abs() < 1e-12, "{text}: {read}");
        }
    }

    /// A difference of 5 °C is 5 K; 5 °C is 278.15 K.
    #[test]
    fn a_difference_leaves_the_zero_of_its_unit_out() {
        let read = |text| parse_difference(text, Dimension::TEMPERATURE).expect(text);
        assert!((read("5 °C") - 5.0).abs() < 1e-12 && (read("5 degC") - 5.0).abs() < 1e-12);
        assert_eq!(read("5 K").to_bits(), 5.0_f64.to_bits());
        assert!(parse_difference("5 s", Dimension::TEMPERATURE).is_err());
    }

    #[test]
    fn bad_text_is_named() {
        assert!(matches!(parse("mm", Dimension::LENGTH), Err(QuantityError::NoNumber { .. })));
        assert!(matches!(
            parse("3 furlong", Dimension::LENGTH),
            Err(QuantityError::UnknownUnit { .. })
        ));
        assert!(matches!(parse("nan m", Dimension::LENGTH), Err(QuantityError::NotFinite { .. })));
        assert!(matches!(
            parse("1e999 m", Dimension::LENGTH),
            Err(QuantityError::NotFinite { .. })
        ));
        let error = parse("3 kg", Dimension::LENGTH).expect_err("a mass is no length");
        assert_eq!(error.to_string(), "`3 kg` is a mass (kg)");
    }

    #[test]
    fn engineering_notation_rounds_across_a_prefix() {
        assert_eq!(engineering(999.96, "N", 4), "1.000 kN");
        assert_eq!(engineering(-0.000_001_234, "V", 3), "-1.23 µV");
        assert_eq!(engineering(170.9, "m/s", 4), "170.9 m/s");
        assert_eq!(engineering(1e-20, "N", 3), "1.00e-20 N");
        assert_eq!(engineering(5012.4, "g", 4), "5012 g");
        assert_eq!(engineering(2000.0, "g/div", 3), "2000 g/div");
        assert_eq!(engineering(0.0124, "g", 3), "12.4 mg");
    }

    #[test]
    fn c_exponent_has_two_digits() {
        assert_eq!(c_exponential(2500.0, 6), "2.500000e+03");
        assert_eq!(c_exponential(-0.0, 12), "-0.000000000000e+00");
        assert_eq!(c_exponential(2e-7, 6), "2.000000e-07");
    }
}
