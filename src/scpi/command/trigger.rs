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
    Both, Command, Context, GroupQuery, GroupQueryAndCommand, Number, Parts, Query, Stop,
    WordSetting,
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

/// The group.
pub const GROUP: Group = Group {
    title: "Trigger",
    rows: &[
        CommandRow::acts(
            "*TRG",
            &Command(device_trigger),
            "executes what `*DDT` says; where that is empty, triggers, if the scope is ready",
        ),
        CommandRow::acts(
            "TRIGger",
            &GroupQueryAndCommand(Parts::Below, force),
            "`FORCe` triggers, if the scope is ready",
        ),
        CommandRow::acts(
            "TRIGger:STATE",
            &Query(|at| Ok(ReplyValue::Word(at.instrument.state().word()))),
            "what the acquisition is doing",
        )
        .apart(),
        CommandRow::acts(
            "TRIGger:MAIn",
            &GroupQueryAndCommand(Parts::Below, set_level),
            "`SETLevel` puts the level at half height; event 221 where the scope is stopped, or at the mains",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:MODe",
            &WordSetting(|i, _| &mut i.panel.trigger.mode),
            "`AUTO` or `NORMal`",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:TYPe",
            &WordSetting(|i, _| &mut i.panel.trigger.kind),
            "`EDGE`, `VIDeo` or `PULse`; no input carries video",
        ),
        CommandRow::acts("TRIGger:MAIn:HOLDOff", &GroupQuery(Parts::Below), "holdoff"),
        CommandRow::acts(
            "TRIGger:MAIn:HOLDOff:VALue",
            &Number(
                |i, _| &mut i.panel.trigger.holdoff,
                |i, _, time| limits::within(time, i.model.limits.holdoff),
            ),
            "seconds after a trigger without another",
        ),
        CommandRow::acts("TRIGger:MAIn:EDGE", &GroupQuery(Parts::Below), "the edge trigger"),
        CommandRow::acts(
            "TRIGger:MAIn:EDGE:SOUrce",
            &SOURCE,
            "`CH<x>`, `EXT`, `EXT5` (what the bench puts there) or `LINE` (the mains)",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:EDGE:COUPling",
            &WordSetting(|i, _| &mut i.panel.trigger.coupling),
            "`DC`, `AC`, `HFRej`, `LFRej` or `NOISErej`",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:EDGE:SLOpe",
            &WordSetting(|i, _| &mut i.panel.trigger.slope),
            "`RISe` or `FALL`",
        ),
        CommandRow::accepted("TRIGger:MAIn:VIDeo", &GroupQuery(Parts::Below), "the video trigger"),
        CommandRow::acts(
            "TRIGger:MAIn:VIDeo:SOUrce",
            &SOURCE,
            "the same source as the edge trigger's",
        )
        .apart(),
        CommandRow::accepted(
            "TRIGger:MAIn:VIDeo:SYNC",
            &WordSetting(|i, _| &mut i.panel.trigger.video_sync),
            "`FIELD`, `LINE`, `ODD`, `EVEN` or `LINENum`",
        ),
        CommandRow::accepted(
            "TRIGger:MAIn:VIDeo:POLarity",
            &WordSetting(|i, _| &mut i.panel.trigger.video_polarity),
            "`NORMal` or `INVert`",
        ),
        CommandRow::accepted(
            "TRIGger:MAIn:VIDeo:LINE",
            &Both(set_line, line),
            "number of the line",
        ),
        CommandRow::accepted(
            "TRIGger:MAIn:VIDeo:STANdard",
            &WordSetting(|i, _| &mut i.panel.trigger.video_standard),
            "`NTSC` or `PAL`",
        ),
        CommandRow::acts("TRIGger:MAIn:PULse", &GroupQuery(Parts::Below), "the pulse trigger"),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:SOUrce",
            &SOURCE,
            "the same source as the edge trigger's",
        )
        .apart(),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:WIDth",
            &GroupQuery(Parts::Below),
            "which pulses trigger",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:WIDth:POLarity",
            &WordSetting(|i, _| &mut i.panel.trigger.pulse_polarity),
            "`POSITIVe` or `NEGAtive`",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:WIDth:WHEN",
            &WordSetting(|i, _| &mut i.panel.trigger.pulse_when),
            "`EQual`, `NOTEqual`, `INside` or `OUTside`",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:PULse:WIDth:WIDth",
            &Number(
                |i, _| &mut i.panel.trigger.pulse_width,
                |i, _, width| limits::within(width, i.model.limits.pulse_width),
            ),
            "seconds, 33 ns to 10 s",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:LEVel",
            &Both(set_trigger_level, |at| {
                Ok(ReplyValue::Number(at.instrument.panel.trigger.level))
            }),
            "volts; the mains have no level (event 221)",
        ),
        CommandRow::acts(
            "TRIGger:MAIn:FREQuency",
            &Query(frequency),
            "frequency of the source, six digits",
        )
        .apart(),
    ],
};

const SOURCE: WordSetting<TriggerSource> = WordSetting(|i, _| &mut i.panel.trigger.source);

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

fn set_line(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.instrument.panel.trigger.video_line = whole(arguments, 1, LINES)?;
    Ok(())
}

fn line(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    Ok(ReplyValue::Integer(i64::from(at.instrument.panel.trigger.video_line)))
}

fn frequency(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    let number = at.instrument.panel.trigger.source.channel();
    let record = number.and_then(|n| at.instrument.waveform(Source::Channel(n)).ok());
    let found = record.and_then(|record| measure(MeasurementType::Frequency, &record).ok());
    Ok(ReplyValue::Number(found.map_or(INVALID, |value| limits::rounded(value, 6))))
}
