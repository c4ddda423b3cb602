//! A snapshot of the settings of a served scope.

use crate::client::{ScopeState, displayed};
use crate::experiment::{Integration, facts};
use crate::recording::set_file::SetFile;
use crate::recording::{Capture, InstrumentIdentity, Origin, Shot, TraceSet};
use crate::scene::{Scene, oscilloscope};
use crate::scope::{
    ChannelSetup, Deviation, Model, Setup, Source, Trigger, TriggerMode, TriggerSource,
    VerticalSetup,
};
use crate::tui::model::RunState;
use crate::tui::model::live_state::{ServedScope, TunedSettings};
use crate::tui::model::served::ServedUpdate;

/// What the knobs of a scope can do; none if no scope ships.
pub fn model(instrument: &InstrumentIdentity) -> Option<Model> {
    // Of a sister that is not described here, the knobs' steps are much the same as of the scope in
    // the scenes that ship.
    let shipped = || Some(Scene::load(Scene::names().first()?).ok()?.scope.model);
    oscilloscope(&instrument.model.to_lowercase()).ok().or_else(shipped)
}

/// Everything but the records, at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct ServedSnapshot {
    state: ScopeState,
    set_up: String,
    panel: SetFile,
    model: Model,
    impacts: u32,
    /// The bench's scene by name, as it ships.
    named: Option<Scene>,
    /// Name of the bench's scene.
    name: String,
    knobs: Vec<f64>,
}

impl ServedSnapshot {
    /// The state of the acquisition, and the front panel as text and as settings.
    pub fn new(state: ScopeState, (set_up, panel): (String, SetFile), model: Model) -> Self {
        let (named, name, knobs) = (None, String::new(), Vec::new());
        Self { state, set_up, panel, model, impacts: 0, named, name, knobs }
    }

    /// The number of impacts and the scene's name; a scene that ships is known here, too.
    pub fn on_bench(&mut self, told: &str, before: Option<&Self>) {
        let (impacts, name) = told.split_once(';').unwrap_or_default();
        self.impacts = impacts.parse().unwrap_or_default();
        name.trim_matches('"').clone_into(&mut self.name);
        self.named = match before.filter(|before| before.name == self.name) {
            Some(before) => before.named.clone(),
            None if Scene::names().contains(&self.name.as_str()) => Scene::load(&self.name).ok(),
            None => None,
        };
    }

    /// Query of the knobs that the scene has; others would put errors into the queue that all
    /// clients share.
    pub fn knobs_query(&self) -> Option<String> {
        let scene = self.named.as_ref()?;
        let striker = scene.striker_speed().map(|_| ":BENC:STRI:MASS?;SPE?");
        let magnet = scene.chain.magnet().map(|_| ":BENC:MAGN:FORC?");
        let queries: Vec<&str> = striker.into_iter().chain(magnet).collect();
        (!queries.is_empty()).then(|| queries.join(";"))
    }

    /// Where the knobs stand.
    pub fn turned(&mut self, told: &str) {
        self.knobs = told.split(';').filter_map(|value| value.parse().ok()).collect();
    }

    /// The state of the acquisition.
    pub fn state(&self) -> &ScopeState {
        &self.state
    }

    /// Whether the record changes all the time: in scan mode, where no acquisition is counted.
    pub fn is_scanning(&self) -> bool {
        self.state.trigger == "SCAN"
    }

    /// Whether there may be a record. A scope that runs has none before its first acquisition, and
    /// a query of it would be an error; one that was stopped may have that of a scan.
    pub fn has_records(&self) -> bool {
        self.state.count > 0 || self.is_scanning() || !self.state.is_running
    }

    /// The traces that are on its screen.
    pub fn displayed(&self) -> Vec<Source> {
        displayed(&self.panel)
    }

    /// The front panel as settings.
    pub fn panel(&self) -> &SetFile {
        &self.panel
    }

    /// The front panel as it was told.
    pub fn set_up(&self) -> &str {
        &self.set_up
    }

    /// The front panel; inputs as in the scene, where that is known.
    fn scope(&self) -> Setup {
        let panel = &self.panel;
        let known = self.named.as_ref().map(|scene| scene.scope.clone());
        let channel = |number: u8| -> Option<ChannelSetup> {
            let place = usize::from(number).checked_sub(1)?;
            let known = known.as_ref().and_then(|setup| setup.channels.get(place)?.clone());
            let vertical = VerticalSetup {
                scale: panel.scale(number)?,
                position: panel.position(number)?,
                coupling: panel.coupling(number),
                bandwidth_limited: panel.is_on(&format!("CH{number}:BANDWIDTH")),
                inverted: panel.is_on(&format!("CH{number}:INVERT")),
                probe: panel.probe(number).unwrap_or(1.0),
            };
            let input = known.and_then(|channel| channel.input);
            Some(ChannelSetup { vertical, input, offset: 0.0, deviation: Deviation::default() })
        };
        let shown = |number: u8| panel.is_selected(Source::Channel(number)) == Some(true);
        let source = match panel.value("TRIGGER:MAIN:EDGE:SOURCE") {
            Some("EXT") => TriggerSource::External,
            Some("EXT5") => TriggerSource::External5,
            Some("LINE") => TriggerSource::Line,
            other => TriggerSource::Channel(
                other.and_then(|name| name.strip_prefix("CH")?.parse().ok()).unwrap_or(1),
            ),
        };
        let automatic = panel.value("TRIGGER:MAIN:MODE") == Some("AUTO");
        Setup {
            channels: (1..=4).map(|n| channel(n).filter(|_| shown(n))).collect(),
            external: known.as_ref().and_then(|setup| setup.external.clone()),
            time_base: panel.time_base().unwrap_or(1.0),
            horizontal_position: panel.horizontal_position().unwrap_or_default(),
            trigger: Trigger {
                source,
                level: panel.trigger_level().unwrap_or_default(),
                slope: panel.trigger_slope().unwrap_or(crate::scope::Slope::Rise),
                mode: if automatic { TriggerMode::Auto } else { TriggerMode::Normal },
                coupling: crate::scope::EdgeCoupling::Dc,
                holdoff: 0.0,
            },
            acquisition: crate::scope::AcquireSetup::default(),
            noise: known.as_ref().map_or(0.0, |setup| setup.noise),
            model: self.model.clone(),
        }
    }

