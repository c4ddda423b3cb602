//! Save and recall: `*SAV`, `*RCL`, `SAVe`, `RECAll`, `FACtory`, `*RST`.

use crate::instrument::word::{Word as _, words};
use crate::instrument::{Event, SETUP_MEMORIES};
use crate::scope::Source;
use crate::scpi::argument::{none, real, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Setting, Stop, both, command};

words! {
    /// A set-up that is recalled.
    Recalled {
        /// The factory's.
        Factory = "FACtory",
    }
}

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Save and recall",
    rows: &[
        CommandRow::acts("*SAV", command(save_setup), "keeps the front panel in memory 1 to 10"),
        CommandRow::acts("*RCL", command(recall_setup), "sets the front panel as in memory 1 to 10"),
        CommandRow::acts("*RST", command(reset), "the factory's set-up"),
        CommandRow::acts(
            "FACtory",
            command(factory),
            "the factory's set-up, `HEADer ON`, no enabled events, an empty `*DDT`; printer, contrast, lock, language, serial line and `VERBose` stay",
        ),
        CommandRow::acts("SAVe:SETUp", command(save_setup), "as `*SAV`"),
        CommandRow::acts("RECAll:SETUp", command(recall_setup), "as `*RCL`, or `FACtory`"),
        CommandRow::acts("SAVe:WAVEform", command(save_waveform), "`<wfm>,REF<x>` copies a waveform into a reference memory"),
        CommandRow::acts("RECAll:WAVEform", command(recall_waveform), "`REF<x>` displays a reference memory"),
        CommandRow::refused("SAVe:IMAge", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("SAVe:IMAge:FILEFormat", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:COPy", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:CWD", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:DELEte", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:DIR", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:FORMat", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:FREESpace", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:MKDir", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:OVERWrite", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:PRInt", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:READFile", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:REName", NO_CARD, "no memory card (event 241)"),
        CommandRow::refused("FILESystem:RMDir", NO_CARD, "no memory card (event 241)"),
    ],
};

/// What a memory card would do.
const NO_CARD: Setting =
    both(|_, _| Err(Event::HardwareMissing.into()), |_| Err(Event::HardwareMissing.into()));

fn number(arguments: &[Argument]) -> Result<usize, Stop> {
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

fn save_setup(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    Ok(at.instrument.save_setup(number(arguments)?)?)
}

fn recall_setup(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    if word(arguments) == Ok(Recalled::Factory) {
        at.instrument.reset();
        return Ok(());
    }
    Ok(at.instrument.recall_setup(number(arguments)?)?)
}

fn reset(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    at.instrument.reset();
    Ok(())
}

fn factory(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    reset(at, arguments)?;
    let status = &mut at.instrument.status;
    (status.device_enable, status.event_enable, status.service_enable) = (u8::MAX, 0, 0);
    status.power_on_clear = true;
    // Programs rely on it; `VERBose` stays as it is.
    at.preferences.header = true;
    Ok(())
}

/// A waveform's name.
fn waveform(argument: &Argument) -> Result<Source, Event> {
    match argument {
        Argument::Word(typed) => Source::from_word(typed).ok_or(Event::IllegalParameter),
        Argument::Text(_) | Argument::Block(_) => Err(Event::DataType),
    }
}

fn save_waveform(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let [from, to] = arguments else { return Err(Event::MissingParameter.into()) };
    let Source::Reference(letter) = waveform(to)? else {
        return Err(Event::NotAReference.into());
    };
    Ok(at.instrument.save_waveform(waveform(from)?, letter)?)
}

fn recall_waveform(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let Source::Reference(letter) = word(arguments)? else {
        return Err(Event::NotAReference.into());
    };
    Ok(at.instrument.display_reference(letter, true)?)
}
