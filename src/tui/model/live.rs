//! The live bench: strikes it, and takes what a strike brought.

use super::ScreenState;
use super::live_state::{LiveBench, StrikeResult};
use super::state::{Request, RunState, StrikeRequest};

impl ScreenState {
    /// The bench behind the screen; none behind a recording.
    pub fn live(&self) -> Option<&LiveBench> {
        self.live.as_ref()
    }

    /// Takes out of the last impact what differs from machine to machine, so that pictures can be
    /// compared.
    pub fn clear_wall_time(&mut self) {
        if let Some(summary) = self.live.as_mut().and_then(|live| live.summary.as_mut()) {
            summary.wall_s = 0.0;
        }
    }

    /// Opens the bench of scene `base` (a name that ships, or a whole path) and strikes it.
    pub fn open_bench(&mut self, base: String) {
        self.live = Some(LiveBench::new(base));
        self.strike();
    }

    /// The bench; sets a notice where there is none.
    pub(super) fn bench(&mut self) -> Option<&mut LiveBench> {
        if self.live.is_none() {
            let word =
                "a recording cannot be turned: `hertzscope view SCENE` opens a bench that can";
            self.notice = Some(word.to_owned());
        }
        self.live.as_mut()
    }

    /// Has the bench struck as it is tuned now.
    pub(super) fn strike(&mut self) {
        let Some(live) = &mut self.live else { return };
        live.asked += 1;
        let name = self.title.clone();
        let strike = StrikeRequest { name, text: live.text(), shot: live.shot, turn: live.asked };
        self.requests.retain(|request| !matches!(request, Request::Strike(_)));
        self.requests.push(Request::Strike(strike));
        self.request_bands();
    }

    /// A knob was turned: the bench is struck again where the scope runs.
    pub(super) fn set_value(&mut self, path: String, value: String) {
        if path.starts_with("scope.") {
            // The picture is the scope's again.
            self.adjustments.values_mut().for_each(|adjustment| {
                (adjustment.scale, adjustment.position) = (None, None);
            });
            self.window = None;
        }
        if self.is_served() {
            return self.send_value(path, value);
        }
        let Some(live) = &mut self.live else { return };
        live.settings.insert(path, value);
        if live.acquisition == RunState::Running {
            self.strike();
        } else {
            self.notice =
                Some("set; the scope is stopped: space runs it, i strikes once".to_owned());
        }
    }

    /// The answer to a strike; one that is older than what is on screen is let go.
    pub fn apply_strike_result(&mut self, turn: u64, answer: Result<Box<StrikeResult>, String>) {
        let Some(live) = &mut self.live else { return };
        if turn < live.shown {
            return;
        }
        live.shown = turn;
        let struck = match answer {
            Ok(struck) => *struck,
            Err(problem) => {
                if turn == live.asked {
                    live.settings = live.good.clone();
                }
                self.notice = Some(problem);
                return;
            }
        };
        if turn == live.asked {
            live.good = live.settings.clone();
        }
        let triggered = struck.summary.trigger.crossed;
        if live.acquisition == RunState::Armed && triggered {
            live.acquisition = RunState::Stopped;
        }
        live.summary = Some(struck.summary);
        let other = self.scene.as_ref().is_none_or(|scene| scene.texts != struck.scene.texts);
        self.scene = Some(struck.scene);
        if other {
            self.invalidate_studies();
        }
        let held = struck.set.shots.iter().all(|shot| shot.captures.is_empty());
        if held && !self.set.shots.is_empty() {
            self.notice = Some(
                "no trigger: the screen shows the last record (f forces a trigger)".to_owned(),
            );
            return;
        }
        self.persist_traces();
        self.set = struck.set;
        self.shot = 0;
        self.reload_traces();
        self.compare_again();
    }

    /// Runs or stops the scope.
    pub(super) fn run_stop(&mut self) {
        if self.is_served() {
            return self.run_or_stop_served();
        }
        let Some(live) = &mut self.live else { return };
        live.acquisition = match live.acquisition {
            RunState::Stopped => RunState::Running,
            RunState::Running | RunState::Armed => RunState::Stopped,
        };
        if live.acquisition == RunState::Running {
            self.strike();
        }
    }

    /// Waits for one trigger.
    pub(super) fn arm(&mut self) {
        if let Some(live) = self.bench() {
            live.acquisition = RunState::Armed;
            self.notice = Some("armed: i strikes the chain".to_owned());
            if self.is_served() {
                self.send(":ACQ:STOPA SEQ;STATE RUN");
            }
        }
    }

    /// Strikes the chain once, with noise and clock of their own; a scope that is stopped does not
    /// see it.
    pub(super) fn impact(&mut self) {
        let Some(live) = self.bench() else { return };
        if live.acquisition == RunState::Stopped {
            self.notice =
                Some("the scope is stopped: s arms it for one trigger, space runs it".to_owned());
            return;
        }
        if live.served.is_some() {
            return self.strike_served();
        }
        live.shot = live.shot.saturating_add(1);
        self.strike();
    }

    /// Takes a record without a trigger: the mode goes to auto.
    pub(super) fn force(&mut self) {
        if self.is_served() {
            self.send(":TRIG FORC");
        } else if self.bench().is_some() {
            self.set_value("scope.trigger.mode".to_owned(), "auto".to_owned());
        }
    }
}
