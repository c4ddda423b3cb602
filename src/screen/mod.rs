//! The instrument's screen as a picture of 320 x 240 dots, and the picture as a file.
//!
//! [`Screen`] says what is shown, [`draw()`] puts it on a [`Picture`], [`file()`] writes that in a
//! format of `HARDCopy`. The arrangement follows the screen of the TDS2000 family: status above the
//! graticule, menu beside it, scales below; a division is 25 dots, so a level of the digitiser is a
//! dot. Which menu the screen shows is told by no command: it is that of the measurements, the
//! cursors, or the first channel. No date is shown, since the instrument has no clock.

mod content;
mod draw;
mod file;
mod menu;
mod picture;
mod readout;
mod strokes;
mod surroundings;

pub use content::{Bar, Screen, TriggerReadout, Zoom};
pub use draw::draw;
pub use file::{PictureFormat, file};
pub use picture::{HEIGHT, Ink, Picture, WIDTH};
