//! What signals and chains mean: numbers that a physicist would read off.

pub mod dispersion;
pub mod gate;
pub mod spectral_peak;
pub mod spectrum;
pub mod time_frequency;
pub mod window;
