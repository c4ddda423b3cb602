//! Optional physics of the chain: one file an effect, on only where a scene names its table.
//!
//! An effect whose force does not depend on the state is folded into the static solution before the
//! first step and costs nothing during the run. Losses go into the contacts, and a chain that has
//! some is integrated as another system; so is one whose magnet follows its particle. Adding an
//! effect: `chain/effects/<name>.rs` and a field in [`EffectsSpec`].

mod dashpot;
mod gravity;
mod kuwabara_kono;
mod linearised_contacts;
mod loss_spec;
mod magnet_law;
mod magnet_preload;
mod power_law_loss;

pub use dashpot::Dashpot;
pub use gravity::Gravity;
pub use kuwabara_kono::KuwabaraKono;
pub use linearised_contacts::LinearisedContacts;
pub use loss_spec::{ContactOverride, LossSpec};
pub use magnet_law::MagnetLaw;
pub use magnet_preload::{MagnetForce, MagnetPreload, PlacedAt, PlacedMagnet};
pub use power_law_loss::PowerLawLoss;

use super::EndOfContact;
use super::loss::ContactLoss;

/// Something that acts on the chain beyond its contacts.
pub trait Effect {
    /// Name of its table in a scene, `[effects.<name>]`.
    fn name(&self) -> &'static str;

    /// One line for the summary: what it is set to.
    fn summary(&self) -> String;

    /// Adds its constant force on each body (N, downward positive). `striker` tells whether body 0
    /// is one.
    fn add_load(&self, masses: &[f64], striker: bool, load: &mut [f64]) {
        let _ = (masses, striker, load);
    }
}

/// The effects a scene calls for; `None` is off.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EffectsSpec {
    /// `[effects.dashpot]`
    pub dashpot: Option<Dashpot>,
    /// `[effects.gravity]`
    pub gravity: Option<Gravity>,
    /// `[effects.kuwabara_kono]`
    pub kuwabara_kono: Option<KuwabaraKono>,
    /// `[effects.linearised_contacts]`
    pub linearised_contacts: Option<LinearisedContacts>,
    /// `[effects.magnet_law]`
    pub magnet_law: Option<MagnetLaw>,
    /// `[effects.magnet_preload]`
    pub magnet_preload: Option<MagnetPreload>,
    /// `[effects.power_law_loss]`
    pub power_law_loss: Option<PowerLawLoss>,
}

impl EffectsSpec {
    /// The effects that are on, in a fixed order.
    pub fn active(&self) -> impl Iterator<Item = &dyn Effect> {
        let effects: [Option<&dyn Effect>; 7] = [
            self.dashpot.as_ref().map(|e| e as _),
            self.gravity.as_ref().map(|e| e as _),
            self.kuwabara_kono.as_ref().map(|e| e as _),
            self.linearised_contacts.as_ref().map(|e| e as _),
            self.magnet_law.as_ref().map(|e| e as _),
            self.magnet_preload.as_ref().map(|e| e as _),
            self.power_law_loss.as_ref().map(|e| e as _),
        ];
        effects.into_iter().flatten()
    }

    /// Switches the effect called `name` off; none of that name, no change.
    pub fn remove(&mut self, name: &str) {
        match name {
            "dashpot" => self.dashpot = None,
            "gravity" => self.gravity = None,
            "kuwabara_kono" => self.kuwabara_kono = None,
            "linearised_contacts" => self.linearised_contacts = None,
            "magnet_law" => self.magnet_law = None,
            "magnet_preload" => self.magnet_preload = None,
            "power_law_loss" => self.power_law_loss = None,
            _ => {}
        }
    }

    /// The losses that are on, in the order of a contact's terms.
    pub fn losses(&self) -> [Option<&LossSpec>; 3] {
        [
            self.dashpot.as_ref().map(|e| &e.gamma),
            self.kuwabara_kono.as_ref().map(|e| &e.eta),
            self.power_law_loss.as_ref().map(|e| &e.force),
        ]
    }

    /// The losses of the contact between the bodies so named; none where nothing is lost.
    pub fn loss_between(&self, upper: &str, lower: &str) -> Option<ContactLoss> {
        let losses = self.losses();
        let end = losses.iter().flatten().next().map(|spec| spec.end)?;
        let [dashpot, relaxation, power_force] =
            losses.map(|spec| spec.map_or(0.0, |spec| spec.between(upper, lower)));
        let power_exponent = self.power_law_loss.as_ref().map_or(1.0, |power| power.exponent);
        let loss = ContactLoss { dashpot, relaxation, power_force, power_exponent, end };
        loss.is_some().then_some(loss)
    }

    /// What ends a contact; none where nothing is lost.
    pub fn end_of_contact(&self) -> Option<EndOfContact> {
        self.losses().into_iter().flatten().next().map(|spec| spec.end)
    }
}
