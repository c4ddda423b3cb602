//! The events that the instrument reports: code, text, and the bit of the event status register
//! that each sets.
//!
//! Codes and the texts of 401, 420, 2202 and 2225 are those of real replies; further texts follow
//! IEEE 488.2 and SCPI-1999, volume 2, chapter 21, where codes agree, and are this program's own
//! words for 2231 to 2244.

/// Declares the events with their codes and texts.
macro_rules! events {
    ($($event:ident = $code:literal, $text:literal;)+) => {
        /// Something that the instrument has to report.
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum Event { $(#[doc = concat!("Code ", $code, ": ", $text, ".")] $event),+ }

        impl Event {
            fn row(self) -> (u16, &'static str) {
                match self { $(Self::$event => ($code, $text)),+ }
            }
        }
    };
}

events! {
    Command = 100, "Command error";
    InvalidCharacter = 101, "Invalid character";
    Syntax = 102, "Syntax error";
    DataType = 104, "Data type error";
    ParameterNotAllowed = 108, "Parameter not allowed";
    MissingParameter = 109, "Missing parameter";
    UndefinedHeader = 113, "Undefined header";
    InvalidString = 151, "Invalid string data";
    InvalidBlock = 161, "Invalid block data";
    SettingsConflict = 221, "Settings conflict";
    OutOfRange = 222, "Data out of range";
    IllegalParameter = 224, "Illegal parameter value";
    HardwareMissing = 241, "Hardware missing";
    SystemError = 310, "System error";
    QueueOverflow = 350, "Queue overflow";
    InputOverrun = 363, "Input buffer overrun";
    PowerOn = 401, "Power on";
    OperationComplete = 402, "Operation complete";
    QueryInterrupted = 410, "Query INTERRUPTED";
    QueryUnterminated = 420, "Query UNTERMINATED";
    QueryDeadlocked = 430, "Query DEADLOCKED";
    QueryAfterIndefinite = 440, "Query UNTERMINATED after indefinite response";
    NoPeriod = 2202, "Measurement error, No period found";
    NoCrossing = 2208, "Measurement error, No crossing found";
    NoWaveform = 2225, "Measurement error, No waveform to measure";
    NoMeasurementType = 2231, "Measurement error, Measurement type is NONE";
    InvalidMath = 2235, "Math error, Invalid math description";
    NotAReference = 2241, "Waveform is not a reference memory";
    NotActive = 2244, "Waveform is not active";
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

    /// The text as the instrument writes it, with the mark after which further information may
    /// stand.
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
}

/// Code and text of an empty queue when nothing waits for `*ESR?`.
pub const EMPTY: (u16, &str) = (0, "No events to report - queue empty");
/// Code and text of an empty queue when events wait for `*ESR?`.
pub const PENDING: (u16, &str) = (1, "No events to report - new events pending *ESR?");
