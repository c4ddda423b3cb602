//! One contact: its static state, and how its force follows its overlap.

use super::hertz;
use super::loss::{ContactLoss, Touch};

/// How a contact's force follows its overlap.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// Hertz: `F = A overlap^1.5`, nothing once open.
    Hertz,
    /// Hertz linearised about the static state, by [`super::LinearisedContacts`].
    Linearised,
}

/// One contact and its static state.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Contact {
    /// `A` in `F = A overlap^1.5`; 0 where there is nothing to touch (N/m^1.5).
    pub stiffness: f64,
    /// Static force (N).
    pub static_force: f64,
    /// Static overlap (m).
    pub static_overlap: f64,
    /// How the force follows the overlap.
    pub law: Law,
    /// What it takes out of the motion; none where it is elastic.
    pub loss: Option<ContactLoss>,
    /// Force at which its softer body begins to yield; none where that is not known (N).
    pub yield_force: Option<f64>,
}

impl Contact {
    /// Nothing stands here.
    pub(super) const OPEN: Self = Self {
        stiffness: 0.0,
        static_force: 0.0,
        static_overlap: 0.0,
        law: Law::Hertz,
        loss: None,
        yield_force: None,
    };

    /// Stiffness against small changes of the static state (N/m).
    #[must_use]
    pub fn static_stiffness(&self) -> f64 {
        hertz::tangent_stiffness(self.stiffness, self.static_overlap)
    }

    /// Change of the force when the overlap grows by `change` (m) over the static one (N).
    #[must_use]
    pub fn force_change(&self, change: f64) -> f64 {
        match self.law {
            Law::Hertz => hertz::force_change(self.stiffness, self.static_overlap.sqrt(), change),
            Law::Linearised => self.static_stiffness() * change,
        }
    }

    /// The contact when its overlap has grown by `change` (m) over the static one and grows by `closing` (m/s).
    #[must_use]
    pub fn touch(&self, change: f64, closing: f64, closed: bool) -> Touch {
        let elastic = self.static_force + self.force_change(change);
        Touch { overlap: self.static_overlap + change, closing, elastic, closed }
    }

    /// Change of the force, losses included (N).
    #[must_use]
    pub fn lossy_force_change(&self, change: f64, closing: f64, closed: bool) -> f64 {
        let taken = |loss: ContactLoss| {
            loss.taken(self.stiffness, self.touch(change, closing, closed)).force
        };
        self.force_change(change) + self.loss.map_or(0.0, taken)
    }

    /// Stiffness against further changes (N/m).
    #[must_use]
    pub fn tangent_stiffness(&self, change: f64) -> f64 {
        match self.law {
            Law::Hertz => hertz::tangent_stiffness(self.stiffness, self.static_overlap + change),
            Law::Linearised => self.static_stiffness(),
        }
    }

    /// Elastic energy, that of the static overlap included (J).
    #[must_use]
    pub fn energy(&self, change: f64) -> f64 {
        match self.law {
            Law::Hertz => hertz::energy(self.stiffness, self.static_overlap + change),
            Law::Linearised => {
                hertz::energy(self.stiffness, self.static_overlap)
                    + (self.static_force + 0.5 * self.static_stiffness() * change) * change
            }
        }
    }
}
