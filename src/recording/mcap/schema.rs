//! The descriptors by which other readers decode the messages of a recording, made from
//! `hertzscope.proto` and `foxglove.proto`.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet,
};

/// The messages, as users compile them.
const MESSAGES: &str = include_str!("hertzscope.proto");
/// Foxglove's log.
const FOXGLOVE: &str = include_str!("foxglove.proto");

/// The kinds of messages, by the names of their schemas.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Schema {
    /// `hertzscope.Capture`
    Capture,
    /// `hertzscope.Setup`
    Setup,
    /// `hertzscope.Series`
    Series,
    /// `hertzscope.Energy`
    Energy,
    /// `foxglove.Log`
    Log,
    /// `hertzscope.ScpiLine`
    ScpiLine,
}

impl Schema {
    /// All of them.
    pub const ALL: [Self; 6] =
        [Self::Capture, Self::Setup, Self::Series, Self::Energy, Self::Log, Self::ScpiLine];

    /// Full name, package included.
    pub fn name(self) -> &'static str {
        match self {
            Self::Capture => "hertzscope.Capture",
            Self::Setup => "hertzscope.Setup",
            Self::Series => "hertzscope.Series",
            Self::Energy => "hertzscope.Energy",
            Self::Log => "foxglove.Log",
            Self::ScpiLine => "hertzscope.ScpiLine",
        }
    }

    /// The name of the field with this number.
    pub fn field_name(self, number: u32) -> Option<&'static str> {
        let ending = format!(" = {number}");
        self.body().lines().find_map(|line| {
            let declared = line.split(';').next()?.strip_suffix(ending.as_str())?;
            declared.rsplit(' ').next()
        })
    }

    /// The fields of the message, as they are written.
    fn body(self) -> &'static str {
        let (_, message) = self.name().split_once('.').unwrap_or(("", self.name()));
        let source = if self == Self::Log { FOXGLOVE } else { MESSAGES };
        let body =
            source.split_once(&format!("message {message} {{\n")).map_or("", |(_, body)| body);
        body.split_once("\n}").map_or(body, |(body, _)| body)
    }

    /// The serialised `FileDescriptorSet` by which any protobuf reader decodes this message.
    pub fn descriptor(self) -> Vec<u8> {
        let (package, message) = self.name().split_once('.').unwrap_or(("", self.name()));
        let body = self.body();
        let descriptor = DescriptorProto {
            name: Some(message.to_owned()),
            field: body.lines().filter_map(field).collect(),
            enum_type: if self == Self::Log { vec![log_level(body)] } else { Vec::new() },
            ..Default::default()
        };
        let file = FileDescriptorProto {
            name: Some(format!("{package}/{message}.proto")),
            package: Some(package.to_owned()),
            dependency: vec!["google/protobuf/timestamp.proto".to_owned()],
            message_type: vec![descriptor],
            syntax: Some("proto3".to_owned()),
            ..Default::default()
        };
        FileDescriptorSet { file: vec![timestamp_file(), file] }.encode_to_vec()
    }
}

/// A field's line, `  repeated float volts = 11;  // ...`; none for other lines.
fn field(line: &str) -> Option<FieldDescriptorProto> {
    let words: Vec<&str> = line.strip_prefix("  ")?.split(';').next()?.split(' ').collect();
    let (label, words) = match *words {
        ["repeated", ref rest @ ..] => (Label::Repeated, rest),
        ref all => (Label::Optional, all),
    };
    let [kind, name, "=", number] = *words else { return None };
    let (kind, type_name) = match kind {
        "double" => (Type::Double, None),
        "float" => (Type::Float, None),
        "uint32" => (Type::Uint32, None),
        "fixed32" => (Type::Fixed32, None),
        "bool" => (Type::Bool, None),
        "string" => (Type::String, None),
        "bytes" => (Type::Bytes, None),
        "Level" => (Type::Enum, Some(".foxglove.Log.Level".to_owned())),
        "google.protobuf.Timestamp" => (Type::Message, Some(format!(".{kind}"))),
        _ => return None,
    };
    Some(FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: number.parse().ok(),
        // proto3 calls every single field optional.
        label: Some(label.into()),
        r#type: Some(kind.into()),
        type_name,
        ..Default::default()
    })
}

/// The levels in a log's body, `    DEBUG = 1;`.
fn log_level(body: &str) -> EnumDescriptorProto {
    let value = |line: &str| {
        let (name, number) = line.strip_prefix("    ")?.strip_suffix(';')?.split_once(" = ")?;
        let (name, number) = (Some(name.to_owned()), number.parse().ok());
        Some(EnumValueDescriptorProto { name, number, ..Default::default() })
    };
    EnumDescriptorProto {
        name: Some("Level".to_owned()),
        value: body.lines().filter_map(value).collect(),
        ..Default::default()
    }
}

fn timestamp_file() -> FileDescriptorProto {
    let field = |name: &str, number: i32, kind: Type| FieldDescriptorProto {
        name: Some(name.to_owned()),
        number: Some(number),
        label: Some(Label::Optional.into()),
        r#type: Some(kind.into()),
        ..Default::default()
    };
    FileDescriptorProto {
        name: Some("google/protobuf/timestamp.proto".to_owned()),
        package: Some("google.protobuf".to_owned()),
        message_type: vec![DescriptorProto {
            name: Some("Timestamp".to_owned()),
            field: vec![field("seconds", 1, Type::Int64), field("nanos", 2, Type::Int32)],
            ..Default::default()
        }],
        syntax: Some("proto3".to_owned()),
        ..Default::default()
    }
}
