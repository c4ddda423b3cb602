//! Hard copy: `HARDCopy`. Pictures come over the connection; there is no printer behind it.

use crate::instrument::Event;
use crate::instrument::panel::{HardCopyFormat, Port};
use crate::instrument::word::words;
use crate::scpi::argument::word;
use crate::scpi::message::Argument;
use crate::scpi::row::{Group, Row};
use crate::scpi::setting::{Context, GroupQueryAndCommand, OnOff, Parts, Stop, Words};
use crate::screen::{PictureFormat, Screen, draw, file};

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
        Row::acts(
            "HARDCopy",
            &GroupQueryAndCommand(Parts::Below, order),
            "`STARt` sends the screen's picture, bare bytes without a terminator; `ABOrt` does nothing",
        ),
        Row::acts(
            "HARDCopy:FORMat",
            &Words(|i, _| &mut i.panel.hard_copy.format),
            "`BMP`, `RLE`, `PCX`, `TIFf`, `EPSCOlor`, `EPSMono`; `STARt` refuses printers' languages (event 241)",
        ),
        Row::acts(
            "HARDCopy:PORT",
            &Words(|i, _| &mut i.panel.hard_copy.port),
            "`RS232` and `GPIB` are this connection; at `CENtronics` is no printer (event 241)",
        ),
        Row::accepted(
            "HARDCopy:LAYout",
            &Words(|i, _| &mut i.panel.hard_copy.layout),
            "`PORTRait` or `LANdscape`; pictures are upright",
        ),
        Row::acts(
            "HARDCopy:INKSaver",
            &OnOff(|i, _| &mut i.panel.hard_copy.ink_saver),
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
