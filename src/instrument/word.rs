//! Settings that are words: one spelling, its capitals the shortest form that the remote interface
//! takes.

use crate::scope::{
    AcquireMode, Coupling, EdgeCoupling, Slope, Source, TriggerMode, TriggerSource,
};

/// A setting that the remote interface names with one word.
pub trait Word: Copy + PartialEq + Sync + 'static {
    /// Every choice with its spelling; the leading capitals and digits are the shortest form.
    const WORDS: &'static [(Self, &'static str)];

    /// The spelling of this choice.
    fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(choice, _)| *choice == self).map_or("", |(_, word)| word)
    }

    /// The choice that a typed word stands for, at any length between the short form and the full
    /// one.
    fn from_word(typed: &str) -> Option<Self> {
        Self::WORDS.iter().find(|(_, word)| abbreviates(typed, word)).map(|(choice, _)| *choice)
    }
}

/// The part of a spelling that must be typed: everything before the first small letter.
pub fn short_form(word: &str) -> &str {
    let end = word.find(|c: char| c.is_ascii_lowercase()).unwrap_or(word.len());
    word.get(..end).unwrap_or(word)
}

/// Whether `typed` is `word` or a beginning of it that is no shorter than its short form, in
/// capitals or not.
pub fn abbreviates(typed: &str, word: &str) -> bool {
    typed.len() >= short_form(word).len()
        && word.get(..typed.len()).is_some_and(|start| start.eq_ignore_ascii_case(typed))
}

/// Declares an enumeration together with its words.
macro_rules! words {
    ($($(#[$meta:meta])* $name:ident {
        $($(#[$variant_meta:meta])* $variant:ident = $word:literal),+ $(,)?
    })+) => { $(
        $(#[$meta])*
        #[derive(Debug, Clone, Copy, PartialEq, Eq)]
        pub enum $name { $($(#[$variant_meta])* $variant),+ }

        impl $crate::instrument::word::Word for $name {
            const WORDS: &'static [(Self, &'static str)] = &[$((Self::$variant, $word)),+];
        }
    )+ };
}
pub(crate) use words;

impl Word for Coupling {
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Dc, "DC"), (Self::Ac, "AC"), (Self::Ground, "GND")];
}

impl Word for AcquireMode {
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Sample, "SAMple"), (Self::PeakDetect, "PEAKdetect"), (Self::Average, "AVErage")];
}

impl Word for EdgeCoupling {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Dc, "DC"),
        (Self::Ac, "AC"),
        (Self::HighFrequencyReject, "HFRej"),
        (Self::LowFrequencyReject, "LFRej"),
        (Self::NoiseReject, "NOISErej"),
    ];
}

impl Word for Slope {
    const WORDS: &'static [(Self, &'static str)] = &[(Self::Rise, "RISe"), (Self::Fall, "FALL")];
}

impl Word for TriggerMode {
    const WORDS: &'static [(Self, &'static str)] =
        &[(Self::Auto, "AUTO"), (Self::Normal, "NORMal")];
}

impl Word for TriggerSource {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Channel(1), "CH1"),
        (Self::Channel(2), "CH2"),
        (Self::Channel(3), "CH3"),
        (Self::Channel(4), "CH4"),
        (Self::External, "EXT"),
        (Self::External5, "EXT5"),
        (Self::Line, "LINE"),
    ];
}

impl Word for Source {
    const WORDS: &'static [(Self, &'static str)] = &[
        (Self::Channel(1), "CH1"),
        (Self::Channel(2), "CH2"),
        (Self::Channel(3), "CH3"),
        (Self::Channel(4), "CH4"),
        (Self::Math, "MATH"),
        (Self::Reference('A'), "REFA"),
        (Self::Reference('B'), "REFB"),
        (Self::Reference('C'), "REFC"),
        (Self::Reference('D'), "REFD"),
    ];
}
