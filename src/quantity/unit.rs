//! Unit symbols, SI prefixes and dimensions: `"N/m^1.5"` to scale and [`Dimension`].

use super::QuantityError;

/// Exponents of kg, m, s, A, K and oscilloscope division, each counted in halves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension([i16; 6]);

/// The symbols of the base units, in the order of [`Dimension`]'s exponents.
const BASE: [&str; 6] = ["kg", "m", "s", "A", "K", "div"];

/// Dimension from whole exponents of kg, m, s, A, K, div.
const fn whole(exponents: [i16; 6]) -> Dimension {
    let mut halves = exponents;
    let mut i = 0;
    while i < 6 {
        halves[i] *= 2;
        i += 1;
    }
    Dimension(halves)
}

impl Dimension {
    /// A plain number.
    pub const NONE: Self = whole([0, 0, 0, 0, 0, 0]);
    /// kg.
    pub const MASS: Self = whole([1, 0, 0, 0, 0, 0]);
    /// m.
    pub const LENGTH: Self = whole([0, 1, 0, 0, 0, 0]);
    /// s.
    pub const TIME: Self = whole([0, 0, 1, 0, 0, 0]);
    /// Hz.
    pub const FREQUENCY: Self = whole([0, 0, -1, 0, 0, 0]);
    /// m/s.
    pub const SPEED: Self = whole([0, 1, -1, 0, 0, 0]);
    /// m/s².
    pub const ACCELERATION: Self = whole([0, 1, -2, 0, 0, 0]);
    /// N.
    pub const FORCE: Self = whole([1, 1, -2, 0, 0, 0]);
    /// Pa.
    pub const PRESSURE: Self = whole([1, -1, -2, 0, 0, 0]);
    /// kg/m³.
    pub const DENSITY: Self = whole([1, -3, 0, 0, 0, 0]);
    /// J.
    pub const ENERGY: Self = whole([1, 2, -2, 0, 0, 0]);
    /// N s/m.
    pub const DAMPING: Self = whole([1, 0, -1, 0, 0, 0]);
    /// N/m.
    pub const STIFFNESS: Self = whole([1, 0, -2, 0, 0, 0]);
    /// N/m^1.5.
    pub const HERTZ_STIFFNESS: Self = Self([2, -1, -4, 0, 0, 0]);
    /// K.
    pub const TEMPERATURE: Self = whole([0, 0, 0, 0, 1, 0]);
    /// 1/K.
    pub const PER_TEMPERATURE: Self = whole([0, 0, 0, 0, -1, 0]);
    /// T.
    pub const MAGNETIC_FLUX_DENSITY: Self = whole([1, 0, -2, -1, 0, 0]);
    /// C.
    pub const CHARGE: Self = whole([0, 0, 1, 1, 0, 0]);
    /// C/N.
    pub const CHARGE_PER_FORCE: Self = whole([-1, -1, 3, 1, 0, 0]);
    /// V.
    pub const VOLTAGE: Self = whole([1, 2, -3, -1, 0, 0]);
    /// V/N.
    pub const VOLTAGE_PER_FORCE: Self = whole([0, 1, -1, -1, 0, 0]);
    /// Ohm.
    pub const RESISTANCE: Self = whole([1, 2, -3, -2, 0, 0]);
    /// F.
    pub const CAPACITANCE: Self = whole([-1, -2, 4, 2, 0, 0]);
    /// div.
    pub const DIVISION: Self = whole([0, 0, 0, 0, 0, 1]);
    /// V/div.
    pub const VOLTAGE_PER_DIVISION: Self = whole([1, 2, -3, -1, 0, -1]);
    /// s/div.
    pub const TIME_PER_DIVISION: Self = whole([0, 0, 1, 0, 0, -1]);

