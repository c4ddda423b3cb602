//! Settings that belong to no set-up memory: lock, device trigger, serial line, language.

use super::word::words;

words! {
    /// Parity of the serial line.
    Parity {
        /// Even.
        Even = "EVEN",
        /// None.
        None = "NONe",
        /// Odd.
        Odd = "ODD",
    }

    /// Language of the screen.
    Language {
        /// English.
        English = "ENGLish",
        /// French.
        French = "FRENch",
        /// German.
        German = "GERMan",
        /// Italian.
        Italian = "ITALian",
        /// Spanish.
        Spanish = "SPANish",
        /// Portuguese.
        Portuguese = "PORTUguese",
        /// Japanese.
        Japanese = "JAPAnese",
        /// Korean.
        Korean = "KOREan",
        /// Traditional Chinese.
        TraditionalChinese = "TRADitionalchinese",
        /// Simplified Chinese.
        SimplifiedChinese = "SIMPlifiedchinese",
    }

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

    /// How `AUTOSet` shows its signal.
    AutosetView {
        /// Several cycles.
        ManyCycles = "MULTICY",
        /// One cycle.
        OneCycle = "SINGLECY",
        /// Its spectrum.
        Spectrum = "FFT",
        /// A rising edge.
        Rising = "RISING",
        /// A falling edge.
        Falling = "FALLING",
        /// A field of a video signal.
        Field = "FIELD",
        /// Its odd fields.
        Odd = "ODD",
        /// Its even fields.
        Even = "EVEN",
        /// Its lines.
        Line = "LINE",
        /// One of its lines.
        LineNumber = "LINENum",
        /// A level.
        Level = "DCLIne",
        /// As usual.
        Default = "DEFault",
        /// Nothing was set up.
        None = "NONE",
    }
}

/// Lock, device trigger, serial line, language.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Service {
    /// Whether the front panel's keys are locked.
    pub locked: bool,
    /// What `*TRG` does (`*DDT`); empty: force a trigger.
    pub device_trigger: String,
    /// Language of the screen.
    pub language: Language,
    /// Speed of the serial line (baud).
    pub baud: u32,
    /// Whether the serial line is stopped by RTS and CTS.
    pub hard_flagging: bool,
    /// Whether the serial line is stopped by XON and XOFF.
    pub soft_flagging: bool,
    /// Parity of the serial line.
    pub parity: Parity,
    /// How `AUTOSet` shows its signal.
    pub autoset_view: AutosetView,
}

impl Default for Service {
    fn default() -> Self {
        Self {
            locked: false,
            device_trigger: String::new(),
            language: Language::English,
            baud: 9600,
            hard_flagging: true,
            soft_flagging: false,
            parity: Parity::None,
            autoset_view: AutosetView::None,
        }
    }
}
