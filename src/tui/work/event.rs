//! Events of the terminal and of the worker threads.

use ratatui::crossterm::event::Event;

use crate::recording::mcap::ShotNotes;
use crate::recording::{ScpiLine, Shot, TraceSet};
use crate::tui::job::Change;
use crate::tui::model::ScreenState;
use crate::tui::model::served::ServedUpdate;

/// An event for the screen's loop.
pub enum ScreenEvent {
    /// A key, the mouse, another size.
    Terminal(Event),
    /// The terminal is gone.
    Closed,
    /// How far the recording was read: shots, whether there may be more, and what holds for all.
    Read(usize, bool, Box<TraceSet>),
    /// A shot and the messages of the remote interface around it, with its place.
    Shot(usize, Box<(Shot, ShotNotes, Vec<ScpiLine>)>),
    /// A change of the model by a job.
    Changed(Change<ScreenState>),
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
            Self::Changed(change) => change(model),
            Self::Told(words) => model.set_notice(words),
            Self::Read(count, open, facts) => model.apply_index(count, open, *facts),
            Self::Shot(place, found) => {
                let (shot, notes, lines) = *found;
                model.note_shot(&shot, notes, lines);
                model.apply_shot(place, shot);
            }
            Self::Heard(update) => model.apply_served_update(*update),
            Self::Lost(why) => model.connection_lost(why),
        }
    }
}
