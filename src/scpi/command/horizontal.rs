//! Horizontal: `HORizontal`.

use crate::instrument::limits;
use crate::scpi::argument::real;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Setting, Stop, both, group, number, query, word};
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Horizontal",
    rows: &[
        CommandRow::acts("HORizontal", group(Parts::Below), "all settings of the time base"),
        CommandRow::acts("HORizontal:VIEw", word!(|at| at.instrument.panel.horizontal.view), "`MAIn`, `WINDOW` (records are those of the window) or `ZONE`"),
        CommandRow::acts("HORizontal:RECOrdlength", query(record_length), "points in a record"),
        CommandRow::acts("HORizontal:MAIn", group(Parts::Below), "the main time base"),
        CommandRow::acts("HORizontal:MAIn:SCAle", SCALE, "s/div, the nearest step of 1-2.5-5"),
        CommandRow::acts("HORizontal:MAIn:POSition", POSITION, "the screen's centre after the trigger, in seconds"),
        CommandRow::alias("HORizontal:MAIn:SECdiv", "HORizontal:MAIn:SCAle"),
        CommandRow::acts("HORizontal:DELay", group(Parts::Below), "the window's time base"),
        CommandRow::acts(
            "HORizontal:DELay:SCAle",
            number!(|at| at.instrument.panel.horizontal.delay_scale, |i, _, scale| {
                limits::time_base(&i.model, scale).min(i.panel.horizontal.scale)
            }),
            "s/div of the window",
        ),
        CommandRow::acts(
            "HORizontal:DELay:POSition",
            number!(|at| at.instrument.panel.horizontal.delay_position, |i, _, position| {
                limits::horizontal_position(&i.model, position, i.panel.horizontal.delay_scale)
            }),
            "the window's centre after the trigger, in seconds",
        ),
        CommandRow::alias("HORizontal:DELay:SECdiv", "HORizontal:DELay:SCAle"),
        CommandRow::acts("HORizontal:SCAle", SCALE, "the main time base").apart(),
        CommandRow::alias("HORizontal:SECdiv", "HORizontal:SCAle"),
        CommandRow::acts("HORizontal:POSition", POSITION, "the main position").apart(),
    ],
};

const SCALE: Setting = both(set_scale, scale);
const POSITION: Setting =
    number!(|at| at.instrument.panel.horizontal.position, |i, _, position| {
        limits::horizontal_position(&i.model, position, i.panel.horizontal.scale)
    });

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

fn scale(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Number(at.instrument.panel.horizontal.scale))
}

fn record_length(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let points = at.instrument.model.record_length;
    Ok(ReplyValue::Plain(points.to_string()))
}
