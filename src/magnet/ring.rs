//! An axially magnetised ring and a soft iron sphere on its axis.
//!
//! Field on the axis, `z` from the ring's centre: `B(z) = Br/2 [g(z, R2) - g(z, R1)]`,
//! `g(z, R) = a/sqrt(a^2 + R^2) - b/sqrt(b^2 + R^2)`, `a = z + L/2`, `b = z - L/2`: two current sheets of strength `Br/mu0` on the
//! outer radius `R2` and against it on the inner `R1`. Its slope `B'` has `g' = R^2 [(a^2 + R^2)^(-3/2) - (b^2 + R^2)^(-3/2)]`.
//! Source: the sheets' Biot-Savart integral, e.g. J. M. Camacho, V. Sosa, Rev. Mex. Fis. E 59, 8 (2013). Exact for magnets of
//! even magnetisation that their own field does not change, as those of rare earths nearly are.
//!
//! Force on a sphere of radius `Rs` and volume `V`: `F = V M B'`, the magnetisation `M = 3 |B|/mu0` up to saturation `Ms`: below it
//! `F = (4 pi Rs^3/mu0) B B'`, above `F = V Ms B'`. Source: a sphere of high permeability in an even field, J. D. Jackson, Classical
//! Electrodynamics (1999), section 5.11. Valid for spheres small against the field's own length; here sphere and bore are
//! of one size, so a wanted force is to be set with a balance, and this tells where to look and how steep it is.
//!
//! Remanence falls with temperature, `Br(T) = Br [1 + c (T - T0)]`: reversible, below the magnet's rated temperature.

use std::f64::consts::PI;

/// Permeability of vacuum, CODATA 2018 (N/A^2).
pub const VACUUM_PERMEABILITY: f64 = 1.256_637_062_12e-6;

/// An axially magnetised ring.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingMagnet {
    /// Radius of the bore (m).
    pub inner_radius: f64,
    /// Outer radius (m).
    pub outer_radius: f64,
    /// Length along the axis (m).
    pub length: f64,
    /// Remanence at the reference temperature (T).
    pub remanence: f64,
    /// Relative change of the remanence with temperature (1/K).
    pub temperature_coefficient: f64,
    /// Temperature at which the remanence is stated (K).
    pub reference_temperature: f64,
}

/// A soft ferromagnetic sphere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    /// Radius (m).
    pub radius: f64,
    /// Saturation as a flux density, `mu0 Ms` (T).
    pub saturation: f64,
}

/// The ring's field at one temperature.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RingField {
    ring: RingMagnet,
    /// Remanence at this temperature (T).
    pub remanence: f64,
}

impl RingMagnet {
    /// The field at `temperature` (K).
    #[must_use]
    pub fn at(&self, temperature: f64) -> RingField {
        let change = self.temperature_coefficient * (temperature - self.reference_temperature);
        RingField { ring: *self, remanence: self.remanence * (1.0 + change) }
    }
}

impl RingField {
    /// Flux density on the axis, `z` (m) from the ring's centre, along the magnetisation (T).
    #[must_use]
    pub fn field(&self, z: f64) -> f64 {
        let (a, b) = self.faces(z);
        let g = |radius: f64| a / a.hypot(radius) - b / b.hypot(radius);
        0.5 * self.remanence * (g(self.ring.outer_radius) - g(self.ring.inner_radius))
    }

    /// Its change along the axis (T/m).
    #[must_use]
    pub fn gradient(&self, z: f64) -> f64 {
        let (a, b) = self.faces(z);
        let slope =
            |radius: f64| radius * radius * (a.hypot(radius).powi(-3) - b.hypot(radius).powi(-3));
        0.5 * self.remanence * (slope(self.ring.outer_radius) - slope(self.ring.inner_radius))
    }

    /// How far `sphere` is magnetised at `z` (m): 1 is saturated (1).
    #[must_use]
    pub fn saturation(&self, z: f64, sphere: &Sphere) -> f64 {
        (3.0 * self.field(z).abs() / sphere.saturation).min(1.0)
    }

    /// Force that draws `sphere` at `z` (m) toward the ring's centre (N).
    #[must_use]
    pub fn attraction(&self, z: f64, sphere: &Sphere) -> f64 {
        let volume = 4.0 / 3.0 * PI * sphere.radius.powi(3);
        let magnetisation = self.saturation(z, sphere) * sphere.saturation / VACUUM_PERMEABILITY;
        let along = volume * magnetisation * self.gradient(z) * self.field(z).signum();
        // Along the axis, upward in z: toward the centre is against the sign of z.
        -along * z.signum()
    }

    /// Distances from the two faces.
    fn faces(&self, z: f64) -> (f64, f64) {
        (z + 0.5 * self.ring.length, z - 0.5 * self.ring.length)
    }
}
