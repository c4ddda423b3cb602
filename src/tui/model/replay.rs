//! Going through a recording: shots in memory or on disk, playing, seeking, what stays behind.

use std::collections::BTreeMap;

use super::screen_state::{Request, ScreenState};
use super::state::{PartialRecording, PersistedTraces, SidePanel};
use crate::recording::mcap::ShotNotes;
use crate::recording::{ScpiLine, Shot, TraceSet};
use crate::tui::axis::{TurnDirection, ViewWindow};

/// So many shots stay on screen behind the present one.
const PERSISTED_SHOTS_LIMIT: usize = 16;
/// Slowest and fastest play (1).
const PLAYBACK_SPEEDS: (f64, f64) = (1.0 / 64.0, 64.0);

impl ScreenState {
    /// A recording that is read as it is looked at; shots and facts come as answers. `follow` shows
    /// each new shot.
    pub fn open_partial_recording(&mut self, follow: bool) {
        self.recordings.front_mut().partial = Some(PartialRecording {
            count: 0,
            open: true,
            here: None,
            follow,
            follows: follow,
            is_noted: false,
        });
    }

    /// After the user has chosen a shot: a step back ends following, the last shot begins it again.
    pub(super) fn follow_from_here(&mut self) {
        let last = self.recordings.front().shot + 1 >= self.shots();
        let partial = self.recordings.front_mut().partial.as_mut();
        if let Some(partial) = partial.filter(|partial| partial.follow) {
            if partial.follows && !last {
                self.notice =
                    Some("no longer following: End shows the newest shots again".to_owned());
            }
            partial.follows = last;
        }
    }

    /// Takes the index of the recording that was opened first: number of shots so far, whether it
    /// may grow, and its facts.
    pub fn apply_index(&mut self, count: usize, open: bool, facts: TraceSet) {
        let first = self.recordings.first_mut();
        let Some(partial) = &mut first.partial else { return };
        let grown = count > partial.count;
        (partial.count, partial.open) = (count, open);
        let wanted = match partial.here {
            _ if partial.follows && grown => Some(count - 1),
            None if count > 0 => Some(0),
            _ => None,
        };
        let facts_changed =
            first.set.attachments != facts.attachments || first.set.metadata != facts.metadata;
        let known = std::mem::take(&mut first.set);
        first.set =
            TraceSet { shots: known.shots, lines: known.lines, notes: known.notes, ..facts };
        if partial.is_noted {
            first.set.metadata = known.metadata;
            first.set.attachments = known.attachments;
        }
        if facts_changed {
            first.read_scene();
            self.reload_traces();
        }
        if let Some(place) = wanted {
            self.load(place);
        }
    }

    /// Takes the recording in front with what commands said of its bench.
    pub fn apply_bench_facts(&mut self, set: TraceSet) {
        let front = self.recordings.front_mut();
        front.set.metadata = set.metadata;
        front.set.attachments = set.attachments;
        if let Some(partial) = &mut front.partial {
            partial.is_noted = true;
        }
        front.read_scene();
        self.notice = Some("noted; :write FILE.mcap keeps it".to_owned());
        self.reload_traces();
        self.shot_changed();
    }

    /// Takes what is kept of the shot beside captures and truth, and the messages of the remote
    /// interface around it.
    pub fn note_shot(&mut self, shot: &Shot, notes: ShotNotes, lines: Vec<ScpiLine>) {
        let set = &mut self.recordings.first_mut().set;
        set.notes = BTreeMap::from([(shot.number, notes)]);
        set.lines = lines;
    }

    /// Takes a shot of the recording that was opened first; one that is no longer wanted is
    /// dropped.
    pub fn apply_shot(&mut self, place: usize, shot: Shot) {
        let is_front = self.recordings.is_first_in_front();
        let first = self.recordings.first_mut();
        if place != first.shot {
            return;
        }
        // The rest of a shot that was still being written.
        let again = first.partial.is_some_and(|partial| partial.here == Some(place));
        if let Some(partial) = &mut first.partial {
            partial.here = Some(place);
        }
        if !is_front {
            first.set.shots = vec![shot];
            self.reload_traces();
            return;
        }
        let before = self.recorded_window();
        let (time, row) = (self.play.bench_time, self.row);
        if !again {
            self.persist_traces();
        }
        self.recordings.first_mut().set.shots = vec![shot];
        self.after_shot_change(before);
        if again {
            (self.play.bench_time, self.row) = (time, row);
        }
    }

    /// How many shots there are.
    pub fn shots(&self) -> usize {
        self.recordings.front().shots()
    }

    /// Whether the file is still being read or may grow.
    pub fn is_growing(&self) -> bool {
        self.recordings.front().partial.is_some_and(|partial| partial.open)
    }

    /// The shot's place in the recording, from 0.
    pub fn shot_index(&self) -> usize {
        self.recordings.front().shot
    }

