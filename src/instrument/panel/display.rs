//! Settings of screen and printer: they change pictures of the screen, never records.

use crate::instrument::word::words;

words! {
    /// Display format: YT or XY.
    DisplayFormat {
        /// Volts against time.
        Yt = "YT",
        /// Channel 2 against channel 1.
        Xy = "XY",
    }

    /// How points are drawn.
    DisplayStyle {
        /// As dots.
        Dots = "DOTs",
        /// Joined by lines.
        Vectors = "VECtors",
    }

    /// Way of the picture onto paper.
    Layout {
        /// Upright.
        Portrait = "PORTRait",
        /// Turned.
        Landscape = "LANdscape",
    }

    /// Where the printer is.
    Port {
        /// Parallel port.
        Centronics = "CENtronics",
        /// Serial port.
        Rs232 = "RS232",
        /// Instrument bus.
        Gpib = "GPIB",
    }

    /// Language of the printer.
    HardCopyFormat {
        /// Windows bitmap.
        Bmp = "BMP",
        /// Bubble jet.
        BubbleJet = "BUBBLEJet",
        /// Seiko DPU 411.
        Dpu411 = "DPU411",
        /// Seiko DPU 412.
        Dpu412 = "DPU412",
        /// Desk jet in colour.
        DeskJetColour = "DESKJETC",
        /// Desk jet.
        DeskJet = "DESKJet",
        /// Encapsulated PostScript in colour.
        EpsColour = "EPSCOlor",
        /// Encapsulated PostScript.
        EpsMono = "EPSMono",
        /// Epson, 9 or 24 pins.
        Epson = "EPSOn",
        /// Interleaf.
        Interleaf = "INTERLeaf",
        /// Laser jet.
        LaserJet = "LASERJet",
        /// PC Paintbrush.
        Pcx = "PCX",
        /// RLE bitmap.
        Rle = "RLE",
        /// Think jet.
        ThinkJet = "THINKjet",
        /// Tagged image file.
        Tiff = "TIFf",
    }
}

/// The screen's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Display {
    /// Display format: YT or XY.
    pub format: DisplayFormat,
    /// How points are drawn.
    pub style: DisplayStyle,
    /// How long a record stays on the screen; infinite for good (s).
    pub persistence: f64,
    /// Contrast of the screen, 1 to 100.
    pub contrast: u32,
    /// Whether the screen is dark on bright.
    pub inverted: bool,
}

impl Default for Display {
    fn default() -> Self {
        Self {
            format: DisplayFormat::Yt,
            style: DisplayStyle::Vectors,
            persistence: 0.0,
            contrast: 50,
            inverted: false,
        }
    }
}

/// The printer's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HardCopy {
    /// Language of the printer.
    pub format: HardCopyFormat,
    /// Where the printer is.
    pub port: Port,
    /// Way of the picture onto paper.
    pub layout: Layout,
    /// Whether the background stays white.
    pub ink_saver: bool,
}

impl Default for HardCopy {
    fn default() -> Self {
        Self {
            format: HardCopyFormat::Epson,
            port: Port::Centronics,
            layout: Layout::Portrait,
            ink_saver: true,
        }
    }
}
