//! The command line: what has no key of its own.

use std::path::PathBuf;

use super::knobs::BenchKnob;
use super::state::{BenchOption, Page, Request};
use super::{Popup, ScreenState};
use crate::scene::Scene;
use crate::tui::axis::TurnDirection;

/// The commands, as the help shows them.
pub const COMMANDS: &[(&str, &str)] = &[
    (":write FILE", "save .mcap (shot), .csv (traces), .toml (scene), .svg"),
    (":compare WHAT", "hold the shot against a recording, a folder, or a scene"),
    (":goto N", "show trigger N, counted from 1"),
    (":seek TIME", "wind the moving bench to a time, e.g. 0.8 ms"),
    (":scene SCENE", "the bench of the recording: sensors, distances"),
    (":map CH1=p2,...", "which of its sensors is at a channel"),
    (":sensor CH1=FILE", "a channel's sensor, by name or file"),
    (":distance CH1-CH2=D", "along the chain, e.g. 47.2 mm +- 0.1 mm"),
    (":set PATH VALUE", "change the bench's scene, e.g. :set striker.speed 0.6 m/s"),
    (":effects", "what each effect of the bench changes, and what it costs"),
    (":hard-cases", "cases that are hard to integrate, each with its bound"),
    (":quit", "leave"),
];

/// What a command says of the bench.
fn bench_option(word: &str) -> Option<BenchOption> {
    match word {
        "scene" => Some(BenchOption::Scene),
        "map" => Some(BenchOption::Map),
        "sensor" => Some(BenchOption::Sensor),
        "distance" => Some(BenchOption::Distance),
        _ => None,
    }
}

impl ScreenState {
    /// Opens the command line with `start` typed already.
    pub(super) fn open_prompt(&mut self, start: &str) {
        self.panel = Popup::Prompt;
        self.recalled = self.typed_lines.len();
        start.clone_into(&mut self.prompt);
    }

    /// Completes the word that is being typed, as far as all that begin like it agree.
    pub(super) fn complete_prompt(&mut self) {
        let (before, word) = match self.prompt.rsplit_once(' ') {
            Some((before, word)) => (format!("{before} "), word),
            None => (String::new(), self.prompt.as_str()),
        };
        let candidates: Vec<String> = match before.trim() {
            "" => COMMANDS
                .iter()
                .filter_map(|(command, _)| Some(command.split(' ').next()?.get(1..)?.to_owned()))
                .collect(),
            "compare" | "scene" => Scene::names().into_iter().map(str::to_owned).collect(),
            "set" => self.settable_paths(),
            _ => Vec::new(),
        };
        let found: Vec<&String> = candidates.iter().filter(|full| full.starts_with(word)).collect();
        let Some(first) = found.first() else { return };
        let shared = found.iter().fold(first.len(), |length, other| {
            let same = first.bytes().zip(other.bytes()).take_while(|(a, b)| a == b).count();
            length.min(same)
        });
        let end = if found.len() == 1 { " " } else { "" };
        self.prompt = format!("{before}{}{end}", first.get(..shared).unwrap_or(word));
        if found.len() > 1 {
            let names: Vec<&str> = found.iter().map(|name| name.as_str()).collect();
            self.notice = Some(names.join("  "));
        }
    }

    /// Where the knobs stand in the scene, for the selected channel.
    fn settable_paths(&self) -> Vec<String> {
        let Some(scene) = &self.scene else { return Vec::new() };
        let knobs = BenchKnob::ALL.iter().filter_map(|knob| knob.path_in(scene, self.selected));
        let panel = ["time_base", "position", "trigger.level", "trigger.source", "trigger.slope"];
        let panel = panel.iter().map(|key| format!("scope.{key}"));
        let channel = self.channel_path().into_iter().flat_map(|path| {
            let keys = ["scale", "position", "coupling", "probe", "bandwidth_limit"];
            keys.map(|key| format!("{path}.{key}"))
        });
        knobs.chain(panel).chain(channel).collect()
    }

    /// Brings back the line before the one that is shown, or the one after it.
    pub(super) fn recall(&mut self, turn: TurnDirection) {
        let at = match turn {
            TurnDirection::Up => self.recalled.saturating_sub(1),
            TurnDirection::Down => (self.recalled + 1).min(self.typed_lines.len()),
        };
        self.recalled = at;
        self.prompt = self.typed_lines.get(at).cloned().unwrap_or_default();
    }

    /// Does what was typed.
    pub(super) fn submit(&mut self) {
        self.panel = Popup::Scope;
        let line = std::mem::take(&mut self.prompt);
        let line = line.trim();
        if !line.is_empty() && self.typed_lines.last().is_none_or(|last| last != line) {
            self.typed_lines.push(line.to_owned());
        }
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        let is = |command: &str| !word.is_empty() && command.starts_with(word);
        if word.is_empty() {
        } else if is("write") {
            self.write(rest);
        } else if is("compare") {
            self.compare(rest);
        } else if is("goto") {
            self.goto(rest);
        } else if is("seek") {
            self.seek_typed(rest);
        } else if is("set") {
            self.set_typed(rest);
        } else if let Some(option) = bench_option(word) {
            self.note(option, rest);
        } else if is("effects") {
            self.open_study(Page::Effects);
        } else if is("hard-cases") {
            self.open_study(Page::HardCases);
        } else if is("quit") {
            self.running = false;
        } else {
            let known = COMMANDS.iter().filter_map(|(command, _)| command.split(' ').next());
            let known: Vec<&str> = known.collect();
            self.notice = Some(format!("found :{word}, expected one of {}", known.join(" ")));
        }
    }

    fn write(&mut self, file: &str) {
        let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        let known = ["mcap", "csv", "toml", "svg"];
        if ending.is_some_and(|ending| known.contains(&ending.as_str())) {
            self.requests.push(Request::Save(PathBuf::from(file)));
        } else {
            self.notice = Some(
                "expected :write and a file that ends in .mcap, .csv, .toml or .svg".to_owned(),
            );
        }
    }

    fn compare(&mut self, other: &str) {
        if other.is_empty() {
            self.notice =
                Some("expected :compare and a recording, a folder, or a scene".to_owned());
        } else {
            self.compare_with(other.to_owned());
        }
    }

    fn note(&mut self, option: BenchOption, value: &str) {
        if self.live.is_some() {
            self.notice = Some("this bench is known: :set changes it".to_owned());
        } else {
            self.requests.push(Request::Note(option, value.to_owned()));
        }
    }

    fn goto(&mut self, number: &str) {
        match number.parse::<usize>().ok().and_then(|number| number.checked_sub(1)) {
            Some(place) => self.go_to(place),
            None => {
                self.notice = Some(format!("found {number}, expected :goto and a number from 1"));
            }
        }
    }

    fn seek_typed(&mut self, time: &str) {
        match crate::quantity::parse(time, crate::quantity::Dimension::TIME) {
            Ok(time) => {
                self.page = Page::Bench;
                let change = time - self.play.bench_time;
                self.seek(change);
            }
            Err(error) => {
                self.notice =
                    Some(format!("found {error}, expected :seek and a time, e.g. 0.8 ms"));
            }
        }
    }

    fn set_typed(&mut self, rest: &str) {
        if self.bench().is_none() {
            return;
        }
        match rest.split_once(char::is_whitespace) {
            Some((path, value)) => {
                self.set_value(path.to_owned(), value.trim().trim_matches('"').to_owned());
            }
            None => {
                self.notice = Some(
                    "expected :set, a path and a value, e.g. :set striker.speed 0.6 m/s".to_owned(),
                );
            }
        }
    }
}
