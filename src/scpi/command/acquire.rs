//! Acquisition: `ACQuire`.

use crate::instrument::word::words;
use crate::scpi::argument::{real, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, query, word};
use crate::scpi::value::ReplyValue;

words! {
    /// Runs or stops, as the RUN/STOP key.
    RunStop {
        /// Start.
        On = "ON",
        /// Stop.
        Off = "OFF",
        /// Start.
        Run = "RUN",
        /// Stop.
        Stop = "STOP",
    }
}

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Acquisition",
    rows: &[
        CommandRow::acts("ACQuire", group(Parts::Below), "all settings of the acquisition"),
        CommandRow::acts("ACQuire:STOPAfter", word!(|at| at.instrument.panel.acquire.stop_after), "`RUNSTop` or `SEQuence`"),
        CommandRow::acts("ACQuire:STATE", both(set_state, state), "`ON`, `OFF`, `RUN`, `STOP` or a number"),
        CommandRow::acts("ACQuire:MODe", word!(|at| at.instrument.panel.acquire.mode), "`SAMple`, `PEAKdetect` or `AVErage`"),
        CommandRow::acts("ACQuire:NUMAVg", both(set_averages, averages), "4, 16, 64 or 128 records"),
        CommandRow::acts("ACQuire:NUMACq", query(count), "records taken since the start, 0 in scan mode").apart(),
    ],
};

fn set_state(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let run = match real(arguments) {
        Ok(value) => value.round().abs() > 0.0,
        Err(_) => matches!(word(arguments)?, RunStop::On | RunStop::Run),
    };
    if run {
        at.instrument.run();
    } else {
        at.instrument.stop();
    }
    Ok(())
}

fn state(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::flag(at.instrument.is_running()))
}

fn set_averages(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let asked = whole(arguments, 1, 1000)?;
    let averages = &at.instrument.model.limits.averages;
    let nearest = averages.iter().min_by_key(|number| number.abs_diff(asked));
    at.instrument.panel.acquire.averages = nearest.copied().unwrap_or(asked);
    Ok(())
}

fn averages(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::integer(at.instrument.panel.acquire.averages))
}

fn count(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::integer(at.instrument.acquisitions()))
}
