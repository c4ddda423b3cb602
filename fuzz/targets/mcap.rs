//! Recordings, sound or damaged.

#![no_main]

use std::path::Path;

use hertzscope::recording::mcap::read_bytes;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let _ = read_bytes(bytes, Path::new("F.mcap"));
});
