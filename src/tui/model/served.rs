//! A scope that is served somewhere else: what it tells, and what is turned on it from here.

use super::live_state::{LiveBench, ServedScope, TunedSettings};
use super::screen_state::{Request, ScreenState};
use super::state::RunState;
use crate::quantity::Quantity;
use crate::recording::TraceSet;
use crate::scene::Scene;
use crate::scope::{Setup, TriggerMode};

/// State and records received from a served scope.
#[derive(Debug, Clone, PartialEq)]
pub struct ServedUpdate {
    /// State and front panel.
    pub served: ServedScope,
    /// Name of its scene; empty without one.
    pub base: String,
    /// State of the acquisition.
    pub acquisition: RunState,
    /// Settings on top of `base` that describe this bench.
    pub settings: TunedSettings,
    /// The bench, where it is known here.
    pub scene: Option<Scene>,
    /// New records with what is known about them, if there are some.
    pub set: Option<TraceSet>,
}

/// State of a served scope while its line is down.
const LOST: &str = "LOST";

impl ScreenState {
    /// Shows a scope that is served somewhere else; what it tells comes as [`ServedUpdate`].
    pub fn open_served(&mut self) {
        let mut live = LiveBench::new(String::new());
        live.served = Some(ServedScope::default());
        self.recordings.front_mut().live = Some(live);
    }

    /// Takes an update of the served scope.
    pub fn apply_served_update(&mut self, update: ServedUpdate) {
        let is_front = self.recordings.is_first_in_front();
        let first = self.recordings.first_mut();
        let Some(live) = &mut first.live else { return };
        live.acquisition = update.acquisition;
        live.settings.clone_from(&update.settings);
        live.good = update.settings;
        live.base = update.base;
        let mode = |served: &ServedScope| served.scope.as_ref().map(|scope| scope.trigger.mode);
        let is_new = live.served.as_ref().and_then(mode).is_none();
        if is_new && mode(&update.served) == Some(TriggerMode::Auto) {
            self.notice = Some("the scope is in AUTO: after an impact it goes on with records without one; t (NORMAL) keeps it".to_owned());
        }
        live.served = Some(update.served);
        let bench = |scene: &Scene| (scene.spec.clone(), scene.name.clone());
        let is_other = first.scene.as_ref().map(bench) != update.scene.as_ref().map(bench);
        first.scene = update.scene;
        if is_other && is_front {
            self.invalidate_studies();
        }
        if let Some(set) = update.set {
            self.take_set(set);
        }
    }

    /// Shows the only shot of `set` in place of that of the bench or scope that was opened first.
    pub(super) fn take_set(&mut self, set: TraceSet) {
        let before = self.recorded_window();
        let is_front = self.recordings.is_first_in_front();
        if is_front {
            self.persist_traces();
        }
        let first = self.recordings.first_mut();
        (first.set, first.shot) = (set, 0);
        if is_front {
            self.after_shot_change(before);
        } else {
            self.reload_traces();
        }
    }

    /// The connection to the served scope is lost; what is on screen stays.
    pub fn connection_lost(&mut self, why: String) {
        let live = self.recordings.first_mut().live.as_mut();
        if let Some(served) = live.and_then(|live| live.served.as_mut()) {
            *served = ServedScope { state: LOST.to_owned(), ..ServedScope::default() };
        }
        self.notice = Some(why);
    }

    /// Whether the line to the served scope is down.
    fn is_lost(&self) -> bool {
        let served = self.recordings.front().live.as_ref().and_then(|live| live.served.as_ref());
        served.is_some_and(|served| served.state == LOST)
    }

    /// Whether the bench is another process's.
    pub(super) fn is_served(&self) -> bool {
        self.recordings.front().live.as_ref().is_some_and(|live| live.served.is_some())
    }

    /// The front panel: the served scope's, or the scene's.
    pub fn scope(&self) -> Option<&Setup> {
        match self.recordings.front().live.as_ref().and_then(|live| live.served.as_ref()) {
            Some(served) => served.scope.as_deref(),
            None => self.recordings.front().scene.as_ref().map(|scene| &scene.scope),
        }
    }

    /// Has `command` sent to the served scope.
    pub(super) fn send(&mut self, command: &str) {
        self.requests.push(Request::Send(command.to_owned()));
    }

