//! Waveform transfer: `DATa`.

use crate::instrument::Event;
use crate::instrument::transfer::{Encoding, Transfer};
use crate::instrument::word::{Word as _, words};
use crate::scope::Source;
use crate::scpi::argument::{only, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Setting, Stop, both, group_and_command, place, word};
use crate::scpi::value::ReplyValue;

words! {
    /// Argument of `DATa`.
    Initialise {
        /// Set everything as at power on.
        Everything = "INIT",
    }
}

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Waveform: how it travels",
    rows: &[
        CommandRow::acts("DATa", group_and_command(Parts::Below, initialise), "`INIT` sets all of this as at power on"),
        CommandRow::acts("DATa:ENCdg", both(set_encoding, encoding), "`ASCIi` (`ASC` is taken, too), `RIBinary`, `RPBinary`, `SRIbinary` or `SRPbinary`"),
        CommandRow::acts(
            "DATa:DESTination",
            both(set_destination, |at| {
                Ok(ReplyValue::Word(at.instrument.transfer.destination.word()))
            }),
            "the reference memory that `CURVe` writes",
        ),
        CommandRow::alias("DATa:TARget", "DATa:DESTination"),
        CommandRow::acts("DATa:SOUrce", word!(|at| at.instrument.transfer.source), "the waveform that `CURVe?` reads"),
        CommandRow::acts(
            "DATa:STARt",
            both(
                |at, a| {
                    at.instrument.transfer.start = point(at, a)?;
                    Ok(())
                },
                |at| Ok(ReplyValue::Plain(at.instrument.transfer.start.to_string())),
            ),
            "first point, counted from 1",
        ),
        CommandRow::acts(
            "DATa:STOP",
            both(
                |at, a| {
                    at.instrument.transfer.stop = point(at, a)?;
                    Ok(())
                },
                |at| Ok(ReplyValue::Plain(at.instrument.transfer.stop.to_string())),
            ),
            "last point",
        ),
        CommandRow::acts("DATa:WIDth", WIDTH, "bytes a point, 1 or 2"),
    ],
};

fn initialise(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let Initialise::Everything = word(arguments)?;
    at.instrument.transfer = Transfer::initial(at.instrument.model.record_length);
    Ok(())
}

fn set_encoding(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    // `ASC` is what the preamble tells, and what scripts send: shorter than the manual's shortest
    // `ASCI`.
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
pub(super) fn point(at: &Context<'_>, arguments: &[Argument]) -> Result<usize, Stop> {
    let last = u32::try_from(at.instrument.model.record_length).unwrap_or(u32::MAX);
    Ok(usize::try_from(whole(arguments, 1, last)?).unwrap_or(1))
}

/// Bytes a point.
pub(super) const WIDTH: Setting = place!(
    |at| at.instrument.transfer.width,
    |a| whole(a, 1, 2).map(|width| width as u8),
    ReplyValue::integer
);
