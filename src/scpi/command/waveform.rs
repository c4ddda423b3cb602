//! Waveform preambles: `WFMPre`.
//!
//! Queries tell of the waveform that `DATa:SOUrce` names, commands of the one that `CURVe` will
//! bring. With two bytes a point the level of the converter is the high byte, so a step is 1/256 of
//! a level; positive numbers begin at the lowest level. Text is always signed. Sources: user
//! manuals of the TDS1012 (p. 182, 187) and TDS2022 (p. 190), real replies.

use crate::instrument::Event;
use crate::instrument::transfer::{Points, Transfer};
use crate::instrument::word::Word as _;
use crate::scope::AcquireMode;
use crate::scope::set_up::waveform_id;
use crate::scope::waveform::LEVELS_PER_DIVISION;
use crate::scope::{Coupling, PointFormat, Preamble, Source, Waveform};
use crate::scpi::argument::{real, text, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, place, query, word};
use crate::scpi::value::ReplyValue;
use crate::scpi::value::setting;

/// What is said of fields of a waveform in the header.
const ABOVE: &str = "see above; set for reference memories only (event 2241 for others)";

/// A field of the waveform that `DATa:SOUrce` names, and of the one to come.
macro_rules! outgoing {
    ($field:ident, |$at:pat_param, $a:ident| $take:expr) => {
        both(
            |at, $a| {
                let $at = at;
                $take;
                Ok(())
            },
            |at| told(at, at.instrument.transfer.source, $field),
        )
    };
}

/// A field of the waveform in the header. Those of reference memories can be set; a memory holds as
/// many points as it was given.
macro_rules! of_reference {
    ($field:ident, |$w:pat_param, $by:pat_param, $a:ident| $change:expr) => {
        both(
            |at, $a| {
                change_reference(at, &|$w, $by| {
                    $change;
                    Ok(())
                })
            },
            |at| told(at, at.place.source, $field),
        )
    };
}

/// The fields in the order of a reply.
const FIELDS: [&str; 16] = [
    "WFMPre:BYT_Nr",
    "WFMPre:BIT_Nr",
    "WFMPre:ENCdg",
    "WFMPre:BN_Fmt",
    "WFMPre:BYT_Or",
    "WFMPre:NR_Pt",
    "WFMPre:WFId",
    "WFMPre:PT_Fmt",
    "WFMPre:XINcr",
    "WFMPre:PT_Off",
    "WFMPre:XZEro",
    "WFMPre:XUNit",
    "WFMPre:YMUlt",
    "WFMPre:YZEro",
    "WFMPre:YOFf",
    "WFMPre:YUNit",
];

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Waveform: preamble",
    rows: &[
        CommandRow::acts("WFMPre", group(Parts::Of(&FIELDS)), "all of the preamble"),
        CommandRow::acts("WFMPre:BYT_Nr", super::data::WIDTH, "bytes a point"),
        CommandRow::acts(
            "WFMPre:BIT_Nr",
            both(set_bits, |at| {
                Ok(ReplyValue::Integer(8 * i64::from(at.instrument.transfer.width)))
            }),
            "bits a point",
        ),
        CommandRow::acts("WFMPre:ENCdg", word!(|at| at.instrument.transfer.format), "`ASC` or `BIN`"),
        CommandRow::acts("WFMPre:BN_Fmt", word!(|at| at.instrument.transfer.numbers), "`RI` signed, `RP` positive"),
        CommandRow::acts("WFMPre:BYT_Or", word!(|at| at.instrument.transfer.byte_order), "`MSB` or `LSB` first"),
        CommandRow::acts("WFMPre:NR_Pt", outgoing!(nr_pt, |at, a| at.instrument.incoming.nr_pt = super::data::point(at, a)?), "points"),
        CommandRow::acts(
            "WFMPre:WFId",
            query(|at| {
                let source = at.instrument.transfer.source;
                wfid(at, source)
            }),
            "what the waveform is, in words",
        ),
        CommandRow::acts(
            "WFMPre:PT_Fmt",
            outgoing!(pt_fmt, |at, a| at.instrument.incoming.pt_fmt = word::<Points>(a)?),
            "`Y` samples, `ENV` lowest and highest in turn",
        ),
        CommandRow::acts("WFMPre:XINcr", outgoing!(x_incr, |at, a| at.instrument.incoming.x_incr = real(a)?), "from one point to the next"),
        CommandRow::acts("WFMPre:PT_Off", outgoing!(pt_off, |_, a| real(a)?), "always 0"),
        CommandRow::acts("WFMPre:XZEro", outgoing!(x_zero, |at, a| at.instrument.incoming.x_zero = real(a)?), "abscissa of the first point"),
        CommandRow::accepted("WFMPre:XUNit", outgoing!(x_unit, |_, a| text(a)?), "unit of the abscissa"),
        CommandRow::accepted(
            "WFMPre:XMUlt",
            place!(|at| at.instrument.incoming.x_mult, real, ReplyValue::Number),
            "one step of the abscissa in XY, which no waveform of this instrument has",
        )
        .apart(),
        CommandRow::acts("WFMPre:YMUlt", outgoing!(y_mult, |at, a| at.instrument.incoming.y_mult = real(a)?), "one step of the ordinate"),
        CommandRow::acts("WFMPre:YZEro", outgoing!(y_zero, |at, a| at.instrument.incoming.y_zero = real(a)?), "added after scaling"),
        CommandRow::acts("WFMPre:YOFf", outgoing!(y_off, |at, a| at.instrument.incoming.y_off = real(a)?), "step at which the ordinate is `YZEro`"),
        CommandRow::accepted("WFMPre:YUNit", outgoing!(y_unit, |_, a| text(a)?), "unit of the ordinate"),
        CommandRow::acts("WFMPre:<wfm>", group(Parts::Below), "the preamble of a waveform that `DATa:SOUrce` need not name"),
        CommandRow::acts(
            "WFMPre:<wfm>:WFId",
            query(|at| {
                let source = at.place.source;
                wfid(at, source)
            }),
            ABOVE,
        ),
        CommandRow::acts("WFMPre:<wfm>:NR_Pt", of_reference!(nr_pt, |w, _, a| whole(a, 1, u32::try_from(w.codes.len()).unwrap_or(u32::MAX).max(1))?), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:PT_Fmt", of_reference!(pt_fmt, |w, _, a| w.preamble.pt_fmt = word::<Points>(a)?.into()), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:XINcr", of_reference!(x_incr, |w, _, a| w.preamble.x_incr = real(a)?), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:PT_Off", of_reference!(pt_off, |_, _, a| real(a)?), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:XZEro", of_reference!(x_zero, |w, _, a| w.preamble.x_zero = real(a)?), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:XUNit", of_reference!(x_unit, |w, _, a| text(a)?.clone_into(&mut w.preamble.x_unit)), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YMUlt", of_reference!(y_mult, |w, by, a| w.preamble.y_mult = real(a)? * by.steps()), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YZEro", of_reference!(y_zero, |w, _, a| w.preamble.y_zero = real(a)?), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YOFf", of_reference!(y_off, |w, by, a| w.preamble.y_off = real(a)? / by.steps() - by.shift()), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YUNit", of_reference!(y_unit, |w, _, a| si_unit(text(a)?).clone_into(&mut w.preamble.y_unit)), ABOVE),
    ],
};

