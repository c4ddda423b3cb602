//! Settings of the front panel: acquisition, cursors, display, time base, math, measurements,
//! trigger, channels.
//!
//! A row here is a setting of [`crate::scope::Panel`], whose limits hold after every command. A
//! measurement without result answers 9.9E37 and reports why: 2225 for a waveform that is not
//! displayed, 2202 for a record without a full cycle, 2231 for a measurement that measures nothing,
//! 221 in scan mode and in XY, where nothing is measured.

use crate::instrument::Event;
use crate::instrument::measure::{INVALID, measure, unit};
use crate::scope::limits::{self, rounded};
use crate::scope::model::nearest;
use crate::scope::panel::{
    BarUnits, CursorFunction, DisplayFormat, MathFunction, Measurement, MeasurementType,
};
use crate::scope::word::{Word as _, words};
use crate::scope::{Coupling, Source, TriggerSource};
use crate::scpi::message::Argument;
use crate::scpi::table::Setting::{Both, Command, GroupAndCommand, Number, Query, StoredInSetup};
use crate::scpi::table::{
    Context, Deferred, Group, Parts, Setting, Slot, Stored, Suffix, acts, alias, stub,
};
use crate::scpi::value::{ReplyValue, flag, none, real, text, whole, word};

words! {
    /// Argument of `ACQuire:STATE`.
    RunStop {
        /// Start.
        On = "ON",
        /// Stop.
        Off = "OFF",
        /// Start.
        Run = "RUN",
        /// Stop.
        Stop = "STOP",
    }

    /// Persistence that is not a time.
    Persistence {
        /// For good.
        Infinite = "INFinite",
        /// None.
        Off = "OFF",
    }

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

/// Persistences (s).
const PERSISTENCES: [f64; 4] = [0.0, 1.0, 2.0, 5.0];
/// Horizontal zooms of a spectrum (1).
const HORIZONTAL_ZOOMS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];
/// Vertical zooms of a spectrum (1).
const VERTICAL_ZOOMS: [f64; 5] = [0.5, 1.0, 2.0, 5.0, 10.0];
/// Farthest vertical position of a spectrum (div).
const MAX_SPECTRUM_POSITION: f64 = 100.0;
/// Lines of a field of PAL, the standard with more.
const VIDEO_LINES: u32 = 625;

const BELOW: Setting = Setting::Group(Parts::Below);

const fn of(headers: &'static [&'static str]) -> Setting {
    Setting::Group(Parts::Of(headers))
}

/// `ACQuire`.
#[rustfmt::skip]
pub const ACQUISITION: Group = Group {
    title: "Acquisition",
    rows: &[
        acts("ACQuire", BELOW, "all settings of the acquisition"),
        acts("ACQuire:STOPAfter", Setting::Slot(|c| Slot::Word(&mut c.panel().stop_after)), "`RUNSTop` or `SEQuence`"),
        acts("ACQuire:STATE", Both(set_state, |c| Ok(ReplyValue::flag(c.instrument.is_running()))), "`ON`, `OFF`, `RUN`, `STOP` or a number"),
        acts("ACQuire:MODe", Setting::Slot(|c| Slot::Word(&mut c.panel().acquire.mode)), "`SAMple`, `PEAKdetect` or `AVErage`"),
        acts("ACQuire:NUMAVg", Both(set_averages, |c| Ok(ReplyValue::integer(c.panel().acquire.averages))), "4, 16, 64 or 128 records"),
        acts("ACQuire:NUMACq", Query(|c| Ok(ReplyValue::integer(c.instrument.acquisitions()))), "records taken since the start, 0 in scan mode").apart(),
    ],
};

fn set_state(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let run = match real(arguments) {
        Ok(value) => value.round().abs() > 0.0,
        Err(_) => matches!(word(arguments)?, RunStop::On | RunStop::Run),
    };
    if run {
        context.instrument.run();
    } else {
        context.instrument.stop();
    }
    Ok(())
}

fn set_averages(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let typed = whole(arguments, 1, 1000)?;
    let averages = &context.instrument.model.limits.averages;
    let nearest = averages.iter().min_by_key(|number| number.abs_diff(typed)).copied();
    context.panel().acquire.averages = nearest.unwrap_or(typed);
    Ok(())
}

