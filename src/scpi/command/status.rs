//! Status and error: registers, events, and waiting.

use crate::scpi::argument::{flag, none, whole};
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Both, Command, Context, Query, Stop};
use crate::scpi::value::Value;

/// The group.
pub const GROUP: Group = Group {
    title: "Status and error",
    rows: &[
        Row::acts("*CLS", &Command(clear), "forgets events"),
        Row::acts(
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
        Row::acts(
            "*ESR",
            &Query(|at| Ok(integer(at.instrument.status.read_register()))),
            "reads and clears the event register, releases events",
        ),
        Row::acts(
            "*OPC",
            &Both(complete, completed),
            "event 402 when the acquisition is done; the query waits for that and answers 1",
        ),
        Row::acts(
            "*PSC",
            &Both(
                |at, a| {
                    at.instrument.status.power_on_clear = flag(a)?;
                    Ok(())
                },
                |at| Ok(Value::flag(at.instrument.status.power_on_clear)),
            ),
            "whether registers are cleared at power on",
        ),
        Row::acts(
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
        Row::acts("*STB", &Query(status_byte), "the status byte"),
        Row::acts("*WAI", &Command(wait), "holds what follows until the acquisition is done"),
        Row::acts("ALLEv", &Query(all_events), "every released event"),
        Row::acts(
            "BUSY",
            &Query(|at| Ok(Value::flag(at.instrument.is_busy()))),
            "1 while a single sequence runs",
        ),
        Row::acts(
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
        Row::acts(
            "EVENT",
            &Query(|at| Ok(Value::Integer(i64::from(at.instrument.status.next_event().0)))),
            "code of the next released event",
        ),
        Row::acts("EVMsg", &Query(next_event), "the next released event"),
        Row::acts(
            "EVQty",
            &Query(|at| Ok(integer(at.instrument.status.released_events()))),
            "how many events are released",
        ),
    ],
};

fn byte(arguments: &[Argument]) -> Result<u8, Stop> {
    Ok(u8::try_from(whole(arguments, 0, 255)?).unwrap_or(u8::MAX))
}

fn integer(byte: u8) -> Value {
    Value::Integer(i64::from(byte))
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

fn completed(at: &mut Context<'_>) -> Result<Value, Stop> {
    if at.instrument.is_busy() { Err(Stop::UntilIdle) } else { Ok(Value::Integer(1)) }
}

fn wait(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    if at.instrument.is_busy() { Err(Stop::UntilIdle) } else { Ok(()) }
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn status_byte(at: &mut Context<'_>) -> Result<Value, Stop> {
    Ok(integer(at.instrument.status.byte(at.message_available)))
}

fn written((code, message): &(u16, String)) -> String {
    format!("{code},\"{message}\"")
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn next_event(at: &mut Context<'_>) -> Result<Value, Stop> {
    Ok(Value::Plain(written(&at.instrument.status.next_event())))
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn all_events(at: &mut Context<'_>) -> Result<Value, Stop> {
    let events = at.instrument.status.all_events();
    let texts: Vec<String> = events.iter().map(written).collect();
    Ok(Value::Plain(texts.join(",")))
}
