//! RS-232: `RS232`. The line itself is gone; the terminator acts on the connection that sets it.

use crate::instrument::word::Word as _;
use crate::scpi::argument::{flag, real, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Both, Context, GroupQuery, Parts, Stop};
use crate::scpi::value::ReplyValue;

/// The group.
pub const GROUP: Group = Group {
    title: "RS-232",
    rows: &[
        CommandRow::acts("RS232", &GroupQuery(Parts::Below), "all settings of the line"),
        CommandRow::accepted(
            "RS232:BAUd",
            &Both(
                |_, a| {
                    real(a)?;
                    Ok(())
                },
                |_| Ok(ReplyValue::Integer(9600)),
            ),
            "always 9600",
        ),
        CommandRow::accepted(
            "RS232:HARDFlagging",
            &Both(ignore_flag, |_| Ok(ReplyValue::Word("ON"))),
            "always `ON`",
        ),
        CommandRow::accepted(
            "RS232:SOFTFlagging",
            &Both(ignore_flag, |_| Ok(ReplyValue::Word("OFF"))),
            "always `OFF`",
        ),
        CommandRow::accepted(
            "RS232:PARity",
            &Both(|_, _| Ok(()), |_| Ok(ReplyValue::Word("NONe"))),
            "always `NONe`",
        ),
        CommandRow::acts(
            "RS232:TRANsmit:TERMinator",
            &Both(set_terminator, |at| Ok(ReplyValue::Word(at.preferences.terminator.word()))),
            "end of this connection's replies: `CR`, `LF`, `CRLf` or `LFCr`",
        ),
    ],
};

fn ignore_flag(_: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    flag(arguments)?;
    Ok(())
}

fn set_terminator(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    at.preferences.terminator = word(arguments)?;
    Ok(())
}