/// `CURSor`.
#[rustfmt::skip]
pub const CURSOR: Group = Group {
    title: "Cursor",
    rows: &[
        acts("CURSor", of(&["CURSor:FUNCtion", "CURSor:SELect:SOUrce", "CURSor:VBArs", "CURSor:HBArs"]), "all settings of the cursors"),
        acts("CURSor:FUNCtion", Both(set_cursor, |c| Ok(ReplyValue::Word(c.panel().cursor.function.word()))), "`OFF`, `HBArs` or `VBArs`; none in XY (event 221)"),
        acts("CURSor:SELect:SOUrce", Setting::Slot(|c| Slot::Word(&mut c.panel().cursor.source)), "the waveform"),
        alias("CURSor:SELect", "CURSor:SELect:SOUrce"),
        acts(
            "CURSor:VBArs",
            of(&["CURSor:VBArs:UNIts", "CURSor:VBArs:DELTa", "CURSor:VBArs:POSITION1", "CURSor:VBArs:POSITION2"]),
            "the vertical bars",
        ),
        acts("CURSor:VBArs:UNIts", Setting::Slot(|c| Slot::Word(&mut c.panel().cursor.vertical_units)), "`SECOnds` or `HERtz`"),
        acts("CURSor:VBArs:DELTa", Query(vertical_delta), "their distance").apart(),
        acts("CURSor:VBArs:POSITION<x>", Number(vertical_bar, |_, _, time| rounded(time, 7)), "seconds after the trigger").apart(),
        acts(
            "CURSor:HBArs",
            of(&["CURSor:HBArs:UNIts", "CURSor:HBArs:DELTa", "CURSor:HBArs:POSITION1", "CURSor:HBArs:POSITION2"]),
            "the horizontal bars",
        ),
        acts("CURSor:HBArs:UNIts", Query(|_| Ok(ReplyValue::Word("VOLts"))), "always volts").apart(),
        acts("CURSor:HBArs:DELTa", Query(horizontal_delta), "their distance").apart(),
        acts("CURSor:HBArs:POSITION<x>", Number(horizontal_bar, |_, _, volts| rounded(volts, 7)), "volts").apart(),
    ],
};

fn set_cursor(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let function = word(arguments)?;
    let panel = context.panel();
    if function != CursorFunction::Off && panel.display.format == DisplayFormat::Xy {
        return Err(Event::SettingsConflict.into());
    }
    panel.cursor.function = function;
    Ok(())
}

fn vertical_bar<'c>(context: &'c mut Context<'_>) -> &'c mut f64 {
    let second = context.suffix.number == 2;
    let [one, two] = &mut context.panel().cursor.vertical;
    if second { two } else { one }
}

fn horizontal_bar<'c>(context: &'c mut Context<'_>) -> &'c mut f64 {
    let second = context.suffix.number == 2;
    let [one, two] = &mut context.panel().cursor.horizontal;
    if second { two } else { one }
}

fn vertical_delta(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let cursor = &context.panel().cursor;
    let [first, second] = cursor.vertical;
    let distance = (second - first).abs();
    Ok(ReplyValue::Number(match cursor.vertical_units {
        BarUnits::Seconds => distance,
        BarUnits::Hertz if distance > 0.0 => 1.0 / distance,
        BarUnits::Hertz => INVALID,
    }))
}

fn horizontal_delta(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let [first, second] = context.panel().cursor.horizontal;
    Ok(ReplyValue::Number((second - first).abs()))
}

/// `DISplay`. Format and style show in the picture that `HARDCopy` sends.
#[rustfmt::skip]
pub const DISPLAY: Group = Group {
    title: "Display",
    rows: &[
        stub("DISplay", BELOW, "all settings of the screen"),
        stub("DISplay:CONTRast", Setting::Stored(Stored::Whole((1, 100), 50)), "1 to 100"),
        acts("DISplay:FORMat", Setting::Slot(|c| Slot::Word(&mut c.panel().display.format)), "`YT` or `XY`"),
        acts("DISplay:STYle", Setting::Slot(|c| Slot::Word(&mut c.panel().display.style)), "`DOTs` or `VECtors`"),
        stub("DISplay:PERSistence", Both(set_persistence, persistence), "`OFF`, 1, 2, 5 (seconds) or `INFinite`"),
        stub("DISplay:INVert", StoredInSetup(Stored::Switch), "`ON` or `OFF`; pictures follow `HARDCopy:INKSaver`").apart(),
    ],
};

