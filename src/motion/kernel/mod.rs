//! The kernel for chains without losses, eight contacts at a time: Hertz contacts or springs under
//! constant loads, and a magnet that follows its particle.
//!
//! `vector` is the arithmetic of an instruction set, `rows` the chain's layout and the sweep over
//! its contacts, `rkn86` and `splitting` the steps of the two methods, `opening` the correction
//! where contacts open or close, `stepper` the integrator. Chains with losses are
//! integrated by [`crate::motion`]'s methods for forces that depend on velocities.

mod frame;
mod opening;
mod rkn86;
mod rows;
mod samples;
mod splitting;
mod stepper;
mod vector;

pub use samples::{ContactStep, SampleForces};
pub use stepper::VectorStepper;
pub use vector::{InstructionSet, Kernel, Row, Simd, VARIABLE, Vector};
