//! Hard copy: `HARDCopy`. Pictures come over the connection; there is no printer behind it.

use crate::instrument::Event;
use crate::instrument::panel::{HardCopyFormat, Port};
use crate::instrument::word::words;
use crate::scpi::argument::word;
use crate::scpi::message::Argument;
use crate::scpi::row::{CommandRow, Group};
use crate::scpi::setting::{Context, GroupQueryAndCommand, OnOff, Parts, Stop, WordSetting};
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

/// The group.
pub const GROUP: Group = Group {
    title: "Hard copy",
    rows: &[
        CommandRow::acts(
            "HARDCopy",
            &GroupQueryAndCommand(Parts::Below, order),
            "`STARt` sends the screen's picture, bare bytes without a terminator; `ABOrt` does nothing",
        ),
        CommandRow::acts(
            "HARDCopy:FORMat",
            &WordSetting(|i, _| &mut i.panel.hard_copy.format),
            "`BMP`, `RLE`, `PCX`, `TIFf`, `EPSCOlor`, `EPSMono`; `STARt` refuses printers' languages (event 241)",
        ),
        CommandRow::acts(
            "HARDCopy:PORT",
            &WordSetting(|i, _| &mut i.panel.hard_copy.port),
            "`RS232` and `GPIB` are this connection; at `CENtronics` is no printer (event 241)",
        ),
        CommandRow::accepted(
            "HARDCopy:LAYout",
            &WordSetting(|i, _| &mut i.panel.hard_copy.layout),
            "`PORTRait` or `LANdscape`; pictures are upright",
        ),
        CommandRow::acts(
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
