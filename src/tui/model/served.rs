//! A scope that is served somewhere else: what it tells, and what is turned on it from here.

use super::ScreenState;
use super::live_state::{LiveBench, ServedScope, TunedSettings};
use super::state::{Request, RunState};
use crate::quantity::parse_any;
use crate::recording::TraceSet;
use crate::scene::Scene;
use crate::scope::Setup;

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
        self.live = Some(live);
    }

    /// Takes what the served scope told.
    pub fn apply_served_update(&mut self, heard: ServedUpdate) {
        let Some(live) = &mut self.live else { return };
        live.acquisition = heard.acquisition;
        live.settings.clone_from(&heard.settings);
        live.good = heard.settings;
        live.base = heard.base;
        live.served = Some(heard.served);
        let bench = |scene: &Scene| (scene.spec.clone(), scene.name.clone());
        let other = self.scene.as_ref().map(bench) != heard.scene.as_ref().map(bench);
        self.scene = heard.scene;
        if other {
            self.invalidate_studies();
        }
        if let Some(set) = heard.set {
            let before = self.recorded_window();
            self.persist_traces();
            self.set = set;
            self.shot = 0;
            self.after_shot_change(before);
        }
    }

    /// The connection to the served scope is gone; what is on screen stays.
    pub fn connection_lost(&mut self, why: String) {
        if let Some(served) = self.live.as_mut().and_then(|live| live.served.as_mut()) {
            *served = ServedScope { state: LOST.to_owned(), ..ServedScope::default() };
        }
        self.notice = Some(why);
    }

    /// Whether the line to the served scope is down.
    fn is_lost(&self) -> bool {
        let served = self.live.as_ref().and_then(|live| live.served.as_ref());
        served.is_some_and(|served| served.state == LOST)
    }

    /// Whether the bench is another process's.
    pub(super) fn is_served(&self) -> bool {
        self.live.as_ref().is_some_and(|live| live.served.is_some())
    }

    /// The front panel: the served scope's, or the scene's.
    pub fn scope(&self) -> Option<&Setup> {
        match self.live.as_ref().and_then(|live| live.served.as_ref()) {
            Some(served) => served.scope.as_deref(),
            None => self.scene.as_ref().map(|scene| &scene.scope),
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
        if let Some(live) = &mut self.live {
            live.settings.insert(path, value);
        }
    }

    /// Runs or stops the served scope.
    pub(super) fn run_or_stop_served(&mut self) {
        let stopped = self.live.as_ref().is_some_and(|l| l.acquisition == RunState::Stopped);
        self.send(if stopped { ":ACQ:STOPA RUNST;STATE RUN" } else { ":ACQ:STATE STOP" });
    }

    /// Strikes the chain behind the served scope.
    pub(super) fn strike_served(&mut self) {
        let bench = |live: &LiveBench| live.served.as_ref().is_some_and(|served| served.bench);
        if self.live.as_ref().is_some_and(bench) {
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
    let value = match parse_any(value) {
        Ok((number, _)) => format!("{number:E}"),
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
