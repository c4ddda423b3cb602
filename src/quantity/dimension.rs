//! Dimensions: exponents of the base units, and what the field calls them.

/// Exponents of kg, m, s, A, K and oscilloscope division, each counted in halves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension(pub(super) [i16; 6]);

/// The symbols of the base units, in the order of [`Dimension`]'s exponents.
pub(super) const BASE: [&str; 6] = ["kg", "m", "s", "A", "K", "div"];

/// Dimension from whole exponents of kg, m, s, A, K, div.
pub(super) const fn whole(exponents: [i16; 6]) -> Dimension {
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

    /// Name of a quantity of this dimension, with its unit: `a mass (kg)`.
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

    /// A quantity of this dimension as it is typed.
    pub fn example(self) -> Option<&'static str> {
        const EXAMPLES: [(Dimension, &str); 12] = [
            (Dimension::MASS, "3.5 g"),
            (Dimension::LENGTH, "4.76 mm"),
            (Dimension::TIME, "2 ms"),
            (Dimension::FREQUENCY, "20 kHz"),
            (Dimension::SPEED, "0.6 m/s"),
            (Dimension::ACCELERATION, "9.81 m/s^2"),
            (Dimension::FORCE, "2.4 N"),
            (Dimension::PRESSURE, "193 GPa"),
            (Dimension::DENSITY, "2200 kg/m^3"),
            (Dimension::VOLTAGE, "200 mV"),
            (Dimension::VOLTAGE_PER_DIVISION, "500 mV/div"),
            (Dimension::TIME_PER_DIVISION, "250 us/div"),
        ];
        EXAMPLES.iter().find(|(dimension, _)| *dimension == self).map(|(_, example)| *example)
    }

    /// The SI unit as the field writes it, `N`; `1` for a plain number.
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

    pub(super) fn plus(self, other: Self, halves: i16) -> Option<Self> {
        let mut sum = self.0;
        for (s, o) in sum.iter_mut().zip(other.0) {
            // `other` comes from a unit symbol, whose exponents are whole: the product stays in halves.
            *s = s.checked_add((o / 2).checked_mul(halves)?)?;
        }
        Some(Self(sum))
    }
}
