//! The open recordings and benches side by side: one is in front, the others are behind it on the
//! same axes.

use super::live_state::LiveBench;
use super::shot_traces::shot_traces;
use super::state::PartialRecording;
use crate::measurement::metadata;
use crate::recording::{Capture, Shot, TraceSet};
use crate::scene::Scene;

/// An open recording or bench.
#[derive(Debug)]
pub struct OpenRecording {
    /// Its name.
    pub title: String,
    /// The recording; of one that is read on demand, the shot in memory.
    pub set: TraceSet,
    /// What is known of the shots of a recording that is read on demand; none if all are in `set`.
    pub(super) partial: Option<PartialRecording>,
    /// The bench that was recorded or is struck, if it is known.
    pub scene: Option<Scene>,
    /// The bench that is struck, or the served scope; none of a recording.
    pub live: Option<LiveBench>,
    /// Index of the shot on screen.
    pub(super) shot: usize,
    /// Traces of its shot while it is behind, in volts or newtons.
    traces: Vec<Capture>,
}

impl OpenRecording {
    fn new(title: String, set: TraceSet) -> Self {
        let mut recording = Self {
            title,
            set,
            partial: None,
            scene: None,
            live: None,
            shot: 0,
            traces: Vec::new(),
        };
        recording.read_scene();
        recording
    }

    /// Its name, and which of its shots is shown.
    pub fn label(&self) -> String {
        match self.live {
            Some(_) => self.title.clone(),
            None => format!("{} {}/{}", self.title, self.shot + 1, self.shots()),
        }
    }

    /// Its traces while it is behind, in volts or newtons as those in front.
    pub fn traces(&self) -> &[Capture] {
        &self.traces
    }

    /// Number of its shots.
    pub fn shots(&self) -> usize {
        self.partial.map_or(self.set.shots.len(), |partial| partial.count)
    }

    /// The shot on screen, if it is in memory.
    pub fn shown_shot(&self) -> Option<&Shot> {
        self.set.shots.get(if self.partial.is_some() { 0 } else { self.shot })
    }

    /// Reads the scene that is part of the recording.
    pub(super) fn read_scene(&mut self) {
        self.scene = metadata::scene(&self.set).and_then(Result::ok);
    }
}

/// All that are open; there is always one.
#[derive(Debug)]
pub struct Recordings {
    /// The one that was opened first: worker threads read it, or strike it.
    first: OpenRecording,
    others: Vec<OpenRecording>,
    /// Index of the one in front; 0 is the first.
    front: usize,
}

impl Recordings {
    /// One recording, in front.
    pub(super) fn new(title: String, set: TraceSet) -> Self {
        Self { first: OpenRecording::new(title, set), others: Vec::new(), front: 0 }
    }

    fn place(&self) -> Option<usize> {
        self.front.checked_sub(1).filter(|place| *place < self.others.len())
    }

    /// The one in front.
    pub fn front(&self) -> &OpenRecording {
        self.place().and_then(|place| self.others.get(place)).unwrap_or(&self.first)
    }

    /// The one in front.
    pub fn front_mut(&mut self) -> &mut OpenRecording {
        match self.place().and_then(|place| self.others.get_mut(place)) {
            Some(other) => other,
            None => &mut self.first,
        }
    }

    /// The one that was opened first.
    pub(super) fn first_mut(&mut self) -> &mut OpenRecording {
        &mut self.first
    }

    /// Whether the one that was opened first is in front.
    pub(super) fn is_first_in_front(&self) -> bool {
        self.front == 0
    }

    /// Adds one behind the others.
    pub(super) fn add(&mut self, title: String, set: TraceSet) {
        self.others.push(OpenRecording::new(title, set));
    }

    /// Brings the next one to the front; false if there is no other.
    pub(super) fn next(&mut self) -> bool {
        self.front = (self.front + 1) % (self.others.len() + 1);
        !self.others.is_empty()
    }

    /// Those behind, from the next to come to the front.
    pub fn behind(&self) -> impl Iterator<Item = &OpenRecording> {
        let all = || std::iter::once(&self.first).chain(&self.others);
        all().skip(self.front + 1).chain(all().take(self.front))
    }

    /// Makes the traces of those behind again.
    pub(super) fn rebuild_behind(&mut self, newtons: bool) {
        let front = self.front;
        let all = std::iter::once(&mut self.first).chain(&mut self.others);
        for (_, recording) in all.enumerate().filter(|(index, _)| *index != front) {
            let shot = recording.shown_shot();
            recording.traces =
                shot.map_or_else(Vec::new, |shot| shot_traces(&recording.set, shot, newtons).0);
        }
    }
}
