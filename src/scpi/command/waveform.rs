//! Waveforms: how they travel (`DATa`), their preambles (`WFMPre`), their points (`CURVe`).
//!
//! Queries of the preamble are about the waveform that `DATa:SOUrce` names, commands about the one
//! that `CURVe` will bring. The highest bit of a level is that of the point: with two bytes a point
//! the level of an 8-bit converter is the high byte, so a step is 1/256 of a level; with one byte a
//! converter of more bits sends its upper 8. Positive numbers begin at the lowest level. Text is
//! always signed.
//! Sources: user manuals of the TDS1012 (p. 182, 187) and TDS2022 (p. 190), real replies.

use crate::instrument::Event;
use crate::instrument::transfer::{
    ByteOrder, CurveFormat, Encoding, NumberFormat, Points, Transfer,
};
use crate::scope::set_up::waveform_id;
use crate::scope::waveform::{FAMILY_BITS, levels_per_division};
use crate::scope::word::{Word as _, words};
use crate::scope::{AcquireMode, Coupling, PointFormat, Preamble, Source, VerticalSetup, Waveform};
use crate::scpi::message::Argument;
use crate::scpi::table::Setting::{Both, GroupAndCommand, Query};
use crate::scpi::table::{Context, Deferred, Group, Parts, Setting, Slot, acts, alias, stub};
use crate::scpi::value;
use crate::scpi::value::{ReplyValue, only, real, setting, text, whole, word};

words! {
    /// Argument of `DATa`.
    Initialise {
        /// Set everything as at power on.
        Everything = "INIT",
    }
}

/// What is said of fields of a waveform in the header.
const ABOVE: &str = "see above; set for reference memories only (event 2241 for others)";

const WIDTH: Setting = Setting::Slot(|c| Slot::Whole(&mut c.instrument.transfer.width, (1, 2)));

/// `DATa`.
#[rustfmt::skip]
pub const TRANSFER: Group = Group {
    title: "Waveform: how it travels",
    rows: &[
        acts("DATa", GroupAndCommand(Parts::Below, initialise), "`INIT` sets all of this as at power on"),
        acts("DATa:ENCdg", Both(set_encoding, |c| Ok(ReplyValue::Word(c.instrument.transfer.encoding().word()))), "`ASCIi` (`ASC` is taken, too), `RIBinary`, `RPBinary`, `SRIbinary` or `SRPbinary`"),
        acts("DATa:DESTination", Both(set_destination, |c| Ok(ReplyValue::Word(c.instrument.transfer.destination.word()))), "the reference memory that `CURVe` writes"),
        alias("DATa:TARget", "DATa:DESTination"),
        acts("DATa:SOUrce", Setting::Slot(|c| Slot::Word(&mut c.instrument.transfer.source)), "the waveform that `CURVe?` reads"),
        acts("DATa:STARt", Setting::Slot(|c| { let last = last_point(c); Slot::Whole(&mut c.instrument.transfer.start, (1, last)) }), "first point, counted from 1"),
        acts("DATa:STOP", Setting::Slot(|c| { let last = last_point(c); Slot::Whole(&mut c.instrument.transfer.stop, (1, last)) }), "last point"),
        acts("DATa:WIDth", WIDTH, "bytes a point, 1 or 2"),
    ],
};

/// Number of a record's last point, counted from 1.
fn last_point(context: &Context<'_>) -> u32 {
    u32::try_from(context.instrument.model.record_length).unwrap_or(u32::MAX)
}

fn initialise(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let Initialise::Everything = word(arguments)?;
    context.instrument.transfer = Transfer::initial(context.instrument.model.record_length);
    Ok(())
}

fn set_encoding(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    // `ASC` is what the preamble tells, and what scripts send: shorter than the manual's shortest
    // `ASCI`.
    let encoding = match only(arguments)? {
        Argument::Word(typed) if typed.eq_ignore_ascii_case("ASC") => Encoding::Ascii,
        _ => word::<Encoding>(arguments)?,
    };
    context.instrument.transfer.set_encoding(encoding);
    Ok(())
}