    /// Mass and speed of the striker, force of the magnet.
    fn turned_knobs(&self) -> [Option<f64>; 3] {
        let Some(scene) = &self.named else { return [None; 3] };
        let mut told = self.knobs.iter().copied();
        let striker = scene.striker_speed().is_some();
        let (mass, speed) = if striker { (told.next(), told.next()) } else { (None, None) };
        [mass, speed, scene.chain.magnet().and_then(|_| told.next())]
    }

    /// The bench as it is set up now, with the scope's front panel.
    fn scene(&self) -> Option<Scene> {
        let [mass, speed, force] = self.turned_knobs();
        let scene = self.named.as_ref()?.altered(mass, speed, force).ok()?;
        Some(Scene { scope: self.scope(), ..scene })
    }

    /// The scene settings equivalent to the snapshot.
    fn settings(&self) -> TunedSettings {
        let mut settings = TunedSettings::new();
        let mut set = |path: &str, value: String| settings.insert(path.to_owned(), value);
        let knobs = [
            ("striker.mass", "kg"),
            ("striker.speed", "m/s"),
            ("effects.magnet_preload.force", "N"),
        ];
        for ((path, unit), value) in knobs.into_iter().zip(self.turned_knobs()) {
            if let Some(value) = value {
                set(path, format!("{value} {unit}"));
            }
        }
        let scope = self.scope();
        set("scope.time_base", format!("{} s/div", scope.time_base));
        set("scope.position", format!("{} s", scope.horizontal_position));
        let trigger = scope.trigger;
        set("scope.trigger.level", format!("{} V", trigger.level));
        set("scope.trigger.source", trigger.source.to_string());
        let rising = trigger.slope == crate::scope::Slope::Rise;
        set("scope.trigger.slope", if rising { "rise" } else { "fall" }.to_owned());
        let automatic = trigger.mode == TriggerMode::Auto;
        set("scope.trigger.mode", if automatic { "auto" } else { "normal" }.to_owned());
        for (number, channel) in (1..).zip(&scope.channels) {
            // A channel that the scene does not wire would need more than this.
            let Some(channel) = channel.as_ref().filter(|channel| channel.input.is_some()) else {
                continue;
            };
            let vertical = &channel.vertical;
            set(&format!("scope.ch{number}.scale"), format!("{} V/div", vertical.scale));
            set(&format!("scope.ch{number}.position"), format!("{} div", vertical.position));
            set(&format!("scope.ch{number}.probe"), vertical.probe.to_string());
            if let Some(coupling) = vertical.coupling {
                set(&format!("scope.ch{number}.coupling"), coupling.to_string());
            }
        }
        settings
    }

    /// All of it for the screen, with new records if there are some.
    pub fn update(&self, bench: bool, records: Option<Vec<Capture>>) -> ServedUpdate {
        let acquisition = match (self.state.is_running, self.state.is_single) {
            (true, true) => RunState::Armed,
            (true, false) => RunState::Running,
            (false, _) => RunState::Stopped,
        };
        let scene = self.scene();
        let set = records.map(|captures| self.recording(scene.as_ref(), bench, captures));
        ServedUpdate {
            served: ServedScope {
                state: self.state.trigger.clone(),
                scope: Some(Box::new(self.scope())),
                bench,
            },
            base: self.name.clone(),
            acquisition,
            settings: self.settings(),
            scene,
            set,
        }
    }

    /// The records with everything that is known about them.
    fn recording(&self, scene: Option<&Scene>, bench: bool, captures: Vec<Capture>) -> TraceSet {
        let number = if bench { self.impacts } else { self.state.count };
        let number = number.max(1);
        let origin = if bench { Origin::Simulated } else { Origin::Measured };
        let shot = Shot {
            number,
            origin,
            timestamp_ns: 0,
            captures,
            truth: Vec::new(),
            trigger_time: None,
        };
        let mut set = TraceSet { shots: vec![shot], ..TraceSet::default() };
        if let Some(scene) = scene {
            if let Ok(facts) = facts::facts(scene, Integration::Accuracy(scene.accuracy)) {
                set.metadata = facts;
            }
            set.metadata.extend(facts::shot_facts(scene, number, number));
            set.attachments = facts::scene_attachments(scene);
        }
        set
    }
}
