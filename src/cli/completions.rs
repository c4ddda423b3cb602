//! `hertzscope completions`: what the shell offers when Tab is pressed. The script asks the program
//! itself, which knows its scenes.

use std::ffi::{OsStr, OsString};

use clap::Args;
use clap::builder::PossibleValuesParser;
use clap_complete::CompletionCandidate;
use clap_complete::engine::{
    ArgValueCandidates, ArgValueCompleter, PathCompleter, ValueCompleter as _,
};
use clap_complete::env::{CompleteEnv, Shells};

use crate::data;
use crate::scene::Scene;

/// Set by the script when it asks.
const VARIABLE: &str = "HERTZSCOPE_COMPLETE";
/// Arguments that take a scene, and those that take recordings and a scope's files.
const SCENES: [&str; 5] = ["scene", "simulated", "what", "against", "inputs"];
const RECORDINGS: [&str; 6] = ["file", "files", "measured", "input", "what", "inputs"];
/// Arguments that take a command or a page, and a sensor.
const TOPIC: &str = "topic";
const SENSOR: &str = "simulate";
/// Endings of what holds traces.
const RECORDING_ENDINGS: [&str; 3] = ["mcap", "csv", "isf"];

/// Print the script that lets a shell complete commands, options, scenes and recordings
#[derive(Debug, Args)]
pub struct Arguments {
    /// The shell
    #[arg(value_parser = PossibleValuesParser::new(Shells::builtins().names()))]
    shell: String,
}

/// Prints the script.
pub fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let shells = Shells::builtins();
    let mut script = Vec::new();
    if let Some(shell) = shells.completer(&arguments.shell) {
        let program = std::env::current_exe()?.display().to_string();
        shell.write_registration(VARIABLE, "hertzscope", "hertzscope", &program, &mut script)?;
    }
    super::print(String::from_utf8_lossy(&script).trim_end())
}

/// Answers the script and ends the program, if it was the script that called.
pub fn answer(command: impl Fn() -> clap::Command, words: &[OsString]) {
    let asked = CompleteEnv::with_factory(|| completing(command())).var(VARIABLE);
    let folder = std::env::current_dir().ok();
    match asked.try_complete(words.iter().cloned(), folder.as_deref()) {
        Ok(false) => (),
        Ok(true) => std::process::exit(0),
        Err(error) => error.exit(),
    }
}

/// `command`, with what its arguments may be.
fn completing(mut command: clap::Command) -> clap::Command {
    let names: Vec<String> = command.get_subcommands().map(|c| c.get_name().to_owned()).collect();
    let topics = [&names[..], &names_of("help")].concat();
    for name in names {
        let argument = |found: clap::Arg| completing_argument(found, &topics);
        command = command.mut_subcommand(name, |found| found.mut_args(argument));
    }
    command
}

fn names_of(kind: &str) -> Vec<String> {
    data::instrument_names(kind).into_iter().map(str::to_owned).collect()
}

fn completing_argument(argument: clap::Arg, topics: &[String]) -> clap::Arg {
    let known = match argument.get_id().as_str() {
        TOPIC => topics.to_vec(),
        SENSOR => names_of("sensors"),
        _ => Vec::new(),
    };
    if !known.is_empty() {
        let candidates = move || known.iter().map(CompletionCandidate::new).collect();
        return argument.add(ArgValueCandidates::new(candidates));
    }
    let is_in = |ids: &[&str]| ids.contains(&argument.get_id().as_str());
    let (scenes, recordings) = (is_in(&SCENES), is_in(&RECORDINGS));
    if !scenes && !recordings {
        return argument;
    }
    argument.add(ArgValueCompleter::new(move |typed: &OsStr| {
        let files = PathCompleter::any().filter(move |path| {
            let ending = path.extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
            ending.is_some_and(|ending| {
                (scenes && ending == "toml")
                    || (recordings && RECORDING_ENDINGS.contains(&ending.as_str()))
            })
        });
        let mut found = files.complete(typed);
        if scenes {
            found.extend(included(typed));
        }
        found
    }))
}

/// The included scenes that begin as `typed`.
fn included(typed: &OsStr) -> Vec<CompletionCandidate> {
    let typed = typed.to_string_lossy();
    let names = Scene::names().into_iter().filter(|name| name.starts_with(&*typed));
    names
        .map(|name| {
            let title = Scene::load(name).ok().map(|scene| scene.title.into());
            CompletionCandidate::new(name).help(title)
        })
        .collect()
}
