//! One binary for all integration tests.

mod architecture;
mod tek_csv;
#[cfg(feature = "tui")]
mod tui;
