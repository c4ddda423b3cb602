//! The protobuf messages of a recording.
//!
//! Field numbers are an interface: they never change meaning. `tests/it/recordings/descriptors.rs`
//! checks that the structures and the descriptors of `schema.rs` agree.

use prost::Message;
use prost_types::Timestamp;

/// One channel's record of one trigger. Numbers that an instrument may give as -0 are optional: a
/// plain number that equals 0 is left out of a message, and its sign with it.
#[derive(Clone, PartialEq, Message)]
pub struct CaptureMessage {
    /// Time of the trigger.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Counted from 1.
    #[prost(uint32, tag = "2")]
    pub shot: u32,
    /// `CH1` to `CH4`, `MATH`, `REFA` to `REFD`.
    #[prost(string, tag = "3")]
    pub source: String,
    /// First point after the trigger (s).
    #[prost(double, optional, tag = "4")]
    pub t0_s: Option<f64>,
    /// From point to point (s).
    #[prost(double, tag = "5")]
    pub dt_s: f64,
    /// One digitiser level (V).
    #[prost(double, tag = "6")]
    pub y_mult: f64,
    /// Level of zero volts (1).
    #[prost(double, optional, tag = "7")]
    pub y_off: Option<f64>,
    /// Volts at that level (V).
    #[prost(double, optional, tag = "8")]
    pub y_zero: Option<f64>,
    /// Unit of the ordinate.
    #[prost(string, tag = "9")]
    pub unit: String,
    /// Digitiser levels: one signed byte each, or two (most significant first) where one does not
    /// suffice.
    #[prost(bytes = "vec", tag = "10")]
    pub codes: Vec<u8>,
    /// The same in volts, for readers that do not want to know about levels.
    #[prost(float, repeated, tag = "11")]
    pub volts: Vec<f32>,
    /// `simulated` or `measured`.
    #[prost(string, tag = "12")]
    pub origin: String,
    /// Index of the trigger in the record (1).
    #[prost(double, optional, tag = "13")]
    pub trigger_point: Option<f64>,
    /// Vertical scale (V/div).
    #[prost(double, tag = "14")]
    pub vertical_scale: f64,
    /// Time base (s/div).
    #[prost(double, tag = "15")]
    pub horizontal_scale: f64,
    /// Vertical position (div).
    #[prost(double, optional, tag = "16")]
    pub position_div: Option<f64>,
    /// Probe attenuation (1).
    #[prost(double, tag = "17")]
    pub probe: f64,
    /// `DC`, `AC`, `GND`, or empty where it is not known.
    #[prost(string, tag = "18")]
    pub coupling: String,
    /// Whether the bandwidth limiter was on.
    #[prost(bool, optional, tag = "19")]
    pub bandwidth_limited: Option<bool>,
    /// Whether the trace was turned upside down.
    #[prost(bool, optional, tag = "20")]
    pub inverted: Option<bool>,
    /// Model of the instrument, empty where it is not known.
    #[prost(string, tag = "21")]
    pub model: String,
    /// Its serial number.
    #[prost(string, tag = "22")]
    pub serial: String,
    /// Its firmware.
    #[prost(string, tag = "23")]
    pub firmware: String,
    /// `Y` or `ENV`.
    #[prost(string, tag = "24")]
    pub point_format: String,
    /// Unit of the abscissa.
    #[prost(string, tag = "25")]
    pub x_unit: String,
    /// Time of the trigger on the simulation's clock; absent for measurements (s).
    #[prost(double, optional, tag = "26")]
    pub trigger_time_s: Option<f64>,
    /// Notes on guesses of the import, and on suspicious values.
    #[prost(string, repeated, tag = "27")]
    pub notes: Vec<String>,
    /// The values as a file gives them, if the levels do not return them exactly (unit).
    #[prost(double, repeated, tag = "28")]
    pub values: Vec<f64>,
}

/// The front panel at a trigger.
#[derive(Clone, PartialEq, Message)]
pub struct SetupMessage {
    /// Time of the trigger.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Counted from 1.
    #[prost(uint32, tag = "2")]
    pub shot: u32,
    /// As the instrument's `SET?` would tell it.
    #[prost(string, tag = "3")]
    pub set: String,
}

/// Ground truth of a simulation: an evenly sampled series.
#[derive(Clone, PartialEq, Message)]
pub struct SeriesMessage {
    /// Time of the trigger.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Counted from 1.
    #[prost(uint32, tag = "2")]
    pub shot: u32,
    /// Its name.
    #[prost(string, tag = "3")]
    pub name: String,
    /// Unit of the values.
    #[prost(string, tag = "4")]
    pub unit: String,
    /// First value, on the simulation's clock (s).
    #[prost(double, tag = "5")]
    pub t0_s: f64,
    /// From value to value (s).
    #[prost(double, tag = "6")]
    pub dt_s: f64,
    /// The values, in the unit named (unit).
    #[prost(double, repeated, tag = "7")]
    pub values: Vec<f64>,
}

