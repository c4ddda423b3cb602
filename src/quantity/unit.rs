//! Unit symbols, SI prefixes and dimensions: `"N/m^1.5"` to scale and [`Dimension`].

use super::QuantityError;
use super::dimension::{Dimension, whole};

/// A unit: SI value = number * scale + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Unit {
    pub(super) dimension: Dimension,
    scale: Scale,
    offset: f64,
}

/// Scale as a decimal power times a factor. Powers of ten are applied by one correctly rounded
/// multiplication or division, so that `0.61 g` is the same `f64` as `0.61e-3`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Scale {
    power_of_ten: f64,
    factor: f64,
}

impl Unit {
    /// SI value of a number of this unit (unit).
    pub(super) fn to_si(self, number: f64) -> f64 {
        self.scaled(number) + self.offset
    }

    /// SI value of a difference of this many units (unit).
    pub(super) fn scaled(self, number: f64) -> f64 {
        let power = self.scale.power_of_ten;
        let scaled = if power >= 0.0 { number * ten_to(power) } else { number / ten_to(-power) };
        scaled * self.scale.factor
    }
}

/// Ten to the power of `exponent`, which is not negative (1).
fn ten_to(exponent: f64) -> f64 {
    const EXACT: [f64; 16] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let exact = if exponent.fract() == 0.0 { EXACT.get(exponent as usize) } else { None };
    exact.copied().unwrap_or_else(|| 10f64.powf(exponent))
}

/// A unit symbol without prefix: power of ten, factor, dimension, may carry a prefix.
type Symbol = (f64, f64, Dimension, bool);

fn symbol_of(name: &str) -> Option<Symbol> {
    Some(match name {
        "g" => (-3.0, 1.0, Dimension::MASS, true),
        "m" => (0.0, 1.0, Dimension::LENGTH, true),
        "s" => (0.0, 1.0, Dimension::TIME, true),
        "min" => (0.0, 60.0, Dimension::TIME, false),
        "h" => (0.0, 3600.0, Dimension::TIME, false),
        "A" => (0.0, 1.0, whole([0, 0, 0, 1, 0, 0]), true),
        "K" => (0.0, 1.0, Dimension::TEMPERATURE, true),
        "Hz" => (0.0, 1.0, Dimension::FREQUENCY, true),
        "N" => (0.0, 1.0, Dimension::FORCE, true),
        "Pa" => (0.0, 1.0, Dimension::PRESSURE, true),
        "bar" => (5.0, 1.0, Dimension::PRESSURE, true),
        "J" => (0.0, 1.0, Dimension::ENERGY, true),
        "C" => (0.0, 1.0, Dimension::CHARGE, true),
        "V" => (0.0, 1.0, Dimension::VOLTAGE, true),
        "Ohm" | "ohm" | "\u{3a9}" | "\u{2126}" => (0.0, 1.0, Dimension::RESISTANCE, true),
        "F" => (0.0, 1.0, Dimension::CAPACITANCE, true),
        "T" => (0.0, 1.0, Dimension::MAGNETIC_FLUX_DENSITY, true),
        "div" => (0.0, 1.0, Dimension::DIVISION, false),
        "in" => (-2.0, 2.54, Dimension::LENGTH, false),
        "%" => (-2.0, 1.0, Dimension::NONE, false),
        "ppm" => (-6.0, 1.0, Dimension::NONE, false),
        "t" => (3.0, 1.0, Dimension::MASS, false),
        _ => return None,
    })
}

/// Power of ten of a prefix (1).
fn power_of(prefix: char) -> Option<f64> {
    Some(match prefix {
        'f' => -15.0,
        'p' => -12.0,
        'n' => -9.0,
        'u' | 'µ' | 'μ' => -6.0,
        'm' => -3.0,
        'c' => -2.0,
        'k' => 3.0,
        'M' => 6.0,
        'G' => 9.0,
        'T' => 12.0,
        'P' => 15.0,
        _ => return None,
    })
}

/// Reads a product of unit symbols; an empty text is the plain number's unit.
pub(super) fn parse(text: &str) -> Result<Unit, QuantityError> {
    let plain = Unit {
        dimension: Dimension::NONE,
        scale: Scale { power_of_ten: 0.0, factor: 1.0 },
        offset: 0.0,
    };
    if text.is_empty() {
        return Ok(plain);
    }
    if matches!(text, "°C" | "degC") {
        return Ok(Unit { dimension: Dimension::TEMPERATURE, offset: 273.15, ..plain });
    }
    let unknown = |symbol: &str| QuantityError::UnknownUnit { unit: symbol.trim().to_owned() };
    let mut unit = plain;
    let mut sign = 1;
    // `/K` is `1/K`.
    let mut rest = text;
    if let Some(divisor) = text.strip_prefix('/') {
        (rest, sign) = (divisor.trim_start(), -1);
    }
    loop {
        let end = rest.find(['*', '·', '/', ' ']).unwrap_or(rest.len());
        let (factor, tail) = rest.split_at(end);
        let (symbol, halves) = split_exponent(factor).ok_or_else(|| unknown(factor))?;
        let (power, scale, dimension) = look_up(symbol).ok_or_else(|| unknown(text))?;
        let halves = halves * sign;
        let exponent = f64::from(halves) / 2.0;
        unit.dimension = unit.dimension.plus(dimension, halves).ok_or_else(|| unknown(text))?;
        unit.scale.power_of_ten += power * exponent;
        unit.scale.factor *= if (scale - 1.0).abs() > 0.0 { scale.powf(exponent) } else { 1.0 };
        let tail = tail.trim_start();
        let Some(joint) = tail.chars().next() else {
            return Ok(unit);
        };
        // Only what stands right behind a slash is divided: `N*s/m`, but `m/s/s` as well.
        sign = if joint == '/' { -1 } else { 1 };
        rest = if matches!(joint, '*' | '·' | '/') {
            tail[joint.len_utf8()..].trim_start()
        } else {
            tail
        };
        if rest.is_empty() {
            return Err(unknown(text));
        }
    }
}

/// `m^1.5` to (`m`, 3 halves); `s²` to (`s`, 4 halves).
fn split_exponent(factor: &str) -> Option<(&str, i16)> {
    if let Some(symbol) = factor.strip_suffix('²') {
        return Some((symbol, 4));
    }
    if let Some(symbol) = factor.strip_suffix('³') {
        return Some((symbol, 6));
    }
    let Some((symbol, exponent)) = factor.split_once('^') else {
        return Some((factor, 2));
    };
    let halves = exponent.parse::<f64>().ok()? * 2.0;
    (halves.fract() == 0.0 && halves.abs() <= 40.0).then_some((symbol, halves as i16))
}

fn look_up(symbol: &str) -> Option<(f64, f64, Dimension)> {
    match symbol {
        "1" => return Some((0.0, 1.0, Dimension::NONE)),
        // Beside other units a degree is a difference: `%/°C`.
        "°C" | "degC" => return Some((0.0, 1.0, Dimension::TEMPERATURE)),
        _ => {}
    }
    if let Some((power, factor, dimension, _)) = symbol_of(symbol) {
        return Some((power, factor, dimension));
    }
    let mut rest = symbol.chars();
    let power_of_prefix = power_of(rest.next()?)?;
    let (power, factor, dimension, takes_prefix) = symbol_of(rest.as_str())?;
    takes_prefix.then_some((power + power_of_prefix, factor, dimension))
}
