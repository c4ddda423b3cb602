//! One binary for all integration tests.
#![allow(clippy::disallowed_macros, reason = "measurements are printed")]
#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that cannot go on has failed"
)]
#![allow(clippy::unreadable_literal, reason = "digits as references print them")]
#![allow(clippy::similar_names, reason = "what was served and the server it came from")]
#![allow(clippy::float_cmp, reason = "exact values are exact")]

mod accuracy;
mod analysis;
mod architecture;
mod at_rest;
mod calibration;
mod chains;
mod cli;
#[cfg(all(unix, feature = "server"))]
mod client;
mod compare;
mod conservation;
mod contact_law;
#[cfg(all(unix, feature = "server", feature = "tui"))]
mod documents;
mod effects;
mod ensemble;
mod fifty_scenes;
mod files;
mod fit;
#[cfg(feature = "server")]
mod fuzz_corpora;
mod golden;
mod hard_cases;
#[cfg(feature = "server")]
mod hislip;
mod isf;
mod laboratory;
mod losses;
mod magnet;
mod motion_sensors;
mod numbers;
mod order;
mod paper;
mod physics;
mod plasticity;
mod pulses;
mod random_scenes;
mod recordings;
mod scene;
mod scope;
mod scpi;
#[cfg(feature = "server")]
mod server;
mod set_file;
mod supports;
mod sweep;
mod tek_csv;
#[cfg(feature = "tui")]
mod tui;
mod tunability;
mod vector_path;
#[cfg(feature = "server")]
mod vxi11;

/// So many cases of random input, the same ones each time.
fn seeded(cases: u32) -> proptest::test_runner::Config {
    proptest::test_runner::Config {
        cases,
        rng_seed: proptest::test_runner::RngSeed::Fixed(2014),
        failure_persistence: None,
        ..proptest::test_runner::Config::default()
    }
}
