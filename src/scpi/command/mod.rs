//! The table of commands: front panel, waveforms, status and service, bench.

mod bench;
mod front_panel;
mod service;
mod waveform;

use super::table::Group;

/// Every command. Where two headers begin alike, the first one takes what both would.
pub const GROUPS: &[Group] = &[
    front_panel::ACQUISITION,
    service::CALIBRATION,
    front_panel::CURSOR,
    front_panel::DISPLAY,
    service::HARD_COPY,
    front_panel::HORIZONTAL,
    front_panel::MATH,
    front_panel::MEASUREMENT,
    service::MISCELLANEOUS,
    service::RS232,
    service::SAVE_AND_RECALL,
    service::STATUS,
    front_panel::TRIGGER,
    front_panel::VERTICAL,
    waveform::TRANSFER,
    waveform::PREAMBLE,
    waveform::POINTS,
    bench::GROUP,
];
