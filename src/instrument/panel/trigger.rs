//! Settings of the trigger.

use crate::instrument::word::words;
use crate::scope::{Slope, TriggerMode};

words! {
    /// What kind of event triggers.
    TriggerType {
        /// The source crosses the level.
        Edge = "EDGE",
        /// A line or field of a video signal.
        Video = "VIDeo",
        /// A pulse of a certain width.
        Pulse = "PULse",
    }

    /// Where the trigger looks.
    TriggerSource {
        /// Channel 1.
        Channel1 = "CH1",
        /// Channel 2.
        Channel2 = "CH2",
        /// Channel 3.
        Channel3 = "CH3",
        /// Channel 4.
        Channel4 = "CH4",
        /// The external input.
        External = "EXT",
        /// The external input divided by five.
        External5 = "EXT5",
        /// The mains.
        Line = "LINE",
    }

    /// What the edge trigger is deaf to.
    EdgeCoupling {
        /// Nothing.
        Dc = "DC",
        /// The mean.
        Ac = "AC",
        /// High frequencies.
        HighFrequencyReject = "HFRej",
        /// Low frequencies.
        LowFrequencyReject = "LFRej",
        /// Small crossings.
        NoiseReject = "NOISErej",
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

impl TriggerSource {
    /// Channel `number`, counted from 1; numbers beyond the last mean the last.
    #[must_use]
    pub fn of_channel(number: u8) -> Self {
        match number {
            0 | 1 => Self::Channel1,
            2 => Self::Channel2,
            3 => Self::Channel3,
            _ => Self::Channel4,
        }
    }

    /// The channel's number, counted from 1; none for what is no channel.
    #[must_use]
    pub fn channel(self) -> Option<u8> {
        match self {
            Self::Channel1 => Some(1),
            Self::Channel2 => Some(2),
            Self::Channel3 => Some(3),
            Self::Channel4 => Some(4),
            Self::External | Self::External5 | Self::Line => None,
        }
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
    /// What the edge trigger is deaf to.
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
            source: TriggerSource::Channel1,
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