    /// Sends what was set for `path`; the next record shows it.
    pub(super) fn send_value(&mut self, path: String, value: String) {
        let Some(command) = command(&path, &value) else {
            let word = format!(
                "{path} cannot be turned over the network: stop serving, and view the scene itself"
            );
            self.notice = Some(word);
            return;
        };
        self.send(&command);
        self.notice = Some(format!("sent {command}: the next record shows it"));
        if let Some(live) = &mut self.recordings.front_mut().live {
            live.settings.insert(path, value);
        }
    }

    /// Runs or stops the served scope.
    pub(super) fn run_or_stop_served(&mut self) {
        let stopped = self
            .recordings
            .front()
            .live
            .as_ref()
            .is_some_and(|l| l.acquisition == RunState::Stopped);
        self.send(if stopped { ":ACQ:STOPA RUNST;STATE RUN" } else { ":ACQ:STATE STOP" });
    }

    /// Strikes the chain behind the served scope.
    pub(super) fn strike_served(&mut self) {
        let bench = |live: &LiveBench| live.served.as_ref().is_some_and(|served| served.bench);
        if self.recordings.front().live.as_ref().is_some_and(bench) {
            self.send(":BENC:IMP");
            self.notice = Some("sent BENCh:IMPact: the chain is struck".to_owned());
        } else if self.is_lost() {
            self.notice = Some("the scope is not connected: trying again".to_owned());
        } else {
            self.notice =
                Some("no bench behind this scope that could be struck from here".to_owned());
        }
    }
}

/// The remote command that sets the key `path` of a scene; none for keys without a command.
fn command(path: &str, value: &str) -> Option<String> {
    let header = match path {
        "scope.time_base" => "HOR:MAI:SCA".to_owned(),
        "scope.position" => "HOR:MAI:POS".to_owned(),
        "scope.acquisition" => "ACQ:MOD".to_owned(),
        "scope.averages" => "ACQ:NUMAV".to_owned(),
        "scope.trigger.level" => "TRIG:MAI:LEV".to_owned(),
        "scope.trigger.slope" => "TRIG:MAI:EDGE:SLO".to_owned(),
        "scope.trigger.mode" => "TRIG:MAI:MOD".to_owned(),
        "scope.trigger.source" => "TRIG:MAI:EDGE:SOU".to_owned(),
        "striker.mass" => "BENC:STRI:MASS".to_owned(),
        "striker.speed" => "BENC:STRI:SPE".to_owned(),
        "effects.magnet_preload.force" => "BENC:MAGN:FORC".to_owned(),
        _ => {
            let (number, key) = path.strip_prefix("scope.ch")?.split_once('.')?;
            let number: u8 = number.parse().ok()?;
            let word = match key {
                "scale" => "SCA",
                "position" => "POS",
                "coupling" => "COUP",
                "probe" => "PROB",
                "bandwidth_limit" => "BANDWID",
                _ => return None,
            };
            format!("CH{number}:{word}")
        }
    };
    let value = match value.parse::<Quantity>() {
        Ok(quantity) => format!("{:E}", quantity.value),
        Err(_) if matches!(value, "true" | "false") => {
            if value == "true" { "ON" } else { "OFF" }.to_owned()
        }
        // A word, and nothing that would begin another command.
        Err(_) if value.chars().all(|c| c.is_alphanumeric() || c == ' ') => {
            value.replace(' ', "").to_uppercase()
        }
        Err(_) => return None,
    };
    Some(format!(":{header} {value}"))
}

#[cfg(test)]
mod tests {
    use super::command;

    #[test]
    fn what_stands_in_a_scene_is_a_command() {
        for (path, value, expected) in [
            ("scope.ch2.scale", "500 mV/div", Some(":CH2:SCA 5E-1")),
            ("scope.position", "-1.5 ms", Some(":HOR:MAI:POS -1.5E-3")),
            ("scope.trigger.slope", "fall", Some(":TRIG:MAI:EDGE:SLO FALL")),
            ("scope.acquisition", "peak detect", Some(":ACQ:MOD PEAKDETECT")),
            ("scope.averages", "16", Some(":ACQ:NUMAV 1.6E1")),
            ("scope.ch4.coupling", "AC", Some(":CH4:COUP AC")),
            ("scope.ch1.bandwidth_limit", "true", Some(":CH1:BANDWID ON")),
            ("striker.mass", "0.61 g", Some(":BENC:STRI:MASS 6.1E-4")),
            ("effects.gravity.acceleration", "9.81 m/s^2", None),
            ("scope.trigger.mode", "auto;*RST", None),
        ] {
            assert_eq!(command(path, value).as_deref(), expected, "{path}");
        }
    }
}
