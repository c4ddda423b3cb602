//! The command line: what has no key of its own.

use std::path::PathBuf;

use tui_input::Input;

use super::knobs::BenchKnob;
use super::screen_state::{Page, Request, ScreenState};
use super::state::{BenchOption, Popup};
use crate::quantity::engineering;
use crate::scene::Scene;
use crate::tui::axis::TurnDirection;
use crate::tui::job::{Job, Queue};
use crate::tui::pages::{bench, effects, hard_cases};

/// A command of the command line.
pub struct Command {
    /// Its name.
    name: &'static str,
    /// Arguments, as the help shows them.
    arguments: &'static str,
    /// Text of the help.
    help: &'static str,
    /// Words that complete its argument.
    words: fn(&ScreenState) -> Vec<String>,
    /// Does it with what was typed behind its name.
    run: fn(&mut ScreenState, &str),
}

impl Command {
    /// The command as it is typed, with its arguments.
    pub fn usage(&self) -> String {
        let gap = if self.arguments.is_empty() { "" } else { " " };
        format!(":{}{gap}{}", self.name, self.arguments)
    }

    /// Text of the help.
    pub fn help(&self) -> &'static str {
        self.help
    }
}

const fn command(
    name: &'static str,
    arguments: &'static str,
    help: &'static str,
    run: fn(&mut ScreenState, &str),
) -> Command {
    Command { name, arguments, help, words: |_| Vec::new(), run }
}

fn scenes(_: &ScreenState) -> Vec<String> {
    Scene::names().into_iter().map(str::to_owned).collect()
}

/// The commands, as the help shows them.
#[rustfmt::skip]
pub const COMMANDS: &[Command] = &[
    command("write", "FILE", "save .mcap (shot), .csv (one a trace), .toml (scene), .svg", ScreenState::write),
    Command {
        words: scenes,
        ..command("compare", "WHAT", "compare the shot with a recording, a folder, or a scene", ScreenState::compare)
    },
    command("goto", "N", "show trigger N, counted from 1", ScreenState::goto),
    command("seek", "TIME", "go to a time of the moving bench, e.g. 0.8 ms", ScreenState::seek_typed),
    Command {
        words: scenes,
        ..command("scene", "SCENE", "the bench of the recording: sensors, distances", |model, rest| model.note(BenchOption::Scene, rest))
    },
    command("map", "CH1=p2,...", "which of its sensors is at a channel", |model, rest| model.note(BenchOption::Map, rest)),
    command("sensor", "CH1=FILE", "a channel's sensor, by name or file", |model, rest| model.note(BenchOption::Sensor, rest)),
    command("distance", "CH1-CH2=D", "along the chain, e.g. 47.2 mm +- 0.1 mm", |model, rest| model.note(BenchOption::Distance, rest)),
    Command {
        words: ScreenState::settable_paths,
        ..command("set", "PATH VALUE", "change the bench's scene, e.g. :set striker.speed 0.6 m/s", ScreenState::set_typed)
    },
    command("effects", "", "what each effect of the bench changes, and what it costs", |model, _| model.show_page(effects::PAGE)),
    command("hard-cases", "", "cases that are hard to integrate, each with its bound", |model, _| model.show_page(hard_cases::PAGE)),
    command("quit", "", "leave", |model, _| model.running = false),
];

/// The commands whose names begin with `word`; one of exactly this name alone.
pub fn commands_of(word: &str) -> Vec<&'static Command> {
    let exact = COMMANDS.iter().find(|command| command.name == word);
    let begun = COMMANDS.iter().filter(|command| command.name.starts_with(word));
    exact.map_or_else(|| begun.collect(), |exact| vec![exact])
}

impl ScreenState {
    /// Opens the command line with `start` typed already.
    pub(super) fn open_prompt(&mut self, start: &str) {
        self.panel = Popup::Prompt;
        self.recalled = self.typed_lines.len();
        self.prompt = Input::from(start);
    }

