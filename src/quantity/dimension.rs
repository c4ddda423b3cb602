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

/// Dimensions with their names, and how a quantity of each is typed, where that is asked for.
macro_rules! dimensions {
    ($($dimension:ident: $exponents:expr, $name:literal $(, $example:literal)?;)+) => {
        impl Dimension {
            $(#[doc = concat!("Dimension of ", $name, ".")] pub const $dimension: Self = $exponents;)+
        }

        /// Each dimension with its name and its example.
        const NAMES: &[(Dimension, &str, &[&str])] = &[$((Dimension::$dimension, $name, &[$($example)?])),+];
    };
}

dimensions! {
    NONE: whole([0, 0, 0, 0, 0, 0]), "a plain number";
    MASS: whole([1, 0, 0, 0, 0, 0]), "a mass (kg)", "3.5 g";
    LENGTH: whole([0, 1, 0, 0, 0, 0]), "a length (m)", "4.76 mm";
    TIME: whole([0, 0, 1, 0, 0, 0]), "a time (s)", "2 ms";
    FREQUENCY: whole([0, 0, -1, 0, 0, 0]), "a frequency (Hz)", "20 kHz";
    SPEED: whole([0, 1, -1, 0, 0, 0]), "a speed (m/s)", "0.6 m/s";
    ACCELERATION: whole([0, 1, -2, 0, 0, 0]), "an acceleration (m/s^2)", "9.81 m/s^2";
    FORCE: whole([1, 1, -2, 0, 0, 0]), "a force (N)", "2.4 N";
    PRESSURE: whole([1, -1, -2, 0, 0, 0]), "a pressure (Pa)", "193 GPa";
    DENSITY: whole([1, -3, 0, 0, 0, 0]), "a density (kg/m^3)", "2200 kg/m^3";
    ENERGY: whole([1, 2, -2, 0, 0, 0]), "an energy (J)";
    DAMPING: whole([1, 0, -1, 0, 0, 0]), "a damping coefficient (N*s/m)";
    STIFFNESS: whole([1, 0, -2, 0, 0, 0]), "a stiffness (N/m)";
    HERTZ_STIFFNESS: Dimension([2, -1, -4, 0, 0, 0]), "a Hertz stiffness (N/m^1.5)";
    TEMPERATURE: whole([0, 0, 0, 0, 1, 0]), "a temperature (K)";
    PER_TEMPERATURE: whole([0, 0, 0, 0, -1, 0]), "a temperature coefficient (1/K)";
    MAGNETIC_FLUX_DENSITY: whole([1, 0, -2, -1, 0, 0]), "a magnetic flux density (T)";
    CHARGE: whole([0, 0, 1, 1, 0, 0]), "a charge (C)";
    CHARGE_PER_FORCE: whole([-1, -1, 3, 1, 0, 0]), "a piezoelectric coefficient (C/N)";
    VOLTAGE: whole([1, 2, -3, -1, 0, 0]), "a voltage (V)", "200 mV";
    VOLTAGE_PER_FORCE: whole([0, 1, -1, -1, 0, 0]), "a sensitivity (V/N)";
    VOLTAGE_PER_SPEED: whole([1, 1, -2, -1, 0, 0]), "a vibrometer's sensitivity (V*s/m)", "5 V*s/m";
    VOLTAGE_PER_ACCELERATION: whole([1, 1, -1, -1, 0, 0]), "an accelerometer's sensitivity (V*s^2/m)", "1 mV*s^2/m";
    VOLTAGE_PER_CHARGE: whole([1, 2, -4, -2, 0, 0]), "a charge amplifier's gain (V/C)", "10 mV/pC";
    RESISTANCE: whole([1, 2, -3, -2, 0, 0]), "a resistance (Ohm)";
    CAPACITANCE: whole([-1, -2, 4, 2, 0, 0]), "a capacitance (F)";
    DIVISION: whole([0, 0, 0, 0, 0, 1]), "a number of divisions (div)";
    VOLTAGE_PER_DIVISION: whole([1, 2, -3, -1, 0, -1]), "a vertical scale (V/div)", "500 mV/div";
    VOLTAGE_PER_TIME: whole([1, 2, -4, -1, 0, 0]), "a drift (V/s)", "20 V/s";
    TIME_PER_DIVISION: whole([0, 0, 1, 0, 0, -1]), "a time base (s/div)", "250 us/div";
}

impl Dimension {
    fn row(self) -> Option<&'static (Self, &'static str, &'static [&'static str])> {
        NAMES.iter().find(|(dimension, ..)| *dimension == self)
    }

    /// Name of a quantity of this dimension, with its unit: `a mass (kg)`.
    pub fn name(self) -> Option<&'static str> {
        self.row().map(|(_, name, _)| *name)
    }

    /// A quantity of this dimension as it is typed.
    pub fn example(self) -> Option<&'static str> {
        self.row().and_then(|(.., example)| example.first().copied())
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
            // `other` comes from a unit symbol, whose exponents are whole: the product stays in
            // halves.
            *s = s.checked_add((o / 2).checked_mul(halves)?)?;
        }
        Some(Self(sum))
    }
}