    /// Has a shot of the recording that was opened first read from its file.
    fn load(&mut self, place: usize) {
        self.recordings.first_mut().shot = place;
        self.requests.retain(|request| !matches!(request, Request::Load(_)));
        self.requests.push(Request::Load(place));
    }

    /// Shows the shot at `place`, counted from 0.
    pub(super) fn go_to(&mut self, place: usize) {
        if place >= self.shots() {
            self.notice = Some(match self.shots() {
                1 => "there is one shot".to_owned(),
                shots => format!("there are {shots} shots"),
            });
            return;
        }
        if self.recordings.front().partial.is_some() {
            return self.load(place);
        }
        let before = self.recorded_window();
        self.persist_traces();
        self.recordings.front_mut().shot = place;
        self.after_shot_change(before);
    }

    /// Shows another shot, the same part of it where it was recorded alike.
    pub(super) fn change_shot(&mut self, turn: TurnDirection) {
        let next = match turn {
            TurnDirection::Down => self.recordings.front().shot.checked_sub(1),
            TurnDirection::Up => {
                Some(self.recordings.front().shot + 1).filter(|next| *next < self.shots())
            }
        };
        if let Some(next) = next {
            self.go_to(next);
        } else {
            self.play.running = false;
            self.notice = Some("there is no further shot in this direction".to_owned());
        }
    }

    /// After another shot has come; the window stays where it was recorded alike.
    pub(super) fn after_shot_change(&mut self, before: Option<ViewWindow>) {
        self.play.bench_time = 0.0;
        self.reload_traces();
        let alike = match (before, self.recorded_window()) {
            (Some(before), Some(now)) => before.same_as(&now),
            _ => false,
        };
        if !alike {
            self.window = None;
        }
        self.shot_changed();
    }

    /// Keeps the present traces for display behind the next ones, if persistence is on.
    pub(super) fn persist_traces(&mut self) {
        let traces = self.shot().map(|_| self.traces.clone());
        if let (Some(persisted), Some(traces)) = (&mut self.persisted_traces, traces) {
            persisted.push_back(traces);
            if persisted.len() > PERSISTED_SHOTS_LIMIT {
                persisted.pop_front();
            }
        }
    }

    /// Keeps earlier shots on screen, or no longer.
    pub(super) fn persist(&mut self) {
        self.persisted_traces = match self.persisted_traces {
            Some(_) => None,
            None => Some(PersistedTraces::new()),
        };
        let words = if self.persisted_traces.is_some() {
            format!("persistence: the last {PERSISTED_SHOTS_LIMIT} shots stay")
        } else {
            "persistence off".to_owned()
        };
        self.notice = Some(words);
    }

    /// Whether time passes on the screen.
    pub fn is_playing(&self) -> bool {
        self.play.running
    }

    /// Plays or stops.
    pub(super) fn play_or_stop(&mut self) {
        self.play.running = !self.play.running;
        self.play.waited = 0.0;
        let last = self.recordings.front().shot + 1 >= self.shots();
        if self.play.running && last && self.shots() > 1 {
            self.go_to(0);
        }
    }

    /// Twice as fast, or half.
    pub(super) fn change_speed(&mut self, turn: TurnDirection) {
        self.play.speed =
            (self.play.speed * 2f64.powf(turn.sign())).clamp(PLAYBACK_SPEEDS.0, PLAYBACK_SPEEDS.1);
        self.notice = Some(format!("speed {}x", self.play.speed));
    }

    /// Lets `seconds` (s) pass.
    pub(super) fn tick(&mut self, seconds: f64) {
        if !self.play.running {
            return;
        }
        self.play.waited += seconds * self.play.speed;
        if self.play.waited >= 1.0 {
            self.play.waited = 0.0;
            self.change_shot(TurnDirection::Up);
        }
    }

    /// Opens or closes what stands beside the page.
    pub(super) fn open_side(&mut self, side: SidePanel) {
        self.side = if self.side == side { SidePanel::Nothing } else { side };
        self.derive();
    }

    /// Shows a recording behind the one that is in front, on the same axes.
    pub fn add_behind(&mut self, title: String, set: TraceSet) {
        self.recordings.add(title, set);
        self.recordings.rebuild_behind(self.newtons);
    }

    /// The next recording comes to the front; each keeps its shot.
    pub(super) fn next_recording(&mut self) {
        let before = self.recorded_window();
        let text =
            |model: &Self| model.recordings.front().scene.as_ref().map(|scene| scene.texts.clone());
        let scene = text(self);
        if !self.recordings.next() {
            self.notice =
                Some("one recording is open: `hertzscope view A B` shows two or more".to_owned());
            return;
        }
        if text(self) != scene {
            self.invalidate_studies();
        }
        if self.recordings.front().live.is_none() && self.side == SidePanel::Knobs {
            self.side = SidePanel::Nothing;
        }
        self.persisted_traces = self.persisted_traces.as_ref().map(|_| PersistedTraces::new());
        self.after_shot_change(before);
        self.notice =
            Some(format!("in front: {}; dotted: the others", self.recordings.front().title));
    }
}
