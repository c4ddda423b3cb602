//! Horizontal: `HORizontal`.

use crate::instrument::limits;
use crate::scpi::argument::real;
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Both, Context, GroupQuery, Number, Parts, Query, Stop, Words};
use crate::scpi::value::Value;

/// The group.
pub const GROUP: Group = Group {
    title: "Horizontal",
    rows: &[
        Row::acts("HORizontal", &GroupQuery(Parts::Below), "all settings of the time base"),
        Row::acts(
            "HORizontal:VIEw",
            &Words(|i, _| &mut i.panel.horizontal.view),
            "`MAIn`, `WINDOW` (records are those of the window) or `ZONE`",
        ),
        Row::acts("HORizontal:RECOrdlength", &Query(record_length), "points in a record"),
        Row::acts("HORizontal:MAIn", &GroupQuery(Parts::Below), "the main time base"),
        Row::acts("HORizontal:MAIn:SCAle", &SCALE, "s/div, the nearest step of 1-2.5-5"),
        Row::acts(
            "HORizontal:MAIn:POSition",
            &POSITION,
            "the screen's centre after the trigger, in seconds",
        ),
        Row::alias("HORizontal:MAIn:SECdiv", "HORizontal:MAIn:SCAle"),
        Row::acts("HORizontal:DELay", &GroupQuery(Parts::Below), "the window's time base"),
        Row::acts(
            "HORizontal:DELay:SCAle",
            &Number(
                |i, _| &mut i.panel.horizontal.delay_scale,
                |i, _, scale| limits::time_base(&i.model, scale).min(i.panel.horizontal.scale),
            ),
            "s/div of the window",
        ),
        Row::acts(
            "HORizontal:DELay:POSition",
            &Number(
                |i, _| &mut i.panel.horizontal.delay_position,
                |i, _, position| {
                    limits::horizontal_position(&i.model, position, i.panel.horizontal.delay_scale)
                },
            ),
            "the window's centre after the trigger, in seconds",
        ),
        Row::alias("HORizontal:DELay:SECdiv", "HORizontal:DELay:SCAle"),
        Row::acts("HORizontal:SCAle", &SCALE, "the main time base").apart(),
        Row::alias("HORizontal:SECdiv", "HORizontal:SCAle"),
        Row::acts("HORizontal:POSition", &POSITION, "the main position").apart(),
    ],
};

const SCALE: Both = Both(set_scale, scale);
const POSITION: Number = Number(
    |i, _| &mut i.panel.horizontal.position,
    |i, _, position| limits::horizontal_position(&i.model, position, i.panel.horizontal.scale),
);

fn set_scale(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let asked = real(arguments)?;
    let scale = limits::time_base(&at.instrument.model, asked);
    let model = &at.instrument.model;
    let horizontal = &mut at.instrument.panel.horizontal;
    horizontal.scale = scale;
    horizontal.position = limits::horizontal_position(model, horizontal.position, scale);
    horizontal.delay_scale = horizontal.delay_scale.min(scale);
    Ok(())
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn scale(at: &mut Context<'_>) -> Result<Value, Stop> {
    Ok(Value::Number(at.instrument.panel.horizontal.scale))
}

#[allow(clippy::unnecessary_wraps, reason = "the shape of every query in the table")]
fn record_length(at: &mut Context<'_>) -> Result<Value, Stop> {
    let points = at.instrument.model.record_length;
    Ok(Value::Plain(points.to_string()))
}