fn set_persistence(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let distance = |typed: f64, choice: f64| (typed - choice).abs();
    let nearest = |typed: f64| {
        let choices = PERSISTENCES.iter().copied();
        choices.min_by(|a, b| distance(typed, *a).total_cmp(&distance(typed, *b))).unwrap_or(0.0)
    };
    context.panel().display.persistence = match real(arguments) {
        Ok(seconds) => nearest(seconds),
        Err(_) => match word(arguments)? {
            Persistence::Infinite => f64::INFINITY,
            Persistence::Off => 0.0,
        },
    };
    Ok(())
}

fn persistence(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let seconds = context.panel().display.persistence;
    Ok(if seconds.is_finite() {
        ReplyValue::Plain(format!("{seconds}"))
    } else {
        ReplyValue::Word("INFinite")
    })
}

const SCALE: Setting = Both(set_time_base, |c| Ok(ReplyValue::Number(c.panel().horizontal.scale)));
const POSITION: Setting = Number(
    |c| &mut c.panel().horizontal.position,
    |instrument, _, position| {
        let scale = instrument.panel.horizontal.scale;
        limits::horizontal_position(&instrument.model, position, scale)
    },
);
const DELAY_SCALE: Setting = Number(
    |c| &mut c.panel().horizontal.delay_scale,
    |instrument, _, scale| limits::time_base(&instrument.model, scale),
);
const DELAY_POSITION: Setting = Number(
    |c| &mut c.panel().horizontal.delay_position,
    |instrument, _, position| {
        let scale = instrument.panel.horizontal.delay_scale;
        limits::horizontal_position(&instrument.model, position, scale)
    },
);

/// `HORizontal`.
#[rustfmt::skip]
pub const HORIZONTAL: Group = Group {
    title: "Horizontal",
    rows: &[
        acts("HORizontal", BELOW, "all settings of the time base"),
        acts("HORizontal:VIEw", Setting::Slot(|c| Slot::Word(&mut c.panel().horizontal.view)), "`MAIn`, `WINDOW` (records are those of the window) or `ZONE`"),
        acts("HORizontal:RECOrdlength", Query(|c| Ok(ReplyValue::Plain(c.instrument.model.record_length.to_string()))), "points in a record"),
        acts("HORizontal:MAIn", BELOW, "the main time base"),
        acts("HORizontal:MAIn:SCAle", SCALE, "s/div, the nearest step of 1-2.5-5"),
        acts("HORizontal:MAIn:POSition", POSITION, "the screen's centre after the trigger, in seconds"),
        alias("HORizontal:MAIn:SECdiv", "HORizontal:MAIn:SCAle"),
        acts("HORizontal:DELay", BELOW, "the window's time base"),
        acts("HORizontal:DELay:SCAle", DELAY_SCALE, "s/div of the window"),
        acts("HORizontal:DELay:POSition", DELAY_POSITION, "the window's centre after the trigger, in seconds"),
        alias("HORizontal:DELay:SECdiv", "HORizontal:DELay:SCAle"),
        acts("HORizontal:SCAle", SCALE, "the main time base").apart(),
        alias("HORizontal:SECdiv", "HORizontal:SCAle"),
        acts("HORizontal:POSition", POSITION, "the main position").apart(),
    ],
};

fn set_time_base(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let model = &context.instrument.model;
    let scale = limits::time_base(model, real(arguments)?);
    let horizontal = &mut context.instrument.panel.horizontal;
    horizontal.scale = scale;
    // The position keeps to the steps of the new time base.
    horizontal.position = limits::horizontal_position(model, horizontal.position, scale);
    Ok(())
}

/// `MATH`.
#[rustfmt::skip]
pub const MATH: Group = Group {
    title: "Math",
    rows: &[
        acts("MATH", BELOW, "all settings of the math trace"),
        acts("MATH:DEFINE", Both(define, |c| Ok(ReplyValue::Text(c.panel().math.function.definition()))), "e.g. `\"CH1 - CH2\"` or `\"FFT(CH1,HANNING)\"`"),
        acts("MATH:FFT", BELOW, "how the screen shows a spectrum"),
        acts(
            "MATH:FFT:HORizontal:POSition",
            Number(|c| &mut c.panel().math.fft_horizontal_position, |_, _, percent| percent.clamp(0.0, 100.0)),
            "percent of the spectrum in the screen's centre",
        ),
        acts(
            "MATH:FFT:HORizontal:SCAle",
            Number(|c| &mut c.panel().math.fft_horizontal_scale, |_, _, zoom| nearest(zoom, &HORIZONTAL_ZOOMS)),
            "zoom 1, 2, 5 or 10",
        ),
        acts(
            "MATH:FFT:VERtical:POSition",
            Number(|c| &mut c.panel().math.fft_vertical_position, |_, _, divisions| divisions.clamp(-MAX_SPECTRUM_POSITION, MAX_SPECTRUM_POSITION)),
            "divisions",
        ),
        acts(
            "MATH:FFT:VERtical:SCAle",
            Number(|c| &mut c.panel().math.fft_vertical_scale, |_, _, zoom| nearest(zoom, &VERTICAL_ZOOMS)),
            "zoom 0.5, 1, 2, 5 or 10",
        ),
    ],
};

