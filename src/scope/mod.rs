//! The virtual oscilloscope.

pub mod waveform;

pub use waveform::{Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
