//! What signals and chains mean: numbers that a physicist would read off.

pub mod dispersion;
