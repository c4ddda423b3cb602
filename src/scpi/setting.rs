//! The kinds of settings that rows of the table are made of.

use super::argument::{flag, real, word};
use super::message::Argument;
use super::placeholder::Placeholder;
use super::preferences::Preferences;
use super::value::ReplyValue;
use crate::instrument::word::Word;
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

/// Directions of a setting: set, query.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Access {
    /// It can be set.
    pub sets: bool,
    /// It can be asked for.
    pub asks: bool,
}

/// Parts of the reply to a group's query.
#[derive(Debug, Clone, Copy)]
pub enum Parts {
    /// The rows below the group.
    Below,
    /// These headers, as typed.
    Of(&'static [&'static str]),
}

/// The setting behind a row of the table. A direction without a body of its own does not exist.
pub trait Setting: Sync {
    /// Which directions exist.
    fn access(&self) -> Access;

    /// Sets.
    ///
    /// # Errors
    /// [`Stop`], with the event to report.
    fn set(&self, _at: &mut Context<'_>, _arguments: &[Argument]) -> Result<(), Stop> {
        Err(Event::UndefinedHeader.into())
    }

    /// Tells.
    ///
    /// # Errors
    /// [`Stop`], with the event to report.
    fn get(&self, _at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        Err(Event::UndefinedHeader.into())
    }

    /// Reply to a query that other rows answer.
    fn parts(&self) -> Option<Parts> {
        None
    }
}

/// A function that finds a setting in the instrument.
type Field<T> = for<'a> fn(&'a mut Instrument, Placeholder) -> &'a mut T;
/// A function that does what a command says.
type SetFunction = fn(&mut Context<'_>, &[Argument]) -> Result<(), Stop>;
/// A function that answers a query.
type GetFunction = fn(&mut Context<'_>) -> Result<ReplyValue, Stop>;
/// A function that makes a setting of a number.
type Fit = fn(&Instrument, Placeholder, f64) -> f64;

const BOTH: Access = Access { sets: true, asks: true };

/// One of several words.
pub struct WordSetting<T: Word>(pub Field<T>);

impl<T: Word> Setting for WordSetting<T> {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        *(self.0)(at.instrument, at.place) = word(arguments)?;
        Ok(())
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        Ok(ReplyValue::Word((self.0)(at.instrument, at.place).word()))
    }
}

/// A flag that is told as `ON` or `OFF`.
pub struct OnOff(pub Field<bool>);

impl Setting for OnOff {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        *(self.0)(at.instrument, at.place) = flag(arguments)?;
        Ok(())
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        let on = *(self.0)(at.instrument, at.place);
        Ok(ReplyValue::Word(if on { "ON" } else { "OFF" }))
    }
}

/// A flag that is told as `1` or `0`.
pub struct Switch(pub Field<bool>);

impl Setting for Switch {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        *(self.0)(at.instrument, at.place) = flag(arguments)?;
        Ok(())
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        Ok(ReplyValue::flag(*(self.0)(at.instrument, at.place)))
    }
}

/// A number with decimals, and what makes a setting of any number typed.
pub struct Number(pub Field<f64>, pub Fit);

impl Setting for Number {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        let fitted = (self.1)(at.instrument, at.place, real(arguments)?);
        *(self.0)(at.instrument, at.place) = fitted;
        Ok(())
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        Ok(ReplyValue::Number(*(self.0)(at.instrument, at.place)))
    }
}

/// Both directions by functions.
pub struct Both(pub SetFunction, pub GetFunction);

impl Setting for Both {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        (self.0)(at, arguments)
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        (self.1)(at)
    }
}

/// A query without command.
pub struct Query(pub GetFunction);

impl Setting for Query {
    fn access(&self) -> Access {
        Access { sets: false, asks: true }
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        (self.0)(at)
    }
}

/// A command without query.
pub struct Command(pub SetFunction);

impl Setting for Command {
    fn access(&self) -> Access {
        Access { sets: true, asks: false }
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        (self.0)(at, arguments)
    }
}

/// A query that other rows answer.
pub struct GroupQuery(pub Parts);

impl Setting for GroupQuery {
    fn access(&self) -> Access {
        Access { sets: false, asks: true }
    }

    fn parts(&self) -> Option<Parts> {
        Some(self.0)
    }
}

/// A query that other rows answer, and a command.
pub struct GroupQueryAndCommand(pub Parts, pub SetFunction);

impl Setting for GroupQueryAndCommand {
    fn access(&self) -> Access {
        BOTH
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        (self.1)(at, arguments)
    }

    fn parts(&self) -> Option<Parts> {
        Some(self.0)
    }
}

/// The setting of an alias, which is never reached.
pub struct Nothing;

impl Setting for Nothing {
    fn access(&self) -> Access {
        Access { sets: false, asks: false }
    }
}