fn define(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let function = MathFunction::parse(text(arguments)?, context.instrument.model.channels);
    context.panel().math.function = function.ok_or(Event::InvalidMath)?;
    Ok(())
}

/// `MEASUrement`.
#[rustfmt::skip]
pub const MEASUREMENT: Group = Group {
    title: "Measurement",
    rows: &[
        acts(
            "MEASUrement",
            of(&["MEASUrement:MEAS1", "MEASUrement:MEAS2", "MEASUrement:MEAS3", "MEASUrement:MEAS4", "MEASUrement:MEAS5"]),
            "the measurements on the screen",
        ),
        acts("MEASUrement:IMMed", BELOW, "the measurement of the remote interface"),
        acts("MEASUrement:IMMed:TYPe", Both(set_immediate, |c| Ok(ReplyValue::Word(c.panel().immediate.kind.word()))), "what is measured"),
        acts("MEASUrement:IMMed:UNIts", Query(|c| Ok(units(c.panel().immediate))), "unit of the result"),
        acts("MEASUrement:IMMed:SOUrce1", Setting::Slot(|c| Slot::Word(&mut c.panel().immediate.source)), "the waveform"),
        alias("MEASUrement:IMMed:SOU1", "MEASUrement:IMMed:SOUrce1"),
        acts("MEASUrement:IMMed:VALue", Query(|c| { let m = c.panel().immediate; Ok(measured(c, m)) }), "the result, 9.9E37 if there is none").apart(),
        acts("MEASUrement:MEAS<x>", BELOW, "one of the five on the screen"),
        acts("MEASUrement:MEAS<x>:TYPe", Setting::Slot(|c| Slot::Word(&mut c.measurement().kind)), "what is measured, or `NONe`"),
        acts("MEASUrement:MEAS<x>:UNIts", Query(|c| Ok(units(*c.measurement()))), "unit of the result").apart(),
        acts("MEASUrement:MEAS<x>:SOUrce", Setting::Slot(|c| Slot::Word(&mut c.measurement().source)), "the waveform"),
        acts("MEASUrement:MEAS<x>:VALue", Query(|c| { let m = *c.measurement(); Ok(measured(c, m)) }), "the result, 9.9E37 if there is none").apart(),
    ],
};

fn set_immediate(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let kind = word(arguments)?;
    if kind == MeasurementType::None {
        return Err(Event::IllegalParameter.into());
    }
    context.panel().immediate.kind = kind;
    Ok(())
}

fn units(measurement: Measurement) -> ReplyValue {
    ReplyValue::Text(unit(measurement.kind).to_owned())
}

fn measured(context: &mut Context<'_>, measurement: Measurement) -> ReplyValue {
    let instrument = &mut *context.instrument;
    let result = if measurement.kind == MeasurementType::None {
        Err(Event::NoMeasurementType)
    } else if instrument.measures_nothing() {
        Err(Event::SettingsConflict)
    } else {
        let record = instrument.waveform(measurement.source);
        record.map_err(|_| Event::NoWaveform).and_then(|record| measure(measurement.kind, &record))
    };
    match result {
        Ok(value) => ReplyValue::Measurement(value),
        Err(event) => {
            instrument.status.report(event);
            ReplyValue::Number(INVALID)
        }
    }
}

const SOURCE: Setting = Setting::Slot(|c| Slot::Word(&mut c.panel().trigger.source));

