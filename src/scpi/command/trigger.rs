//! Trigger: `TRIGger` and `*TRG`.

use crate::instrument::measure::{INVALID, measure};
use crate::instrument::panel::MeasurementType;
use crate::instrument::word::{Word as _, words};
use crate::instrument::{Event, limits};
use crate::scope::{Source, TriggerSource};
use crate::scpi::argument::{none, real, whole, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{
    Context, Parts, Setting, Stop, both, command, group, group_and_command, number, place, query,
    word,
};
use crate::scpi::value::ReplyValue;

words! {
    /// Argument of `TRIGger`.
    Force {
        /// Trigger now.
        Now = "FORCe",
    }

    /// Argument of `TRIGger:MAIn`.
    SetLevel {
        /// Set the level to half height.
        HalfHeight = "SETLevel",
    }
}

/// Lines of a field of PAL, the standard with more.
const LINES: u32 = 625;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Trigger",
    rows: &[
        CommandRow::acts("*TRG", command(device_trigger), "executes what `*DDT` says; where that is empty, triggers, if the scope is ready"),
        CommandRow::acts("TRIGger", group_and_command(Parts::Below, force), "`FORCe` triggers, if the scope is ready"),
        CommandRow::acts("TRIGger:STATE", query(|at| Ok(ReplyValue::Word(at.instrument.state().word()))), "what the acquisition is doing").apart(),
        CommandRow::acts(
            "TRIGger:MAIn",
            group_and_command(Parts::Below, set_level),
            "`SETLevel` puts the level at half height; event 221 where the scope is stopped, or at the mains",
        ),
        CommandRow::acts("TRIGger:MAIn:MODe", word!(|at| at.instrument.panel.trigger.mode), "`AUTO` or `NORMal`"),
        CommandRow::acts("TRIGger:MAIn:TYPe", word!(|at| at.instrument.panel.trigger.kind), "`EDGE`, `VIDeo` or `PULse`; no input carries video"),
        CommandRow::acts("TRIGger:MAIn:HOLDOff", group(Parts::Below), "holdoff"),
        CommandRow::acts(
            "TRIGger:MAIn:HOLDOff:VALue",
            number!(|at| at.instrument.panel.trigger.holdoff, |i, _, time| limits::within(
                time,
                i.model.limits.holdoff
            )),
            "seconds after a trigger without another",
        ),
        CommandRow::acts("TRIGger:MAIn:EDGE", group(Parts::Below), "the edge trigger"),
        CommandRow::acts("TRIGger:MAIn:EDGE:SOUrce", SOURCE, "`CH<x>`, `EXT`, `EXT5` (what the bench puts there) or `LINE` (the mains)"),
        CommandRow::acts("TRIGger:MAIn:EDGE:COUPling", word!(|at| at.instrument.panel.trigger.coupling), "`DC`, `AC`, `HFRej`, `LFRej` or `NOISErej`"),
        CommandRow::acts("TRIGger:MAIn:EDGE:SLOpe", word!(|at| at.instrument.panel.trigger.slope), "`RISe` or `FALL`"),
        CommandRow::accepted("TRIGger:MAIn:VIDeo", group(Parts::Below), "the video trigger"),
        CommandRow::acts("TRIGger:MAIn:VIDeo:SOUrce", SOURCE, "the same source as the edge trigger's").apart(),
        CommandRow::accepted("TRIGger:MAIn:VIDeo:SYNC", word!(|at| at.instrument.panel.trigger.video_sync), "`FIELD`, `LINE`, `ODD`, `EVEN` or `LINENum`"),
        CommandRow::accepted("TRIGger:MAIn:VIDeo:POLarity", word!(|at| at.instrument.panel.trigger.video_polarity), "`NORMal` or `INVert`"),
        CommandRow::accepted(
            "TRIGger:MAIn:VIDeo:LINE",
            place!(
                |at| at.instrument.panel.trigger.video_line,
                |a| whole(a, 1, LINES),
                ReplyValue::integer
            ),
            "number of the line",
        ),
        CommandRow::accepted("TRIGger:MAIn:VIDeo:STANdard", word!(|at| at.instrument.panel.trigger.video_standard), "`NTSC` or `PAL`"),
        CommandRow::acts("TRIGger:MAIn:PULse", group(Parts::Below), "the pulse trigger"),
        CommandRow::acts("TRIGger:MAIn:PULse:SOUrce", SOURCE, "the same source as the edge trigger's").apart(),
        CommandRow::acts("TRIGger:MAIn:PULse:WIDth", group(Parts::Below), "which pulses trigger"),
        CommandRow::acts("TRIGger:MAIn:PULse:WIDth:POLarity", word!(|at| at.instrument.panel.trigger.pulse_polarity), "`POSITIVe` or `NEGAtive`"),
        CommandRow::acts("TRIGger:MAIn:PULse:WIDth:WHEN", word!(|at| at.instrument.panel.trigger.pulse_when), "`EQual`, `NOTEqual`, `INside` or `OUTside`"),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:WIDth:WIDth",
            number!(|at| at.instrument.panel.trigger.pulse_width, |i, _, width| limits::within(
                width,
                i.model.limits.pulse_width
            )),
            "seconds, 33 ns to 10 s",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:LEVel",
            both(set_trigger_level, |at| Ok(ReplyValue::Number(at.instrument.panel.trigger.level))),
            "volts; the mains have no level (event 221)",
        ),
        CommandRow::acts("TRIGger:MAIn:FREQuency", query(frequency), "frequency of the source, six digits").apart(),
    ],
};

const SOURCE: Setting = word!(|at| at.instrument.panel.trigger.source);

fn force(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let Force::Now = word(arguments)?;
    at.instrument.force_trigger();
    Ok(())
}

fn set_level(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let SetLevel::HalfHeight = word(arguments)?;
    Ok(at.instrument.centre_trigger()?)
}

fn device_trigger(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    let commands = &at.instrument.service.device_trigger;
    if !commands.trim().is_empty() {
        return Err(Stop::Execute(commands.clone()));
    }
    at.instrument.force_trigger();
    Ok(())
}

fn set_trigger_level(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let asked = real(arguments)?;
    let panel = &at.instrument.panel;
    // A set-up that is sent back tells the level as it is.
    let same = (asked - panel.trigger.level).abs() <= f64::EPSILON * asked.abs();
    if panel.trigger.source == TriggerSource::Line && !same {
        return Err(Event::SettingsConflict.into());
    }
    at.instrument.panel.trigger.level = panel.trigger_level(&at.instrument.model, asked);
    Ok(())
}

fn frequency(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let number = at.instrument.panel.trigger.source.channel();
    let record = number.and_then(|n| at.instrument.waveform(Source::Channel(n)).ok());
    let found = record.and_then(|record| measure(MeasurementType::Frequency, &record).ok());
    Ok(ReplyValue::Number(found.map_or(INVALID, |value| limits::rounded(value, 6))))
}
