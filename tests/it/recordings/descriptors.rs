//! The container's own library reads what is written, and the descriptors in the file fit the
//! messages.

use std::collections::BTreeMap;

use mcap::MessageStream;
use prost::Message as _;
use prost_types::FileDescriptorSet;
use prost_types::field_descriptor_proto::{Label, Type};

use super::{bytes_of, set};

/// Takes a variable-length number off the front. Source: protobuf encoding, base 128 varints.
fn varint(bytes: &mut &[u8]) -> u64 {
    let mut value = 0;
    for shift in (0..).step_by(7) {
        let byte = bytes[0];
        *bytes = &bytes[1..];
        value |= u64::from(byte & 0x7F) << shift;
        if byte < 0x80 {
            return value;
        }
    }
    unreachable!("a number ends")
}

/// Wire type of each field of a message.
fn wire_types(mut bytes: &[u8]) -> BTreeMap<i32, u64> {
    let mut fields = BTreeMap::new();
    while !bytes.is_empty() {
        let tag = varint(&mut bytes);
        fields.insert(i32::try_from(tag >> 3).expect("a field's number"), tag & 7);
        let length = match tag & 7 {
            0 => {
                varint(&mut bytes);
                0
            }
            1 => 8,
            2 => usize::try_from(varint(&mut bytes)).expect("a length"),
            5 => 4,
            other => panic!("wire type {other}"),
        };
        bytes = &bytes[length..];
    }
    fields
}

/// How a field of this type stands on the wire; lists of numbers are packed.
fn expected(kind: Type, label: Label) -> u64 {
    match kind {
        _ if label == Label::Repeated => 2,
        Type::Double => 1,
        Type::Uint32 | Type::Bool | Type::Enum => 0,
        Type::Fixed32 => 5,
        _ => 2,
    }
}

#[test]
fn descriptors_fit_the_messages() {
    let set = set(2);
    let bytes = bytes_of(&set);
    let mut seen = BTreeMap::new();
    for message in MessageStream::new(&bytes).expect("a recording") {
        let message = message.expect("a message");
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert_eq!(
            (schema.encoding.as_str(), message.channel.message_encoding.as_str()),
            ("protobuf", "protobuf")
        );
        let files = FileDescriptorSet::decode(schema.data.as_ref()).expect("descriptors");
        let (package, name) = schema.name.split_once('.').expect("a package");
        let file = files.file.iter().find(|f| f.package() == package).expect("a file");
        let described = file.message_type.iter().find(|m| m.name() == name).expect("a message");
        let known: BTreeMap<i32, u64> =
            described.field.iter().map(|f| (f.number(), expected(f.r#type(), f.label()))).collect();
        let found = wire_types(&message.data);
        for (number, wire) in &found {
            assert_eq!(known.get(number), Some(wire), "{}: field {number}", schema.name);
        }
        let (all, _) = seen.entry(schema.name.clone()).or_insert((BTreeMap::new(), known));
        all.extend(found);
    }
    let names: Vec<&str> = seen.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "foxglove.Log",
            "hertzscope.Capture",
            "hertzscope.Energy",
            "hertzscope.ScpiLine",
            "hertzscope.Series",
            "hertzscope.Setup"
        ]
    );
    // Every field of what matters is filled in these tests, so that every descriptor has been held
    // against one.
    for name in [
        "hertzscope.Capture",
        "hertzscope.Energy",
        "hertzscope.ScpiLine",
        "hertzscope.Series",
        "hertzscope.Setup",
    ] {
        let (found, known) = &seen[name];
        assert_eq!(found, known, "{name}");
    }
}