/// `TRIGger` and `*TRG`.
#[rustfmt::skip]
pub const TRIGGER: Group = Group {
    title: "Trigger",
    rows: &[
        acts("*TRG", Command(device_trigger), "executes what `*DDT` says; where that is empty, triggers, if the scope is ready"),
        acts("TRIGger", GroupAndCommand(Parts::Below, force), "`FORCe` triggers, if the scope is ready"),
        acts("TRIGger:STATE", Query(|c| Ok(ReplyValue::Word(c.instrument.state().word()))), "what the acquisition is doing").apart(),
        acts("TRIGger:MAIn", GroupAndCommand(Parts::Below, set_level), "`SETLevel` puts the level at half height; event 221 where the scope is stopped, or at the mains"),
        acts("TRIGger:MAIn:MODe", Setting::Slot(|c| Slot::Word(&mut c.panel().trigger.mode)), "`AUTO` or `NORMal`"),
        acts("TRIGger:MAIn:TYPe", Setting::Slot(|c| Slot::Word(&mut c.panel().trigger_type)), "`EDGE`, `VIDeo` or `PULse`; no input carries video"),
        acts("TRIGger:MAIn:HOLDOff", BELOW, "holdoff"),
        acts(
            "TRIGger:MAIn:HOLDOff:VALue",
            Number(|c| &mut c.panel().trigger.holdoff, |i, _, time| limits::within(time, i.model.limits.holdoff)),
            "seconds after a trigger without another",
        ),
        acts("TRIGger:MAIn:EDGE", BELOW, "the edge trigger"),
        acts("TRIGger:MAIn:EDGE:SOUrce", SOURCE, "`CH<x>`, `EXT`, `EXT5` (what the bench puts there) or `LINE` (the mains)"),
        acts("TRIGger:MAIn:EDGE:COUPling", Setting::Slot(|c| Slot::Word(&mut c.panel().trigger.coupling)), "`DC`, `AC`, `HFRej`, `LFRej` or `NOISErej`"),
        acts("TRIGger:MAIn:EDGE:SLOpe", Setting::Slot(|c| Slot::Word(&mut c.panel().trigger.slope)), "`RISe` or `FALL`"),
        stub("TRIGger:MAIn:VIDeo", BELOW, "the video trigger"),
        acts("TRIGger:MAIn:VIDeo:SOUrce", SOURCE, "the same source as the edge trigger's").apart(),
        stub("TRIGger:MAIn:VIDeo:SYNC", StoredInSetup(Stored::Words(&["FIELD", "LINE", "ODD", "EVEN", "LINENum"])), "`FIELD`, `LINE`, `ODD`, `EVEN` or `LINENum`"),
        stub("TRIGger:MAIn:VIDeo:POLarity", StoredInSetup(Stored::Words(&["NORMal", "INVert"])), "`NORMal` or `INVert`"),
        stub("TRIGger:MAIn:VIDeo:LINE", StoredInSetup(Stored::Whole((1, VIDEO_LINES), 1)), "number of the line"),
        stub("TRIGger:MAIn:VIDeo:STANdard", StoredInSetup(Stored::Words(&["NTSC", "PAL"])), "`NTSC` or `PAL`"),
        acts("TRIGger:MAIn:PULse", BELOW, "the pulse trigger"),
        acts("TRIGger:MAIn:PULse:SOUrce", SOURCE, "the same source as the edge trigger's").apart(),
        acts("TRIGger:MAIn:PULse:WIDth", BELOW, "which pulses trigger"),
        acts("TRIGger:MAIn:PULse:WIDth:POLarity", Setting::Slot(|c| Slot::Word(&mut c.panel().pulse.polarity)), "`POSITIVe` or `NEGAtive`"),
        acts("TRIGger:MAIn:PULse:WIDth:WHEN", Setting::Slot(|c| Slot::Word(&mut c.panel().pulse.when)), "`EQual`, `NOTEqual`, `INside` or `OUTside`"),
        acts(
            "TRIGger:MAIn:PULse:WIDth:WIDth",
            Number(|c| &mut c.panel().pulse.width, |i, _, width| limits::within(width, i.model.limits.pulse_width)),
            "seconds, 33 ns to 10 s",
        ),
        acts("TRIGger:MAIn:LEVel", Both(set_trigger_level, |c| Ok(ReplyValue::Number(c.panel().trigger.level))), "volts; the mains have no level (event 221)"),
        acts("TRIGger:MAIn:FREQuency", Query(frequency), "frequency of the source, six digits").apart(),
    ],
};

fn force(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let Force::Now = word(arguments)?;
    context.instrument.force_trigger();
    Ok(())
}

fn set_level(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let SetLevel::HalfHeight = word(arguments)?;
    Ok(context.instrument.centre_trigger()?)
}

fn device_trigger(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    let commands = &context.instrument.service.device_trigger;
    if !commands.trim().is_empty() {
        return Err(Deferred::Execute(commands.clone()));
    }
    context.instrument.force_trigger();
    Ok(())
}

