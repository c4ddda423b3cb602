//! Random bytes and mutations for the readers of the foreign dialects: an error or a sound capture,
//! never a panic.

use std::sync::LazyLock;

use hertzscope::recording::tek_csv::read_all;
use proptest::prelude::*;

use super::foreign_texts::{headerless, newer, openchoice, spreadsheet, with_semicolons};
use super::made_up::{PLAIN, ramp_after, record};
use crate::seeded;

static TEXTS: LazyLock<Vec<String>> = LazyLock::new(texts);

/// The first rows of a text of each dialect.
fn texts() -> Vec<String> {
    let record = record(&PLAIN, ramp_after(&[], 2500));
    let volts: Vec<String> = (0..200).map(|i| format!("{}", f64::from(i) * 0.04)).collect();
    let sheet = spreadsheet(&record);
    let texts = [
        with_semicolons(&sheet),
        format!(",,,x,y\n{sheet}"),
        sheet,
        headerless(&record),
        openchoice(&[record.clone(), record]),
        newer(&[1.0, 1.0], &[volts.clone(), volts]),
    ];
    let head = |text: &String| text.split_inclusive('\n').take(60).collect();
    texts.iter().map(head).collect()
}

fn is_sound(bytes: &[u8]) {
    for capture in read_all(bytes, "F.CSV").unwrap_or_default() {
        let waveform = capture.waveform;
        assert!(waveform.codes.len() >= 2);
        assert!(waveform.preamble.x_incr > 0.0 && waveform.preamble.y_mult > 0.0);
        let last = waveform.codes.len() - 1;
        assert!(waveform.time(last).is_finite());
        assert!(waveform.codes.iter().all(|code| waveform.volts_of(*code).is_finite()));
        assert!(waveform.vertical.scale > 0.0 && waveform.vertical.position.is_finite());
    }
}

proptest! {
    #![proptest_config(seeded(512))]

    #[test]
    fn random_bytes_never_panic(bytes in proptest::collection::vec(any::<u8>(), 0..500)) {
        is_sound(&bytes);
    }

    #[test]
    fn random_tables_never_panic(text in "([-+0-9.eE]{0,8}[,;\t\"]?){0,8}(\n([-+0-9.eE]{0,8}[,;]){2}){0,8}") {
        is_sound(text.as_bytes());
    }

    #[test]
    fn mutations_never_panic(
        which in 0..6_usize,
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        cut in any::<prop::sample::Index>(),
    ) {
        let mut bytes = TEXTS[which].clone().into_bytes();
        is_sound(&bytes);
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        is_sound(&bytes);
        is_sound(&bytes[..cut.index(bytes.len())]);
    }
}
