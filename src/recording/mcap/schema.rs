//! The descriptors by which other readers decode the messages of a recording.

use prost::Message as _;
use prost_types::field_descriptor_proto::{Label, Type};
use prost_types::{
    DescriptorProto, EnumDescriptorProto, EnumValueDescriptorProto, FieldDescriptorProto,
    FileDescriptorProto, FileDescriptorSet,
};

/// Name, type, cardinality. Fields are numbered in order from 1.
type Field = (&'static str, Type, Label);

/// proto3 calls every single field optional.
const SINGLE: Label = Label::Optional;
const TIMESTAMP: Field = ("timestamp", Type::Message, SINGLE);

const CAPTURE: [Field; 27] = [
    TIMESTAMP,
    ("shot", Type::Uint32, SINGLE),
    ("source", Type::String, SINGLE),
    ("t0_s", Type::Double, SINGLE),
    ("dt_s", Type::Double, SINGLE),
    ("y_mult", Type::Double, SINGLE),
    ("y_off", Type::Double, SINGLE),
    ("y_zero", Type::Double, SINGLE),
    ("unit", Type::String, SINGLE),
    ("codes", Type::Bytes, SINGLE),
    ("volts", Type::Float, Label::Repeated),
    ("origin", Type::String, SINGLE),
    ("trigger_point", Type::Double, SINGLE),
    ("vertical_scale", Type::Double, SINGLE),
    ("horizontal_scale", Type::Double, SINGLE),
    ("position_div", Type::Double, SINGLE),
    ("probe", Type::Double, SINGLE),
    ("coupling", Type::String, SINGLE),
    ("bandwidth_limited", Type::Bool, SINGLE),
    ("inverted", Type::Bool, SINGLE),
    ("model", Type::String, SINGLE),
    ("serial", Type::String, SINGLE),
    ("firmware", Type::String, SINGLE),
    ("point_format", Type::String, SINGLE),
    ("x_unit", Type::String, SINGLE),
    ("trigger_time_s", Type::Double, SINGLE),
    ("notes", Type::String, Label::Repeated),
];

const SETUP: [Field; 3] =
    [TIMESTAMP, ("shot", Type::Uint32, SINGLE), ("set", Type::String, SINGLE)];

const SERIES: [Field; 7] = [
    TIMESTAMP,
    ("shot", Type::Uint32, SINGLE),
    ("name", Type::String, SINGLE),
    ("unit", Type::String, SINGLE),
    ("t0_s", Type::Double, SINGLE),
    ("dt_s", Type::Double, SINGLE),
    ("values", Type::Double, Label::Repeated),
];

const ENERGY: [Field; 15] = [
    TIMESTAMP,
    ("shot", Type::Uint32, SINGLE),
    ("initial_j", Type::Double, SINGLE),
    ("final_j", Type::Double, SINGLE),
    ("dissipated_j", Type::Double, SINGLE),
    ("drift", Type::Double, SINGLE),
    ("kinetic_j", Type::Double, SINGLE),
    ("elastic_j", Type::Double, SINGLE),
    ("gravity_j", Type::Double, SINGLE),
    ("magnet_j", Type::Double, SINGLE),
    ("end_forces_j", Type::Double, SINGLE),
    ("dashpot_j", Type::Double, SINGLE),
    ("kuwabara_kono_j", Type::Double, SINGLE),
    ("power_law_loss_j", Type::Double, SINGLE),
    ("left_in_contacts_j", Type::Double, SINGLE),
];

const LOG: [Field; 6] = [
    TIMESTAMP,
    ("level", Type::Enum, SINGLE),
    ("message", Type::String, SINGLE),
    ("name", Type::String, SINGLE),
    ("file", Type::String, SINGLE),
    ("line", Type::Fixed32, SINGLE),
];

const SCPI_LINE: [Field; 5] = [
    TIMESTAMP,
    ("peer", Type::String, SINGLE),
    ("direction", Type::String, SINGLE),
    ("text", Type::String, SINGLE),
    ("bytes", Type::Bytes, SINGLE),
];

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

    fn fields(self) -> &'static [Field] {
        match self {
            Self::Capture => &CAPTURE,
            Self::Setup => &SETUP,
            Self::Series => &SERIES,
            Self::Energy => &ENERGY,
            Self::Log => &LOG,
            Self::ScpiLine => &SCPI_LINE,
        }
    }

    /// The serialised `FileDescriptorSet` by which any protobuf reader decodes this message.
    pub fn descriptor(self) -> Vec<u8> {
        let (package, message) = self.name().split_once('.').unwrap_or(("", self.name()));
        let field = |(number, (name, kind, label)): (i32, &Field)| FieldDescriptorProto {
            name: Some((*name).to_owned()),
            number: Some(number),
            label: Some((*label).into()),
            r#type: Some((*kind).into()),
            type_name: match kind {
                Type::Message => Some(".google.protobuf.Timestamp".to_owned()),
                Type::Enum => Some(".foxglove.Log.Level".to_owned()),
                _ => None,
            },
            ..Default::default()
        };
        let descriptor = DescriptorProto {
            name: Some(message.to_owned()),
            field: (1..).zip(self.fields()).map(field).collect(),
            enum_type: if self == Self::Log { vec![log_level()] } else { Vec::new() },
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

fn log_level() -> EnumDescriptorProto {
    let names = ["UNKNOWN", "DEBUG", "INFO", "WARNING", "ERROR", "FATAL"];
    let value = |(number, name): (i32, &&str)| EnumValueDescriptorProto {
        name: Some((*name).to_owned()),
        number: Some(number),
        ..Default::default()
    };
    EnumDescriptorProto {
        name: Some("Level".to_owned()),
        value: (0..).zip(&names).map(value).collect(),
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
