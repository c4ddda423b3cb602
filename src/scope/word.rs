//! Settings that are words: one spelling, its capitals the shortest form that the remote interface
//! takes.

/// A setting that the remote interface names with one word.
pub trait Word: Copy + PartialEq + Sync + 'static {
    /// Every choice with its spelling; the leading capitals and digits are the shortest form.
    const WORDS: &'static [(Self, &'static str)];

    /// Whether a model with so many channels has this choice. It has as many reference memories as
    /// channels.
    fn exists(self, _channels: u8) -> bool {
        true
    }

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

/// A setting that is a [`Word`] of any kind.
pub trait WordSetting {
    /// The spelling of the present choice.
    fn spelling(&self) -> &'static str;
    /// Sets the choice that `typed` stands for, on a model with so many channels. Whether there is
    /// one.
    fn choose(&mut self, typed: &str, channels: u8) -> bool;
}

impl<T: Word> WordSetting for T {
    fn spelling(&self) -> &'static str {
        self.word()
    }

    fn choose(&mut self, typed: &str, channels: u8) -> bool {
        let choice = T::from_word(typed).filter(|choice| choice.exists(channels));
        *self = choice.unwrap_or(*self);
        choice.is_some()
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
        #[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
        pub enum $name { $($(#[$variant_meta])* $variant),+ }

        impl $crate::scope::word::Word for $name {
            const WORDS: &'static [(Self, &'static str)] = &[$((Self::$variant, $word)),+];
        }
    )+ };
}
pub(crate) use words;
