//! Measurements: `MEASUrement`.
//!
//! A measurement without result answers 9.9E37 and reports why: 2225 for a waveform that is not
//! displayed, 2202 for a record without a full cycle, 2231 for a measurement that measures nothing,
//! 221 in scan mode and in XY, where nothing is measured.

use crate::instrument::Event;
use crate::instrument::measure::{INVALID, measure, unit};
use crate::instrument::panel::{Measurement, MeasurementType};
use crate::instrument::word::Word as _;
use crate::scpi::argument::word;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, query, word};
use crate::scpi::value::ReplyValue;

/// Type and source of the five measurements on the screen.
const MEASUREMENTS: [&str; 5] = [
    "MEASUrement:MEAS1",
    "MEASUrement:MEAS2",
    "MEASUrement:MEAS3",
    "MEASUrement:MEAS4",
    "MEASUrement:MEAS5",
];

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Measurement",
    rows: &[
        CommandRow::acts("MEASUrement", group(Parts::Of(&MEASUREMENTS)), "the measurements on the screen"),
        CommandRow::acts("MEASUrement:IMMed", group(Parts::Below), "the measurement of the remote interface"),
        CommandRow::acts("MEASUrement:IMMed:TYPe", both(set_immediate, immediate), "what is measured"),
        CommandRow::acts("MEASUrement:IMMed:UNIts", query(|at| Ok(units(at.instrument.panel.immediate))), "unit of the result"),
        CommandRow::acts("MEASUrement:IMMed:SOUrce1", word!(|at| at.instrument.panel.immediate.source), "the waveform"),
        CommandRow::alias("MEASUrement:IMMed:SOU1", "MEASUrement:IMMed:SOUrce1"),
        CommandRow::acts(
            "MEASUrement:IMMed:VALue",
            query(|at| {
                let m = at.instrument.panel.immediate;
                Ok(value(at, m))
            }),
            "the result, 9.9E37 if there is none",
        )
        .apart(),
        CommandRow::acts("MEASUrement:MEAS<x>", group(Parts::Below), "one of the five on the screen"),
        CommandRow::acts("MEASUrement:MEAS<x>:TYPe", word!(|at| at.instrument.panel.measurement_mut(at.place.number).kind), "what is measured, or `NONe`"),
        CommandRow::acts("MEASUrement:MEAS<x>:UNIts", query(|at| Ok(units(slot(at)))), "unit of the result").apart(),
        CommandRow::acts("MEASUrement:MEAS<x>:SOUrce", word!(|at| at.instrument.panel.measurement_mut(at.place.number).source), "the waveform"),
        CommandRow::acts(
            "MEASUrement:MEAS<x>:VALue",
            query(|at| {
                let m = slot(at);
                Ok(value(at, m))
            }),
            "the result, 9.9E37 if there is none",
        )
        .apart(),
    ],
};

fn slot(at: &mut Context<'_>) -> Measurement {
    *at.instrument.panel.measurement_mut(at.place.number)
}

fn set_immediate(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let kind = word(arguments)?;
    if kind == MeasurementType::None {
        return Err(Event::IllegalParameter.into());
    }
    at.instrument.panel.immediate.kind = kind;
    Ok(())
}

fn immediate(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Word(at.instrument.panel.immediate.kind.word()))
}

fn units(measurement: Measurement) -> ReplyValue {
    ReplyValue::Text(unit(measurement.kind).to_owned())
}

fn value(at: &mut Context<'_>, measurement: Measurement) -> ReplyValue {
    let result = if measurement.kind == MeasurementType::None {
        Err(Event::NoMeasurementType)
    } else if at.instrument.measures_nothing() {
        Err(Event::SettingsConflict)
    } else {
        let record = at.instrument.waveform(measurement.source);
        record.map_err(|_| Event::NoWaveform).and_then(|record| measure(measurement.kind, &record))
    };
    match result {
        Ok(value) => ReplyValue::Measurement(value),
        Err(event) => {
            at.instrument.status.report(event);
            ReplyValue::Number(INVALID)
        }
    }
}
