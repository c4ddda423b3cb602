//! Waveform points: `CURVe` and `WAVFrm?`.

use crate::instrument::Event;
use crate::instrument::transfer::{ByteOrder, CurveFormat, Transfer};
use crate::scope::waveform::{HIGHEST_CODE, LEVELS_PER_DIVISION, LOWEST_CODE};
use crate::scope::{Preamble, Source, VerticalSetup, Waveform};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group};
use crate::scpi::value;
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Waveform: points",
    rows: &[
        CommandRow::acts("CURVe", both(receive, send), "points, as `DATa` says; of a waveform that is not displayed none, and events 2244 and 420"),
        CommandRow::acts("WAVFrm", group(Parts::Of(&["WFMPre", "CURVe"])), "preamble and points"),
    ],
};

fn send(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let transfer = at.instrument.transfer;
    let waveform = at.instrument.waveform(transfer.source)?;
    let range = transfer.range(waveform.codes.len());
    let codes = waveform.codes.get(range).unwrap_or_default();
    if transfer.format == CurveFormat::Ascii {
        let point = |code: &i16| level_to_point(*code, &transfer).to_string();
        let points: Vec<String> = codes.iter().map(point).collect();
        return Ok(ReplyValue::Plain(points.join(",")));
    }
    let mut bytes = Vec::with_capacity(2 * codes.len());
    for code in codes {
        let [high, low] = level_to_point(*code, &transfer).to_be_bytes();
        match (transfer.width, transfer.byte_order) {
            (2, ByteOrder::HighFirst) => bytes.extend([high, low]),
            (2, ByteOrder::LowFirst) => bytes.extend([low, high]),
            _ => bytes.push(low),
        }
    }
    Ok(ReplyValue::block(&bytes))
}

/// A level as the number that is sent, its lowest 16 bits.
fn level_to_point(code: i16, transfer: &Transfer) -> i16 {
    let number = (f64::from(code) + transfer.shift()) * transfer.steps();
    (number as i32) as i16
}

fn receive(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let transfer = at.instrument.transfer;
    let incoming = at.instrument.incoming;
    let Source::Reference(letter) = transfer.destination else {
        return Err(Event::NotAReference.into());
    };
    let mut codes = match arguments {
        [] => return Err(Event::MissingParameter.into()),
        [Argument::Block(bytes)] => points_of_block(bytes, &transfer),
        words => points_of_words(words)?,
    };
    let scaled = |point: i32| {
        let level = f64::from(point) / transfer.steps() - transfer.shift();
        level.round().clamp(f64::from(LOWEST_CODE), f64::from(HIGHEST_CODE)) as i16
    };
    codes.truncate(at.instrument.model.record_length.min(incoming.nr_pt));
    let y_mult = incoming.y_mult * transfer.steps();
    let y_off = incoming.y_off / transfer.steps() - transfer.shift();
    let points = at.instrument.model.interval(1.0);
    let codes = codes.into_iter().map(scaled);
    // The first point goes to `DATa:STARt`; what stands elsewhere in the memory stays, and where
    // nothing does, it is at zero volts.
    let first = transfer.start.min(transfer.stop).saturating_sub(1);
    let mut all: Vec<i16> = match at.instrument.reference(letter) {
        Some(before) if first > 0 => before.codes.clone(),
        _ => Vec::new(),
    };
    let zero = y_off.round().clamp(f64::from(LOWEST_CODE), f64::from(HIGHEST_CODE)) as i16;
    all.resize(all.len().max(first), zero);
    for (place, code) in (first..).zip(codes) {
        match all.get_mut(place) {
            Some(point) => *point = code,
            None => all.push(code),
        }
    }
    all.truncate(at.instrument.model.record_length);
    let waveform = Waveform {
        source: transfer.destination,
        codes: all,
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
            scale: y_mult * LEVELS_PER_DIVISION,
            position: y_off / LEVELS_PER_DIVISION,
            coupling: None,
            bandwidth_limited: None,
            inverted: None,
            probe: 1.0,
        },
        horizontal_scale: incoming.x_incr / points,
        trigger_point: if incoming.x_incr > 0.0 { -incoming.x_zero / incoming.x_incr } else { 0.0 },
    };
    Ok(at.instrument.put_reference(waveform, letter)?)
}

fn points_of_block(bytes: &[u8], transfer: &Transfer) -> Vec<i32> {
    let signed = transfer.shift() == 0.0;
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
