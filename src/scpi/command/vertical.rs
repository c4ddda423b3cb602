//! Vertical: `CH<x>` and `SELect`.

use crate::instrument::{Event, limits};
use crate::scope::{Coupling, Source};
use crate::scpi::argument::{flag, real};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{
    Both, Context, GroupQuery, Number, OnOff, Parts, Stop, Switch, WordSetting,
};
use crate::scpi::value::ReplyValue;

/// The group.
pub const GROUP: Group = Group {
    title: "Vertical",
    rows: &[
        CommandRow::acts("CH<x>", &GroupQuery(Parts::Below), "all settings of a channel"),
        CommandRow::acts(
            "CH<x>:PRObe",
            &Both(set_probe, probe),
            "attenuation 1, 10, 100 or 1000; V/div at the input stays",
        ),
        CommandRow::acts(
            "CH<x>:SCAle",
            &Both(set_scale, scale),
            "V/div, the nearest step of 1-2-5, or to three digits if `BENCh:CH<x>:FINe` is on",
        ),
        CommandRow::alias("CH<x>:VOLts", "CH<x>:SCAle"),
        CommandRow::acts(
            "CH<x>:POSition",
            &Number(
                |i, at| &mut i.panel.channel_mut(at.number).vertical.position,
                |i, at, position| {
                    let vertical = i.panel.channel(at.number).vertical;
                    limits::vertical_position(&i.model, position, vertical.scale, vertical.probe)
                },
            ),
            "divisions above the centre, in steps of 1/25",
        ),
        CommandRow::acts(
            "CH<x>:COUPling",
            &WordSetting(|i, at| {
                i.panel.channel_mut(at.number).vertical.coupling.get_or_insert(Coupling::Dc)
            }),
            "`DC`, `AC` or `GND`",
        ),
        CommandRow::acts(
            "CH<x>:BANdwidth",
            &OnOff(|i, at| {
                i.panel.channel_mut(at.number).vertical.bandwidth_limited.get_or_insert(false)
            }),
            "the 20 MHz limiter, `ON` or `OFF`",
        ),
        CommandRow::acts(
            "CH<x>:INVert",
            &OnOff(|i, at| i.panel.channel_mut(at.number).vertical.inverted.get_or_insert(false)),
            "`ON` turns the trace upside down",
        ),
        CommandRow::acts(
            "SELect",
            &GroupQuery(Parts::Of(&SELECT)),
            "which waveforms are displayed",
        ),
        CommandRow::acts("SELect:CH<x>", &SHOWN, "`ON` displays the channel"),
        CommandRow::acts(
            "SELect:MATH",
            &Switch(|i, _| i.panel.displayed_mut(Source::Math)),
            "`ON` displays the math trace",
        ),
        CommandRow::acts(
            "SELect:REF<x>",
            &Both(show_reference, |at| {
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

const SHOWN: Switch = Switch(|i, at| i.panel.displayed_mut(at.source));

fn show_reference(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let on = flag(arguments)?;
    let Source::Reference(letter) = at.place.source else {
        return Err(Event::NotAReference.into());
    };
    Ok(at.instrument.display_reference(letter, on)?)
}

fn set_probe(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let probe = limits::nearest(real(arguments)?, &at.instrument.model.probes);
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
