//! An axially magnetised ring and a soft iron sphere on its axis.
//!
//! Field on the axis, `z` from the ring's centre: `B(z) = Br/2 [g(z, R2) - g(z, R1)]`,
//! `g(z, R) = a/sqrt(a^2 + R^2) - b/sqrt(b^2 + R^2)`, `a = z + L/2`, `b = z - L/2`: two current
//! sheets of strength `Br/mu0` on the outer radius `R2` and against it on the inner `R1`. Its slope
//! `B'` has `g' = R^2 [(a^2 + R^2)^(-3/2) - (b^2 + R^2)^(-3/2)]`. Source: the sheets' Biot-Savart
//! integral, e.g. J. M. Camacho, V. Sosa, Rev. Mex. Fis. E 59, 8 (2013). Exact for magnets of even
//! magnetisation that their own field does not change, as those of rare earths nearly are.
//!
//! Force on a sphere of radius `Rs` and volume `V`: `F = V M B'`, the magnetisation `M = 3 |B|/mu0`
//! up to saturation `Ms`: below it `F = (4 pi Rs^3/mu0) B B'`, above `F = V Ms B'`. Source: a
//! sphere of high permeability in an even field, J. D. Jackson, Classical Electrodynamics (1999),
//! section 5.11. Valid for spheres small against the field's own length; here sphere and bore are
//! of one size, so a wanted force is to be set with a balance, and this tells where to look and how
//! steep it is. The force is the slope of an energy, `-W`: `W = (2 pi Rs^3/mu0) B^2` below
//! saturation, `V Ms |B| - (2 pi Rs^3/mu0) (mu0 Ms/3)^2` above.
//!
//! Remanence falls with temperature, `Br(T) = Br [1 + c (T - T0)]`: reversible, below the magnet's
//! rated temperature.

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
    /// Temperature at which its material is no magnet any more, infinite if that is not known (K).
    pub curie_temperature: f64,
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

impl Sphere {
    /// Its volume (m^3).
    pub fn volume(&self) -> f64 {
        4.0 / 3.0 * PI * self.radius.powi(3)
    }
}

impl RingMagnet {
    /// The field at `temperature` (K).
    pub fn at(&self, temperature: f64) -> RingField {
        let change = self.temperature_coefficient * (temperature - self.reference_temperature);
        RingField { ring: *self, remanence: self.remanence * (1.0 + change) }
    }
}

impl RingField {
    /// Flux density on the axis, `z` (m) from the ring's centre, along the magnetisation (T).
    pub fn field(&self, z: f64) -> f64 {
        let (a, b) = self.faces(z);
        let g = |radius: f64| a / a.hypot(radius) - b / b.hypot(radius);
        0.5 * self.remanence * (g(self.ring.outer_radius) - g(self.ring.inner_radius))
    }

    /// Its change along the axis (T/m).
    pub fn gradient(&self, z: f64) -> f64 {
        let (a, b) = self.faces(z);
        let slope =
            |radius: f64| radius * radius * (a.hypot(radius).powi(-3) - b.hypot(radius).powi(-3));
        0.5 * self.remanence * (slope(self.ring.outer_radius) - slope(self.ring.inner_radius))
    }

    /// Change of its slope along the axis (T/m^2).
    pub fn curvature(&self, z: f64) -> f64 {
        let (a, b) = self.faces(z);
        let bend = |radius: f64| {
            let term = |face: f64| face * face.hypot(radius).powi(-5);
            3.0 * radius * radius * (term(b) - term(a))
        };
        0.5 * self.remanence * (bend(self.ring.outer_radius) - bend(self.ring.inner_radius))
    }

    /// How far `sphere` is magnetised at `z` (m): 1 is saturated (1).
    pub fn saturation(&self, z: f64, sphere: &Sphere) -> f64 {
        (3.0 * self.field(z).abs() / sphere.saturation).min(1.0)
    }

    /// Force that draws `sphere` at `z` (m) toward the ring's centre (N).
    pub fn attraction(&self, z: f64, sphere: &Sphere) -> f64 {
        self.pull(z, sphere) * z.signum()
    }

    /// Force on `sphere` at `z` (m) against the direction of `z`, on either side of the centre (N).
    pub fn pull(&self, z: f64, sphere: &Sphere) -> f64 {
        let magnetisation = self.saturation(z, sphere) * sphere.saturation / VACUUM_PERMEABILITY;
        -sphere.volume() * magnetisation * self.gradient(z) * self.field(z).signum()
    }

    /// Change of [`RingField::pull`] along the axis (N/m).
    pub fn pull_slope(&self, z: f64, sphere: &Sphere) -> f64 {
        let (field, gradient, bend) = (self.field(z), self.gradient(z), self.curvature(z));
        let per_tesla = 3.0 * sphere.volume() / VACUUM_PERMEABILITY;
        if self.saturation(z, sphere) < 1.0 {
            -per_tesla * (gradient * gradient + field * bend)
        } else {
            -per_tesla * sphere.saturation / 3.0 * bend * field.signum()
        }
    }

    /// Energy of `sphere` at `z` (m), whose slope is [`RingField::pull`]; zero far away (J).
    pub fn energy(&self, z: f64, sphere: &Sphere) -> f64 {
        let field = self.field(z).abs();
        let edge = sphere.saturation / 3.0;
        let per_tesla = 3.0 * sphere.volume() / VACUUM_PERMEABILITY;
        let square = if field < edge { field * field } else { edge * (2.0 * field - edge) };
        -0.5 * per_tesla * square
    }

    /// Distances from the two faces.
    fn faces(&self, z: f64) -> (f64, f64) {
        (z + 0.5 * self.ring.length, z - 0.5 * self.ring.length)
    }
}