/// The energy ledger of one shot.
#[derive(Clone, PartialEq, Message)]
pub struct EnergyMessage {
    /// Time of the trigger.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Counted from 1.
    #[prost(uint32, tag = "2")]
    pub shot: u32,
    /// At the striker's first contact (J).
    #[prost(double, tag = "3")]
    pub initial_j: f64,
    /// At the end (J).
    #[prost(double, tag = "4")]
    pub final_j: f64,
    /// Booked as lost (J).
    #[prost(double, tag = "5")]
    pub dissipated_j: f64,
    /// `final + dissipated - work_of_drive - initial`, over the energy in motion (1).
    #[prost(double, tag = "6")]
    pub drift: f64,
    /// Kinetic energy at the end (J).
    #[prost(double, tag = "7")]
    pub kinetic_j: f64,
    /// Elastic energy at the end, without that of contacts held at zero force (J).
    #[prost(double, tag = "8")]
    pub elastic_j: f64,
    /// Less the work of gravity (J).
    #[prost(double, tag = "9")]
    pub gravity_j: f64,
    /// Less the work of the magnet (J).
    #[prost(double, tag = "10")]
    pub magnet_j: f64,
    /// Less the work of forces that press on the chain's ends (J).
    #[prost(double, tag = "11")]
    pub end_forces_j: f64,
    /// Taken by dashpots (J).
    #[prost(double, tag = "12")]
    pub dashpot_j: f64,
    /// Taken by Kuwabara and Kono's losses (J).
    #[prost(double, tag = "13")]
    pub kuwabara_kono_j: f64,
    /// Taken by power-law losses (J).
    #[prost(double, tag = "14")]
    pub power_law_loss_j: f64,
    /// Left in contacts held at zero force (J).
    #[prost(double, tag = "15")]
    pub left_in_contacts_j: f64,
    /// Taken by contacts that yield (J).
    #[prost(double, tag = "16")]
    pub plasticity_j: f64,
    /// Taken by a rod or plate at the top (J).
    #[prost(double, tag = "17")]
    pub top_wall_j: f64,
    /// Taken by a rod or plate at the bottom (J).
    #[prost(double, tag = "18")]
    pub bottom_wall_j: f64,
    /// Put in by a drive, not part of what is lost (J).
    #[prost(double, tag = "19")]
    pub work_of_drive_j: f64,
}

/// `foxglove.Log`: a line for people. Source: Foxglove's public message schemas.
#[derive(Clone, PartialEq, Message)]
pub struct LogMessage {
    /// Time of the trigger.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// 2 is information, 3 a warning.
    #[prost(int32, tag = "2")]
    pub level: i32,
    /// The line.
    #[prost(string, tag = "3")]
    pub message: String,
    /// Who says so.
    #[prost(string, tag = "4")]
    pub name: String,
    /// Unused.
    #[prost(string, tag = "5")]
    pub file: String,
    /// Unused.
    #[prost(fixed32, tag = "6")]
    pub line: u32,
}

/// A command to the instrument or a reply from it.
#[derive(Clone, PartialEq, Message)]
pub struct ScpiLineMessage {
    /// When it was received or sent.
    #[prost(message, optional, tag = "1")]
    pub timestamp: Option<Timestamp>,
    /// Protocol and address of the client.
    #[prost(string, tag = "2")]
    pub peer: String,
    /// `command` or `reply`.
    #[prost(string, tag = "3")]
    pub direction: String,
    /// The beginning of the line for people: without its end, what cannot be printed escaped.
    #[prost(string, tag = "4")]
    pub text: String,
    /// All of it, as it went over the wire; a command without its end, a reply with its terminator.
    #[prost(bytes = "vec", tag = "5")]
    pub bytes: Vec<u8>,
}

/// Level of a line that tells something the user did not ask for.
pub const WARNING: i32 = 3;
/// Level of a line that only informs.
pub const INFORMATION: i32 = 2;

/// Nanoseconds since 1970 as protobuf keeps them.
pub fn timestamp(nanoseconds: u64) -> Timestamp {
    const BILLION: u64 = 1_000_000_000;
    Timestamp {
        seconds: i64::try_from(nanoseconds / BILLION).unwrap_or(i64::MAX),
        nanos: i32::try_from(nanoseconds % BILLION).unwrap_or(0),
    }
}

/// Records of a shot beside its captures and truth.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ShotNotes {
    /// The front panel as `SET?` would tell it.
    pub set_up: String,
    /// The energy ledger, of a simulation.
    pub energy: Option<EnergyMessage>,
    /// Lines for people; `true` marks a warning.
    pub log: Vec<(bool, String)>,
}
