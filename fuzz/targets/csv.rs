//! CSV files of every dialect; what the native writer makes of them reads back as the same.

#![cfg_attr(not(test), no_main)]

use hertzscope::recording::tek_csv::{read, read_all, write};

/// One input.
pub fn run(bytes: &[u8]) {
    let Ok(captures) = read_all(bytes, "F.CSV") else { return };
    for capture in captures {
        let Ok(text) = write(&capture) else { continue };
        let again = read(text.as_bytes(), "F.CSV").expect("what was written");
        assert_eq!(again.waveform.codes, capture.waveform.codes);
        assert_eq!(write(&again).expect("the same again"), text);
    }
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
