//! The events that the instrument reports: code, text, and the bit of the event status register that each sets.
//!
//! Codes and the texts of 401, 420, 2202 and 2225 are those of real replies; further texts follow IEEE 488.2 and
//! SCPI-1999, volume 2, chapter 21, where codes agree, and are this program's own words for 2231 to 2244.

/// Something that the instrument has to report.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Event {
    /// Not a sequence of commands.
    Command,
    /// A character that cannot stand where it stands.
    InvalidCharacter,
    /// Not a command.
    Syntax,
    /// An argument of the wrong kind.
    DataType,
    /// More arguments than the command takes.
    ParameterNotAllowed,
    /// Fewer arguments than the command takes.
    MissingParameter,
    /// No such command.
    UndefinedHeader,
    /// A block whose length is not what it says.
    InvalidBlock,
    /// A text that has no end or is too long.
    InvalidString,
    /// The command cannot be obeyed in the present state.
    SettingsConflict,
    /// A number that no neighbouring setting stands for.
    OutOfRange,
    /// Not one of the choices.
    IllegalParameter,
    /// The command needs a missing option.
    HardwareMissing,
    /// Something behind the front panel failed.
    SystemError,
    /// Events were lost.
    QueueOverflow,
    /// A message longer than the input buffer.
    InputOverrun,
    /// The instrument was switched on.
    PowerOn,
    /// Everything asked for is done.
    OperationComplete,
    /// A reply was thrown away because another message came.
    QueryInterrupted,
    /// A reply was read without a query.
    QueryUnterminated,
    /// Replies grew beyond the output buffer.
    QueryDeadlocked,
    /// A query after one whose reply has no known end.
    QueryAfterIndefinite,
    /// The record holds no full cycle.
    NoPeriod,
    /// The signal does not cross the level in question.
    NoCrossing,
    /// The waveform is not there.
    NoWaveform,
    /// The measurement's type is `NONE`.
    NoMeasurementType,
    /// Only reference memories can be written.
    NotAReference,
    /// The waveform is not displayed.
    NotActive,
    /// A math definition that this instrument has not.
    InvalidMath,
}

/// Bits of the standard event status register.
pub mod bit {
    /// Operation complete.
    pub const OPERATION_COMPLETE: u8 = 1;
    /// Query error.
    pub const QUERY: u8 = 1 << 2;
    /// Device error.
    pub const DEVICE: u8 = 1 << 3;
    /// Execution error.
    pub const EXECUTION: u8 = 1 << 4;
    /// Command error.
    pub const COMMAND: u8 = 1 << 5;
    /// Power on.
    pub const POWER_ON: u8 = 1 << 7;
}

impl Event {
    /// The code.
    pub fn code(self) -> u16 {
        self.row().0
    }

    /// The text as the instrument writes it, with the mark after which further information may stand.
    pub fn message(self) -> String {
        format!("{}; ", self.row().1)
    }

    /// The bit of the event status register.
    pub fn bit(self) -> u8 {
        match self.code() {
            100..=199 => bit::COMMAND,
            300..=399 => bit::DEVICE,
            401 => bit::POWER_ON,
            402 => bit::OPERATION_COMPLETE,
            410 | 420 | 430 | 440 => bit::QUERY,
            _ => bit::EXECUTION,
        }
    }

    fn row(self) -> (u16, &'static str) {
        match self {
            Self::Command => (100, "Command error"),
            Self::InvalidCharacter => (101, "Invalid character"),
            Self::Syntax => (102, "Syntax error"),
            Self::DataType => (104, "Data type error"),
            Self::ParameterNotAllowed => (108, "Parameter not allowed"),
            Self::MissingParameter => (109, "Missing parameter"),
            Self::UndefinedHeader => (113, "Undefined header"),
            Self::InvalidString => (151, "Invalid string data"),
            Self::InvalidBlock => (161, "Invalid block data"),
            Self::SettingsConflict => (221, "Settings conflict"),
            Self::OutOfRange => (222, "Data out of range"),
            Self::IllegalParameter => (224, "Illegal parameter value"),
            Self::HardwareMissing => (241, "Hardware missing"),
            Self::SystemError => (310, "System error"),
            Self::QueueOverflow => (350, "Queue overflow"),
            Self::InputOverrun => (363, "Input buffer overrun"),
            Self::PowerOn => (401, "Power on"),
            Self::OperationComplete => (402, "Operation complete"),
            Self::QueryInterrupted => (410, "Query INTERRUPTED"),
            Self::QueryUnterminated => (420, "Query UNTERMINATED"),
            Self::QueryDeadlocked => (430, "Query DEADLOCKED"),
            Self::QueryAfterIndefinite => (440, "Query UNTERMINATED after indefinite response"),
            Self::NoPeriod => (2202, "Measurement error, No period found"),
            Self::NoCrossing => (2208, "Measurement error, No crossing found"),
            Self::NoWaveform => (2225, "Measurement error, No waveform to measure"),
            Self::NoMeasurementType => (2231, "Measurement error, Measurement type is NONE"),
            Self::InvalidMath => (2235, "Math error, Invalid math description"),
            Self::NotAReference => (2241, "Waveform is not a reference memory"),
            Self::NotActive => (2244, "Waveform is not active"),
        }
    }
}

/// Code and text of an empty queue when nothing waits for `*ESR?`.
pub const EMPTY: (u16, &str) = (0, "No events to report - queue empty");
/// Code and text of an empty queue when events wait for `*ESR?`.
pub const PENDING: (u16, &str) = (1, "No events to report - new events pending *ESR?");