    /// Completes the word that is being typed, as far as all that begin like it agree.
    pub(super) fn complete_prompt(&mut self) {
        let (before, word) = match self.prompt.value().rsplit_once(' ') {
            Some((before, word)) => (format!("{before} "), word),
            None => (String::new(), self.prompt.value()),
        };
        let candidates: Vec<String> = match before.trim() {
            "" => COMMANDS.iter().map(|command| command.name.to_owned()).collect(),
            word => match commands_of(word).as_slice() {
                [command] => (command.words)(self),
                _ => Vec::new(),
            },
        };
        let found: Vec<&String> = candidates.iter().filter(|full| full.starts_with(word)).collect();
        let Some(first) = found.first() else { return };
        let shared = found.iter().fold(first.len(), |length, other| {
            let same = first.bytes().zip(other.bytes()).take_while(|(a, b)| a == b).count();
            length.min(same)
        });
        let end = if found.len() == 1 { " " } else { "" };
        let completed = format!("{before}{}{end}", first.get(..shared).unwrap_or(word));
        let (count, found) =
            (found.len(), found.iter().map(|name| name.as_str()).collect::<Vec<_>>().join("  "));
        self.prompt = Input::from(completed);
        if count > 1 {
            self.notice = Some(found);
        }
    }

    /// Where the knobs stand in the scene, for the selected channel.
    fn settable_paths(&self) -> Vec<String> {
        let Some(scene) = &self.recordings.front().scene else { return Vec::new() };
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
        self.prompt = self.typed_lines.get(at).cloned().unwrap_or_default().into();
    }

    /// Does what was typed.
    pub(super) fn submit(&mut self) {
        self.panel = Popup::Scope;
        let line = std::mem::take(&mut self.prompt);
        let line = line.value().trim();
        if !line.is_empty() && self.typed_lines.last().is_none_or(|last| last != line) {
            self.typed_lines.push(line.to_owned());
        }
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((line, ""));
        let rest = rest.trim();
        if word.is_empty() {
            return;
        }
        let names = |commands: &[&Command]| {
            let names: Vec<String> = commands.iter().map(|c| format!(":{}", c.name)).collect();
            names.join(" ")
        };
        match commands_of(word).as_slice() {
            [command] => (command.run)(self, rest),
            [] => {
                let all: Vec<&Command> = COMMANDS.iter().collect();
                self.notice = Some(format!("found :{word}, expected one of {}", names(&all)));
            }
            several => {
                self.notice = Some(format!(":{word} is the beginning of {}", names(several)));
            }
        }
    }

    /// Shows a page.
    fn show_page(&mut self, page: Page) {
        if self.page != Some(page) {
            self.open_page(page);
        }
    }

    fn write(&mut self, file: &str) {
        let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
        let known = ["mcap", "csv", "toml", "svg"];
        if ending.as_deref() == Some("toml")
            && let Some(live) = &mut self.recordings.front_mut().live
        {
            live.written = live.settings.clone();
        }
        if ending.is_some_and(|ending| known.contains(&ending.as_str())) {
            self.requests.push(Request::Save(PathBuf::from(file)));
        } else {
            self.notice = Some(
                "expected :write and a file that ends in .mcap, .csv, .toml or .svg; convert makes a .png of a .mcap".to_owned(),
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
        if self.recordings.front().live.is_some() {
            self.notice =
                Some("this bench is simulated: change it with :set PATH VALUE".to_owned());
        } else {
            self.note_option(option, value);
        }
    }

    /// Notes what is said of the bench of the recording in front, which may read files.
    fn note_option(&mut self, option: BenchOption, value: &str) {
        let Some(note) = self.note_option else { return };
        let (mut set, value) = (self.recordings.front().set.clone(), value.to_owned());
        let title = self.recordings.front().title.clone();
        self.ask(Job::new(
            Queue::File,
            move |_| note(&mut set, option, &value).map(|()| set),
            move |model: &mut Self, noted| match noted {
                Ok(set) if model.recordings.front().title == title => model.apply_bench_facts(set),
                Ok(_) => {}
                Err(problem) => model.notice = Some(problem),
            },
        ));
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
                self.show_page(bench::PAGE);
                let change = time - self.play.bench_time;
                self.seek(change);
                if let Some((start, end)) = self.film_span()
                    && !(start..=end).contains(&time)
                {
                    let [start, end] = [start, end].map(|time| engineering(time, "s", 3));
                    self.notice = Some(format!("the motion is recorded from {start} to {end}"));
                }
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
