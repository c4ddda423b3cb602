//! Cursors: `CURSor`.

use crate::instrument::Event;
use crate::instrument::limits::rounded;
use crate::instrument::measure::INVALID;
use crate::instrument::panel::{BarUnits, CursorFunction, DisplayFormat};
use crate::instrument::word::Word as _;
use crate::scpi::argument::word;
use crate::scpi::message::Argument;
use crate::scpi::placeholder::Placeholder;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Setting, Stop, both, group, number, query, word};
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Cursor",
    rows: &[
        CommandRow::acts(
            "CURSor",
            group(Parts::Of(&[
                "CURSor:FUNCtion",
                "CURSor:SELect:SOUrce",
                "CURSor:VBArs",
                "CURSor:HBArs",
            ])),
            "all settings of the cursors",
        ),
        CommandRow::acts(
            "CURSor:FUNCtion",
            both(set_function, |at| {
                Ok(ReplyValue::Word(at.instrument.panel.cursor.function.word()))
            }),
            "`OFF`, `HBArs` or `VBArs`; none in XY (event 221)",
        ),
        CommandRow::acts("CURSor:SELect:SOUrce", word!(|at| at.instrument.panel.cursor.source), "the waveform"),
        CommandRow::alias("CURSor:SELect", "CURSor:SELect:SOUrce"),
        CommandRow::acts(
            "CURSor:VBArs",
            group(Parts::Of(&[
                "CURSor:VBArs:UNIts",
                "CURSor:VBArs:DELTa",
                "CURSor:VBArs:POSITION1",
                "CURSor:VBArs:POSITION2",
            ])),
            "the vertical bars",
        ),
        CommandRow::acts("CURSor:VBArs:UNIts", word!(|at| at.instrument.panel.cursor.vertical_units), "`SECOnds` or `HERtz`"),
        CommandRow::acts("CURSor:VBArs:DELTa", query(vertical_delta), "their distance").apart(),
        CommandRow::acts("CURSor:VBArs:POSITION<x>", VERTICAL, "seconds after the trigger").apart(),
        CommandRow::acts(
            "CURSor:HBArs",
            group(Parts::Of(&[
                "CURSor:HBArs:UNIts",
                "CURSor:HBArs:DELTa",
                "CURSor:HBArs:POSITION1",
                "CURSor:HBArs:POSITION2",
            ])),
            "the horizontal bars",
        ),
        CommandRow::acts("CURSor:HBArs:UNIts", query(|_| Ok(ReplyValue::Word("VOLts"))), "always volts").apart(),
        CommandRow::acts("CURSor:HBArs:DELTa", query(horizontal_delta), "their distance").apart(),
        CommandRow::acts("CURSor:HBArs:POSITION<x>", HORIZONTAL, "volts").apart(),
    ],
};

fn set_function(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let function = word(arguments)?;
    let panel = &mut at.instrument.panel;
    if function != CursorFunction::Off && panel.display.format == DisplayFormat::Xy {
        return Err(Event::SettingsConflict.into());
    }
    panel.cursor.function = function;
    Ok(())
}

const VERTICAL: Setting =
    number!(|at| at.instrument.panel.cursor.vertical[bar(at.place)], |i, _, time| {
        let (start, end) = i.setup().record_span();
        rounded(time.clamp(start.min(end), end), 7)
    });

const HORIZONTAL: Setting = number!(
    |at| at.instrument.panel.cursor.horizontal[bar(at.place)],
    |_, _, volts| rounded(volts, 7)
);

/// Index of the bar in the header.
fn bar(place: Placeholder) -> usize {
    usize::from(place.number == 2)
}

fn vertical_delta(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let cursor = &at.instrument.panel.cursor;
    let [first, second] = cursor.vertical;
    let distance = (second - first).abs();
    Ok(ReplyValue::Number(match cursor.vertical_units {
        BarUnits::Seconds => distance,
        BarUnits::Hertz if distance > 0.0 => 1.0 / distance,
        BarUnits::Hertz => INVALID,
    }))
}

fn horizontal_delta(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let [first, second] = at.instrument.panel.cursor.horizontal;
    Ok(ReplyValue::Number((second - first).abs()))
}
