//! Questions to signals, against closed forms, other people's numbers, and what the simulated bench
//! knows.

mod arrival;
mod commands;
mod scope_arrival;
mod scope_spectrum;
mod spectrum;
mod spectrum_figures;
mod spectrum_golden;
mod time_frequency;
mod wavenumber;
