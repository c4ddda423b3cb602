//! The chain in motion: time integration of `x'' = a(x, v)`, one step at a time.
//!
//! `chain` describes the chain; `experiment` drives an [`Integrator`] and reads each step through
//! its [`Interpolant`], so that nothing downstream depends on where the integrator put its steps.
//! Chains without losses run on the [`kernel`], eight contacts at a time; chains with losses are a
//! [`ChainSystem`] for the explicit and implicit methods here. The equations are autonomous: no
//! method sees the time but for bookkeeping.

mod chain_system;
pub mod control;
pub mod dormand_el_mikkawy_prince_86;
pub mod force_segment;
pub mod hermite;
mod integrator;
pub mod kernel;
mod method;
pub mod probe_step;
pub mod rodas;
pub mod runge_kutta;
pub mod splitting;
pub mod switching;
mod system;
pub mod tableaus;
pub mod two_step;

pub use chain_system::ChainSystem;
pub use force_segment::ForceSegment;
pub use hermite::{COEFFICIENTS, Interpolant};
pub use integrator::{IntegrateError, Integrator, Restart, Work};
pub use method::{GeneralScheme, LosslessScheme, Method, Scheme};
pub use rodas::Rodas;
pub use system::{Linearised, Motion, Scales, Sides, Switching, System, Tridiagonal, Turning};
pub use two_step::Pacing;
