//! Recordings, sound or damaged.

#![cfg_attr(not(test), no_main)]

use std::path::Path;

use hertzscope::recording::mcap::read_bytes;

/// One input.
pub fn run(bytes: &[u8]) {
    let _ = read_bytes(bytes, Path::new("F.mcap"));
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
