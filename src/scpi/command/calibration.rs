//! Calibration and diagnostic. The virtual instrument needs neither; everything has passed.

use crate::scpi::argument::none;
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Command, Context, Query, Stop};
use crate::scpi::value::Value;

/// The group.
pub const GROUP: Group = Group {
    title: "Calibration and diagnostic",
    rows: &[
        Row::accepted("*CAL", &Query(|_| Ok(Value::Integer(0))), "0: passed"),
        Row::accepted("*TST", &Query(|_| Ok(Value::Integer(0))), "0: passed"),
        Row::accepted("CALibrate:ABOrt", &Command(nothing), "nothing to abort"),
        Row::accepted("CALibrate:CONTINUE", &Command(nothing), "nothing to go on with"),
        Row::accepted("CALibrate:INTERNAL", &Command(nothing), "nothing to calibrate"),
        Row::accepted("CALibrate:STATUS", &Query(|_| Ok(Value::Word("PASS"))), "`PASS`"),
        Row::accepted("DIAg:RESUlt:FLAg", &Query(|_| Ok(Value::Word("PASS"))), "`PASS`"),
        Row::accepted(
            "DIAg:RESUlt:LOG",
            &Query(|_| Ok(Value::Text("No errors recorded.".to_owned()))),
            "the self test's log",
        ),
        Row::accepted(
            "ERRLOG:FIRST",
            &Query(|_| Ok(Value::Text(String::new()))),
            "the error log is empty",
        ),
        Row::accepted(
            "ERRLOG:NEXT",
            &Query(|_| Ok(Value::Text(String::new()))),
            "the error log is empty",
        ),
    ],
};

fn nothing(_: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    Ok(none(arguments)?)
}
