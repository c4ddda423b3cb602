//! Miscellaneous: identity, headers, locks, set-up text.

use crate::instrument::Event;
use crate::instrument::word::{Word as _, words};
use crate::scpi::argument::{flag, only, text, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, command, group, place, query, word};
use crate::scpi::value::ReplyValue;

words! {
    /// Lock state.
    Lock {
        /// The keys.
        All = "ALL",
        /// Nothing.
        None = "NONe",
    }

    /// Argument of `AUTOSet`.
    Execute {
        /// Set everything up.
        Everything = "EXECute",
    }
}

/// Longest text of `*DDT` and `REM`.
const LONGEST_REMARK: usize = 80;

/// The settings of a set-up in the order of `.SET` files of this family.
const SETUP: [&str; 54] = [
    "DISplay:FORMat",
    "DISplay:STYle",
    "DISplay:PERSistence",
    "ACQuire:MODe",
    "ACQuire:NUMAVg",
    "ACQuire:STATE",
    "ACQuire:STOPAfter",
    "CH1",
    "CH2",
    "CH3",
    "CH4",
    "HORizontal:VIEw",
    "HORizontal:MAIn:SCAle",
    "HORizontal:MAIn:POSition",
    "HORizontal:DELay:SCAle",
    "HORizontal:DELay:POSition",
    "HORizontal:SCAle",
    "TRIGger:MAIn:MODe",
    "TRIGger:MAIn:TYPe",
    "TRIGger:MAIn:HOLDOff:VALue",
    "TRIGger:MAIn:EDGE:SOUrce",
    "TRIGger:MAIn:EDGE:COUPling",
    "TRIGger:MAIn:EDGE:SLOpe",
    "TRIGger:MAIn:VIDeo:SYNC",
    "TRIGger:MAIn:VIDeo:POLarity",
    "TRIGger:MAIn:VIDeo:LINE",
    "TRIGger:MAIn:VIDeo:STANdard",
    "TRIGger:MAIn:PULse:WIDth:POLarity",
    "TRIGger:MAIn:PULse:WIDth:WHEN",
    "TRIGger:MAIn:PULse:WIDth:WIDth",
    "TRIGger:MAIn:LEVel",
    "SELect:CH1",
    "SELect:CH2",
    "SELect:CH3",
    "SELect:CH4",
    "SELect:MATH",
    "SELect:REFA",
    "SELect:REFB",
    "SELect:REFC",
    "SELect:REFD",
    "CURSor:FUNCtion",
    "CURSor:SELect:SOUrce",
    "CURSor:VBArs:UNIts",
    "CURSor:VBArs:POSITION1",
    "CURSor:VBArs:POSITION2",
    "CURSor:HBArs:POSITION1",
    "CURSor:HBArs:POSITION2",
    "MEASUrement:MEAS1",
    "MEASUrement:MEAS2",
    "MEASUrement:MEAS3",
    "MEASUrement:MEAS4",
    "MEASUrement:MEAS5",
    "MATH:DEFINE",
    "MATH:FFT",
];

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Miscellaneous",
    rows: &[
        CommandRow::acts("*IDN", query(identity), "maker, model, serial number, firmware; the last query of a message"),
        CommandRow::acts("ID", query(identity_in_short), "the same in the family's older form"),
        CommandRow::acts("*LRN", group(Parts::Of(&SETUP)), "the whole set-up, with headers"),
        CommandRow::acts("SET", group(Parts::Of(&SETUP)), "the whole set-up, with headers"),
        CommandRow::acts("HEADer", place!(|at| at.preferences.header, flag, ReplyValue::flag), "headers before answers, on this connection"),
        CommandRow::alias("HDR", "HEADer"),
        CommandRow::acts("VERBose", place!(|at| at.preferences.verbose, flag, ReplyValue::flag), "words in full, on this connection"),
        CommandRow::acts("AUTOSet", command(autoset), "`EXECute` scales the channels and triggers at half height"),
        CommandRow::accepted(
            "LOCk",
            both(lock, |at| {
                Ok(ReplyValue::Word(if at.instrument.service.locked { "ALL" } else { "NONe" }))
            }),
            "`ALL` or `NONe` of the keys",
        ),
        CommandRow::acts(
            "AUTOSet:SIGNAL",
            query(|at| Ok(ReplyValue::Word(at.instrument.autoset_signal().word()))),
            "what the last `AUTOSet` took its signal for: `LEVEL`, `SINE`, `SQUARE`, `OTHER`, `NONe`; no input carries video",
        ),
        CommandRow::accepted(
            "AUTOSet:VIEW",
            word!(|at| at.instrument.service.autoset_view),
            "how it would show it, `MULTICY` to `NONE`; `DEFault` after `AUTOSet`",
        ),
        CommandRow::accepted("UNLock", command(unlock), "`ALL`"),
        CommandRow::accepted(
            "LANGuage",
            word!(|at| at.instrument.service.language),
            "`ENGLish`, `FRENch`, `GERMan`, `ITALian`, `SPANish`, `PORTUguese`, `JAPAnese`, `KOREan`, `TRADitionalchinese` or `SIMPlifiedchinese`; pictures are in English",
        ),
        CommandRow::acts(
            "*DDT",
            both(set_device_trigger, |at| {
                Ok(ReplyValue::Text(at.instrument.service.device_trigger.clone()))
            }),
            "up to 80 characters, as text or block, that `*TRG` executes; empty: it triggers",
        ),
        CommandRow::acts(
            "REM",
            command(|_, a| {
                remark(a)?;
                Ok(())
            }),
            "a remark of up to 80 characters",
        ),
    ],
};

fn identity(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    if let Some(text) = at.instrument.bench.faults.identity() {
        return Ok(ReplyValue::Plain(text.to_owned()));
    }
    let model = &at.instrument.model;
    Ok(ReplyValue::Plain(format!(
        "TEKTRONIX,{},{},CF:91.1CT {} {}",
        model.name, model.serial, model.firmware, model.interface
    )))
}

fn identity_in_short(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    if let Some(text) = at.instrument.bench.faults.identity() {
        return Ok(ReplyValue::Plain(text.to_owned()));
    }
    let model = &at.instrument.model;
    let name = &model.name;
    Ok(ReplyValue::Plain(format!("TEK/{name},CF:91.1CT,{} {}", model.firmware, model.interface)))
}

fn autoset(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let Execute::Everything = word(arguments)?;
    at.instrument.autoset();
    Ok(())
}

fn lock(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.service.locked = word::<Lock>(arguments)? == Lock::All;
    Ok(())
}

fn unlock(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    match word(arguments)? {
        Lock::All => at.instrument.service.locked = false,
        Lock::None => return Err(Event::IllegalParameter.into()),
    }
    Ok(())
}

fn remark(arguments: &[Argument]) -> Result<&str, Event> {
    let remark = text(arguments)?;
    if remark.len() > LONGEST_REMARK { Err(Event::InvalidString) } else { Ok(remark) }
}

/// Text or a block, of up to 80 characters.
fn commands(arguments: &[Argument]) -> Result<String, Event> {
    match only(arguments)? {
        Argument::Block(bytes) if bytes.len() > LONGEST_REMARK => Err(Event::InvalidBlock),
        Argument::Block(bytes) => Ok(String::from_utf8_lossy(bytes).into_owned()),
        Argument::Text(_) | Argument::Word(_) => remark(arguments).map(str::to_owned),
    }
}

fn set_device_trigger(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.service.device_trigger = commands(arguments)?;
    Ok(())
}
