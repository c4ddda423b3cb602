//! One binary for all integration tests.
#![allow(clippy::float_cmp, reason = "exact values are exact")]
#![allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    reason = "small counts in tests"
)]

mod architecture;
mod chains;
mod conservation;
mod golden;
mod order;
mod physics;
mod tek_csv;
#[cfg(feature = "tui")]
mod tui;
