//! The state of the screen and its changes by actions; the views read it and change nothing.
//!
//! The recording is never touched: scales and positions that the user turns are kept beside it, for
//! each trace, and shown as different from the recorded ones. The model does no input and no
//! output, and nothing that takes long: what it needs done it leaves as [`Request`]s, most of them
//! closures for a thread whose result is a change of the model.

mod autoset;
pub mod command;
pub mod comparison;
mod cursors;
mod derived;
mod front_panel;
pub mod knobs;
mod live;
pub mod live_state;
mod recordings;
mod replay;
mod screen_state;
pub mod served;
mod shot_traces;
pub mod state;
mod traces;
mod update;

pub use super::job::JobState;
pub use cursors::CursorReading;
pub use live_state::{LiveBench, StrikeResult};
pub use recordings::{OpenRecording, Recordings};
pub use screen_state::{Action, DerivedPart, NoteOption, Page, PageSpec, Request, ScreenState};
pub use shot_traces::MathMode;
pub use state::{
    BackgroundJobs, BenchOption, CursorKind, Cursors, Derived, FilmScales, MeasurementReading,
    Overlay, Palette, PersistedTraces, Playback, Popup, RunState, SidePanel, Visibility,
    ordinate_unit,
};
pub use update::update;
