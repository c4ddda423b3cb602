//! Status and error: registers, events, and waiting.

use crate::instrument::Event;
use crate::scpi::argument::{flag, none, real, whole};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Both, Command, Context, Query, Stop};
use crate::scpi::value::ReplyValue;

/// The group.
pub const GROUP: Group = Group {
    title: "Status and error",
    rows: &[
        CommandRow::acts("*CLS", &Command(clear), "forgets events"),
        CommandRow::acts(
            "*ESE",
            &Both(
                |at, a| {
                    at.instrument.status.event_enable = byte(a)?;
                    Ok(())
                },
                |at| Ok(integer(at.instrument.status.event_enable)),
            ),
            "events that show in the status byte",
        ),
        CommandRow::acts(
            "*ESR",
            &Query(|at| Ok(integer(at.instrument.status.read_register()))),
            "reads and clears the event register, releases events",
        ),
        CommandRow::acts(
            "*OPC",
            &Both(complete, completed),
            "event 402 when the acquisition is done; the query waits for that and answers 1",
        ),
        CommandRow::acts(
            "*PSC",
            &Both(
                |at, a| {
                    at.instrument.status.power_on_clear = flag(a)?;
                    Ok(())
                },
                |at| Ok(ReplyValue::flag(at.instrument.status.power_on_clear)),
            ),
            "whether registers are cleared at power on",
        ),
        CommandRow::acts(
            "*SRE",
            &Both(
                |at, a| {
                    at.instrument.status.service_enable = byte(a)?;
                    Ok(())
                },
                |at| Ok(integer(at.instrument.status.service_enable)),
            ),
            "parts of the status byte that ask for service",
        ),
        CommandRow::acts("*STB", &Query(status_byte), "the status byte"),
        CommandRow::acts(
            "*WAI",
            &Command(wait),
            "holds what follows until the acquisition is done",
        ),
        CommandRow::acts("ALLEv", &Query(all_events), "every released event"),
        CommandRow::acts(
            "BUSY",
            &Query(|at| Ok(ReplyValue::flag(at.instrument.is_busy()))),
            "1 while a single sequence runs",
        ),
        CommandRow::acts(
            "DESE",
            &Both(
                |at, a| {
                    at.instrument.status.device_enable = byte(a)?;
                    Ok(())
                },
                |at| Ok(integer(at.instrument.status.device_enable)),
            ),
            "events that are noticed at all",
        ),
        CommandRow::acts(
            "EVENT",
            &Query(|at| Ok(ReplyValue::Integer(i64::from(at.instrument.status.next_event().0)))),
            "code of the next released event",
        ),
        CommandRow::acts("EVMsg", &Query(next_event), "the next released event"),
        CommandRow::acts(
            "EVQty",
            &Query(|at| Ok(integer(at.instrument.status.released_events()))),
            "how many events are released",
        ),
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

fn integer(byte: u8) -> ReplyValue {
    ReplyValue::Integer(i64::from(byte))
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
    Ok(integer(at.instrument.status.byte(at.message_available)))
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
