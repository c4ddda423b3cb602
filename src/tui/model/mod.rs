//! The state of the screen and its changes by actions; the views read it and change nothing.
//!
//! The recording is never touched: scales and positions that the user turns are kept beside it, for
//! each trace, and shown as different from the recorded ones. The model does no input and no
//! output: what it needs done it leaves as [`Request`]s, and the answers come back as method calls.

mod accessors;
mod action;
mod autoset;
pub mod background_jobs;
mod band;
pub mod command;
mod cursors;
mod derived;
pub mod features;
mod front_panel;
mod knob_actions;
pub mod knobs;
pub mod lists;
mod live;
pub mod live_state;
mod math_mode;
pub mod recording_behind;
mod recordings;
mod replay;
mod screen_state;
mod selection;
pub mod served;
mod shot_traces;
pub mod state;
mod traces;
mod update;

pub use action::Action;

pub use cursors::CursorReading;
pub use live_state::{LiveBench, StrikeResult};
pub use math_mode::MathMode;
pub use screen_state::ScreenState;
pub use state::{
    BackgroundJobs, BenchOption, CursorKind, Cursors, Derived, JobState, MeasurementReading,
    Overlay, Page, Palette, PersistedTraces, Playback, Popup, PrintedTables, Request, RunState,
    SidePanel, StrikeRequest, Visibility, ordinate_unit,
};
pub use update::update;
