//! Several recordings side by side: one in front, the others behind it on the same axes.

use super::ScreenState;
use super::recording_behind::RecordingBehind;
use super::state::{PersistedTraces, SidePanel};
use crate::recording::TraceSet;

impl ScreenState {
    /// Shows a recording behind the one that is in front, on the same axes.
    pub fn add_behind(&mut self, title: String, set: TraceSet) {
        let own = ScreenState::new(set, title, self.palette);
        self.behind.push_back(RecordingBehind {
            title: own.title,
            set: own.set,
            on_tape: None,
            scene: own.scene,
            live: None,
            shot: 0,
            traces: own.traces,
        });
    }

    /// The recordings behind the one in front.
    pub fn behind(&self) -> impl Iterator<Item = &RecordingBehind> {
        self.behind.iter()
    }

    /// The next recording comes to the front; each keeps its shot.
    pub(super) fn next_recording(&mut self) {
        if self.behind.is_empty() {
            self.notice =
                Some("one recording is open: `hertzscope view A B` shows two or more".to_owned());
            return;
        }
        let before = self.recorded_window();
        let text = |model: &Self| model.scene.as_ref().map(|scene| scene.texts.clone());
        let scene = text(self);
        self.rotate();
        if text(self) != scene {
            self.invalidate_studies();
        }
        if self.live.is_none() && self.side == SidePanel::Knobs {
            self.side = SidePanel::Nothing;
        }
        self.persisted_traces = self.persisted_traces.as_ref().map(|_| PersistedTraces::new());
        self.after_shot_change(before);
        self.notice = Some(format!("in front: {}; dotted: the others", self.title));
    }

    /// Does `work`, which concerns the recording or bench that was opened first, with that in
    /// front.
    pub fn with_first(&mut self, work: impl FnOnce(&mut Self)) {
        let turned = self.in_front;
        while self.in_front != 0 {
            self.rotate();
        }
        work(self);
        while self.in_front != turned {
            self.rotate();
        }
        if turned != 0 {
            self.reload_traces();
        }
    }

    fn rotate(&mut self) {
        let Some(mut next) = self.behind.pop_front() else { return };
        std::mem::swap(&mut self.title, &mut next.title);
        std::mem::swap(&mut self.set, &mut next.set);
        std::mem::swap(&mut self.on_tape, &mut next.on_tape);
        std::mem::swap(&mut self.scene, &mut next.scene);
        std::mem::swap(&mut self.live, &mut next.live);
        std::mem::swap(&mut self.shot, &mut next.shot);
        self.behind.push_back(next);
        self.in_front = (self.in_front + 1) % (self.behind.len() + 1);
    }
}
