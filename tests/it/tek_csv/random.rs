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

    #[test]
    fn truncated_files_are_refused(at in any::<prop::sample::Index>()) {
        let text = write(&plain_record()).expect("writable");
        let end = at.index(text.len());
        prop_assert!(read(&text.as_bytes()[..end], "cut.csv").is_err());
    }

    /// A changed byte is refused, or stands where it makes another valid file: a name, a level,
    /// padding.
    #[test]
    fn mutated_files_are_refused_or_valid(header in any::<bool>(), at in any::<prop::sample::Index>(), byte in any::<u8>()) {
        let mut bytes = write(&plain_record()).expect("writable").into_bytes();
        let reach = if header { 1000 } else { bytes.len() };
        bytes[at.index(reach)] = byte;
        if let Ok(capture) = read(&bytes, "mutated.csv") {
            let text = write(&capture).expect("what was read can be written");
            prop_assert_eq!(read(text.as_bytes(), "mutated.csv").expect("as written"), capture);
        }
    }

    #[test]
    fn any_levels_come_back(codes in proptest::collection::vec(-128_i16..=127, 2500)) {
        let capture = record(&PLAIN, codes);
        let text = write(&capture).expect("writable");
        prop_assert_eq!(read(text.as_bytes(), "levels.csv").expect("as written"), capture);
    }
}
