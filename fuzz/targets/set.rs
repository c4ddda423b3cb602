//! `.SET` files, and what they add to a capture.

#![cfg_attr(not(test), no_main)]

use hertzscope::recording::set_file::SetFile;

/// One input.
pub fn run(bytes: &[u8]) {
    let Ok(set_up) = SetFile::read(bytes, "F.SET") else { return };
    assert!(!set_up.settings.is_empty());
    let isf = b":WFMP:NR_P 2;BYT_N 1;ENC BIN;BN_F RI;XIN 1E-3;YMU 4E-2;YOF 0;WFI \"Ch1\";:CURV #12\x01\x02";
    let mut capture = hertzscope::recording::isf::read(isf, "F.ISF").expect("a sound file");
    set_up.complete(&mut capture);
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
