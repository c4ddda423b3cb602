//! Status and error: registers, events, and waiting.

use crate::instrument::Event;
use crate::scpi::argument::{flag, none, real, whole};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Stop, both, command, place, query};
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Status and error",
    rows: &[
        CommandRow::acts("*CLS", command(clear), "forgets events"),
        CommandRow::acts("*ESE", place!(|at| at.instrument.status.event_enable, byte, ReplyValue::integer), "events that show in the status byte"),
        CommandRow::acts(
            "*ESR",
            query(|at| Ok(ReplyValue::integer(at.instrument.status.read_register()))),
            "reads and clears the event register, releases events",
        ),
        CommandRow::acts("*OPC", both(complete, completed), "event 402 when the acquisition is done; the query waits for that and answers 1"),
        CommandRow::acts("*PSC", place!(|at| at.instrument.status.power_on_clear, flag, ReplyValue::flag), "whether registers are cleared at power on"),
        CommandRow::acts("*SRE", place!(|at| at.instrument.status.service_enable, byte, ReplyValue::integer), "parts of the status byte that ask for service"),
        CommandRow::acts("*STB", query(status_byte), "the status byte"),
        CommandRow::acts("*WAI", command(wait), "holds what follows until the acquisition is done"),
        CommandRow::acts("ALLEv", query(all_events), "every released event"),
        CommandRow::acts("BUSY", query(|at| Ok(ReplyValue::flag(at.instrument.is_busy()))), "1 while a single sequence runs"),
        CommandRow::acts("DESE", place!(|at| at.instrument.status.device_enable, byte, ReplyValue::integer), "events that are noticed at all"),
        CommandRow::acts("EVENT", query(|at| Ok(ReplyValue::integer(at.instrument.status.next_event().0))), "code of the next released event"),
        CommandRow::acts("EVMsg", query(next_event), "the next released event"),
        CommandRow::acts("EVQty", query(|at| Ok(ReplyValue::integer(at.instrument.status.released_events()))), "how many events are released"),
    ],
};

/// A register's content; what does not fit is refused, not clamped.
fn byte(arguments: &[Argument]) -> Result<u8, Stop> {
    let value = real(arguments)?.round();
    if !(0.0..=255.0).contains(&value) {
        return Err(Event::OutOfRange.into());
    }
    Ok(u8::try_from(whole(arguments, 0, 255)?).unwrap_or(u8::MAX))
}

fn clear(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    at.instrument.status.clear();
    Ok(())
}

fn complete(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    at.instrument.status.ask_for_completion();
    if !at.instrument.is_busy() {
        at.instrument.status.complete();
    }
    Ok(())
}

fn completed(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    if at.instrument.is_busy() { Err(Stop::UntilIdle) } else { Ok(ReplyValue::Integer(1)) }
}

fn wait(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    if at.instrument.is_busy() { Err(Stop::UntilIdle) } else { Ok(()) }
}

fn status_byte(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::integer(at.instrument.status.byte(at.message_available)))
}

fn written((code, message): &(u16, String)) -> String {
    format!("{code},\"{message}\"")
}

fn next_event(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Plain(written(&at.instrument.status.next_event())))
}

fn all_events(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let events = at.instrument.status.all_events();
    let texts: Vec<String> = events.iter().map(written).collect();
    Ok(ReplyValue::Plain(texts.join(",")))
}
