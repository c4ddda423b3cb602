//! The kinds of settings that rows of the table are made of.

use super::message::Argument;
use super::placeholder::Placeholder;
use super::reply::Preferences;
use super::value::ReplyValue;
use crate::instrument::{Event, Instrument};

/// Why a unit did not do what it says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Stop {
    /// It failed.
    Event(Event),
    /// It has to wait until the acquisition is done.
    UntilIdle,
    /// These commands take its place.
    Execute(String),
}

impl From<Event> for Stop {
    fn from(event: Event) -> Self {
        Self::Event(event)
    }
}

/// Context in which a unit is executed.
pub struct Context<'a> {
    /// The instrument.
    pub instrument: &'a mut Instrument,
    /// The connection's headers and terminator.
    pub preferences: &'a mut Preferences,
    /// Value of the header's placeholder.
    pub place: Placeholder,
    /// Whether a reply of the same message waits.
    pub message_available: bool,
    /// Bytes that are sent as they are, behind the replies to the message.
    pub raw: &'a mut Vec<u8>,
}

/// Parts of the reply to a group's query.
#[derive(Debug, Clone, Copy)]
pub enum Parts {
    /// The rows below the group.
    Below,
    /// These headers, as typed.
    Of(&'static [&'static str]),
}

/// A function that does what a command says.
pub type SetFunction = fn(&mut Context<'_>, &[Argument]) -> Result<(), Stop>;
/// A function that answers a query.
pub type GetFunction = fn(&mut Context<'_>) -> Result<ReplyValue, Stop>;

/// A function that makes a setting of a number.
pub type FitFunction = fn(&Instrument, Placeholder, f64) -> f64;

/// The setting behind a row of the table. A direction without a function does not exist.
#[derive(Clone, Copy)]
pub struct Setting {
    /// Sets, as the command says.
    pub set: Option<SetFunction>,
    /// Answers the query.
    pub get: Option<GetFunction>,
    /// The rows that answer the query instead.
    pub parts: Option<Parts>,
}

impl Setting {
    /// The setting of an alias, which is never reached.
    pub const NONE: Self = Self { set: None, get: None, parts: None };

    /// Whether it can be queried.
    pub fn answers(&self) -> bool {
        self.get.is_some() || self.parts.is_some()
    }
}

/// A command and a query.
pub const fn both(set: SetFunction, get: GetFunction) -> Setting {
    Setting { set: Some(set), get: Some(get), parts: None }
}

/// A query without command.
pub const fn query(get: GetFunction) -> Setting {
    Setting { get: Some(get), ..Setting::NONE }
}

/// A command without query.
pub const fn command(set: SetFunction) -> Setting {
    Setting { set: Some(set), ..Setting::NONE }
}

/// A query that other rows answer.
pub const fn group(parts: Parts) -> Setting {
    Setting { parts: Some(parts), ..Setting::NONE }
}

/// A query that other rows answer, and a command.
pub const fn group_and_command(parts: Parts, set: SetFunction) -> Setting {
    Setting { set: Some(set), parts: Some(parts), ..Setting::NONE }
}

/// A place in the instrument that a command sets to what `$read` reads from its arguments, and a
/// query tells as what `$reply` makes of it.
macro_rules! place {
    (|$at:ident| $place:expr, $read:expr, $reply:expr) => {
        $crate::scpi::setting::both(
            |$at, arguments| {
                let value = $read(arguments)?;
                $place = value;
                Ok(())
            },
            |$at| Ok($reply($place)),
        )
    };
}

/// One of several words.
macro_rules! word {
    (|$at:ident| $place:expr) => {
        $crate::scpi::setting::place!(|$at| $place, $crate::scpi::argument::word, |word| {
            $crate::scpi::value::ReplyValue::Word($crate::instrument::word::Word::word(word))
        })
    };
}

/// A number with decimals; the function makes a setting of any number typed.
macro_rules! number {
    (|$at:ident| $place:expr, $fit:expr) => {
        $crate::scpi::setting::both(
            |$at, arguments| {
                let fit: $crate::scpi::setting::FitFunction = $fit;
                let fitted =
                    fit($at.instrument, $at.place, $crate::scpi::argument::real(arguments)?);
                $place = fitted;
                Ok(())
            },
            |$at| Ok($crate::scpi::value::ReplyValue::Number($place)),
        )
    };
}

pub(super) use {number, place, word};
