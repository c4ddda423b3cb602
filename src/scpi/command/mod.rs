//! The table of commands, one file a group.

mod acquire;
mod bench;
mod calibration;
mod cursor;
mod curve;
mod data;
mod display;
mod hard_copy;
mod horizontal;
mod math;
mod measurement;
mod miscellaneous;
mod rs232;
mod save;
mod status;
mod trigger;
mod vertical;
mod waveform;

use super::row::Group;

/// Every command. Where two headers begin alike, the first one takes what both would.
pub const GROUPS: &[Group] = &[
    acquire::GROUP,
    calibration::GROUP,
    cursor::GROUP,
    display::GROUP,
    hard_copy::GROUP,
    horizontal::GROUP,
    math::GROUP,
    measurement::GROUP,
    miscellaneous::GROUP,
    rs232::GROUP,
    save::GROUP,
    status::GROUP,
    trigger::GROUP,
    vertical::GROUP,
    data::GROUP,
    waveform::GROUP,
    curve::GROUP,
    bench::GROUP,
];
