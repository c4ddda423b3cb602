//! Random bytes, cut and changed files: an error or a capture, never a panic.

use hertzscope::recording::tek_csv::{read, write};
use proptest::prelude::*;

use super::made_up::{PLAIN, plain_record, record};
use crate::seeded;

proptest! {
    #![proptest_config(seeded(256))]

    #[test]
    fn random_bytes_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..2000)) {
        prop_assert!(read(&bytes, "random.csv").is_err());
    }

    /// A cut file has the rows before the cut, and says that others are missing. Of a number that
    /// is cut, a value is left that is off by less than the screen's height.
    #[test]
    fn truncated_files_are_refused_or_noted(at in any::<prop::sample::Index>()) {
        let whole = plain_record();
        let text = write(&whole).expect("writable");
        let end = at.index(text.len());
        if let Ok(found) = read(&text.as_bytes()[..end], "cut.csv") {
            prop_assert!(!found.notes.is_empty());
            let rows = text[..end].matches('\n').count().saturating_sub(1);
            // With a few rows, a cut number may hide the levels.
            if rows > 100 {
                prop_assert_eq!(&found.waveform.codes[..rows], &whole.waveform.codes[..rows]);
            }
        }
    }

    /// A changed byte is refused, noted, or makes another valid file: a name, a level, padding.
    #[test]
    fn mutated_files_are_refused_noted_or_valid(header in any::<bool>(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let whole = plain_record();
        let mut bytes = write(&whole).expect("writable").into_bytes();
        let reach = if header { 1000 } else { bytes.len() };
        bytes[at.index(reach)] = byte;
        if let Ok(capture) = read(&bytes, "mutated.csv") {
            let differs = |(a, b): (&i16, &i16)| a != b;
            let codes = capture.waveform.codes.iter().zip(&whole.waveform.codes);
            let changed = codes.filter(|(a, b)| differs((a, b))).count();
            if capture.notes.is_empty() {
                prop_assert!(changed <= 1);
                let text = write(&capture).expect("what was read can be written");
                prop_assert_eq!(read(text.as_bytes(), "mutated.csv").expect("as written"), capture);
            }
        }
    }

    #[test]
    fn any_levels_come_back(codes in proptest::collection::vec(-128_i16..=127, 2500)) {
        let capture = record(&PLAIN, codes);
        let text = write(&capture).expect("writable");
        prop_assert_eq!(read(text.as_bytes(), "levels.csv").expect("as written"), capture);
    }
}
