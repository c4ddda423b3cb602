//! Hard copy: `HARDCopy`. Pictures come over the connection; there is no printer behind it.

use crate::instrument::Event;
use crate::instrument::panel::{HardCopyFormat, Port};
use crate::instrument::word::words;
use crate::scpi::argument::{flag, word};
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, Parts, Stop, group_and_command, place, word};
use crate::scpi::value::ReplyValue;
use crate::screen::{PictureFormat, Screen, draw, file};

words! {
    /// Argument of `HARDCopy`.
    Order {
        /// Print.
        Start = "STARt",
        /// Do not.
        Abort = "ABOrt",
    }
}

/// The group, a row a line.
#[rustfmt::skip]
pub const GROUP: Group = Group {
    title: "Hard copy",
    rows: &[
        CommandRow::acts(
            "HARDCopy",
            group_and_command(Parts::Below, order),
            "`STARt` sends the screen's picture, bare bytes without a terminator; `ABOrt` does nothing",
        ),
        CommandRow::acts(
            "HARDCopy:FORMat",
            word!(|at| at.instrument.panel.hard_copy.format),
            "`BMP`, `RLE`, `PCX`, `TIFf`, `EPSCOlor`, `EPSMono`; `STARt` refuses printers' languages (event 241)",
        ),
        CommandRow::acts(
            "HARDCopy:PORT",
            word!(|at| at.instrument.panel.hard_copy.port),
            "`RS232` and `GPIB` are this connection; at `CENtronics` is no printer (event 241)",
        ),
        CommandRow::accepted("HARDCopy:LAYout", word!(|at| at.instrument.panel.hard_copy.layout), "`PORTRait` or `LANdscape`; pictures are upright"),
        CommandRow::acts(
            "HARDCopy:INKSaver",
            place!(|at| at.instrument.panel.hard_copy.ink_saver, flag, ReplyValue::on_or_off),
            "`ON` leaves the background white",
        ),
    ],
};

fn order(at: &mut Context<'_>, arguments: &[Argument]) -> Result<(), Stop> {
    if word::<Order>(arguments)? == Order::Abort {
        return Ok(());
    }
    let format = match at.instrument.panel.hard_copy.format {
        HardCopyFormat::Bmp => PictureFormat::Bmp,
        HardCopyFormat::Rle => PictureFormat::Rle,
        HardCopyFormat::Pcx => PictureFormat::Pcx,
        HardCopyFormat::Tiff => PictureFormat::Tiff,
        HardCopyFormat::EpsColour => PictureFormat::EpsColour,
        HardCopyFormat::EpsMono => PictureFormat::EpsMono,
        _ => return Err(Event::HardwareMissing.into()),
    };
    if at.instrument.panel.hard_copy.port == Port::Centronics {
        return Err(Event::HardwareMissing.into());
    }
    at.raw.extend(file(&draw(&Screen::of(at.instrument)), format));
    Ok(())
}
