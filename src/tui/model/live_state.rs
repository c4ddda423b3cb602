//! The live bench: knobs that change a scene, and the scene they make.
//!
//! Changed settings are kept as text, `striker.speed = "0.46 m/s"`, on top of the scene that was
//! opened; that text is simulated, and the same text is what is saved.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use super::state::RunState;
use crate::chain::Indentations;
use crate::experiment::outcome::Summary;
use crate::recording::TraceSet;
use crate::scene::Scene;
use crate::scene::adjust::base_in;
use crate::scene::document::quoted;
use crate::scope::Setup;

/// Settings by path, `striker.speed`, as text.
pub type TunedSettings = BTreeMap<String, String>;

/// An impact that was simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct StrikeResult {
    /// The bench.
    pub scene: Scene,
    /// The recording of this one shot.
    pub set: TraceSet,
    /// The run's summary.
    pub summary: Summary,
    /// Indentations that the contacts have after it.
    pub indentations: Indentations,
}

/// The bench behind the screen.
#[derive(Debug, Clone, PartialEq)]
pub struct LiveBench {
    /// The scene that was opened: a name that ships, or a whole path.
    pub base: String,
    pub(super) settings: TunedSettings,
    /// The settings that the bench took last.
    pub(super) good: TunedSettings,
    /// The settings that were written to a scene's file last.
    pub(super) written: TunedSettings,
    /// Place of the selected knob in [`BenchKnob::ALL`](super::knobs::BenchKnob::ALL).
    pub knob: usize,
    /// State of the acquisition.
    pub acquisition: RunState,
    pub(super) asked: u64,
    pub(super) shown: u64,
    pub(super) shot: u32,
    /// Indentations that the contacts have before that shot, and after it.
    pub(super) indentations: [Indentations; 2],
    /// Summary of the last impact.
    pub summary: Option<Summary>,
    /// The scope, where another process serves it; none where the bench is this one's.
    pub served: Option<ServedScope>,
}

impl LiveBench {
    /// The bench of scene `base`, running.
    pub fn new(base: String) -> Self {
        Self {
            base,
            settings: TunedSettings::new(),
            good: TunedSettings::new(),
            written: TunedSettings::new(),
            knob: 0,
            acquisition: RunState::Running,
            asked: 0,
            shown: 0,
            shot: 1,
            indentations: <[Indentations; 2]>::default(),
            summary: None,
            served: None,
        }
    }

    /// Whether a newer picture is on its way.
    pub fn is_waiting(&self) -> bool {
        self.asked > self.shown
    }

    /// The changed settings, in the order of the paths.
    pub fn settings(&self) -> &TunedSettings {
        &self.settings
    }

    /// Sets a value without striking.
    pub(super) fn set_quietly(&mut self, path: String, value: String) {
        self.settings.insert(path, value);
    }

    /// The tuned scene as text.
    pub fn text(&self) -> String {
        self.text_based_on(&self.base)
    }

    /// The same for the file `file`.
    pub fn text_in(&self, file: &Path) -> String {
        self.text_based_on(&base_in(&self.base, file))
    }

    fn text_based_on(&self, base: &str) -> String {
        let mut tables: BTreeMap<&str, Vec<(&str, &str)>> = BTreeMap::new();
        for (path, value) in &self.settings {
            let (table, key) = path.rsplit_once('.').unwrap_or(("", path));
            tables.entry(table).or_default().push((key, value));
        }
        let mut text = format!("base = {}\n", quoted(base));
        for (table, pairs) in tables {
            if !table.is_empty() {
                let _ = write!(text, "\n[{table}]\n");
            }
            for (key, value) in pairs {
                let _ = match value {
                    "true" | "false" => writeln!(text, "{key} = {value}"),
                    number if number.parse::<u64>().is_ok() => writeln!(text, "{key} = {number}"),
                    _ => writeln!(text, "{key} = {}", quoted(value)),
                };
            }
        }
        text
    }
}

/// State of a served scope, without its traces.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ServedScope {
    /// State of the acquisition, as of `TRIGger:STATE?`; empty before the first reply.
    pub state: String,
    /// The front panel.
    pub scope: Option<Box<Setup>>,
    /// Whether a bench stands behind it that can be struck.
    pub bench: bool,
}
