//! Vertical: `CH<x>` and `SELect`.

use crate::instrument::{Event, limits};
use crate::scope::model::nearest;
use crate::scope::{Coupling, Source};
use crate::scpi::argument::{flag, real};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Setting, Stop, both, group, number, place, word};
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Vertical",
    rows: &[
        CommandRow::acts("CH<x>", group(Parts::Below), "all settings of a channel"),
        CommandRow::acts("CH<x>:PRObe", both(set_probe, probe), "attenuation 1, 10, 100 or 1000; V/div at the input stays"),
        CommandRow::acts("CH<x>:SCAle", both(set_scale, scale), "V/div, the nearest step of 1-2-5, or to three digits if `BENCh:CH<x>:FINe` is on"),
        CommandRow::alias("CH<x>:VOLts", "CH<x>:SCAle"),
        CommandRow::acts(
            "CH<x>:POSition",
            number!(
                |at| at.instrument.panel.channel_mut(at.place.number).vertical.position,
                |i, at, position| {
                    let vertical = i.panel.channel(at.number).vertical;
                    limits::vertical_position(&i.model, position, vertical.scale, vertical.probe)
                }
            ),
            "divisions above the centre, in steps of 1/25",
        ),
        CommandRow::acts(
            "CH<x>:COUPling",
            word!(|at| *at
                .instrument
                .panel
                .channel_mut(at.place.number)
                .vertical
                .coupling
                .get_or_insert(Coupling::Dc)),
            "`DC`, `AC` or `GND`",
        ),
        CommandRow::acts(
            "CH<x>:BANdwidth",
            place!(
                |at| *at
                    .instrument
                    .panel
                    .channel_mut(at.place.number)
                    .vertical
                    .bandwidth_limited
                    .get_or_insert(false),
                flag,
                ReplyValue::on_or_off
            ),
            "the 20 MHz limiter, `ON` or `OFF`",
        ),
        CommandRow::acts(
            "CH<x>:INVert",
            place!(
                |at| *at
                    .instrument
                    .panel
                    .channel_mut(at.place.number)
                    .vertical
                    .inverted
                    .get_or_insert(false),
                flag,
                ReplyValue::on_or_off
            ),
            "`ON` turns the trace upside down",
        ),
        CommandRow::acts("SELect", group(Parts::Of(&SELECT)), "which waveforms are displayed"),
        CommandRow::acts("SELect:CH<x>", SHOWN, "`ON` displays the channel"),
        CommandRow::acts("SELect:MATH", place!(|at| *at.instrument.panel.displayed_mut(Source::Math), flag, ReplyValue::flag), "`ON` displays the math trace"),
        CommandRow::acts(
            "SELect:REF<x>",
            both(show_reference, |at| {
                Ok(ReplyValue::flag(at.instrument.panel.displays(at.place.source)))
            }),
            "`ON` displays the reference memory (event 2244 where it is empty)",
        ),
    ],
};

/// The waveforms in the order of `SELect?`.
const SELECT: [&str; 9] = [
    "SELect:CH1",
    "SELect:CH2",
    "SELect:CH3",
    "SELect:CH4",
    "SELect:MATH",
    "SELect:REFA",
    "SELect:REFB",
    "SELect:REFC",
    "SELect:REFD",
];

const SHOWN: Setting =
    place!(|at| *at.instrument.panel.displayed_mut(at.place.source), flag, ReplyValue::flag);

fn show_reference(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let on = flag(arguments)?;
    let Source::Reference(letter) = at.place.source else {
        return Err(Event::NotAReference.into());
    };
    Ok(at.instrument.display_reference(letter, on)?)
}

fn set_probe(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let probe = nearest(real(arguments)?, &at.instrument.model.probes);
    let vertical = &mut at.instrument.panel.channel_mut(at.place.number).vertical;
    vertical.scale = limits::rounded(vertical.scale / vertical.probe * probe, 9);
    vertical.probe = probe;
    Ok(())
}

fn probe(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let probe = at.instrument.panel.channel(at.place.number).vertical.probe;
    Ok(ReplyValue::Plain(format!("{probe}")))
}

fn set_scale(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let asked = real(arguments)?;
    let model = &at.instrument.model;
    let channel = at.instrument.panel.channel_mut(at.place.number);
    limits::turn_scale(model, channel, asked);
    Ok(())
}

fn scale(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Number(at.instrument.panel.channel(at.place.number).vertical.scale))
}
