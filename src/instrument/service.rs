//! Settings that belong to no set-up memory: lock, device trigger, printer, serial line, language.

use std::collections::BTreeMap;

use crate::scope::panel::HardCopy;
use crate::scope::word::words;

words! {
    /// What `AUTOSet` takes its signal for.
    AutosetSignal {
        /// A level that does not change.
        Level = "LEVEL",
        /// A sine.
        Sine = "SINE",
        /// A square wave.
        Square = "SQUARE",
        /// A video signal, PAL.
        VideoPal = "VIDPAL",
        /// A video signal, NTSC.
        VideoNtsc = "VIDNTSC",
        /// Another one.
        Other = "OTHER",
        /// Nothing was looked at.
        None = "NONe",
    }
}

/// Settings that no set-up memory holds and no reset changes.
#[derive(Debug, Clone, PartialEq)]
pub struct Service {
    /// Whether the front panel's keys are locked.
    pub locked: bool,
    /// What `*TRG` does (`*DDT`); empty: force a trigger.
    pub device_trigger: String,
    /// Printer.
    pub hard_copy: HardCopy,
    /// Whether the serial line is stopped by RTS and CTS.
    pub hard_flagging: bool,
    /// Whether the serial line is stopped by XON and XOFF.
    pub soft_flagging: bool,
    /// Settings without effect, by the header of their command: stored and returned.
    pub stored: BTreeMap<&'static str, u32>,
}

impl Default for Service {
    fn default() -> Self {
        Self {
            locked: false,
            device_trigger: String::new(),
            hard_copy: HardCopy::default(),
            hard_flagging: true,
            soft_flagging: false,
            stored: BTreeMap::new(),
        }
    }
}
