//! Calibration and diagnostic. The virtual instrument needs neither; everything has passed.

use crate::scpi::argument::none;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Command, Context, Query, Stop};
use crate::scpi::value::ReplyValue;

/// The group.
pub const GROUP: Group = Group {
    title: "Calibration and diagnostic",
    rows: &[
        CommandRow::accepted("*CAL", &Query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        CommandRow::accepted("*TST", &Query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        CommandRow::accepted("CALibrate:ABOrt", &Command(nothing), "nothing to abort"),
        CommandRow::accepted("CALibrate:CONTINUE", &Command(nothing), "nothing to go on with"),
        CommandRow::accepted("CALibrate:FACtory", &Command(nothing), "nothing to calibrate"),
        CommandRow::accepted("CALibrate:INTERNAL", &Command(nothing), "nothing to calibrate"),
        CommandRow::accepted(
            "CALibrate:STATUS",
            &Query(|_| Ok(ReplyValue::Word("PASS"))),
            "`PASS`",
        ),
        CommandRow::accepted(
            "DIAg:RESUlt:FLAg",
            &Query(|_| Ok(ReplyValue::Word("PASS"))),
            "`PASS`",
        ),
        CommandRow::accepted(
            "DIAg:RESUlt:LOG",
            &Query(|_| Ok(ReplyValue::Text("No errors recorded.".to_owned()))),
            "the self test's log",
        ),
        CommandRow::accepted(
            "ERRLOG:FIRST",
            &Query(|_| Ok(ReplyValue::Text(String::new()))),
            "the error log is empty",
        ),
        CommandRow::accepted(
            "ERRLOG:NEXT",
            &Query(|_| Ok(ReplyValue::Text(String::new()))),
            "the error log is empty",
        ),
    ],
};

fn nothing(_: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    Ok(none(arguments)?)
}
