//! Settings of the time base.

use crate::instrument::word::words;

words! {
    /// The part of the record on the screen.
    View {
        /// The main time base.
        Main = "MAIn",
        /// The window zone on top of the main time base.
        Zone = "ZONE",
        /// The window alone.
        Window = "WINDOW",
    }
}

/// The time base's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Horizontal {
    /// Which part is shown.
    pub view: View,
    /// Main time base (s/div).
    pub scale: f64,
    /// Screen's centre after the trigger (s).
    pub position: f64,
    /// Time base of the window (s/div).
    pub delay_scale: f64,
    /// Window's centre after the trigger (s).
    pub delay_position: f64,
}

impl Default for Horizontal {
    fn default() -> Self {
        Self {
            view: View::Main,
            scale: 500e-6,
            position: 0.0,
            delay_scale: 50e-6,
            delay_position: 0.0,
        }
    }
}
