//! The vector path: chains of elastic Hertz contacts under constant loads, eight contacts at a
//! time.
//!
//! `vector` is the arithmetic of an instruction set, `rows` the chain's layout and the sweep over
//! its contacts, `rkn86` and `splitting` the steps of the two methods, `opening` the correction
//! where contacts open or close, `stepper` the integrator. Everything else runs on
//! [`crate::integrate`]'s own methods.

mod frame;
mod opening;
mod rkn86;
mod rows;
mod samples;
mod splitting;
mod stepper;
mod vector;

pub use samples::{ContactStep, SampleForces};
pub use stepper::{Refinement, VectorStepper};
pub use vector::{InstructionSet, Kernel, Row, Simd, VARIABLE, Vector};
