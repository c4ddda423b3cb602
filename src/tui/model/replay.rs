//! Going through a recording: shots in memory or on disk, playing, seeking, what stays behind.

use std::collections::BTreeMap;

use super::ScreenState;
use super::state::{Page, PartialRecording, PersistedTraces, Request, SidePanel};
use crate::recording::mcap::ShotNotes;
use crate::recording::{ScpiLine, Shot, TraceSet, TrueSignal};
use crate::trace::Trace;
use crate::tui::axis::{TurnDirection, ViewWindow};

/// So many shots stay on screen behind the present one.
const PERSISTED_SHOTS_LIMIT: usize = 16;
/// Slowest and fastest play (1).
const PLAYBACK_SPEEDS: (f64, f64) = (1.0 / 64.0, 64.0);
/// The bench's film runs so much slower than the bench, at speed 1 (1).
const PLAYBACK_TIME_SCALE: f64 = 1e-3;

impl ScreenState {
    /// A recording that is read as it is looked at; shots and facts come as answers. `follow` shows
    /// each new shot.
    pub fn open_partial_recording(&mut self, follow: bool) {
        self.on_tape = Some(PartialRecording {
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
        let last = self.shot + 1 >= self.shots();
        if let Some(tape) = self.on_tape.as_mut().filter(|tape| tape.follow) {
            if tape.follows && !last {
                self.notice =
                    Some("no longer following: End shows the newest shots again".to_owned());
            }
            tape.follows = last;
        }
    }

    /// Takes the index of the recording so far: number of shots, whether it may grow, and its
    /// facts.
    pub fn apply_index(&mut self, count: usize, open: bool, facts: TraceSet) {
        let Some(tape) = &mut self.on_tape else { return };
        let grown = count > tape.count;
        (tape.count, tape.open) = (count, open);
        let first = tape.here.is_none() && count > 0;
        let (follow, is_noted) = (tape.follows, tape.is_noted);
        let shots = std::mem::take(&mut self.set.shots);
        let notes = std::mem::take(&mut self.set.notes);
        let lines = std::mem::take(&mut self.set.lines);
        let facts_changed =
            self.set.attachments != facts.attachments || self.set.metadata != facts.metadata;
        let known = std::mem::take(&mut self.set);
        self.set = TraceSet { shots, lines, notes, ..facts };
        if is_noted {
            (self.set.metadata, self.set.attachments) = (known.metadata, known.attachments);
        }
        if facts_changed {
            self.read_scene();
            self.reload_traces();
        }
        if follow && grown {
            self.go_to(count - 1);
        } else if first {
            self.go_to(0);
        }
    }

    /// The recording with what commands said of its bench.
    pub fn apply_bench_facts(&mut self, set: TraceSet) {
        self.set = set;
        if let Some(tape) = &mut self.on_tape {
            tape.is_noted = true;
        }
        self.notice = Some("noted; :write FILE.mcap keeps it".to_owned());
        self.read_scene();
        self.reload_traces();
        if self.page == Page::Compare {
            self.compare_again();
        }
    }

    /// What is kept of the shot on screen beside captures and truth, and the messages of the remote
    /// interface around it.
    pub fn note_shot(&mut self, shot: &Shot, notes: ShotNotes, lines: Vec<ScpiLine>) {
        self.set.notes = BTreeMap::from([(shot.number, notes)]);
        self.set.lines = lines;
    }

    /// The shot that was asked for.
    pub fn apply_shot(&mut self, place: usize, shot: Shot) {
        if place != self.shot {
            return;
        }
        let before = self.recorded_window();
        // The rest of a shot that was still being written.
        let again = self.on_tape.is_some_and(|tape| tape.here == Some(place));
        let (time, row) = (self.play.bench_time, self.row);
        if !again {
            self.persist_traces();
        }
        if let Some(tape) = &mut self.on_tape {
            tape.here = Some(place);
        }
        self.set.shots = vec![shot];
        self.after_shot_change(before);
        if again {
            (self.play.bench_time, self.row) = (time, row);
        }
    }

    /// How many shots there are.
    pub fn shots(&self) -> usize {
        self.on_tape.map_or(self.set.shots.len(), |tape| tape.count)
    }

    /// Whether the file is still being read or may grow.
    pub fn is_growing(&self) -> bool {
        self.on_tape.is_some_and(|tape| tape.open)
    }

    /// The shot's place in the recording, from 0.
    pub fn shot_index(&self) -> usize {
        self.shot
    }

    /// The shot in memory that is on screen.
    pub(super) fn set_shot(&self) -> Option<&Shot> {
        self.set.shots.get(if self.on_tape.is_some() { 0 } else { self.shot })
    }

    /// Shows the shot at `place`, counted from 0.
    pub(super) fn go_to(&mut self, place: usize) {
        if place >= self.shots() {
            self.notice = Some(format!("there are {} shots", self.shots()));
            return;
        }
        if self.on_tape.is_some() {
            self.shot = place;
            self.requests.retain(|request| !matches!(request, Request::Load(_)));
            self.requests.push(Request::Load(place));
            return;
        }
        let before = self.recorded_window();
        self.persist_traces();
        self.shot = place;
        self.after_shot_change(before);
    }

    /// Shows another shot, the same part of it where it was recorded alike.
    pub(super) fn change_shot(&mut self, turn: TurnDirection) {
        let next = match turn {
            TurnDirection::Down => self.shot.checked_sub(1),
            TurnDirection::Up => Some(self.shot + 1).filter(|next| *next < self.shots()),
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
        self.select_first_row();
        let alike = match (before, self.recorded_window()) {
            (Some(before), Some(now)) => before.same_as(&now),
            _ => false,
        };
        if !alike {
            self.window = None;
        }
        if self.page == Page::Compare {
            self.compare_again();
        }
    }

    /// Keeps the present traces for display behind the next ones, if persistence is on.
    pub(super) fn persist_traces(&mut self) {
        let traces = self.set_shot().map(|_| self.traces.clone());
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
        let last = self.shot + 1 >= self.shots();
        if self.play.running && last && self.page != Page::Bench && self.shots() > 1 {
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
        if self.page == Page::Bench {
            self.seek(seconds * self.play.speed * PLAYBACK_TIME_SCALE);
            return;
        }
        self.play.waited += seconds * self.play.speed;
        if self.play.waited >= 1.0 {
            self.play.waited = 0.0;
            self.change_shot(TurnDirection::Up);
        }
    }

    /// Moves the bench's film by `seconds` of its own time (s); beyond its end it starts again.
    pub(super) fn seek(&mut self, seconds: f64) {
        let Some((start, end)) = self.film_span() else { return };
        let time = self.play.bench_time + seconds;
        self.play.bench_time = if time > end {
            start
        } else if time < start {
            end
        } else {
            time
        };
    }

    /// First and last time of the film on the bench's own clock; none where the shot has none (s).
    pub fn film_span(&self) -> Option<(f64, f64)> {
        let is_contact =
            |trace: &&Trace| matches!(TrueSignal::of(trace), Some(TrueSignal::Contact(_)));
        let film = self.shot()?.truth.iter().find(is_contact)?;
        Some((film.start, film.time(film.values.len().checked_sub(1)?)))
    }

    /// Opens or closes a page.
    pub(super) fn open_page(&mut self, page: Page) {
        self.page = if self.page == page { Page::Scope } else { page };
        self.play.running = false;
        self.select_first_row();
        self.derive();
    }

    /// Opens or closes what stands beside the page.
    pub(super) fn open_side(&mut self, side: SidePanel) {
        self.side = if self.side == side { SidePanel::Nothing } else { side };
        self.derive();
    }
}
