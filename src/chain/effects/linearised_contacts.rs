//! Contacts linearised about the static state: `F = F0 + beta (change of overlap)`,
//! `beta = 3/2 A^(2/3) F0^(1/3)`.
//!
//! The linear chain of the paper's Figs 4 and 5. A linearised contact never opens and pulls when it
//! is drawn apart, so this holds only while dynamic forces are far below the static ones; every
//! contact must be precompressed. Source: Herbold et al. (2009), Eqs (3) to (6).

use super::Effect;

/// `[effects.linearised_contacts]`
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LinearisedContacts;

impl Effect for LinearisedContacts {
    fn name(&self) -> &'static str {
        "linearised_contacts"
    }

    fn summary(&self) -> String {
        "Eq. (3): never open, right only far below the static force".to_owned()
    }
}
