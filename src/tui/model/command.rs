//! The command line: what has no key of its own.

use std::path::PathBuf;

use super::state::{Page, Request};
use super::{Popup, ScreenState};

/// The commands, as the help shows them.
pub const COMMANDS: &[(&str, &str)] = &[
    (":write FILE", "save .mcap (shot), .csv (traces), .toml (scene), .svg"),
    (":compare WHAT", "hold the shot against a recording, a folder, or a scene"),
    (":goto N", "show trigger N, counted from 1"),
    (":seek TIME", "wind the moving bench to a time, e.g. 0.8 ms"),
    (":set PATH VALUE", "change the bench's scene, e.g. :set striker.speed 0.6 m/s"),
    (":quit", "leave"),
];

impl ScreenState {
    /// Opens the command line with `start` typed already.
    pub(super) fn open_prompt(&mut self, start: &str) {
        self.panel = Popup::Prompt;
        start.clone_into(&mut self.prompt);
    }

    /// Does what was typed.
    pub(super) fn submit(&mut self) {
        self.panel = Popup::Scope;
        let line = std::mem::take(&mut self.prompt);
        let line = line.trim();
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
        } else if is("quit") {
            self.running = false;
        } else {
            let known: Vec<&str> = COMMANDS.iter().map(|(command, _)| *command).collect();
            self.notice = Some(format!("found {word}, expected one of {}", known.join(", ")));
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
