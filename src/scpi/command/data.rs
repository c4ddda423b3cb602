//! Waveform transfer: `DATa`.

use crate::instrument::Event;
use crate::instrument::transfer::{Encoding, Transfer};
use crate::instrument::word::{Word as _, words};
use crate::scope::Source;
use crate::scpi::argument::{only, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Both, Context, GroupQueryAndCommand, Parts, Stop, WordSetting};
use crate::scpi::value::ReplyValue;

words! {
    /// Argument of `DATa`.
    Initialise {
        /// Set everything as at power on.
        Everything = "INIT",
    }
}

/// The group.
pub const GROUP: Group = Group {
    title: "Waveform: how it travels",
    rows: &[
        CommandRow::acts(
            "DATa",
            &GroupQueryAndCommand(Parts::Below, initialise),
            "`INIT` sets all of this as at power on",
        ),
        CommandRow::acts(
            "DATa:ENCdg",
            &Both(set_encoding, encoding),
            "`ASCIi` (`ASC` is taken, too), `RIBinary`, `RPBinary`, `SRIbinary` or `SRPbinary`",
        ),
        CommandRow::acts(
            "DATa:DESTination",
            &Both(set_destination, |at| {
                Ok(ReplyValue::Word(at.instrument.transfer.destination.word()))
            }),
            "the reference memory that `CURVe` writes",
        ),
        CommandRow::alias("DATa:TARget", "DATa:DESTination"),
        CommandRow::acts(
            "DATa:SOUrce",
            &WordSetting(|i, _| &mut i.transfer.source),
            "the waveform that `CURVe?` reads",
        ),
        CommandRow::acts(
            "DATa:STARt",
            &Both(set_start, |at| Ok(ReplyValue::Plain(at.instrument.transfer.start.to_string()))),
            "first point, counted from 1",
        ),
        CommandRow::acts(
            "DATa:STOP",
            &Both(set_stop, |at| Ok(ReplyValue::Plain(at.instrument.transfer.stop.to_string()))),
            "last point",
        ),
        CommandRow::acts(
            "DATa:WIDth",
            &Both(set_width, |at| Ok(ReplyValue::Integer(i64::from(at.instrument.transfer.width)))),
            "bytes a point, 1 or 2",
        ),
    ],
};

fn initialise(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let Initialise::Everything = word(arguments)?;
    at.instrument.transfer = Transfer::initial(at.instrument.model.record_length);
    Ok(())
}

fn set_encoding(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    // `ASC` is what the preamble tells, and what scripts send: shorter than the manual's shortest `ASCI`.
    let encoding = match only(arguments)? {
        Argument::Word(typed) if typed.eq_ignore_ascii_case("ASC") => Encoding::Ascii,
        _ => word::<Encoding>(arguments)?,
    };
    at.instrument.transfer.set_encoding(encoding);
    Ok(())
}

fn encoding(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Word(at.instrument.transfer.encoding().word()))
}

fn set_destination(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let destination = word(arguments)?;
    if !matches!(destination, Source::Reference(_)) {
        return Err(Event::NotAReference.into());
    }
    at.instrument.transfer.destination = destination;
    Ok(())
}

/// A point of a record, counted from 1.
fn point(at: &Context<'_>, arguments: &[Argument]) -> Result<usize, Stop> {
    let last = u32::try_from(at.instrument.model.record_length).unwrap_or(u32::MAX);
    Ok(usize::try_from(whole(arguments, 1, last)?).unwrap_or(1))
}

fn set_start(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.transfer.start = point(at, arguments)?;
    Ok(())
}

fn set_stop(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.transfer.stop = point(at, arguments)?;
    Ok(())
}

pub(super) fn set_width(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.transfer.width = if whole(arguments, 1, 2)? == 2 { 2 } else { 1 };
    Ok(())
}