    /// What the field calls a quantity of this dimension, with its unit: `a mass (kg)`.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        const NAMES: [(Dimension, &str); 26] = [
            (Dimension::NONE, "a plain number"),
            (Dimension::MASS, "a mass (kg)"),
            (Dimension::LENGTH, "a length (m)"),
            (Dimension::TIME, "a time (s)"),
            (Dimension::FREQUENCY, "a frequency (Hz)"),
            (Dimension::SPEED, "a speed (m/s)"),
            (Dimension::ACCELERATION, "an acceleration (m/s^2)"),
            (Dimension::FORCE, "a force (N)"),
            (Dimension::PRESSURE, "a pressure (Pa)"),
            (Dimension::DENSITY, "a density (kg/m^3)"),
            (Dimension::ENERGY, "an energy (J)"),
            (Dimension::DAMPING, "a damping coefficient (N*s/m)"),
            (Dimension::STIFFNESS, "a stiffness (N/m)"),
            (Dimension::HERTZ_STIFFNESS, "a Hertz stiffness (N/m^1.5)"),
            (Dimension::TEMPERATURE, "a temperature (K)"),
            (Dimension::PER_TEMPERATURE, "a temperature coefficient (1/K)"),
            (Dimension::MAGNETIC_FLUX_DENSITY, "a magnetic flux density (T)"),
            (Dimension::CHARGE, "a charge (C)"),
            (Dimension::CHARGE_PER_FORCE, "a piezoelectric coefficient (C/N)"),
            (Dimension::VOLTAGE, "a voltage (V)"),
            (Dimension::VOLTAGE_PER_FORCE, "a sensitivity (V/N)"),
            (Dimension::RESISTANCE, "a resistance (Ohm)"),
            (Dimension::CAPACITANCE, "a capacitance (F)"),
            (Dimension::DIVISION, "a number of divisions (div)"),
            (Dimension::VOLTAGE_PER_DIVISION, "a vertical scale (V/div)"),
            (Dimension::TIME_PER_DIVISION, "a time base (s/div)"),
        ];
        NAMES.iter().find(|(dimension, _)| *dimension == self).map(|(_, name)| *name)
    }

    /// The SI unit as the field writes it, `N`; `1` for a plain number.
    #[must_use]
    pub fn unit(self) -> String {
        let named =
            self.name().and_then(|name| Some(name.split_once('(')?.1.trim_end_matches(')')));
        match named {
            Some(unit) => unit.to_owned(),
            None if self == Self::NONE => "1".to_owned(),
            None => self.base_units(),
        }
    }

    /// The dimension spelled in base units: `kg*m^-0.5*s^-2`.
    #[must_use]
    pub fn base_units(self) -> String {
        let mut parts = Vec::new();
        for (symbol, halves) in BASE.iter().zip(self.0) {
            match halves {
                0 => {}
                2 => parts.push((*symbol).to_owned()),
                _ => parts.push(format!("{symbol}^{}", f64::from(halves) / 2.0)),
            }
        }
        parts.join("*")
    }

    fn plus(self, other: Self, halves: i16) -> Option<Self> {
        let mut sum = self.0;
        for (s, o) in sum.iter_mut().zip(other.0) {
            // `other` comes from a unit symbol, whose exponents are whole: the product stays in halves.
            *s = s.checked_add((o / 2).checked_mul(halves)?)?;
        }
        Some(Self(sum))
    }
}

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
    pub(super) fn to_si(self, number: f64) -> f64 {
        let power = self.scale.power_of_ten;
        let scaled = if power >= 0.0 { number * ten_to(power) } else { number / ten_to(-power) };
        scaled * self.scale.factor + self.offset
    }
}

/// Ten to the power of `exponent`, which is not negative (1).
fn ten_to(exponent: f64) -> f64 {
    const EXACT: [f64; 16] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number")]
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
        "Ohm" | "ohm" | "Ω" => (0.0, 1.0, Dimension::RESISTANCE, true),
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

/// What a prefix stands for, as a power of ten (1).
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
    let mut rest = text;
    let mut sign = 1;
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
    #[allow(clippy::cast_possible_truncation, reason = "checked to be a whole number within range")]
    (halves.fract() == 0.0 && halves.abs() <= 40.0).then_some((symbol, halves as i16))
}

fn look_up(symbol: &str) -> Option<(f64, f64, Dimension)> {
    if symbol == "1" {
        return Some((0.0, 1.0, Dimension::NONE));
    }
    if let Some((power, factor, dimension, _)) = symbol_of(symbol) {
        return Some((power, factor, dimension));
    }
    let mut rest = symbol.chars();
    let power_of_prefix = power_of(rest.next()?)?;
    let (power, factor, dimension, takes_prefix) = symbol_of(rest.as_str())?;
    takes_prefix.then_some((power + power_of_prefix, factor, dimension))
}
