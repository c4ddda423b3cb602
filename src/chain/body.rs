//! Bodies, ends of the chain, and the description of a whole chain.

use std::sync::Arc;

use super::effects::EffectsSpec;
use super::hertz::Elasticity;

/// A rigid body with two elastic faces.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// What the scene calls it; bodies of a kind have it in common.
    pub name: Arc<str>,
    /// Mass (kg).
    pub mass: f64,
    /// Extent along the chain (m).
    pub length: f64,
    /// Curvature of its faces, `1/R`; 0 is flat (1/m).
    pub curvature: f64,
    /// Direction of the axis of a cylinder that lies across the chain, around the chain's axis;
    /// none of other bodies (rad).
    pub axis: Option<f64>,
    /// Elastic constants.
    pub elasticity: Elasticity,
    /// Uniaxial stress at which the material yields; none where that is not known (Pa).
    pub yield_strength: Option<f64>,
}

impl Body {
    /// The same shape and material, so many times as large (1).
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            mass: self.mass * factor.powi(3),
            length: self.length * factor,
            curvature: self.curvature / factor,
            ..self.clone()
        }
    }

    /// Whether the other is of the same kind and size; their masses may differ by what sits in
    /// them.
    pub fn is_alike(&self, other: &Self) -> bool {
        let shape = |body: &Self| {
            let axis = body.axis.unwrap_or(f64::INFINITY);
            [body.length, body.curvature, axis].map(f64::to_bits)
        };
        self.name == other.name && shape(self) == shape(other)
    }

    /// Whether it and the two after it are two kinds in turn, or of one kind and size.
    pub fn repeats_after(&self, second: &Self, third: &Self) -> bool {
        self.is_alike(third) && (self.name != second.name || self.is_alike(second))
    }
}

/// What stands at an end of the chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum End {
    /// Nothing.
    Free,
    /// A constant force that presses on the outermost particle, along the chain (N).
    Force(f64),
    /// A flat, immovable wall.
    Wall(Elasticity),
}

/// Everything that defines a chain.
#[derive(Debug, Clone, PartialEq)]
pub struct ChainSpec {
    /// The body that hits particle 1, if any.
    pub striker: Option<Body>,
    /// The particles from top to bottom.
    pub particles: Vec<Body>,
    /// Support above particle 1.
    pub top: End,
    /// What stands below the last particle.
    pub bottom: End,
    /// Force with which a top wall presses in the static state (N).
    pub wall_preload: f64,
    /// Optional physics.
    pub effects: EffectsSpec,
}
