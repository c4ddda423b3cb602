//! The bench behind the instrument: `BENCh`. No real oscilloscope has these commands.

use crate::instrument::Event;
use crate::instrument::limits;
use crate::scpi::argument::{flag, none, only, real};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, query};
use crate::scpi::value;
use crate::scpi::value::ReplyValue;
use crate::trace::Trace;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "The bench behind the instrument (not Tektronix's)",
    rows: &[
        CommandRow::own("BENCh", group(Parts::Below), "all of this"),
        CommandRow::own(
            "BENCh:IMPact",
            both(strike, |at| Ok(ReplyValue::integer(at.instrument.bench.impacts))),
            "strikes the chain as soon as the part of the record before the trigger is full; the query counts impacts",
        ),
        CommandRow::own("BENCh:STRIker", group(Parts::Below), "mass and speed of the striker"),
        CommandRow::own(
            "BENCh:STRIker:MASS",
            both(set_striker_mass, |at| number(at, at.instrument.bench.scene.striker_mass)),
            "mass of the striker in kg, 1E-5 to 0.1",
        ),
        CommandRow::own(
            "BENCh:STRIker:SPEed",
            both(set_striker_speed, |at| number(at, at.instrument.bench.scene.striker_speed)),
            "speed of the striker in m/s, 1E-3 to 10, around which a scene may spread it",
        ),
        CommandRow::own(
            "BENCh:MAGNet:FORCe",
            both(set_magnet_force, |at| number(at, at.instrument.bench.scene.magnet_force)),
            "force of the magnet in N, 0 to 100",
        ),
        CommandRow::own(
            "BENCh:SCENe",
            both(set_scene, |at| {
                present(at)?;
                Ok(ReplyValue::Text(at.instrument.bench.scene.name.clone()))
            }),
            "the scene that the bench is set up as: one that ships with the program, or the one that is served; the front panel stays as it is",
        ),
        CommandRow::own(
            "BENCh:CH<x>:FINe",
            both(set_fine, |at| {
                let fine = at.instrument.panel.channel(at.place.number).fine;
                Ok(ReplyValue::on_or_off(fine))
            }),
            "Volts/Div of a channel's menu: `ON` is fine, and `CH<x>:SCAle` takes what stands between the steps; `OFF` is coarse",
        )
        .apart(),
        CommandRow::own(
            "BENCh:FAUlt",
            both(set_fault, |at| {
                present(at)?;
                Ok(ReplyValue::Text(at.instrument.bench.faults.text()))
            }),
            "adds a fault, e.g. `\"late=500ms\"` (`hertzscope serve --help` lists them); `\"none\"` ends all",
        )
        .apart(),
        CommandRow::own(
            "BENCh:CH<x>:FORCe",
            query(forces),
            "true force at the channel's sensor in the last impact: a block of 64-bit numbers in N, least significant byte first; none without a sensor or an impact",
        )
        .apart(),
        CommandRow::own(
            "BENCh:CH<x>:FORCe:TIMe",
            query(force_times),
            "of these forces: time of the first, after the trigger or, without one, the striker's first contact, and interval, in s",
        )
        .apart(),
    ],
};

/// Whether there is a bench at all.
fn present(at: &Context<'_>) -> Result<(), Event> {
    if at.instrument.bench.scenes.is_empty() { Err(Event::HardwareMissing) } else { Ok(()) }
}

fn number(at: &Context<'_>, setting: Option<f64>) -> Result<ReplyValue, Stop> {
    present(at)?;
    Ok(ReplyValue::Number(setting.ok_or(Event::SettingsConflict)?))
}

/// The result of a setting that this bench may not have.
fn set(at: &Context<'_>, is_there: bool) -> Result<(), Stop> {
    present(at)?;
    if is_there { Ok(()) } else { Err(Event::SettingsConflict.into()) }
}

fn strike(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    none(arguments)?;
    present(at)?;
    at.instrument.bench.ask_for_impact();
    Ok(())
}

fn set_striker_mass(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let is_there = at.instrument.bench.set_striker_mass(real(arguments)?);
    set(at, is_there)
}

fn set_striker_speed(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let is_there = at.instrument.bench.set_striker_speed(real(arguments)?);
    set(at, is_there)
}

fn set_magnet_force(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let is_there = at.instrument.bench.set_magnet_force(real(arguments)?);
    set(at, is_there)
}

fn set_fine(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let fine = flag(arguments)?;
    let model = &at.instrument.model;
    let channel = at.instrument.panel.channel_mut(at.place.number);
    channel.fine = fine;
    limits::turn_scale(model, channel, channel.vertical.scale);
    Ok(())
}

fn set_scene(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let name = match only(arguments)? {
        Argument::Word(name) | Argument::Text(name) => name,
        Argument::Block(_) => return Err(Event::DataType.into()),
    };
    present(at)?;
    if at.instrument.bench.set_scene(name) { Ok(()) } else { Err(Event::IllegalParameter.into()) }
}

fn set_fault(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let (Argument::Word(text) | Argument::Text(text)) = only(arguments)? else {
        return Err(Event::DataType.into());
    };
    present(at)?;
    let faults = &mut at.instrument.bench.faults;
    if text.eq_ignore_ascii_case("none") {
        faults.clear();
    } else {
        faults.add(text.parse().map_err(|_| Event::IllegalParameter)?);
    }
    Ok(())
}

/// The true force of the channel that is asked for, if it has a sensor and there was an impact.
fn true_force<'a>(at: &'a Context<'_>) -> Option<&'a Trace> {
    let channel = usize::from(at.place.number).checked_sub(1)?;
    at.instrument.bench.forces.get(channel)?.as_ref()
}

fn forces(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    present(at)?;
    let values = true_force(at).map(|force| force.values.as_slice()).unwrap_or_default();
    let bytes: Vec<u8> = values.iter().flat_map(|newtons| newtons.to_le_bytes()).collect();
    Ok(ReplyValue::block(&bytes))
}

fn force_times(at: &mut Context<'_>) -> Result<ReplyValue, Stop> {
    present(at)?;
    let zero = at.instrument.bench.triggered_at.unwrap_or(0.0);
    let times = true_force(at).map_or((0.0, 0.0), |force| (force.start - zero, force.interval));
    let (start, interval) = (value::setting(times.0), value::setting(times.1));
    Ok(ReplyValue::Plain(format!("{start},{interval}")))
}
