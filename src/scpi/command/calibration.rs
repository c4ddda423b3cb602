//! Calibration and diagnostic. The virtual instrument needs neither; everything has passed.

use crate::scpi::argument::none;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Stop, command, query};
use crate::scpi::value::ReplyValue;

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Calibration and diagnostic",
    rows: &[
        CommandRow::accepted("*CAL", query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        CommandRow::accepted("*TST", query(|_| Ok(ReplyValue::Integer(0))), "0: passed"),
        CommandRow::accepted("CALibrate:ABOrt", command(nothing), "nothing to abort"),
        CommandRow::accepted("CALibrate:CONTINUE", command(nothing), "nothing to go on with"),
        CommandRow::accepted("CALibrate:FACtory", command(nothing), "nothing to calibrate"),
        CommandRow::accepted("CALibrate:INTERNAL", command(nothing), "nothing to calibrate"),
        CommandRow::accepted("CALibrate:STATUS", query(|_| Ok(ReplyValue::Word("PASS"))), "`PASS`"),
        CommandRow::accepted("DIAg:RESUlt:FLAg", query(|_| Ok(ReplyValue::Word("PASS"))), "`PASS`"),
        CommandRow::accepted("DIAg:RESUlt:LOG", query(|_| Ok(ReplyValue::Text("No errors recorded.".to_owned()))), "the self test's log"),
        CommandRow::accepted("ERRLOG:FIRST", query(|_| Ok(ReplyValue::Text(String::new()))), "the error log is empty"),
        CommandRow::accepted("ERRLOG:NEXT", query(|_| Ok(ReplyValue::Text(String::new()))), "the error log is empty"),
    ],
};

fn nothing(_: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    Ok(none(arguments)?)
}
