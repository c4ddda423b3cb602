//! The chain: bodies in a row, Hertz contacts between neighbours, and the static state they start
//! from.
//!
//! Stands between `scene`, which describes it, and `motion`, which moves it. Body 0 is the
//! striker where there is one; contact `j` lies between bodies `j - 1` and `j`, contact 0 and the
//! last one touch the boundaries. State is the displacement from static equilibrium, downward
//! positive: 0.3 m of chain has an ulp that is 1e-8 of a 5 nm overlap, so absolute positions never
//! appear.
//!
//! Statics is exact: every contact force is the sum of the loads above it,
//! `N[j+1] = N[j] + load[j]`, and every overlap follows from its force in closed form.

mod body;
mod contact;
pub mod effects;
mod energy;
mod equilibrium;
mod error;
mod geometry;
pub mod hertz;
mod ledger;
pub mod loss;
mod magnet;
mod plasticity;
mod power;
pub(crate) mod probe;
mod restitution;
mod stability;
mod state;
mod statics;
mod support;

pub use body::{Body, ChainSpec, End};
pub use contact::{Contact, Law, Past};
pub use effects::{
    ContactLaw, ContactOverride, EffectsSpec, Gravity, LOSS_MODELS, LinearisedContacts, LossKind,
    LossModel, LossSpec, MagnetForce, MagnetLaw, MagnetPreload, PlacedAt, PlacedMagnet,
};
pub use energy::Energy;
pub use equilibrium::Chain;
pub use error::ChainError;
pub use hertz::Elasticity;
pub(crate) use ledger::into_chain;
pub use ledger::{Accounts, Dissipated, EndAccounts};
pub use loss::{ACCOUNTS, ContactLoss, EndOfContact};
pub use magnet::{ChainMagnet, Pull};
pub use plasticity::{Indentations, PlasticModel, Plasticity, Unloading, YieldLaw};
pub use probe::ForceProbe;
pub use restitution::Restitution;
pub use stability::StabilityLimit;
pub use state::State;
pub use support::{Backing, Carrier, Drive, Echo, Signal, Support};
