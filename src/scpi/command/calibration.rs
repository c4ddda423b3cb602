//! Calibration and diagnostic. The virtual instrument needs neither; everything has passed.

use crate::scpi::argument::none;
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Asks, At, Does, Stop};
use crate::scpi::value::Value;

/// The group.
pub const GROUP: Group = Group {
    title: "Calibration and diagnostic",
    rows: &[
        Row::accepted("*CAL", &Asks(|_| Ok(Value::Integer(0))), "0: passed"),
        Row::accepted("*TST", &Asks(|_| Ok(Value::Integer(0))), "0: passed"),
        Row::accepted("CALibrate:ABOrt", &Does(nothing), "nothing to abort"),
        Row::accepted("CALibrate:CONTINUE", &Does(nothing), "nothing to go on with"),
        Row::accepted("CALibrate:INTERNAL", &Does(nothing), "nothing to calibrate"),
        Row::accepted("CALibrate:STATUS", &Asks(|_| Ok(Value::Word("PASS"))), "`PASS`"),
        Row::accepted("DIAg:RESUlt:FLAg", &Asks(|_| Ok(Value::Word("PASS"))), "`PASS`"),
        Row::accepted(
            "DIAg:RESUlt:LOG",
            &Asks(|_| Ok(Value::Text("No errors recorded.".to_owned()))),
            "the self test's log",
        ),
        Row::accepted(
            "ERRLOG:FIRST",
            &Asks(|_| Ok(Value::Text(String::new()))),
            "the error log is empty",
        ),
        Row::accepted(
            "ERRLOG:NEXT",
            &Asks(|_| Ok(Value::Text(String::new()))),
            "the error log is empty",
        ),
    ],
};

fn nothing(_: &mut At<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    Ok(none(arguments)?)
}
