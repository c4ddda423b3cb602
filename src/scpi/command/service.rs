//! Everything of the instrument that is neither front panel nor waveform: identity, headers,
//! set-ups, printer, serial line, status and events.

use crate::instrument::{Event, SETUP_MEMORIES};
use crate::scope::Source;
use crate::scope::panel::{HardCopyFormat, Port};
use crate::scope::word::{Word as _, words};
use crate::scpi::message::Argument;
use crate::scpi::table::Setting::{Both, Command, Query};
use crate::scpi::table::{
    Context, Deferred, Group, Parts, Setting, Slot, Stored, acts, alias, refused, stub,
};
use crate::scpi::value::{ReplyValue, flag, none, only, real, text, word};
use crate::screen::{PictureFormat, Screen, draw, file};

words! {
    /// Argument of `HARDCopy`.
    Print {
        /// Print.
        Start = "STARt",
        /// Do not.
        Abort = "ABOrt",
    }

    /// Argument of `LOCk` and `UNLock`.
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

    /// A set-up that is recalled by name.
    Recalled {
        /// The factory's.
        Factory = "FACtory",
    }
}

/// Longest text of `*DDT` and `REM`.
const MAX_REMARK: usize = 80;
/// Speeds of the serial line (baud).
const BAUD_RATES: [f64; 7] = [300.0, 600.0, 1200.0, 2400.0, 4800.0, 9600.0, 19200.0];
/// Languages of the screen.
const LANGUAGES: [&str; 10] = [
    "ENGLish",
    "FRENch",
    "GERMan",
    "ITALian",
    "SPANish",
    "PORTUguese",
    "JAPAnese",
    "KOREan",
    "TRADitionalchinese",
    "SIMPlifiedchinese",
];
/// Header of the way in which `AUTOSet` shows its signal.
const AUTOSET_VIEW: &str = "AUTOSet:VIEW";
/// These ways: none before an `AUTOSet`, the default one after it.
const AUTOSET_VIEWS: [&str; 13] = [
    "NONE", "DEFault", "MULTICY", "SINGLECY", "FFT", "RISING", "FALLING", "FIELD", "ODD", "EVEN",
    "LINE", "LINENum", "DCLIne",
];
/// Index of the default one.
const AUTOSET_VIEW_DEFAULT: u32 = 1;

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

