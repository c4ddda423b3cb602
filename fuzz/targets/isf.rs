//! ISF files; what is written of them reads back as the same levels.

#![cfg_attr(not(test), no_main)]

use hertzscope::recording::isf::{Width, read, write};

/// One input.
pub fn run(bytes: &[u8]) {
    let Ok(capture) = read(bytes, "F.ISF") else { return };
    for width in [Width::One, Width::Two] {
        let Ok(file) = write(&capture, width) else { continue };
        let again = read(&file, "F.ISF").expect("what was written");
        assert_eq!(again.waveform.codes, capture.waveform.codes);
    }
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
