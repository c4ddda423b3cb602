//! The force of a ring or of a measured table follows the particle as it moves: `F(d0 - u)` in
//! place of `F(d0)`.
//!
//! A spring of 1.4 to 3.9 N/mm beside contacts of 500: the particle travels 21 to 215 um under the
//! paper's strikers, so the force changes by 3 to 8 % each 50 um of it. Source: `crate::magnet`.

use super::Effect;

/// `[effects.magnet_law]`
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MagnetLaw;

impl Effect for MagnetLaw {
    fn name(&self) -> &'static str {
        "magnet_law"
    }

    fn summary(&self) -> String {
        "the magnet's force changes as its particle moves".to_owned()
    }
}