/// `*CAL`, `*TST`, `CALibrate`, `DIAg`, `ERRLOG`. The virtual instrument needs neither calibration
/// nor diagnosis; everything has passed.
#[rustfmt::skip]
pub const CALIBRATION: Group = Group {
    title: "Calibration and diagnostic",
    rows: &[
        stub("*CAL", Query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        stub("*TST", Query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        stub("CALibrate:ABOrt", Command(nothing), "nothing to abort"),
        stub("CALibrate:CONTINUE", Command(nothing), "nothing to go on with"),
        stub("CALibrate:FACtory", Command(nothing), "nothing to calibrate"),
        stub("CALibrate:INTERNAL", Command(nothing), "nothing to calibrate"),
        stub("CALibrate:STATUS", Query(|_| Ok(ReplyValue::Word("PASS"))), "`PASS`"),
        stub("DIAg:RESUlt:FLAg", Query(|_| Ok(ReplyValue::Word("PASS"))), "`PASS`"),
        stub("DIAg:RESUlt:LOG", Query(|_| Ok(ReplyValue::Text("No errors recorded.".to_owned()))), "the self test's log"),
        stub("ERRLOG:FIRST", Query(|_| Ok(ReplyValue::Text(String::new()))), "the error log is empty"),
        stub("ERRLOG:NEXT", Query(|_| Ok(ReplyValue::Text(String::new()))), "the error log is empty"),
    ],
};

fn nothing(_: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    Ok(none(arguments)?)
}

/// `HARDCopy`. Pictures come over the connection; there is no printer behind it.
#[rustfmt::skip]
pub const HARD_COPY: Group = Group {
    title: "Hard copy",
    rows: &[
        acts("HARDCopy", Setting::GroupAndCommand(Parts::Below, hard_copy), "`STARt` sends the screen's picture, bare bytes without a terminator; `ABOrt` does nothing"),
        acts("HARDCopy:FORMat", Setting::Slot(|c| Slot::Word(&mut c.instrument.service.hard_copy.format)), "`BMP` or `TIFf`; `STARt` refuses other formats and printers' languages (event 241)"),
        acts("HARDCopy:PORT", Setting::Slot(|c| Slot::Word(&mut c.instrument.service.hard_copy.port)), "`RS232` and `GPIB` are this connection; at `CENtronics` is no printer (event 241)"),
        stub("HARDCopy:LAYout", Setting::Stored(Stored::Words(&["PORTRait", "LANdscape"])), "`PORTRait` or `LANdscape`; pictures are upright"),
        acts("HARDCopy:INKSaver", Setting::Slot(|c| Slot::Switch(&mut c.instrument.service.hard_copy.ink_saver)), "`ON` leaves the background white"),
    ],
};

fn hard_copy(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    if word::<Print>(arguments)? == Print::Abort {
        return Ok(());
    }
    let printer = context.instrument.service.hard_copy;
    let format = match printer.format {
        HardCopyFormat::Bmp => PictureFormat::Bmp,
        HardCopyFormat::Tiff => PictureFormat::Tiff,
        _ => return Err(Event::HardwareMissing.into()),
    };
    if printer.port == Port::Centronics {
        return Err(Event::HardwareMissing.into());
    }
    context.raw.extend(file(&draw(&Screen::of(context.instrument)), format));
    Ok(())
}

/// Identity, headers, locks, the whole set-up.
#[rustfmt::skip]
pub const MISCELLANEOUS: Group = Group {
    title: "Miscellaneous",
    rows: &[
        acts("*IDN", Query(identity), "maker, model, serial number, firmware; the last query of a message"),
        acts("ID", Query(identity_in_short), "the same in the family's older form"),
        acts("*LRN", Setting::Group(Parts::Of(&SETUP)), "the whole set-up, with headers"),
        acts("SET", Setting::Group(Parts::Of(&SETUP)), "the whole set-up, with headers"),
        acts("HEADer", Setting::Slot(|c| Slot::Flag(&mut c.preferences.header)), "headers before answers, on this connection"),
        alias("HDR", "HEADer"),
        acts("VERBose", Setting::Slot(|c| Slot::Flag(&mut c.preferences.verbose)), "words in full, on this connection"),
        acts("AUTOSet", Command(autoset), "`EXECute` scales the channels and triggers at half height"),
        stub(
            "LOCk",
            Both(lock, |c| {
                Ok(ReplyValue::Word(if c.instrument.service.locked { "ALL" } else { "NONe" }))
            }),
            "`ALL` or `NONe` of the keys",
        ),
        acts(
            "AUTOSet:SIGNAL",
            Query(|c| Ok(ReplyValue::Word(c.instrument.autoset_signal().word()))),
            "what the last `AUTOSet` took its signal for: `LEVEL`, `SINE`, `SQUARE`, `OTHER`, `NONe`; no input carries video",
        ),
        stub(
            AUTOSET_VIEW,
            Setting::Stored(Stored::Words(&AUTOSET_VIEWS)),
            "how it would show it, `MULTICY` to `NONE`; `DEFault` after `AUTOSet`",
        ),
        stub("UNLock", Command(unlock), "`ALL`"),
        stub(
            "LANGuage",
            Setting::Stored(Stored::Words(&LANGUAGES)),
            "`ENGLish`, `FRENch`, `GERMan`, `ITALian`, `SPANish`, `PORTUguese`, `JAPAnese`, `KOREan`, `TRADitionalchinese` or `SIMPlifiedchinese`; pictures are in English",
        ),
        acts(
            "*DDT",
            Both(set_device_trigger, |c| {
                Ok(ReplyValue::Text(c.instrument.service.device_trigger.clone()))
            }),
            "up to 80 characters, as text or block, that `*TRG` executes; empty: it triggers",
        ),
        acts(
            "REM",
            Command(|_, a| {
                remark(a)?;
                Ok(())
            }),
            "a remark of up to 80 characters",
        ),
    ],
};

fn identity(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    if let Some(text) = context.instrument.bench.faults.identity() {
        return Ok(ReplyValue::Plain(text.to_owned()));
    }
    let model = &context.instrument.model;
    Ok(ReplyValue::Plain(format!(
        "TEKTRONIX,{},{},CF:91.1CT {} {}",
        model.name, model.serial, model.firmware, model.interface
    )))
}

fn identity_in_short(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    if let Some(text) = context.instrument.bench.faults.identity() {
        return Ok(ReplyValue::Plain(text.to_owned()));
    }
    let model = &context.instrument.model;
    let name = &model.name;
    Ok(ReplyValue::Plain(format!("TEK/{name},CF:91.1CT,{} {}", model.firmware, model.interface)))
}

fn autoset(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let Execute::Everything = word(arguments)?;
    context.instrument.autoset();
    context.instrument.service.stored.insert(AUTOSET_VIEW, AUTOSET_VIEW_DEFAULT);
    Ok(())
}

fn lock(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    context.instrument.service.locked = word::<Lock>(arguments)? == Lock::All;
    Ok(())
}

fn unlock(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    match word(arguments)? {
        Lock::All => context.instrument.service.locked = false,
        Lock::None => return Err(Event::IllegalParameter.into()),
    }
    Ok(())
}

fn remark(arguments: &[Argument]) -> Result<&str, Event> {
    let remark = text(arguments)?;
    if remark.len() > MAX_REMARK { Err(Event::InvalidString) } else { Ok(remark) }
}

/// Text or a block, of up to 80 characters.
fn commands(arguments: &[Argument]) -> Result<String, Event> {
    match only(arguments)? {
        Argument::Block(bytes) if bytes.len() > MAX_REMARK => Err(Event::InvalidBlock),
        Argument::Block(bytes) => Ok(String::from_utf8_lossy(bytes).into_owned()),
        Argument::Text(_) | Argument::Word(_) => remark(arguments).map(str::to_owned),
    }
}

fn set_device_trigger(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    context.instrument.service.device_trigger = commands(arguments)?;
    Ok(())
}

/// `RS232`. There is no serial line; its settings are stored, and the terminator acts on the
/// connection that sets it.
#[rustfmt::skip]
pub const RS232: Group = Group {
    title: "RS-232",
    rows: &[
        acts("RS232", Setting::Group(Parts::Below), "all settings of the line"),
        stub("RS232:BAUd", Setting::Stored(Stored::OneOf(&BAUD_RATES, 9600)), "300, 600, 1200, 2400, 4800, 9600 or 19200"),
        stub("RS232:HARDFlagging", Both(set_hard_flagging, |c| Ok(ReplyValue::on_or_off(c.instrument.service.hard_flagging))), "`ON` or `OFF`; `ON` turns the other one off"),
        stub("RS232:SOFTFlagging", Both(set_soft_flagging, |c| Ok(ReplyValue::on_or_off(c.instrument.service.soft_flagging))), "`ON` or `OFF`; `ON` turns the other one off"),
        stub("RS232:PARity", Setting::Stored(Stored::Words(&["NONe", "EVEN", "ODD"])), "`EVEN`, `ODD` or `NONe`"),
        acts("RS232:TRANsmit:TERMinator", Setting::Slot(|c| Slot::Word(&mut c.preferences.terminator)), "end of this connection's replies: `CR`, `LF`, `CRLf` or `LFCr`"),
    ],
};

fn set_hard_flagging(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let on = flag(arguments)?;
    let service = &mut context.instrument.service;
    service.hard_flagging = on;
    service.soft_flagging &= !on;
    Ok(())
}

fn set_soft_flagging(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let on = flag(arguments)?;
    let service = &mut context.instrument.service;
    service.soft_flagging = on;
    service.hard_flagging &= !on;
    Ok(())
}

/// `*SAV`, `*RCL`, `SAVe`, `RECAll`, `FACtory`, `*RST`, and the memory card, which is missing.
#[rustfmt::skip]
pub const SAVE_AND_RECALL: Group = Group {
    title: "Save and recall",
    rows: &[
        acts("*SAV", Command(save_setup), "keeps the front panel in memory 1 to 10"),
        acts("*RCL", Command(recall_setup), "sets the front panel as in memory 1 to 10"),
        acts("*RST", Command(reset), "the factory's set-up"),
        acts(
            "FACtory",
            Command(factory),
            "the factory's set-up, `HEADer ON`, no enabled events, an empty `*DDT`; printer, contrast, lock, language, serial line and `VERBose` stay",
        ),
        acts("SAVe:SETUp", Command(save_setup), "as `*SAV`"),
        acts("RECAll:SETUp", Command(recall_setup), "as `*RCL`, or `FACtory`"),
        acts("SAVe:WAVEform", Command(save_waveform), "`<wfm>,REF<x>` copies a waveform into a reference memory"),
        acts("RECAll:WAVEform", Command(recall_waveform), "`REF<x>` displays a reference memory"),
        refused("SAVe:IMAge", NO_CARD, "no memory card (event 241)"),
        refused("SAVe:IMAge:FILEFormat", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:COPy", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:CWD", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:DELEte", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:DIR", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:FORMat", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:FREESpace", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:MKDir", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:OVERWrite", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:PRInt", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:READFile", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:REName", NO_CARD, "no memory card (event 241)"),
        refused("FILESystem:RMDir", NO_CARD, "no memory card (event 241)"),
    ],
};

/// What a memory card would do.
const NO_CARD: Setting =
    Both(|_, _| Err(Event::HardwareMissing.into()), |_| Err(Event::HardwareMissing.into()));

fn memory_number(arguments: &[Argument]) -> Result<usize, Deferred> {
    if matches!(arguments, [Argument::Text(_)]) {
        // The name of a file on the memory card.
        return Err(Event::HardwareMissing.into());
    }
    let value = real(arguments)?.round();
    (1..=SETUP_MEMORIES)
        .zip(1_u32..)
        .find(|(_, number)| (f64::from(*number) - value).abs() < 0.5)
        .map(|(number, _)| number)
        .ok_or_else(|| Event::OutOfRange.into())
}

fn save_setup(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    Ok(context.instrument.save_setup(memory_number(arguments)?)?)
}

fn recall_setup(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    if word(arguments) == Ok(Recalled::Factory) {
        context.instrument.reset();
        return Ok(());
    }
    Ok(context.instrument.recall_setup(memory_number(arguments)?)?)
}

fn reset(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    context.instrument.reset();
    Ok(())
}

fn factory(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    reset(context, arguments)?;
    let status = &mut context.instrument.status;
    (status.device_enable, status.event_enable, status.service_enable) = (u8::MAX, 0, 0);
    status.power_on_clear = true;
    // Programs rely on it; `VERBose` stays as it is.
    context.preferences.header = true;
    Ok(())
}

/// A waveform's name.
fn waveform(argument: &Argument, channels: u8) -> Result<Source, Event> {
    let exists = |source: &Source| source.exists(channels);
    match argument {
        Argument::Word(typed) => {
            Source::from_word(typed).filter(exists).ok_or(Event::IllegalParameter)
        }
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

fn save_waveform(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let [from, to] = arguments else { return Err(Event::MissingParameter.into()) };
    let channels = context.instrument.model.channels;
    let Source::Reference(letter) = waveform(to, channels)? else {
        return Err(Event::NotAReference.into());
    };
    Ok(context.instrument.save_waveform(waveform(from, channels)?, letter)?)
}

fn recall_waveform(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let source = waveform(only(arguments)?, context.instrument.model.channels)?;
    let Source::Reference(letter) = source else {
        return Err(Event::NotAReference.into());
    };
    Ok(context.instrument.display_reference(letter, true)?)
}

/// Registers, events, and waiting.
#[rustfmt::skip]
pub const STATUS: Group = Group {
    title: "Status and error",
    rows: &[
        acts("*CLS", Command(clear), "forgets events"),
        acts("*ESE", Setting::Slot(|c| Slot::Register(&mut c.instrument.status.event_enable)), "events that show in the status byte"),
        acts(
            "*ESR",
            Query(|c| Ok(ReplyValue::integer(c.instrument.status.read_register()))),
            "reads and clears the event register, releases events",
        ),
        acts("*OPC", Both(complete, completed), "event 402 when the acquisition is done; the query waits for that and answers 1"),
        acts("*PSC", Setting::Slot(|c| Slot::Flag(&mut c.instrument.status.power_on_clear)), "whether registers are cleared at power on"),
        acts("*SRE", Setting::Slot(|c| Slot::Register(&mut c.instrument.status.service_enable)), "parts of the status byte that ask for service"),
        acts("*STB", Query(status_byte), "the status byte"),
        acts("*WAI", Command(wait), "holds what follows until the acquisition is done"),
        acts("ALLEv", Query(all_events), "every released event"),
        acts("BUSY", Query(|c| Ok(ReplyValue::flag(c.instrument.is_busy()))), "1 while a single sequence runs"),
        acts("DESE", Setting::Slot(|c| Slot::Register(&mut c.instrument.status.device_enable)), "events that are noticed at all"),
        acts("EVENT", Query(|c| Ok(ReplyValue::integer(c.instrument.status.next_event().0))), "code of the next released event"),
        acts("EVMsg", Query(next_event), "the next released event"),
        acts("EVQty", Query(|c| Ok(ReplyValue::integer(c.instrument.status.released_events()))), "how many events are released"),
    ],
};

fn clear(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    context.instrument.status.clear();
    Ok(())
}

fn complete(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    context.instrument.status.ask_for_completion();
    if !context.instrument.is_busy() {
        context.instrument.status.complete();
    }
    Ok(())
}

fn completed(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    if context.instrument.is_busy() { Err(Deferred::UntilIdle) } else { Ok(ReplyValue::Integer(1)) }
}

fn wait(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    if context.instrument.is_busy() { Err(Deferred::UntilIdle) } else { Ok(()) }
}

fn status_byte(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    Ok(ReplyValue::integer(context.instrument.status.byte(context.message_available)))
}

fn written((code, message): &(u16, String)) -> String {
    format!("{code},\"{message}\"")
}

fn next_event(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    Ok(ReplyValue::Plain(written(&context.instrument.status.next_event())))
}

fn all_events(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let events = context.instrument.status.all_events();
    let texts: Vec<String> = events.iter().map(written).collect();
    Ok(ReplyValue::Plain(texts.join(",")))
}
