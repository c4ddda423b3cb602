//! Optional physics of the chain: one file an effect, on only where a scene names its table.
//!
//! An effect whose force does not depend on the state is folded into the static solution before the first
//! step and costs nothing during the run. Adding an effect: `chain/effects/<name>.rs` and a field in [`EffectsSpec`].

mod gravity;
mod linearised_contacts;
mod magnet_preload;

pub use gravity::Gravity;
pub use linearised_contacts::LinearisedContacts;
pub use magnet_preload::MagnetPreload;

/// Something that acts on the chain beyond its contacts.
pub trait Effect {
    /// Name of its table in a scene, `[effects.<name>]`.
    fn name(&self) -> &'static str;

    /// One line for the summary: what it is set to.
    fn summary(&self) -> String;

    /// Adds its constant force on each body (N, downward positive). `striker` tells whether body 0 is one.
    fn add_load(&self, masses: &[f64], striker: bool, load: &mut [f64]);
}

/// The effects a scene calls for; `None` is off.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct EffectsSpec {
    /// `[effects.gravity]`
    pub gravity: Option<Gravity>,
    /// `[effects.linearised_contacts]`
    pub linearised_contacts: Option<LinearisedContacts>,
    /// `[effects.magnet_preload]`
    pub magnet_preload: Option<MagnetPreload>,
}

impl EffectsSpec {
    /// The effects that are on, in a fixed order.
    pub fn active(&self) -> impl Iterator<Item = &dyn Effect> {
        let gravity = self.gravity.as_ref().map(|e| e as &dyn Effect);
        let magnet_preload = self.magnet_preload.as_ref().map(|e| e as &dyn Effect);
        let linearised = self.linearised_contacts.as_ref().map(|e| e as &dyn Effect);
        [gravity, linearised, magnet_preload].into_iter().flatten()
    }
}
