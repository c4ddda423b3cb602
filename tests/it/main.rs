//! One binary for all integration tests.

mod architecture;
mod cli;
mod recordings;
mod scene;
mod tek_csv;
