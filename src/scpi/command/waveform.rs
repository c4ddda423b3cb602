//! Waveform preambles: `WFMPre`.
//!
//! Queries tell of the waveform that `DATa:SOUrce` names, commands of the one that `CURVe` will bring. With two bytes a
//! point the level of the converter is the high byte, so a step is 1/256 of a level; positive numbers begin at the lowest
//! level. Text is always signed. Sources: user manuals of the TDS1012 (p. 182, 187) and TDS2022 (p. 190), real replies.

use crate::instrument::Event;
use crate::instrument::transfer::{Points, Transfer};
use crate::instrument::word::Word as _;
use crate::scope::AcquireMode;
use crate::scope::waveform::LEVELS_PER_DIVISION;
use crate::scope::{Coupling, PointFormat, Preamble, Source, Waveform};
use crate::scpi::argument::{real, text, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::number::setting;
use crate::scpi::placeholder::Placeholder;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{
    Access, Both, Context, GroupQuery, Parts, Query, Setting, Stop, WordSetting,
};
use crate::scpi::value::ReplyValue;

/// What is said of fields of a waveform in the header.
const ABOVE: &str = "see above; set for reference memories only (event 2241 for others)";

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

/// The group.
pub const GROUP: Group = Group {
    title: "Waveform: preamble",
    rows: &[
        CommandRow::acts("WFMPre", &GroupQuery(Parts::Of(&FIELDS)), "all of the preamble"),
        CommandRow::acts(
            "WFMPre:BYT_Nr",
            &Both(super::data::set_width, |at| {
                Ok(ReplyValue::Integer(i64::from(at.instrument.transfer.width)))
            }),
            "bytes a point",
        ),
        CommandRow::acts(
            "WFMPre:BIT_Nr",
            &Both(set_bits, |at| {
                Ok(ReplyValue::Integer(8 * i64::from(at.instrument.transfer.width)))
            }),
            "bits a point",
        ),
        CommandRow::acts(
            "WFMPre:ENCdg",
            &WordSetting(|i, _| &mut i.transfer.format),
            "`ASC` or `BIN`",
        ),
        CommandRow::acts(
            "WFMPre:BN_Fmt",
            &WordSetting(|i, _| &mut i.transfer.numbers),
            "`RI` signed, `RP` positive",
        ),
        CommandRow::acts(
            "WFMPre:BYT_Or",
            &WordSetting(|i, _| &mut i.transfer.byte_order),
            "`MSB` or `LSB` first",
        ),
        CommandRow::acts("WFMPre:NR_Pt", &Field(nr_pt, set_nr_pt), "points"),
        CommandRow::acts(
            "WFMPre:WFId",
            &Query(|at| {
                let source = at.instrument.transfer.source;
                wfid(at, source)
            }),
            "what the waveform is, in words",
        ),
        CommandRow::acts(
            "WFMPre:PT_Fmt",
            &Field(pt_fmt, |at, a| {
                at.instrument.incoming.pt_fmt = word::<Points>(a)?;
                Ok(())
            }),
            "`Y` samples, `ENV` lowest and highest in turn",
        ),
        CommandRow::acts(
            "WFMPre:XINcr",
            &Field(x_incr, |at, a| {
                at.instrument.incoming.x_incr = real(a)?;
                Ok(())
            }),
            "from one point to the next",
        ),
        CommandRow::acts(
            "WFMPre:PT_Off",
            &Field(
                |_, _| ReplyValue::Integer(0),
                |_, a| {
                    real(a)?;
                    Ok(())
                },
            ),
            "always 0",
        ),
        CommandRow::acts(
            "WFMPre:XZEro",
            &Field(x_zero, |at, a| {
                at.instrument.incoming.x_zero = real(a)?;
                Ok(())
            }),
            "abscissa of the first point",
        ),
        CommandRow::accepted(
            "WFMPre:XUNit",
            &Field(x_unit, |_, a| {
                text(a)?;
                Ok(())
            }),
            "unit of the abscissa",
        ),
        CommandRow::accepted(
            "WFMPre:XMUlt",
            &Both(
                |at, a| {
                    at.instrument.incoming.x_mult = real(a)?;
                    Ok(())
                },
                |at| Ok(ReplyValue::Number(at.instrument.incoming.x_mult)),
            ),
            "one step of the abscissa in XY, which no waveform of this instrument has",
        )
        .apart(),
        CommandRow::acts(
            "WFMPre:YMUlt",
            &Field(y_mult, |at, a| {
                at.instrument.incoming.y_mult = real(a)?;
                Ok(())
            }),
            "one step of the ordinate",
        ),
        CommandRow::acts(
            "WFMPre:YZEro",
            &Field(y_zero, |at, a| {
                at.instrument.incoming.y_zero = real(a)?;
                Ok(())
            }),
            "added after scaling",
        ),
        CommandRow::acts(
            "WFMPre:YOFf",
            &Field(y_off, |at, a| {
                at.instrument.incoming.y_off = real(a)?;
                Ok(())
            }),
            "step at which the ordinate is `YZEro`",
        ),
        CommandRow::accepted(
            "WFMPre:YUNit",
            &Field(y_unit, |_, a| {
                text(a)?;
                Ok(())
            }),
            "unit of the ordinate",
        ),
        CommandRow::acts(
            "WFMPre:<wfm>",
            &GroupQuery(Parts::Below),
            "the preamble of a waveform that `DATa:SOUrce` need not name",
        ),
        CommandRow::acts(
            "WFMPre:<wfm>:WFId",
            &Query(|at| {
                let source = at.place.source;
                wfid(at, source)
            }),
            ABOVE,
        ),
        CommandRow::acts("WFMPre:<wfm>:NR_Pt", &Of(nr_pt, keep_nr_pt), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:PT_Fmt", &Of(pt_fmt, change_pt_fmt), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:XINcr", &Of(x_incr, change_x_incr), ABOVE),
        CommandRow::acts(
            "WFMPre:<wfm>:PT_Off",
            &Of(|_, _| ReplyValue::Integer(0), keep_pt_off),
            ABOVE,
        ),
        CommandRow::acts("WFMPre:<wfm>:XZEro", &Of(x_zero, change_x_zero), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:XUNit", &Of(x_unit, change_x_unit), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YMUlt", &Of(y_mult, change_y_mult), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YZEro", &Of(y_zero, change_y_zero), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YOFf", &Of(y_off, change_y_off), ABOVE),
        CommandRow::acts("WFMPre:<wfm>:YUNit", &Of(y_unit, change_y_unit), ABOVE),
    ],
};

/// One field of a waveform's preamble as it is sent.
type Tell = fn(&Waveform, &Transfer) -> ReplyValue;
type Take = fn(&mut Context<'_>, &[Argument]) -> Result<(), Stop>;

/// A field of the waveform that `DATa:SOUrce` names, and of the one to come.
struct Field(Tell, Take);

impl Setting for Field {
    fn access(&self) -> Access {
        Access { sets: true, asks: true }
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        (self.1)(at, arguments)
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        let transfer = at.instrument.transfer;
        Ok((self.0)(at.instrument.waveform(transfer.source)?.as_ref(), &transfer))
    }
}

/// Changes one field of a reference memory's preamble.
type Change = fn(&mut Waveform, &Transfer, &[Argument]) -> Result<(), Stop>;

/// A field of the waveform in the header. Those of reference memories can be set.
struct Of(Tell, Change);

impl Setting for Of {
    fn access(&self) -> Access {
        Access { sets: true, asks: true }
    }

    fn set(&self, at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
        let Source::Reference(letter) = at.place.source else {
            return Err(Event::NotAReference.into());
        };
        let transfer = at.instrument.transfer;
        let mut changed = at.instrument.reference(letter).ok_or(Event::NotActive)?.clone();
        (self.1)(&mut changed, &transfer, arguments)?;
        let interval = changed.preamble.x_incr;
        changed.horizontal_scale = interval / at.instrument.model.interval(1.0);
        changed.trigger_point =
            if interval > 0.0 { -changed.preamble.x_zero / interval } else { 0.0 };
        changed.vertical.scale = changed.preamble.y_mult * LEVELS_PER_DIVISION;
        changed.vertical.position = changed.preamble.y_off / LEVELS_PER_DIVISION;
        Ok(at.instrument.put_reference(changed, letter)?)
    }

    fn get(&self, at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
        let Placeholder { source, .. } = at.place;
        let transfer = at.instrument.transfer;
        Ok((self.0)(at.instrument.waveform(source)?.as_ref(), &transfer))
    }
}

fn keep_nr_pt(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    // A memory holds as many points as it was given.
    let last = u32::try_from(waveform.codes.len()).unwrap_or(u32::MAX);
    whole(a, 1, last.max(1))?;
    Ok(())
}

fn keep_pt_off(_: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    real(a)?;
    Ok(())
}

fn change_pt_fmt(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.pt_fmt = word::<Points>(a)?.into();
    Ok(())
}

fn change_x_incr(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.x_incr = real(a)?;
    Ok(())
}

fn change_x_zero(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.x_zero = real(a)?;
    Ok(())
}

fn change_x_unit(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    text(a)?.clone_into(&mut waveform.preamble.x_unit);
    Ok(())
}

fn change_y_mult(waveform: &mut Waveform, by: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.y_mult = real(a)? * by.steps();
    Ok(())
}

fn change_y_zero(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.y_zero = real(a)?;
    Ok(())
}

fn change_y_off(waveform: &mut Waveform, by: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    waveform.preamble.y_off = real(a)? / by.steps() - by.shift();
    Ok(())
}

fn change_y_unit(waveform: &mut Waveform, _: &Transfer, a: &[Argument]) -> Result<(), Stop> {
    let unit = text(a)?;
    let unit = if unit.eq_ignore_ascii_case("volts") { "V" } else { unit };
    unit.clone_into(&mut waveform.preamble.y_unit);
    Ok(())
}

fn set_bits(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.transfer.width = if whole(arguments, 8, 16)? > 8 { 2 } else { 1 };
    Ok(())
}

fn nr_pt(waveform: &Waveform, transfer: &Transfer) -> ReplyValue {
    ReplyValue::Plain(transfer.range(waveform.codes.len()).len().to_string())
}

fn set_nr_pt(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let last = u32::try_from(at.instrument.model.record_length).unwrap_or(u32::MAX);
    at.instrument.incoming.nr_pt = usize::try_from(whole(arguments, 1, last)?).unwrap_or(1);
    Ok(())
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

/// The waveform in words: `Ch1, DC coupling, 5.0E-1 V/div, 5.0E-2 s/div, 2500 points, Sample mode`.
fn wfid(at: &mut Context<'_>, source: Source) -> Result<ReplyValue, Stop> {
    let waveform = at.instrument.waveform(source)?;
    let coupling = match waveform.vertical.coupling {
        Some(Coupling::Ac) => "AC coupling, ",
        Some(Coupling::Ground) => "GND coupling, ",
        _ => "DC coupling, ",
    };
    let mode = match (waveform.preamble.pt_fmt, at.instrument.panel.acquire.mode) {
        (PointFormat::Envelope, _) => "Peak Detect",
        (PointFormat::Sample, AcquireMode::Average) => "Average",
        (PointFormat::Sample, _) => "Sample",
    };
    let (name, coupling) = match source {
        Source::Channel(number) => (format!("Ch{number}"), coupling),
        Source::Math => ("Math".to_owned(), ""),
        Source::Reference(letter) => (format!("Ref{letter}"), coupling),
    };
    let across = if waveform.preamble.x_unit == "Hz" { "Hz/div" } else { "s/div" };
    Ok(ReplyValue::Text(format!(
        "{name}, {coupling}{} {}/div, {} {across}, {} points, {mode} mode",
        setting(waveform.vertical.scale),
        waveform.preamble.y_unit,
        setting(waveform.horizontal_scale),
        waveform.codes.len(),
    )))
}
