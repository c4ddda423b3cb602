//! One binary for all integration tests.

mod architecture;
mod scene;
mod tek_csv;
