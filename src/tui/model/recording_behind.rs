//! A recording behind the one in front, with its traces.

use super::live_state::LiveBench;
use super::shot_traces::shot_traces;
use super::state::PartialRecording;
use crate::recording::{Capture, TraceSet};
use crate::scene::Scene;

/// A recording or bench that is not in front.
#[derive(Debug, Clone)]
pub struct RecordingBehind {
    pub(super) title: String,
    pub(super) set: TraceSet,
    pub(super) on_tape: Option<PartialRecording>,
    pub(super) scene: Option<Scene>,
    pub(super) live: Option<LiveBench>,
    /// Place of its shot.
    pub(super) shot: usize,
    pub(super) traces: Vec<Capture>,
}

impl RecordingBehind {
    /// Its name, and which of its shots is shown.
    pub fn label(&self) -> String {
        let count = self.on_tape.map_or(self.set.shots.len(), |tape| tape.count);
        match self.live {
            Some(_) => self.title.clone(),
            None => format!("{} {}/{count}", self.title, self.shot + 1),
        }
    }

    /// Its traces, in volts or newtons as those in front.
    pub fn traces(&self) -> &[Capture] {
        &self.traces
    }

    pub(super) fn rebuild(&mut self, newtons: bool) {
        let place = if self.on_tape.is_some() { 0 } else { self.shot };
        let shot = self.set.shots.get(place);
        self.traces = shot.map_or_else(Vec::new, |shot| shot_traces(&self.set, shot, newtons).0);
    }
}
