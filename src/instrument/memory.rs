//! Memories: waveforms on the screen, references, set-ups.

use std::borrow::Cow;

use super::event::Event;
use super::{Instrument, math};
use crate::scope::word::Word as _;
use crate::scope::{Source, Waveform};

impl Instrument {
    /// A displayed waveform.
    ///
    /// # Errors
    /// [`Event::NotActive`] for one that is not displayed or has nothing to show.
    pub fn waveform(&self, source: Source) -> Result<Cow<'_, Waveform>, Event> {
        if !self.panel.displays(source) {
            return Err(Event::NotActive);
        }
        self.memory(source).ok_or(Event::NotActive)
    }

    /// The waveform in memory, displayed or not; the math trace is computed from its channels.
    fn memory(&self, source: Source) -> Option<Cow<'_, Waveform>> {
        let borrowed = match source {
            Source::Channel(number) => self.acquisition.memory(number),
            Source::Math => {
                let record = |number| self.acquisition.memory(number);
                return math::math(&self.model.fft, self.panel.math.function, record)
                    .map(Cow::Owned);
            }
            Source::Reference(letter) => self.reference(letter),
        };
        borrowed.map(Cow::Borrowed)
    }

    /// What reference memory `letter` holds.
    pub fn reference(&self, letter: char) -> Option<&Waveform> {
        self.references.get(&letter)
    }

    /// Displays a reference memory, or not.
    ///
    /// # Errors
    /// [`Event::NotActive`] for an empty one that is to be displayed.
    pub fn display_reference(&mut self, letter: char, on: bool) -> Result<(), Event> {
        if on && self.reference(letter).is_none() {
            return Err(Event::NotActive);
        }
        *self.panel.displayed_mut(Source::Reference(letter)) = on;
        Ok(())
    }

    /// Copies a displayed waveform into reference memory `letter`.
    ///
    /// # Errors
    /// [`Event::NotActive`] for a waveform that is not displayed, [`Event::NotAReference`] for an
    /// unknown memory.
    pub fn save_waveform(&mut self, source: Source, letter: char) -> Result<(), Event> {
        let waveform = self.waveform(source)?.into_owned();
        self.put_reference(waveform, letter)
    }

    /// Puts a waveform into reference memory `letter`.
    ///
    /// # Errors
    /// [`Event::NotAReference`] for an unknown memory.
    pub fn put_reference(&mut self, waveform: Waveform, letter: char) -> Result<(), Event> {
        let source = Source::Reference(letter);
        if !source.exists(self.model.channels) {
            return Err(Event::NotAReference);
        }
        self.references.insert(letter, Waveform { source, ..waveform });
        Ok(())
    }

    /// Keeps the front panel in set-up memory `number`, counted from 1.
    ///
    /// # Errors
    /// [`Event::OutOfRange`] for an unknown memory.
    pub fn save_setup(&mut self, number: usize) -> Result<(), Event> {
        let index = number.checked_sub(1).ok_or(Event::OutOfRange)?;
        *self.setups.get_mut(index).ok_or(Event::OutOfRange)? = self.panel.clone();
        Ok(())
    }

    /// Sets the front panel as in set-up memory `number`, counted from 1.
    ///
    /// # Errors
    /// [`Event::OutOfRange`] for an unknown memory.
    pub fn recall_setup(&mut self, number: usize) -> Result<(), Event> {
        let index = number.checked_sub(1).ok_or(Event::OutOfRange)?;
        self.panel = self.setups.get(index).ok_or(Event::OutOfRange)?.clone();
        self.apply_panel();
        Ok(())
    }
}
