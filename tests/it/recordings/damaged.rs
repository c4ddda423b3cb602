//! Cut and changed recordings: what stands before the damage is kept, and the damage is named.

use hertzscope::recording::TraceSet;
use proptest::prelude::*;

use super::{bytes_of, read, set};
use crate::seeded;

const MAGIC: &[u8] = b"\x89MCAP0\r\n";
/// Opcodes of the container's records.
const CHUNK: u8 = 0x06;
const DATA_END: u8 = 0x0F;

/// End of each top-level record of the data section, with its opcode; offsets from the file's
/// start.
fn record_ends(bytes: &[u8]) -> Vec<(u8, usize)> {
    let mut at = MAGIC.len();
    let mut ends = Vec::new();
    loop {
        let opcode = bytes[at];
        let length: [u8; 8] = bytes[at + 1..at + 9].try_into().expect("eight bytes");
        at += 9 + usize::try_from(u64::from_le_bytes(length)).expect("a length");
        ends.push((opcode, at));
        if opcode == DATA_END {
            return ends;
        }
    }
}

/// A recording of three shots, each in a chunk of its own, where each chunk ends, and where the
/// data end.
fn sound() -> (TraceSet, Vec<u8>, Vec<usize>, usize) {
    let set = set(3);
    let bytes = bytes_of(&set);
    let ends = record_ends(&bytes);
    let chunks: Vec<usize> =
        ends.iter().filter(|(opcode, _)| *opcode == CHUNK).map(|(_, end)| *end).collect();
    assert_eq!(chunks.len(), set.shots.len(), "a chunk a shot");
    let data_end = ends.last().expect("an end").1;
    (set, bytes, chunks, data_end)
}

/// Shots whose chunk ends before `at` are there, unchanged.
fn keeps_what_is_before(back: &TraceSet, sound: &TraceSet, chunks: &[usize], at: usize) {
    let whole = chunks.iter().filter(|end| **end <= at).count();
    for shot in &sound.shots[..whole] {
        assert!(back.shots.contains(shot), "shot {} lost by damage at byte {at}", shot.number);
    }
}

#[test]
fn a_cut_file_keeps_every_shot_before_the_cut() {
    let (set, bytes, chunks, data_end) = sound();
    assert!(data_end < bytes.len());
    let cuts =
        (0..bytes.len()).step_by(97).chain(chunks.clone()).chain([data_end, bytes.len() - 1]);
    for at in cuts {
        match read(&bytes[..at]) {
            Err(error) => {
                // Before the first fact there is nothing to keep.
                let text = error.to_string();
                assert!(at < chunks[0], "cut at {at}: {text}");
                assert!(text.contains("test.mcap") && text.contains("expected"), "{text}");
            }
            Ok(back) => {
                keeps_what_is_before(&back, &set, &chunks, at);
                assert!(!back.problems.is_empty(), "cut at {at} is not named");
                let whole = chunks.iter().filter(|end| **end <= at).count();
                assert_eq!(back.shots.len(), whole, "cut at {at}: no half shots");
            }
        }
    }
}

/// Every checksum together covers the whole data section: no single changed byte passes unseen.
#[test]
fn a_changed_byte_is_named_and_costs_no_shot_before_it() {
    let (set, bytes, chunks, data_end) = sound();
    let first = MAGIC.len()..MAGIC.len() + 300;
    for at in (0..data_end).step_by(11).chain(first).chain(data_end - 60..data_end) {
        for flip in [0x01, 0x80, 0xFF] {
            let mut changed = bytes.clone();
            changed[at] ^= flip;
            match read(&changed) {
                Err(error) => assert!(error.to_string().contains("expected"), "{error}"),
                Ok(back) => {
                    assert!(!back.problems.is_empty(), "byte {at} ^ {flip:#x} passed unseen");
                    keeps_what_is_before(&back, &set, &chunks, at);
                    for shot in &back.shots {
                        let same = set.shots.iter().any(|s| s == shot);
                        let told = back
                            .problems
                            .iter()
                            .any(|p| p.contains("checksum") || p.contains("unpack"));
                        assert!(same || told, "byte {at} ^ {flip:#x} changed shot {}", shot.number);
                    }
                }
            }
        }
    }
}