fn set_trigger_level(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let typed = real(arguments)?;
    let panel = &context.instrument.panel;
    // A set-up that is sent back tells the level as it is.
    let same = (typed - panel.trigger.level).abs() <= f64::EPSILON * typed.abs();
    if panel.trigger.source == TriggerSource::Line && !same {
        return Err(Event::SettingsConflict.into());
    }
    let level = panel.trigger_level(&context.instrument.model, typed);
    context.panel().trigger.level = level;
    Ok(())
}

fn frequency(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    let instrument = &context.instrument;
    let number = instrument.panel.trigger.source.channel();
    let record = number.and_then(|n| instrument.waveform(Source::Channel(n)).ok());
    let found = record.and_then(|record| measure(MeasurementType::Frequency, &record).ok());
    Ok(ReplyValue::Number(found.map_or(INVALID, |value| rounded(value, 6))))
}

const SHOWN: Setting = Setting::Slot(|c| {
    let source = c.suffix.source;
    Slot::Flag(c.panel().displayed_mut(source))
});

/// `CH<x>` and `SELect`.
#[rustfmt::skip]
pub const VERTICAL: Group = Group {
    title: "Vertical",
    rows: &[
        acts("CH<x>", BELOW, "all settings of a channel"),
        acts("CH<x>:PRObe", Both(set_probe, |c| Ok(ReplyValue::Plain(c.channel().vertical.probe.to_string()))), "attenuation 1, 10, 100 or 1000; V/div at the input stays"),
        acts("CH<x>:SCAle", Both(set_scale, |c| Ok(ReplyValue::Number(c.channel().vertical.scale))), "V/div, the nearest step of 1-2-5, or to three digits if `BENCh:CH<x>:FINe` is on"),
        alias("CH<x>:VOLts", "CH<x>:SCAle"),
        acts("CH<x>:POSition", Number(|c| &mut c.channel().vertical.position, vertical_position), "divisions above the centre, in steps of 1/25"),
        acts("CH<x>:COUPling", Setting::Slot(|c| Slot::Word(c.channel().vertical.coupling.get_or_insert(Coupling::Dc))), "`DC`, `AC` or `GND`"),
        acts("CH<x>:BANdwidth", Setting::Slot(|c| Slot::Switch(c.channel().vertical.bandwidth_limited.get_or_insert(false))), "the 20 MHz limiter, `ON` or `OFF`"),
        acts("CH<x>:INVert", Setting::Slot(|c| Slot::Switch(c.channel().vertical.inverted.get_or_insert(false))), "`ON` turns the trace upside down"),
        acts(
            "SELect",
            of(&["SELect:CH1", "SELect:CH2", "SELect:CH3", "SELect:CH4", "SELect:MATH", "SELect:REFA", "SELect:REFB", "SELect:REFC", "SELect:REFD"]),
            "which waveforms are displayed",
        ),
        acts("SELect:CH<x>", SHOWN, "`ON` displays the channel"),
        acts("SELect:MATH", Setting::Slot(|c| Slot::Flag(&mut c.panel().math.displayed)), "`ON` displays the math trace"),
        acts("SELect:REF<x>", Both(show_reference, shows_reference), "`ON` displays the reference memory (event 2244 where it is empty)"),
    ],
};

fn vertical_position(
    instrument: &crate::instrument::Instrument,
    suffix: Suffix,
    position: f64,
) -> f64 {
    let vertical = instrument.panel.channel(suffix.number).vertical;
    limits::vertical_position(&instrument.model, position, vertical.scale, vertical.probe)
}

fn show_reference(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let on = flag(arguments)?;
    let Source::Reference(letter) = context.suffix.source else {
        return Err(Event::NotAReference.into());
    };
    Ok(context.instrument.display_reference(letter, on)?)
}

fn shows_reference(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    Ok(ReplyValue::flag(context.instrument.panel.displays(context.suffix.source)))
}

fn set_probe(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let probe = nearest(real(arguments)?, &context.instrument.model.probes);
    let vertical = &mut context.channel().vertical;
    vertical.scale = rounded(vertical.scale / vertical.probe * probe, 9);
    vertical.probe = probe;
    Ok(())
}

fn set_scale(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let typed = real(arguments)?;
    let model = &context.instrument.model;
    let channel = context.instrument.panel.channel_mut(context.suffix.number);
    channel.turn_scale(model, typed);
    Ok(())
}
