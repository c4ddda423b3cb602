//! The bench behind the instrument: `BENCh`. No real oscilloscope has these commands.

use crate::instrument::{BenchAccess, Event};
use crate::scpi::message::Argument;
use crate::scpi::table::Setting::{Both, Query};
use crate::scpi::table::{Context, Deferred, Group, Parts, Setting, own};
use crate::scpi::value;
use crate::scpi::value::{ReplyValue, flag, none, only, real};
use crate::trace::Trace;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "The bench behind the instrument (not Tektronix's)",
    rows: &[
        own("BENCh", Setting::Group(Parts::Below), "all of this"),
        own(
            "BENCh:IMPact",
            Both(strike, |c| Ok(ReplyValue::integer(c.instrument.bench.impacts))),
            "strikes the chain as soon as the part of the record before the trigger is full; the query counts impacts",
        ),
        own("BENCh:STRIker", Setting::Group(Parts::Below), "mass and speed of the striker"),
        own(
            "BENCh:STRIker:MASS",
            Both(set_striker_mass, |c| number(c, c.instrument.bench.scene.striker_mass)),
            "mass of the striker in kg, 1E-5 to 0.1",
        ),
        own(
            "BENCh:STRIker:SPEed",
            Both(set_striker_speed, |c| number(c, c.instrument.bench.scene.striker_speed)),
            "speed of the striker in m/s, 1E-3 to 10, around which a scene may spread it",
        ),
        own(
            "BENCh:MAGNet:FORCe",
            Both(set_magnet_force, |c| number(c, c.instrument.bench.scene.magnet_force)),
            "force of the magnet in N, 0 to 100",
        ),
        own(
            "BENCh:SCENe",
            Both(set_scene, |c| {
                present(c)?;
                Ok(ReplyValue::Text(c.instrument.bench.scene.name.clone()))
            }),
            "the scene that the bench is set up as: one that ships with the program, or the one that is served; the front panel stays as it is",
        ),
        own(
            "BENCh:CH<x>:FINe",
            Both(set_fine, |c| {
                let fine = c.instrument.panel.channel(c.suffix.number).fine;
                Ok(ReplyValue::on_or_off(fine))
            }),
            "Volts/Div of a channel's menu: `ON` is fine, and `CH<x>:SCAle` takes what stands between the steps; `OFF` is coarse",
        )
        .apart(),
        own(
            "BENCh:FAUlt",
            Both(set_fault, |c| {
                present(c)?;
                Ok(ReplyValue::Text(c.instrument.bench.faults.text()))
            }),
            "adds a fault, e.g. `\"late=500ms\"` (`hertzscope serve --help` lists them); `\"none\"` ends all",
        )
        .apart(),
        own(
            "BENCh:CH<x>:FORCe",
            Query(forces),
            "true force at the channel's sensor in the last impact: a block of 64-bit numbers in N, least significant byte first; none without a sensor or an impact",
        )
        .apart(),
        own(
            "BENCh:CH<x>:FORCe:TIMe",
            Query(force_times),
            "of these forces: time of the first, after the trigger or, without one, the striker's first contact, and interval, in s",
        )
        .apart(),
    ],
};

/// Whether there is a bench at all.
fn present(context: &Context<'_>) -> Result<(), Event> {
    if context.instrument.bench.scenes.is_empty() { Err(Event::HardwareMissing) } else { Ok(()) }
}

fn number(context: &Context<'_>, setting: Option<f64>) -> Result<ReplyValue, Deferred> {
    present(context)?;
    Ok(ReplyValue::Number(setting.ok_or(Event::SettingsConflict)?))
}

/// Whether clients may change the bench.
fn changeable(context: &Context<'_>) -> Result<(), Event> {
    present(context)?;
    match context.instrument.bench.access {
        BenchAccess::Full | BenchAccess::NoFaults => Ok(()),
        BenchAccess::ReadOnly => Err(Event::HardwareMissing),
    }
}

/// The result of a setting that this bench may not have.
fn set(is_there: bool) -> Result<(), Deferred> {
    if is_there { Ok(()) } else { Err(Event::SettingsConflict.into()) }
}

fn strike(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    none(arguments)?;
    changeable(context)?;
    context.instrument.bench.ask_for_impact();
    Ok(())
}

fn set_striker_mass(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    changeable(context)?;
    set(context.instrument.bench.set_striker_mass(real(arguments)?))
}

fn set_striker_speed(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    changeable(context)?;
    set(context.instrument.bench.set_striker_speed(real(arguments)?))
}

fn set_magnet_force(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    changeable(context)?;
    set(context.instrument.bench.set_magnet_force(real(arguments)?))
}

fn set_fine(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let fine = flag(arguments)?;
    let model = &context.instrument.model;
    let channel = context.instrument.panel.channel_mut(context.suffix.number);
    channel.fine = fine;
    channel.turn_scale(model, channel.vertical.scale);
    Ok(())
}

fn set_scene(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let name = match only(arguments)? {
        Argument::Word(name) | Argument::Text(name) => name,
        Argument::Block(_) => return Err(Event::DataType.into()),
    };
    changeable(context)?;
    if context.instrument.bench.set_scene(name) {
        Ok(())
    } else {
        Err(Event::IllegalParameter.into())
    }
}

fn set_fault(context: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Deferred> {
    let (Argument::Word(text) | Argument::Text(text)) = only(arguments)? else {
        return Err(Event::DataType.into());
    };
    changeable(context)?;
    if context.instrument.bench.access == BenchAccess::NoFaults {
        return Err(Event::HardwareMissing.into());
    }
    let faults = &mut context.instrument.bench.faults;
    if text.eq_ignore_ascii_case("none") {
        faults.clear();
    } else {
        faults.add(text.parse().map_err(|_| Event::IllegalParameter)?);
    }
    Ok(())
}

/// The true force of the channel that is asked for, if it has a sensor and there was an impact.
fn true_force<'a>(context: &'a Context<'_>) -> Option<&'a Trace> {
    let channel = usize::from(context.suffix.number).checked_sub(1)?;
    context.instrument.bench.forces.get(channel)?.as_ref()
}

fn forces(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    present(context)?;
    let values = true_force(context).map(|force| force.values.as_slice()).unwrap_or_default();
    let bytes: Vec<u8> = values.iter().flat_map(|newtons| newtons.to_le_bytes()).collect();
    Ok(ReplyValue::block(&bytes))
}

fn force_times(context: &mut Context<'_>) -> Result<ReplyValue, Deferred> {
    present(context)?;
    let zero = context.instrument.bench.triggered_at.unwrap_or(0.0);
    let times =
        true_force(context).map_or((0.0, 0.0), |force| (force.start - zero, force.interval));
    let (start, interval) = (value::setting(times.0), value::setting(times.1));
    Ok(ReplyValue::Plain(format!("{start},{interval}")))
}
