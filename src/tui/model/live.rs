//! The live bench: strikes it and computes its bands on threads, and takes the results.

use super::live_state::{LiveBench, StrikeResult};
use super::screen_state::ScreenState;
use super::state::{RunState, ordinate_unit};
use crate::chain::Indentations;
use crate::experiment::auto_effects::resolve_auto_effects;
use crate::experiment::{Integration, facts, run};
use crate::predict::{SampleOptions, TraceBand, trace_bands};
use crate::scene::Scene;
use crate::scene::adjust::Adjustable;
use crate::scope::Waveform;
use crate::trace::Trace;
use crate::tui::job::{Job, JobState, Queue, with_reasons};

/// Samples of the bench's uncertainty: the ends of 95 % intervals scatter by 7 % of their width.
const BAND_SAMPLES: usize = 100;

impl ScreenState {
    /// Opens the bench of scene `base` (a name that ships, or a whole path) and strikes it.
    pub fn open_bench(&mut self, base: String) {
        self.recordings.front_mut().live = Some(LiveBench::new(base));
        self.strike();
    }

    /// Whether a bench is in front, not a recording.
    pub fn has_bench(&self) -> bool {
        self.recordings.front().live.is_some()
    }

    /// The bench; sets a notice where there is none.
    pub(super) fn bench(&mut self) -> Option<&mut LiveBench> {
        if self.recordings.front().live.is_none() {
            let word =
                "a recording cannot be turned: `hertzscope view SCENE` opens a bench that can";
            self.notice = Some(word.to_owned());
        }
        self.recordings.front_mut().live.as_mut()
    }

    /// Has the bench struck as it is tuned now.
    pub(super) fn strike(&mut self) {
        let title = self.recordings.front().title.clone();
        let Some(live) = &mut self.recordings.front_mut().live else { return };
        live.asked += 1;
        let (text, shot, turn) = (live.text(), live.shot, live.asked);
        let left = live.indentations[0].clone();
        self.ask(Job::new(
            Queue::Bench,
            move |_| struck(&title, &text, shot, &left).map(Box::new),
            move |model: &mut Self, result| model.apply_strike_result(turn, result),
        ));
        self.request_bands();
    }

    /// Shows or hides where 95 % of the bench's traces lie; they follow the knobs.
    pub(super) fn switch_bands(&mut self) {
        if self.jobs.live_bands != JobState::Idle {
            self.jobs.live_bands = JobState::Idle;
            self.notice = Some("bands off".to_owned());
            return;
        }
        match self.bench().map(|live| live.served.is_some()) {
            Some(false) => {}
            Some(true) => {
                let words = "no bands of a served scope: view the scene itself";
                return self.notice = Some(words.to_owned());
            }
            None => return,
        }
        self.jobs.live_bands = JobState::Busy(0.0);
        self.notice = Some("dotted: 95 % of the traces, by the scene's [uncertainty]".to_owned());
        self.request_bands();
    }

    /// Has the bands of the bench computed as it is tuned now, if they are on.
    fn request_bands(&mut self) {
        let title = self.recordings.front().title.clone();
        let live = self.recordings.front().live.as_ref();
        let Some(live) = live.filter(|_| self.jobs.live_bands != JobState::Idle) else { return };
        let text = live.text();
        self.ask(Job::new(
            Queue::Bands,
            move |_| bands(&title, &text),
            |model: &mut Self, found| {
                // They may have been switched off meanwhile.
                if model.jobs.live_bands == JobState::Idle {
                    return;
                }
                if let Err(problem) = &found {
                    model.notice = Some(format!("no bands: {problem}"));
                }
                model.jobs.live_bands = found.into();
            },
        ));
    }

    /// Lower and upper edge of where 95 % of the traces of `waveform` lie, in volts.
    pub fn bands(&self, waveform: &Waveform) -> Option<&[Trace; 2]> {
        let name = waveform.source.to_string();
        let bands = self.jobs.live_bands.done()?.iter();
        bands.into_iter().find(|[low, _]| low.name == name && ordinate_unit(waveform) == low.unit)
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
        let Some(live) = &mut self.recordings.front_mut().live else { return };
        live.settings.insert(path, value);
        if live.acquisition == RunState::Running {
            self.strike();
        } else {
            self.notice =
                Some("set; the scope is stopped: space runs it, i strikes once".to_owned());
        }
    }

    /// Takes the result of a strike; one that is older than what is on screen is dropped.
    pub fn apply_strike_result(&mut self, turn: u64, result: Result<Box<StrikeResult>, String>) {
        let is_front = self.recordings.is_first_in_front();
        let first = self.recordings.first_mut();
        let Some(live) = first.live.as_mut().filter(|live| turn >= live.shown) else { return };
        live.shown = turn;
        let struck = match result {
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
        if live.acquisition == RunState::Armed && struck.summary.trigger.crossed {
            live.acquisition = RunState::Stopped;
        }
        live.summary = Some(struck.summary);
        live.indentations[1] = struck.indentations;
        let is_other = first.scene.as_ref().is_none_or(|scene| scene.texts != struck.scene.texts);
        first.scene = Some(struck.scene);
        let is_missed = struck.set.shots.iter().all(|shot| shot.captures.is_empty());
        let keeps_record = is_missed && !first.set.shots.is_empty();
        if is_other && is_front {
            self.invalidate_studies();
        }
        if keeps_record {
            self.notice = Some(
                "no trigger: the screen shows the last record (f forces a trigger)".to_owned(),
            );
            return;
        }
        if is_front {
            self.persist_traces();
        }
        let first = self.recordings.first_mut();
        (first.set, first.shot) = (struck.set, 0);
        self.reload_traces();
        if is_front {
            self.compare_again();
        }
    }

    /// Runs or stops the scope.
    pub(super) fn run_stop(&mut self) {
        if self.is_served() {
            return self.run_or_stop_served();
        }
        let Some(live) = &mut self.recordings.front_mut().live else { return };
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
        live.indentations[0] = live.indentations[1].clone();
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

/// Where 95 % of the traces of the bench of this text lie: lower and upper edges.
fn bands(title: &str, text: &str) -> Result<Vec<[Trace; 2]>, String> {
    let mut scene =
        Adjustable::from_text(title, "the bench", text).map_err(|error| with_reasons(&error))?;
    let options = SampleOptions { samples: BAND_SAMPLES, ..SampleOptions::default() };
    let bands = trace_bands(&mut scene, options).map_err(|error| with_reasons(&error))?;
    Ok(bands.into_iter().map(TraceBand::edges).collect())
}

/// Strikes the bench of this text; it is the shot with this number, after others that have `left`
/// indentations.
fn struck(title: &str, text: &str, shot: u32, left: &Indentations) -> Result<StrikeResult, String> {
    let told = |error: &dyn std::fmt::Display| {
        error.to_string().split_whitespace().collect::<Vec<&str>>().join(" ")
    };
    let scene = Scene::from_text(title, "the bench", text);
    let mut scene = scene.map_err(|error| told(&error))?;
    scene.keep_indentations(left);
    let integration = Integration::Accuracy(scene.accuracy);
    let scene = resolve_auto_effects(&scene, integration).into_owned();
    let outcome = run(&scene, integration, shot, &mut |_| ()).map_err(|e| told(&e))?;
    let (summary, indentations) = (outcome.summary.clone(), outcome.indentations.clone());
    let set = facts::recording(&scene, integration, [outcome]).map_err(|error| told(&error))?;
    Ok(StrikeResult { scene, set, summary, indentations })
}
