//! Replies of a scope, true or not: a front panel and a record, a zero byte between them. What is
//! taken is finite and has the points that it says.

#![cfg_attr(not(test), no_main)]

use hertzscope::client::{Record, displayed};
use hertzscope::recording::InstrumentIdentity;
use hertzscope::recording::set_file::SetFile;
use hertzscope::scope::Source;

/// One input.
pub fn run(input: &[u8]) {
    let Some(end) = input.iter().position(|byte| *byte == 0) else { return };
    let Ok(panel) = SetFile::read(&input[..end], "reply to SET?") else { return };
    assert!(displayed(&panel).len() <= 9);
    let instrument = InstrumentIdentity {
        model: "TDS2014".to_owned(),
        serial: "C012345".to_owned(),
        firmware: "FV:v4.12".to_owned(),
    };
    let Ok(capture) = Record(&input[end + 1..]).capture(Source::Channel(1), &panel, &instrument)
    else {
        return;
    };
    let waveform = &capture.waveform;
    assert!(waveform.preamble.x_incr > 0.0 && waveform.time(0).is_finite());
    assert!(waveform.codes.iter().all(|code| waveform.volts_of(*code).is_finite()));
    assert!(capture.notes.iter().all(|note| !note.contains(char::is_control)));
}

#[cfg(not(test))]
libfuzzer_sys::fuzz_target!(|bytes: &[u8]| run(bytes));
