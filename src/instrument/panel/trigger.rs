//! Settings of the trigger.

use crate::instrument::word::words;
use crate::scope::{EdgeCoupling, Slope, TriggerMode, TriggerSource};

words! {
    /// Type of the trigger.
    TriggerType {
        /// The source crosses the level.
        Edge = "EDGE",
        /// A line or field of a video signal.
        Video = "VIDeo",
        /// A pulse of a certain width.
        Pulse = "PULse",
    }

    /// Part of a video signal that triggers.
    VideoSync {
        /// Every field.
        Field = "FIELD",
        /// Every line.
        Line = "LINE",
        /// Odd fields.
        Odd = "ODD",
        /// Even fields.
        Even = "EVEN",
        /// One line.
        LineNumber = "LINENum",
    }

    /// Direction of a video signal's pulses.
    Polarity {
        /// Downward.
        Normal = "NORMal",
        /// Upward.
        Inverted = "INVert",
    }

    /// Television standard.
    VideoStandard {
        /// 525 lines.
        Ntsc = "NTSC",
        /// 625 lines.
        Pal = "PAL",
    }

    /// Direction of a pulse.
    PulsePolarity {
        /// Upward.
        Positive = "POSITIVe",
        /// Downward.
        Negative = "NEGAtive",
    }

    /// Which pulses trigger.
    PulseWhen {
        /// As wide as the setting.
        Equal = "EQual",
        /// Narrower or wider.
        NotEqual = "NOTEqual",
        /// Narrower.
        Inside = "INside",
        /// Wider.
        Outside = "OUTside",
    }
}

/// The trigger's part of the front panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TriggerPanel {
    /// Auto or normal.
    pub mode: TriggerMode,
    /// Edge, video or pulse.
    pub kind: TriggerType,
    /// Where the trigger looks, whatever its type.
    pub source: TriggerSource,
    /// Time after a trigger in which no other is taken (s).
    pub holdoff: f64,
    /// Level to cross (V).
    pub level: f64,
    /// Direction of the crossing.
    pub slope: Slope,
    /// Coupling of the edge trigger.
    pub coupling: EdgeCoupling,
    /// Part of the video signal.
    pub video_sync: VideoSync,
    /// Direction of the video signal's pulses.
    pub video_polarity: Polarity,
    /// Line of the video signal.
    pub video_line: u32,
    /// Television standard.
    pub video_standard: VideoStandard,
    /// Direction of the pulse.
    pub pulse_polarity: PulsePolarity,
    /// Which pulses trigger.
    pub pulse_when: PulseWhen,
    /// Width that pulses are compared with (s).
    pub pulse_width: f64,
}

impl Default for TriggerPanel {
    fn default() -> Self {
        Self {
            mode: TriggerMode::Auto,
            kind: TriggerType::Edge,
            source: TriggerSource::Channel(1),
            holdoff: 500e-9,
            level: 0.0,
            slope: Slope::Rise,
            coupling: EdgeCoupling::Dc,
            video_sync: VideoSync::Field,
            video_polarity: Polarity::Normal,
            video_line: 1,
            video_standard: VideoStandard::Ntsc,
            pulse_polarity: PulsePolarity::Positive,
            pulse_when: PulseWhen::Equal,
            pulse_width: 1e-3,
        }
    }
}
