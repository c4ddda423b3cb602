//! Viscoelastic spheres: `F = A (d^1.5 + 3/2 eta d^0.5 ddot)`.
//!
//! The quasistatic viscoelastic correction of Hertz's law; `eta` collects the materials' bulk and
//! shear viscosities. The force is continuous where a contact closes, with the slope of a square
//! root. Source: G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26, 1230 (1987); N. V. Brilliantov, F.
//! Spahn, J.-M. Hertzsch, T. Pöschel, Phys. Rev. E 53, 5382 (1996). Valid for impacts slow against
//! the materials' own relaxation: `3/2 eta (A/mu)^(2/5) v^(1/5)` well below 1.

use super::{Effect, LossSpec};
use crate::quantity::engineering;

/// `[effects.kuwabara_kono]`
#[derive(Debug, Clone, PartialEq)]
pub struct KuwabaraKono {
    /// Times `eta` (s), contact by contact where they differ.
    pub eta: LossSpec,
}

impl Effect for KuwabaraKono {
    fn name(&self) -> &'static str {
        "kuwabara_kono"
    }

    fn summary(&self) -> String {
        self.eta.summary("eta", |eta| engineering(eta, "s", 4))
    }
}
