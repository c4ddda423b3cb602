//! Messages on the wire.

use hertzscope::hislip::{
    DecodedPiece, Decoder, HEADER_BYTES, MAX_PAYLOAD, MessageHeader, MessageType,
};
use proptest::prelude::*;

/// IVI-6.1, table 2: the number of every type that this protocol version has.
#[test]
fn types_have_the_standards_numbers() {
    let named = [
        (0, MessageType::Initialize),
        (2, MessageType::FatalError),
        (3, MessageType::Error),
        (4, MessageType::AsyncLock),
        (6, MessageType::Data),
        (7, MessageType::DataEnd),
        (8, MessageType::DeviceClearComplete),
        (9, MessageType::DeviceClearAcknowledge),
        (10, MessageType::AsyncRemoteLocalControl),
        (12, MessageType::Trigger),
        (13, MessageType::Interrupted),
        (14, MessageType::AsyncInterrupted),
        (15, MessageType::AsyncMaximumMessageSize),
        (17, MessageType::AsyncInitialize),
        (19, MessageType::AsyncDeviceClear),
        (20, MessageType::AsyncServiceRequest),
        (21, MessageType::AsyncStatusQuery),
        (23, MessageType::AsyncDeviceClearAcknowledge),
        (24, MessageType::AsyncLockInfo),
    ];
    for (code, kind) in named {
        assert_eq!((MessageType::from_code(code), kind.code()), (Some(kind), code));
    }
    assert_eq!(MessageType::from_code(26), None);
}

/// A header as pyvisa-py packs it: `!2sBBIQ`.
#[test]
fn a_header_byte_for_byte() {
    let header = MessageHeader { code: 7, control: 1, parameter: 0xFFFF_FF02, length: 5 };
    let bytes = *b"HS\x07\x01\xff\xff\xff\x02\0\0\0\0\0\0\0\x05";
    assert_eq!(header.bytes(), bytes);
    assert_eq!(MessageHeader::parse(&bytes), Some(header));
    assert_eq!(MessageHeader::parse(b"hs\x07\x01\xff\xff\xff\x02\0\0\0\0\0\0\0\x05"), None);
}

/// A long payload is passed over without being kept, and what follows is understood.
#[test]
fn what_is_too_long_is_passed_over() {
    let mut decoder = Decoder::default();
    let long = MessageHeader { code: 6, control: 0, parameter: 1, length: MAX_PAYLOAD as u64 + 1 };
    decoder.push(&long.bytes());
    assert_eq!(decoder.next_piece(), Some(DecodedPiece::TooLarge(long)));
    for chunk in vec![b'x'; MAX_PAYLOAD + 1].chunks(1000) {
        decoder.push(chunk);
        assert_eq!((decoder.waiting(), decoder.next_piece()), (0, None));
    }
    let next = MessageHeader { code: 7, control: 0, parameter: 3, length: 1 };
    decoder.push(&next.bytes());
    decoder.push(b"y");
    assert_eq!(decoder.next_piece(), Some(DecodedPiece::Message(next, b"y".to_vec())));
}

#[test]
fn nothing_follows_what_is_no_header() {
    let mut decoder = Decoder::default();
    decoder.push(b"GET / HTTP/1.1\r\n");
    assert_eq!(decoder.next_piece(), Some(DecodedPiece::Malformed));
    decoder.push(&MessageHeader { code: 7, control: 0, parameter: 0, length: 0 }.bytes());
    assert_eq!(decoder.next_piece(), None);
    assert_eq!(decoder.waiting(), 0);
}

proptest! {
    /// Whatever the cuts, the same messages come out.
    #[test]
    fn messages_survive_any_cut(
        messages in prop::collection::vec(
            (any::<u8>(), any::<u8>(), any::<u32>(), prop::collection::vec(any::<u8>(), 0..40)),
            0..8,
        ),
        cuts in prop::collection::vec(1_usize..50, 1..40),
    ) {
        let mut wire = Vec::new();
        let mut sent = Vec::new();
        for (code, control, parameter, payload) in messages {
            let header = MessageHeader { code, control, parameter, length: payload.len() as u64 };
            wire.extend_from_slice(&header.bytes());
            wire.extend_from_slice(&payload);
            sent.push(DecodedPiece::Message(header, payload));
        }
        let mut decoder = Decoder::default();
        let mut found = Vec::new();
        let mut rest = wire.as_slice();
        for cut in cuts.iter().cycle() {
            let (piece, tail) = rest.split_at((*cut).min(rest.len()));
            decoder.push(piece);
            found.extend(std::iter::from_fn(|| decoder.next_piece()));
            rest = tail;
            if rest.is_empty() {
                break;
            }
        }
        prop_assert_eq!(found, sent);
        prop_assert_eq!(decoder.waiting(), 0);
    }

    /// Random bytes never cost more than a message, and never panic.
    #[test]
    fn random_bytes_are_bounded(pieces in prop::collection::vec(
        prop::collection::vec(prop_oneof![Just(b'H'), Just(b'S'), Just(0), any::<u8>()], 0..60),
        0..40,
    )) {
        let mut decoder = Decoder::default();
        for bytes in pieces {
            decoder.push(&bytes);
            while let Some(piece) = decoder.next_piece() {
                if let DecodedPiece::Message(header, payload) = piece {
                    prop_assert_eq!(header.length, payload.len() as u64);
                }
            }
            prop_assert!(decoder.waiting() <= HEADER_BYTES + MAX_PAYLOAD);
        }
    }
}