fn set_destination(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let destination: Source = word(arguments)?;
    if !destination.exists(context.instrument.model.channels) {
        return Err(Event::IllegalParameter.into());
    }
    if !matches!(destination, Source::Reference(_)) {
        return Err(Event::NotAReference.into());
    }
    context.instrument.transfer.destination = destination;
    Ok(())
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

/// `WFMPre`.
#[rustfmt::skip]
pub const PREAMBLE: Group = Group {
    title: "Waveform: preamble",
    rows: &[
        acts("WFMPre", Setting::Group(Parts::Of(&FIELDS)), "all of the preamble"),
        acts("WFMPre:BYT_Nr", WIDTH, "bytes a point"),
        acts("WFMPre:BIT_Nr", Both(set_bits, |c| Ok(ReplyValue::Plain((8 * c.instrument.transfer.width).to_string()))), "bits a point"),
        acts("WFMPre:ENCdg", Setting::Slot(|c| Slot::Word(&mut c.instrument.transfer.format)), "`ASC` or `BIN`"),
        acts("WFMPre:BN_Fmt", Setting::Slot(|c| Slot::Word(&mut c.instrument.transfer.numbers)), "`RI` signed, `RP` positive"),
        acts("WFMPre:BYT_Or", Setting::Slot(|c| Slot::Word(&mut c.instrument.transfer.byte_order)), "`MSB` or `LSB` first"),
        acts("WFMPre:NR_Pt", Both(set_points, |c| field(c, c.instrument.transfer.source, nr_pt)), "points"),
        acts("WFMPre:WFId", Query(|c| { let source = c.instrument.transfer.source; wfid(c, source) }), "what the waveform is, in words"),
        acts("WFMPre:PT_Fmt", Both(set_point_format, |c| field(c, c.instrument.transfer.source, pt_fmt)), "`Y` samples, `ENV` lowest and highest in turn"),
        acts("WFMPre:XINcr", Both(|c, a| store(&mut c.instrument.incoming.x_incr, a), |c| field(c, c.instrument.transfer.source, x_incr)), "from one point to the next"),
        acts("WFMPre:PT_Off", Both(|_, a| Ok(real(a).map(|_| ())?), |c| field(c, c.instrument.transfer.source, pt_off)), "always 0"),
        acts("WFMPre:XZEro", Both(|c, a| store(&mut c.instrument.incoming.x_zero, a), |c| field(c, c.instrument.transfer.source, x_zero)), "abscissa of the first point"),
        stub("WFMPre:XUNit", Both(|_, a| Ok(text(a).map(|_| ())?), |c| field(c, c.instrument.transfer.source, x_unit)), "unit of the abscissa"),
        stub("WFMPre:XMUlt", Setting::Slot(|c| Slot::Real(&mut c.instrument.incoming.x_mult)), "one step of the abscissa in XY, which no waveform of this instrument has").apart(),
        acts("WFMPre:YMUlt", Both(|c, a| store(&mut c.instrument.incoming.y_mult, a), |c| field(c, c.instrument.transfer.source, y_mult)), "one step of the ordinate"),
        acts("WFMPre:YZEro", Both(|c, a| store(&mut c.instrument.incoming.y_zero, a), |c| field(c, c.instrument.transfer.source, y_zero)), "added after scaling"),
        acts("WFMPre:YOFf", Both(|c, a| store(&mut c.instrument.incoming.y_off, a), |c| field(c, c.instrument.transfer.source, y_off)), "step at which the ordinate is `YZEro`"),
        stub("WFMPre:YUNit", Both(|_, a| Ok(text(a).map(|_| ())?), |c| field(c, c.instrument.transfer.source, y_unit)), "unit of the ordinate"),
        acts("WFMPre:<wfm>", Setting::Group(Parts::Below), "the preamble of a waveform that `DATa:SOUrce` need not name"),
        acts("WFMPre:<wfm>:WFId", Query(|c| { let source = c.suffix.source; wfid(c, source) }), ABOVE),
        acts("WFMPre:<wfm>:NR_Pt", Both(|c, a| change_reference(c, &|w, _| { whole(a, 1, u32::try_from(w.codes.len()).unwrap_or(u32::MAX).max(1))?; Ok(()) }), |c| field(c, c.suffix.source, nr_pt)), ABOVE),
        acts("WFMPre:<wfm>:PT_Fmt", Both(|c, a| change_reference(c, &|w, _| { w.preamble.pt_fmt = word::<Points>(a)?.into(); Ok(()) }), |c| field(c, c.suffix.source, pt_fmt)), ABOVE),
        acts("WFMPre:<wfm>:XINcr", Both(|c, a| change_reference(c, &|w, _| { w.preamble.x_incr = real(a)?; Ok(()) }), |c| field(c, c.suffix.source, x_incr)), ABOVE),
        acts("WFMPre:<wfm>:PT_Off", Both(|c, a| change_reference(c, &|_, _| { real(a)?; Ok(()) }), |c| field(c, c.suffix.source, pt_off)), ABOVE),
        acts("WFMPre:<wfm>:XZEro", Both(|c, a| change_reference(c, &|w, _| { w.preamble.x_zero = real(a)?; Ok(()) }), |c| field(c, c.suffix.source, x_zero)), ABOVE),
        acts("WFMPre:<wfm>:XUNit", Both(|c, a| change_reference(c, &|w, _| { text(a)?.clone_into(&mut w.preamble.x_unit); Ok(()) }), |c| field(c, c.suffix.source, x_unit)), ABOVE),
        acts("WFMPre:<wfm>:YMUlt", Both(|c, a| change_reference(c, &|w, t| { w.preamble.y_mult = real(a)? * t.steps(bits(w)); Ok(()) }), |c| field(c, c.suffix.source, y_mult)), ABOVE),
        acts("WFMPre:<wfm>:YZEro", Both(|c, a| change_reference(c, &|w, _| { w.preamble.y_zero = real(a)?; Ok(()) }), |c| field(c, c.suffix.source, y_zero)), ABOVE),
        acts("WFMPre:<wfm>:YOFf", Both(|c, a| change_reference(c, &|w, t| { w.preamble.y_off = (real(a)? - t.offset()) / t.steps(bits(w)); Ok(()) }), |c| field(c, c.suffix.source, y_off)), ABOVE),
        acts("WFMPre:<wfm>:YUNit", Both(|c, a| change_reference(c, &|w, _| { si_unit(text(a)?).clone_into(&mut w.preamble.y_unit); Ok(()) }), |c| field(c, c.suffix.source, y_unit)), ABOVE),
    ],
};

fn store(slot: &mut f64, arguments: &[Argument]) -> Result<(), Deferred> {
    *slot = real(arguments)?;
    Ok(())
}

fn set_points(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let points = whole(arguments, 1, last_point(context))?;
    context.instrument.incoming.nr_pt = usize::try_from(points).unwrap_or(1);
    Ok(())
}

fn set_point_format(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    context.instrument.incoming.pt_fmt = word::<Points>(arguments)?;
    Ok(())
}

/// Changes a reference memory's preamble; its scales follow.
fn change_reference(
    context: &mut Context<'_>,
    change: &dyn Fn(&mut Waveform, &Transfer) -> Result<(), Event>,
) -> Result<(), Deferred> {
    let Source::Reference(letter) = context.suffix.source else {
        return Err(Event::NotAReference.into());
    };
    let mut changed = context.instrument.reference(letter).ok_or(Event::NotActive)?.clone();
    let levels = levels_per_division(bits(&changed));
    change(&mut changed, &context.instrument.transfer)?;
    let interval = changed.preamble.x_incr;
    changed.horizontal_scale = interval / context.instrument.model.interval(1.0);
    changed.trigger_point = if interval > 0.0 { -changed.preamble.x_zero / interval } else { 0.0 };
    changed.vertical.scale = changed.preamble.y_mult * levels;
    changed.vertical.position = changed.preamble.y_off / levels;
    Ok(context.instrument.put_reference(changed, letter)?)
}

/// A field of a waveform's preamble, as the waveform would be sent.
fn field(
    context: &Context<'_>,
    source: Source,
    field: fn(&Waveform, &Transfer) -> ReplyValue,
) -> Result<ReplyValue, Deferred> {
    let waveform = context.instrument.waveform(source)?;
    Ok(field(&waveform, &context.instrument.transfer))
}

/// Instruments write `Volts`.
fn si_unit(unit: &str) -> &str {
    if unit.eq_ignore_ascii_case("volts") { "V" } else { unit }
}

fn set_bits(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    context.instrument.transfer.width = if whole(arguments, 8, 16)? > 8 { 2 } else { 1 };
    Ok(())
}

/// Bits of the converter that a waveform's levels are of.
fn bits(waveform: &Waveform) -> u8 {
    waveform.bits().unwrap_or(FAMILY_BITS)
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
    ReplyValue::Number(waveform.preamble.y_mult / transfer.steps(bits(waveform)))
}

fn y_zero(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    ReplyValue::Number(waveform.preamble.y_zero)
}

fn y_off(waveform: &Waveform, transfer: &Transfer) -> ReplyValue {
    let Preamble { y_off, .. } = waveform.preamble;
    ReplyValue::Number(y_off * transfer.steps(bits(waveform)) + transfer.offset())
}

fn y_unit(waveform: &Waveform, _: &Transfer) -> ReplyValue {
    let unit = &waveform.preamble.y_unit;
    ReplyValue::Text(if unit == "V" { "Volts".to_owned() } else { unit.clone() })
}

/// The waveform in words. A channel whose coupling is not known has DC coupling, a math trace has
/// none.
fn wfid(context: &mut Context<'_>, source: Source) -> Result<ReplyValue, Deferred> {
    let mut waveform = context.instrument.waveform(source)?.into_owned();
    let coupling = waveform.vertical.coupling.unwrap_or(Coupling::Dc);
    waveform.vertical.coupling = (source != Source::Math).then_some(coupling);
    waveform.source = source;
    let averages = context.instrument.panel.acquire.mode == AcquireMode::Average;
    let mode = if averages { "Average" } else { "Sample" };
    Ok(ReplyValue::Text(waveform_id(&waveform, setting, mode)))
}

/// `CURVe` and `WAVFrm?`.
#[rustfmt::skip]
pub const POINTS: Group = Group {
    title: "Waveform: points",
    rows: &[
        acts("CURVe", Both(receive, send), "points, as `DATa` says; of a waveform that is not displayed none, and events 2244 and 420"),
        acts("WAVFrm", Setting::Group(Parts::Of(&["WFMPre", "CURVe"])), "preamble and points"),
    ],
};

fn send(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let transfer = context.instrument.transfer;
    let waveform = context.instrument.waveform(transfer.source)?;
    let range = transfer.range(waveform.codes.len());
    let codes = waveform.codes.get(range).unwrap_or_default();
    let steps = transfer.steps(bits(&waveform));
    // A point's lowest 16 bits; a level of more bits than the point loses its lowest ones.
    let point = |code: &i16| ((f64::from(*code) * steps).floor() + transfer.offset()) as i32 as i16;
    if transfer.format == CurveFormat::Ascii {
        let points: Vec<String> = codes.iter().map(|code| point(code).to_string()).collect();
        return Ok(ReplyValue::Plain(points.join(",")));
    }
    let mut bytes = Vec::with_capacity(2 * codes.len());
    for code in codes {
        let [high, low] = point(code).to_be_bytes();
        match (transfer.width, transfer.byte_order) {
            (2, ByteOrder::HighFirst) => bytes.extend([high, low]),
            (2, ByteOrder::LowFirst) => bytes.extend([low, high]),
            _ => bytes.push(low),
        }
    }
    Ok(ReplyValue::block(&bytes))
}

fn receive(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let transfer = context.instrument.transfer;
    let incoming = context.instrument.incoming;
    let Source::Reference(letter) = transfer.destination else {
        return Err(Event::NotAReference.into());
    };
    let (mut codes, offset) = match arguments {
        [] => return Err(Event::MissingParameter.into()),
        [Argument::Block(bytes)] => (points_of_block(bytes, &transfer), transfer.binary_offset()),
        words => (points_of_words(words)?, transfer.offset()),
    };
    let model = &context.instrument.model;
    let (steps, levels) = (transfer.steps(model.bits), levels_per_division(model.bits));
    let range = model.codes();
    let code =
        |level: f64| level.round().clamp(f64::from(*range.start()), f64::from(*range.end())) as i16;
    let scaled = |point: i32| code((f64::from(point) - offset) / steps);
    codes.truncate(context.instrument.model.record_length.min(incoming.nr_pt));
    let y_mult = incoming.y_mult * steps;
    let y_off = (incoming.y_off - offset) / steps;
    let points = context.instrument.model.interval(1.0);
    let codes = codes.into_iter().map(scaled);
    // The first point goes to `DATa:STARt`; what stands elsewhere in the memory stays, and where
    // nothing does, it is at zero volts.
    let first = transfer.start.min(transfer.stop).saturating_sub(1);
    let mut all: Vec<i16> = match context.instrument.reference(letter) {
        Some(before) if first > 0 => before.codes.clone(),
        _ => Vec::new(),
    };
    all.resize(all.len().max(first), code(y_off));
    for (place, code) in (first..).zip(codes) {
        match all.get_mut(place) {
            Some(point) => *point = code,
            None => all.push(code),
        }
    }
    all.truncate(context.instrument.model.record_length);
    let waveform = Waveform {
        source: transfer.destination,
        codes: all,
        as_read: Vec::new(),
        preamble: Preamble {
            x_zero: incoming.x_zero,
            x_incr: incoming.x_incr,
            pt_off: 0,
            x_unit: "s".to_owned(),
            y_mult,
            y_zero: incoming.y_zero,
            y_off,
            y_unit: "V".to_owned(),
            pt_fmt: incoming.pt_fmt.into(),
        },
        vertical: VerticalSetup {
            scale: y_mult * levels,
            position: y_off / levels,
            coupling: None,
            bandwidth_limited: None,
            inverted: None,
            probe: 1.0,
        },
        horizontal_scale: incoming.x_incr / points,
        trigger_point: if incoming.x_incr > 0.0 { -incoming.x_zero / incoming.x_incr } else { 0.0 },
    };
    Ok(context.instrument.put_reference(waveform, letter)?)
}

fn points_of_block(bytes: &[u8], transfer: &Transfer) -> Vec<i32> {
    let signed = transfer.numbers == NumberFormat::Signed;
    if transfer.width == 1 {
        let point = |byte: &u8| {
            if signed { i32::from(byte.cast_signed()) } else { i32::from(*byte) }
        };
        return bytes.iter().map(point).collect();
    }
    let point = |pair: &[u8]| {
        let pair = <[u8; 2]>::try_from(pair).unwrap_or_default();
        let bits = match transfer.byte_order {
            ByteOrder::HighFirst => u16::from_be_bytes(pair),
            ByteOrder::LowFirst => u16::from_le_bytes(pair),
        };
        if signed { i32::from(bits.cast_signed()) } else { i32::from(bits) }
    };
    bytes.chunks_exact(2).map(point).collect()
}

fn points_of_words(arguments: &[Argument]) -> Result<Vec<i32>, Event> {
    let point = |argument: &Argument| match argument {
        Argument::Word(typed) => {
            let value = value::parse(typed).ok_or(Event::DataType)?;
            let point = value.round() as i32;
            Ok(point)
        }
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    };
    arguments.iter().map(point).collect()
}
