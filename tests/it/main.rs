//! All integration tests in one binary.

mod tek_csv;
