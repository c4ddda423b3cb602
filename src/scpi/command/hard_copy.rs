//! Hard copy: `HARDCopy`. There is no printer behind it.

use crate::instrument::Event;
use crate::instrument::word::words;
use crate::scpi::argument::word;
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{At, OnOff, Parts, Stop, TellsAndDoes, Words};

words! {
    /// What `HARDCopy` does.
    Order {
        /// Print.
        Start = "STARt",
        /// Do not.
        Abort = "ABOrt",
    }
}

/// The group.
pub const GROUP: Group = Group {
    title: "Hard copy",
    rows: &[
        Row::accepted(
            "HARDCopy",
            &TellsAndDoes(Parts::Below, order),
            "`ABOrt` does nothing, `STARt` is refused: no printer (event 241)",
        ),
        Row::accepted(
            "HARDCopy:FORMat",
            &Words(|i, _| &mut i.panel.hard_copy.format),
            "language of the printer",
        ),
        Row::accepted(
            "HARDCopy:PORT",
            &Words(|i, _| &mut i.panel.hard_copy.port),
            "`CENtronics`, `RS232` or `GPIB`",
        ),
        Row::accepted(
            "HARDCopy:LAYout",
            &Words(|i, _| &mut i.panel.hard_copy.layout),
            "`PORTRait` or `LANdscape`",
        ),
        Row::accepted(
            "HARDCopy:INKSaver",
            &OnOff(|i, _| &mut i.panel.hard_copy.ink_saver),
            "`ON` leaves the background white",
        ),
    ],
};

fn order(_: &mut At<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    match word(arguments)? {
        Order::Start => Err(Event::HardwareMissing.into()),
        Order::Abort => Ok(()),
    }
}
