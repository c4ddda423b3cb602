//! RS-232: `RS232`. There is no serial line; its settings are kept, and the terminator acts on the
//! connection that sets it.

use crate::scope::model::nearest;
use crate::scpi::argument::{flag, real};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, both, group, word};
use crate::scpi::value::ReplyValue;

/// Speeds of the line (baud).
const SPEEDS: [u32; 7] = [300, 600, 1200, 2400, 4800, 9600, 19200];

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "RS-232",
    rows: &[
        CommandRow::acts("RS232", group(Parts::Below), "all settings of the line"),
        CommandRow::accepted(
            "RS232:BAUd",
            both(set_speed, |at| Ok(ReplyValue::integer(at.instrument.service.baud))),
            "300, 600, 1200, 2400, 4800, 9600 or 19200",
        ),
        CommandRow::accepted(
            "RS232:HARDFlagging",
            both(set_hard_flagging, |at| {
                Ok(ReplyValue::on_or_off(at.instrument.service.hard_flagging))
            }),
            "`ON` or `OFF`; `ON` turns the other one off",
        ),
        CommandRow::accepted(
            "RS232:SOFTFlagging",
            both(set_soft_flagging, |at| {
                Ok(ReplyValue::on_or_off(at.instrument.service.soft_flagging))
            }),
            "`ON` or `OFF`; `ON` turns the other one off",
        ),
        CommandRow::accepted("RS232:PARity", word!(|at| at.instrument.service.parity), "`EVEN`, `ODD` or `NONe`"),
        CommandRow::acts("RS232:TRANsmit:TERMinator", word!(|at| at.preferences.terminator), "end of this connection's replies: `CR`, `LF`, `CRLf` or `LFCr`"),
    ],
};

fn set_speed(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let choices = SPEEDS.map(f64::from);
    let speed = nearest(real(arguments)?, &choices);
    let known = SPEEDS.iter().zip(choices).find(|(_, choice)| (choice - speed).abs() < 0.5);
    if let Some((speed, _)) = known {
        at.instrument.service.baud = *speed;
    }
    Ok(())
}

fn set_hard_flagging(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let on = flag(arguments)?;
    let service = &mut at.instrument.service;
    service.hard_flagging = on;
    service.soft_flagging &= !on;
    Ok(())
}

fn set_soft_flagging(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    let on = flag(arguments)?;
    let service = &mut at.instrument.service;
    service.soft_flagging = on;
    service.hard_flagging &= !on;
    Ok(())
}
