//! Cursors: `CURSor`.

use crate::instrument::limits::rounded;
use crate::instrument::measure::INVALID;
use crate::instrument::panel::BarUnits;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Context, GroupQuery, Number, Parts, Query, Stop, Words};
use crate::scpi::value::Value;

/// The group.
pub const GROUP: Group = Group {
    title: "Cursor",
    rows: &[
        Row::acts(
            "CURSor",
            &GroupQuery(Parts::Of(&[
                "CURSor:FUNCtion",
                "CURSor:SELect:SOUrce",
                "CURSor:VBArs",
                "CURSor:HBArs",
            ])),
            "all settings of the cursors",
        ),
        Row::acts(
            "CURSor:FUNCtion",
            &Words(|i, _| &mut i.panel.cursor.function),
            "`OFF`, `HBArs` or `VBArs`",
        ),
        Row::acts(
            "CURSor:SELect:SOUrce",
            &Words(|i, _| &mut i.panel.cursor.source),
            "the waveform",
        ),
        Row::alias("CURSor:SELect", "CURSor:SELect:SOUrce"),
        Row::acts(
            "CURSor:VBArs",
            &GroupQuery(Parts::Of(&[
                "CURSor:VBArs:UNIts",
                "CURSor:VBArs:DELTa",
                "CURSor:VBArs:POSITION1",
                "CURSor:VBArs:POSITION2",
            ])),
            "the vertical bars",
        ),
        Row::acts(
            "CURSor:VBArs:UNIts",
            &Words(|i, _| &mut i.panel.cursor.vertical_units),
            "`SECOnds` or `HERtz`",
        ),
        Row::acts("CURSor:VBArs:DELTa", &Query(vertical_delta), "their distance").apart(),
        Row::acts("CURSor:VBArs:POSITION<x>", &VERTICAL, "seconds after the trigger").apart(),
        Row::acts(
            "CURSor:HBArs",
            &GroupQuery(Parts::Of(&[
                "CURSor:HBArs:UNIts",
                "CURSor:HBArs:DELTa",
                "CURSor:HBArs:POSITION1",
                "CURSor:HBArs:POSITION2",
            ])),
            "the horizontal bars",
        ),
        Row::acts("CURSor:HBArs:UNIts", &Query(|_| Ok(Value::Word("VOLts"))), "always volts")
            .apart(),
        Row::acts("CURSor:HBArs:DELTa", &Query(horizontal_delta), "their distance").apart(),
        Row::acts("CURSor:HBArs:POSITION<x>", &HORIZONTAL, "volts").apart(),
    ],
};

const VERTICAL: Number = Number(
    |i, at| {
        let [first, second] = &mut i.panel.cursor.vertical;
        if at.number == 2 { second } else { first }
    },
    |i, _, time| {
        let (start, end) = i.setup().record_span();
        rounded(time.clamp(start.min(end), end), 7)
    },
);

const HORIZONTAL: Number = Number(
    |i, at| {
        let [first, second] = &mut i.panel.cursor.horizontal;
        if at.number == 2 { second } else { first }
    },
    |_, _, volts| rounded(volts, 7),
);

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn vertical_delta(at: &mut Context<'_>) -> Result<Value, Stop> {
    let cursor = &at.instrument.panel.cursor;
    let [first, second] = cursor.vertical;
    let distance = (second - first).abs();
    Ok(Value::Number(match cursor.vertical_units {
        BarUnits::Seconds => distance,
        BarUnits::Hertz if distance > 0.0 => 1.0 / distance,
        BarUnits::Hertz => INVALID,
    }))
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn horizontal_delta(at: &mut Context<'_>) -> Result<Value, Stop> {
    let [first, second] = at.instrument.panel.cursor.horizontal;
    Ok(Value::Number((second - first).abs()))
}
