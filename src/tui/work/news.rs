//! Events of the worker threads, and how their panics are caught.

use std::panic::{self, AssertUnwindSafe};

use ratatui::crossterm::event::Event;

use crate::recording::mcap::ShotNotes;
use crate::recording::{ScpiLine, Shot, TraceSet};
use crate::tui::model::background_jobs::JobAnswer;
use crate::tui::model::served::ServedUpdate;
use crate::tui::model::{ScreenState, StrikeResult};

/// An event for the screen's loop.
#[derive(Debug)]
pub enum ScreenEvent {
    /// A key, the mouse, another size.
    Terminal(Event),
    /// The terminal is gone.
    Closed,
    /// How far the recording was read: shots, whether there may be more, and what holds for all.
    Read(usize, bool, Box<TraceSet>),
    /// A shot and the messages of the remote interface around it, with its place.
    Shot(usize, Box<(Shot, ShotNotes, Vec<ScpiLine>)>),
    /// The answer to a strike, with its number.
    Struck(u64, Result<Box<StrikeResult>, String>),
    /// The answer to a question.
    Answer(JobAnswer),
    /// An update from a served scope.
    Heard(Box<ServedUpdate>),
    /// The served scope is gone, and why.
    Lost(String),
    /// Something went wrong that the user should know.
    Told(String),
}

impl ScreenEvent {
    /// Applies this to the model; terminal events are handled by the keys.
    pub fn apply(self, model: &mut ScreenState) {
        match self {
            Self::Terminal(_) | Self::Closed => {}
            Self::Answer(answer) => model.apply_answer(answer),
            Self::Told(words) => model.set_notice(words),
            other => model.with_first(|model| other.apply_to_first(model)),
        }
    }

    /// Applies what concerns the recording or bench that was opened first.
    fn apply_to_first(self, model: &mut ScreenState) {
        match self {
            Self::Read(count, open, facts) => model.apply_index(count, open, *facts),
            Self::Shot(place, found) => {
                let (shot, notes, lines) = *found;
                model.note_shot(&shot, notes, lines);
                model.apply_shot(place, shot);
            }
            Self::Struck(turn, answer) => model.apply_strike_result(turn, answer),
            Self::Heard(heard) => model.apply_served_update(*heard),
            Self::Lost(why) => model.connection_lost(why),
            Self::Terminal(_) | Self::Closed | Self::Answer(_) | Self::Told(_) => {}
        }
    }
}

/// An error with all its reasons: what failed, and why the system says so.
pub fn with_reasons(error: &dyn std::error::Error) -> String {
    let reasons = std::iter::successors(error.source(), |reason| reason.source());
    reasons.fold(error.to_string(), |text, reason| format!("{text}: {reason}"))
}

/// Does a piece of work; a panic in it becomes words, and the thread goes on with the next.
///
/// # Errors
/// The worker's error, or its panic.
pub fn guarded<T>(work: impl FnOnce() -> Result<T, String>) -> Result<T, String> {
    panic::catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<&str>().map(|words| (*words).to_owned());
        let words = words.or_else(|| panic.downcast_ref::<String>().cloned());
        let words = words.unwrap_or_else(|| "no words about it".to_owned());
        Err(format!("an error of this program, please report it: {words}"))
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_panic_becomes_an_error_with_its_message() {
        let error = super::guarded(|| -> Result<(), String> { panic!("at shot {}", 3) });
        assert_eq!(error.unwrap_err(), "an error of this program, please report it: at shot 3");
        assert_eq!(super::guarded(|| Ok::<_, String>(4)), Ok(4));
    }
}