/// Changes a reference memory's preamble; its scales follow.
fn change_reference(
    at: &mut Context<'_>,
    change: &dyn Fn(&mut Waveform, &Transfer) -> Result<(), Event>,
) -> Result<(), Stop> {
    let Source::Reference(letter) = at.place.source else {
        return Err(Event::NotAReference.into());
    };
    let mut changed = at.instrument.reference(letter).ok_or(Event::NotActive)?.clone();
    change(&mut changed, &at.instrument.transfer)?;
    let interval = changed.preamble.x_incr;
    changed.horizontal_scale = interval / at.instrument.model.interval(1.0);
    changed.trigger_point = if interval > 0.0 { -changed.preamble.x_zero / interval } else { 0.0 };
    changed.vertical.scale = changed.preamble.y_mult * LEVELS_PER_DIVISION;
    changed.vertical.position = changed.preamble.y_off / LEVELS_PER_DIVISION;
    Ok(at.instrument.put_reference(changed, letter)?)
}

/// What a field's function tells of a waveform as it is sent.
fn told(
    at: &mut Context<'_>,
    source: Source,
    field: fn(&Waveform, &Transfer) -> ReplyValue,
) -> Result<ReplyValue, Stop> {
    let transfer = at.instrument.transfer;
    Ok(field(at.instrument.waveform(source)?.as_ref(), &transfer))
}

/// Instruments write `Volts`.
fn si_unit(unit: &str) -> &str {
    if unit.eq_ignore_ascii_case("volts") { "V" } else { unit }
}

fn set_bits(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.transfer.width = if whole(arguments, 8, 16)? > 8 { 2 } else { 1 };
    Ok(())
}

fn nr_pt(waveform: &Waveform, transfer: &Transfer) -> ReplyValue {
    ReplyValue::Plain(transfer.range(waveform.codes.len()).len().to_string())
}

fn pt_off(_: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Integer(0)
}

fn pt_fmt(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Word(match waveform.preamble.pt_fmt {
        PointFormat::Sample => Points::Samples.word(),
        PointFormat::Envelope => Points::Envelope.word(),
    })
}

fn x_incr(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Number(waveform.preamble.x_incr)
}

fn x_zero(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Number(waveform.preamble.x_zero)
}

fn x_unit(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Text(waveform.preamble.x_unit.clone())
}

fn y_mult(waveform: &Waveform, transfer: &Transfer) -> ReplyValue {
    ReplyValue::Number(waveform.preamble.y_mult / transfer.steps())
}

fn y_zero(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Number(waveform.preamble.y_zero)
}

fn y_off(waveform: &Waveform, transfer: &Transfer) -> ReplyValue {
    let Preamble { y_off, .. } = waveform.preamble;
    ReplyValue::Number((y_off + transfer.shift()) * transfer.steps())
}

fn y_unit(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    let unit = &waveform.preamble.y_unit;
    ReplyValue::Text(if unit == "V" { "Volts".to_owned() } else { unit.clone() })
}

/// The waveform in words. A channel whose coupling is not known has DC coupling, a math trace has
/// none.
fn wfid(at: &mut Context<'_>, source: Source) -> Result<ReplyValue, Stop> {
    let mut waveform = at.instrument.waveform(source)?.into_owned();
    let coupling = waveform.vertical.coupling.unwrap_or(Coupling::Dc);
    waveform.vertical.coupling = (source != Source::Math).then_some(coupling);
    waveform.source = source;
    let averages = at.instrument.panel.acquire.mode == AcquireMode::Average;
    let mode = if averages { "Average" } else { "Sample" };
    Ok(ReplyValue::Text(waveform_id(&waveform, setting, mode)))
}
