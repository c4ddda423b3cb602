//! Settings of one channel.

use crate::scope::{Coupling, VerticalSetup};

/// One channel's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Channel {
    /// Whether the channel is on.
    pub displayed: bool,
    /// Whether the scale may stand between the steps of 1-2-5: Volts/Div on Fine in the channel's
    /// menu.
    pub fine: bool,
    /// Scale, position, coupling, bandwidth, inversion, probe.
    pub vertical: VerticalSetup,
}

impl Default for Channel {
    fn default() -> Self {
        Self {
            displayed: false,
            fine: false,
            vertical: VerticalSetup {
                scale: 1.0,
                position: 0.0,
                coupling: Some(Coupling::Dc),
                bandwidth_limited: Some(false),
                inverted: Some(false),
                probe: 10.0,
            },
        }
    }
}