/// The summary only repeats: damage there costs nothing.
#[test]
fn damage_behind_the_data_costs_nothing() {
    let (set, bytes, _, data_end) = sound();
    for at in (data_end..bytes.len() - MAGIC.len()).step_by(7) {
        let mut changed = bytes.clone();
        changed[at] ^= 0x55;
        assert_eq!(read(&changed).expect("whole data"), set, "byte {at}");
    }
}

/// What a power cut leaves: zeros in the place of the last records, however many.
#[test]
fn a_tail_of_zeros_is_named_once() {
    let (set, bytes, chunks, _) = sound();
    for zeros in [1, 9, 100_000, 64 << 20] {
        let mut cut = bytes[..chunks[1]].to_vec();
        cut.resize(chunks[1] + zeros, 0);
        let back = read(&cut).expect("two shots");
        assert_eq!(back.shots, set.shots[..2]);
        assert_eq!(back.problems.len(), 1, "{:?}", back.problems);
        if zeros >= 9 {
            assert!(back.problems[0].contains("zeros"), "{:?}", back.problems);
        }
    }
    let mut nothing = MAGIC.to_vec();
    nothing.resize(64 << 20, 0);
    let error = read(&nothing).expect_err("no recording").to_string();
    assert!(error.contains("zeros") && error.contains("expected a recording"), "{error}");
}

/// One chunk goes, the others stay: it is found again behind the damage.
#[test]
fn a_spoilt_chunk_takes_no_other_with_it() {
    let (set, bytes, chunks, _) = sound();
    let mut changed = bytes.clone();
    changed[chunks[1] - 20] ^= 0xFF;
    let back = read(&changed).expect("two shots of three");
    assert_eq!(back.shots, [set.shots[0].clone(), set.shots[2].clone()]);
    assert!(
        back.problems.iter().any(|p| p.contains("chunk") || p.contains("checksum")),
        "{:?}",
        back.problems
    );
}

proptest! {
    #![proptest_config(seeded(256))]

    #[test]
    fn random_bytes_are_refused_by_name(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let error = read(&bytes).expect_err("no recording").to_string();
        prop_assert!(error.contains("test.mcap") && error.contains("expected"), "{}", error);
    }

    #[test]
    fn random_bytes_behind_the_magic_are_refused_or_named(bytes in prop::collection::vec(any::<u8>(), 0..2000)) {
        let file = [MAGIC, &bytes].concat();
        match read(&file) {
            Ok(set) => prop_assert!(!set.problems.is_empty()),
            Err(error) => prop_assert!(error.to_string().contains("expected"), "{}", error),
        }
    }

    /// Records whose opcodes and lengths fit, but nothing in them.
    #[test]
    fn random_records_are_refused_or_named(
        records in prop::collection::vec((0_u8..0x10, prop::collection::vec(any::<u8>(), 0..80)), 1..40)
    ) {
        let mut file = MAGIC.to_vec();
        for (opcode, body) in records {
            file.push(opcode);
            file.extend((body.len() as u64).to_le_bytes());
            file.extend(body);
        }
        match read(&file) {
            Ok(set) => prop_assert!(!set.problems.is_empty()),
            Err(error) => prop_assert!(error.to_string().contains("expected"), "{}", error),
        }
    }

    /// Several changes in the recording itself, lengths included.
    #[test]
    fn recordings_with_several_changes_are_refused_or_named(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..20)
    ) {
        let (set, bytes, _, data_end) = sound();
        let mut changed = bytes.clone();
        for (at, byte) in changes {
            changed[at.index(data_end)] = byte;
        }
        if changed != bytes {
            match read(&changed) {
                Ok(back) => prop_assert!(!back.problems.is_empty() && back.shots.len() <= set.shots.len() + 20),
                Err(error) => prop_assert!(error.to_string().contains("expected"), "{}", error),
            }
        }
    }
}
