//! Reads the arguments of a command as what it takes.

use super::message::Argument;
use super::value;
use crate::instrument::Event;
use crate::scope::word::{Word, words};

words! {
    /// A flag as typed.
    Flag {
        /// True.
        On = "ON",
        /// False.
        Off = "OFF",
    }
}

/// The only argument.
///
/// # Errors
/// For none and for more than one.
pub fn only(arguments: &[Argument]) -> Result<&Argument, Event> {
    match arguments {
        [] => Err(Event::MissingParameter),
        [argument] => Ok(argument),
        _ => Err(Event::ParameterNotAllowed),
    }
}

/// No argument.
///
/// # Errors
/// For any.
pub fn none(arguments: &[Argument]) -> Result<(), Event> {
    if arguments.is_empty() { Ok(()) } else { Err(Event::ParameterNotAllowed) }
}

/// The only argument as one of several words.
///
/// # Errors
/// For another count of arguments, and for a word that is not one of the choices.
pub fn word<T: Word>(arguments: &[Argument]) -> Result<T, Event> {
    match only(arguments)? {
        Argument::Word(typed) => T::from_word(typed).ok_or(Event::IllegalParameter),
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

/// The only argument as a flag: `ON`, `OFF`, or a number that is zero for `OFF`.
///
/// # Errors
/// For another count of arguments, and for what is no flag.
pub fn flag(arguments: &[Argument]) -> Result<bool, Event> {
    match real(arguments) {
        Ok(value) => Ok(value.round().abs() > 0.0),
        Err(_) => word::<Flag>(arguments).map(|flag| flag == Flag::On),
    }
}

/// The only argument as a number (unit).
///
/// # Errors
/// For another count of arguments, and for what is no number.
pub fn real(arguments: &[Argument]) -> Result<f64, Event> {
    match only(arguments)? {
        Argument::Word(typed) => value::parse(typed).ok_or(Event::DataType),
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

/// The only argument as a whole number, rounded and clamped into a range.
///
/// # Errors
/// For another count of arguments, and for what is no number.
pub fn whole(arguments: &[Argument], least: u32, most: u32) -> Result<u32, Event> {
    let value = real(arguments)?.round().clamp(f64::from(least), f64::from(most));
    let whole = value as u32;
    Ok(whole)
}

/// The only argument as text in quotation marks.
///
/// # Errors
/// For another count of arguments, and for what is no text.
pub fn text(arguments: &[Argument]) -> Result<&str, Event> {
    match only(arguments)? {
        Argument::Text(text) => Ok(text),
        Argument::Word(_) | Argument::Block(_) => Err(Event::DataType),
    }
}
