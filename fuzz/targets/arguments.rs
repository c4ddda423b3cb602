//! Command lines, a word on each line: they are taken or refused, and nothing is run.

#![cfg_attr(not(test), no_main)]

use hertzscope::cli::parse;

/// One input.
pub fn run(input: &[u8]) {
    let Ok(text) = std::str::from_utf8(input) else { return };
    if let Err(refused) = parse(["hertzscope"].into_iter().chain(text.lines())) {
        assert!(!refused.is_empty());
    }
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
