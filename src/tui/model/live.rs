//! The live bench: knobs that change a scene, and the scene they make.
//!
//! What is tuned is kept as it would be typed, `striker.speed = "0.46 m/s"`, on top of the scene that was opened; that text is
//! simulated, and the same text is what is saved.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use super::Model;
use super::served::Served;
use super::state::{Acquisition, Request, Strike};
use crate::experiment::outcome::Summary;
use crate::recording::TraceSet;
use crate::scene::Scene;

/// What was typed for each path, `striker.speed`.
pub type Settings = BTreeMap<String, String>;

/// An impact that was simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Struck {
    /// The bench.
    pub scene: Scene,
    /// The recording of this one shot.
    pub set: TraceSet,
    /// What happened, and what it cost.
    pub summary: Summary,
}

/// The bench behind the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct Live {
    /// The scene that was opened: a name that ships, or a whole path.
    pub base: String,
    pub(super) settings: Settings,
    /// The settings that the bench took last.
    pub(super) good: Settings,
    /// Place of the selected knob in [`Knob::ALL`](super::knobs::Knob::ALL).
    pub knob: usize,
    /// What the scope is doing.
    pub acquisition: Acquisition,
    asked: u64,
    shown: u64,
    shot: u32,
    /// What happened at the last impact.
    pub summary: Option<Summary>,
    /// The scope, where another process serves it; none where the bench is this one's.
    pub served: Option<Served>,
}

impl Live {
    /// The bench of scene `base`, running.
    pub fn new(base: String) -> Self {
        Self {
            base,
            settings: Settings::new(),
            good: Settings::new(),
            knob: 0,
            acquisition: Acquisition::Running,
            asked: 0,
            shown: 0,
            shot: 1,
            summary: None,
            served: None,
        }
    }

    /// Whether a newer picture is on its way.
    pub fn is_waiting(&self) -> bool {
        self.asked > self.shown
    }

    /// What was tuned, in the order of the paths.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Sets a value without striking.
    pub(super) fn set_quietly(&mut self, path: String, value: String) {
        self.settings.insert(path, value);
    }

    /// The tuned scene as text.
    pub fn text(&self) -> String {
        let mut tables: BTreeMap<&str, Vec<(&str, &str)>> = BTreeMap::new();
        for (path, value) in &self.settings {
            let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
            tables.entry(table).or_default().push((key, value));
        }
        let mut text = format!("base = {:?}\n", self.base);
        for (table, pairs) in tables {
            if !table.is_empty() {
                let _ = write!(text, "\n[{table}]\n");
            }
            for (key, value) in pairs {
                let _ = writeln!(text, "{key} = {value:?}");
            }
        }
        text
    }
}

impl Model {
    /// The bench behind the screen; none behind a recording.
    pub fn live(&self) -> Option<&Live> {
        self.live.as_ref()
    }

    /// Takes out of the last impact what differs from machine to machine, so that pictures can be compared.
    pub fn forget_wall_time(&mut self) {
        if let Some(summary) = self.live.as_mut().and_then(|live| live.summary.as_mut()) {
            summary.wall_s = 0.0;
        }
    }

    /// Opens the bench of scene `base` (a name that ships, or a whole path) and strikes it.
    pub fn open_bench(&mut self, base: String) {
        self.live = Some(Live::new(base));
        self.strike();
    }

    /// The bench, or a word that there is none.
    pub(super) fn bench(&mut self) -> Option<&mut Live> {
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
        let strike = Strike { name, text: live.text(), shot: live.shot, turn: live.asked };
        self.requests.retain(|request| !matches!(request, Request::Strike(_)));
        self.requests.push(Request::Strike(strike));
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
        if live.acquisition == Acquisition::Running {
            self.strike();
        } else {
            self.notice =
                Some("set; the scope is stopped: space runs it, i strikes once".to_owned());
        }
    }

    /// The answer to a strike; one that is older than what is on screen is let go.
    pub fn struck(&mut self, turn: u64, answer: Result<Box<Struck>, String>) {
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
        if live.acquisition == Acquisition::Armed && triggered {
            live.acquisition = Acquisition::Stopped;
        }
        live.summary = Some(struck.summary);
        let other = self.scene.as_ref().is_none_or(|scene| scene.texts != struck.scene.texts);
        self.scene = Some(struck.scene);
        if other {
            self.outdated();
        }
        let held = struck.set.shots.iter().all(|shot| shot.captures.is_empty());
        if held && !self.set.shots.is_empty() {
            self.notice = Some("no trigger: what is on screen is older (f forces one)".to_owned());
            return;
        }
        self.persist_traces();
        self.set = struck.set;
        self.shot = 0;
        self.fresh();
        self.compare_again();
    }

    /// Runs or stops the scope.
    pub(super) fn run_stop(&mut self) {
        if self.is_served() {
            return self.run_or_stop_served();
        }
        let Some(live) = &mut self.live else { return };
        live.acquisition = match live.acquisition {
            Acquisition::Stopped => Acquisition::Running,
            Acquisition::Running | Acquisition::Armed => Acquisition::Stopped,
        };
        if live.acquisition == Acquisition::Running {
            self.strike();
        }
    }

    /// Waits for one trigger.
    pub(super) fn arm(&mut self) {
        if let Some(live) = self.bench() {
            live.acquisition = Acquisition::Armed;
            self.notice = Some("armed: i strikes the chain".to_owned());
            if self.is_served() {
                self.send(":ACQ:STOPA SEQ;STATE RUN");
            }
        }
    }

    /// Strikes the chain once, with noise and clock of their own; a scope that is stopped does not see it.
    pub(super) fn impact(&mut self) {
        let Some(live) = self.bench() else { return };
        if live.acquisition == Acquisition::Stopped {
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
