//! The command line: one file a subcommand. Printing and exit codes happen here and nowhere else.
//!
//! Exit code 0: done; 1: done, and the answer is no; 2: could not.

mod accuracy;
mod document;
mod input;
pub mod installation;
mod output;
mod overwrite;
mod picture;
mod plain_table;
mod progress;
mod provenance;
mod saved;
mod signal;
mod value;

use std::ffi::OsString;
use std::fmt::Write as _;
use std::io::Write as _;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::motion::kernel::InstructionSet;
pub use output::CommandAnswer;
use output::{
    AnswerIsNo, is_broken_pipe, is_coloured, print, print_as_it_is, print_toml, say, show,
};

/// Exit code of what could not be done; clap uses the same for wrong options.
const EXIT_FAILURE: u8 = 2;
/// Exit code of what was done, with the answer no.
const EXIT_ANSWER_NO: u8 = 1;

/// Digital twin of a granular-chain lab bench: simulates the chain, its sensors and the
/// oscilloscope, and analyses measured traces.
#[derive(Debug, Parser)]
#[command(name = "hertzscope", version, max_term_width = 100, disable_help_subcommand = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// A row of the table of commands.
struct Guide {
    group: &'static str,
    module: &'static str,
    example: &'static str,
    /// Page in `docs/`.
    page: &'static str,
    /// What exit code 1 means; empty if the command has none.
    answer_no: &'static str,
}

/// The commands: module with `Arguments` and `run`, variant, example, page in `docs/`, and what
/// exit code 1 means. Their order is that of `--help`.
macro_rules! commands {
    ($($group:literal { $(
        $(#[$feature:meta])* $module:ident $variant:ident: $example:literal, $page:literal
            $(=> $answer_no:literal)?;
    )* })*) => {
        $($($(#[$feature])* mod $module;)*)*

        #[derive(Debug, Subcommand)]
        enum Command {
            $($($(#[$feature])* $variant($module::Arguments),)*)*
        }

        impl Command {
            fn run(&self) -> anyhow::Result<()> {
                match self {
                    $($($(#[$feature])* Self::$variant(arguments) => $module::run(arguments),)*)*
                }
            }
        }

        const GUIDES: &[Guide] = &[$($($(#[$feature])* Guide {
            group: $group,
            module: stringify!($module),
            example: $example,
            page: $page,
            answer_no: concat!($($answer_no)?),
        },)*)*];
    };
}

commands! {
    "Benches" {
        run Run: "run magnet-0.61g -o first.mcap", "first-trace.md";
        show Show: "show magnet-0.61g > mine.toml", "scenes.md";
        scenes Scenes: "scenes magnet-0.61g", "scenes.md";
        list List: "list materials", "scenes.md";
        #[cfg(feature = "tui")] view View: "view magnet-0.61g", "screen.md";
        #[cfg(feature = "server")] serve Serve: "serve magnet-0.61g --impact-every 2s", "clients.md";
        magnet Magnet: "magnet ring-15-6-6 --preload 2.38N", "models/magnets.md";
    }
    "Records, simulated or measured" {
        acquire Acquire: "acquire tcp://127.0.0.1:5025 -o day.mcap --shots 10", "acquire.md";
        info Info: "info F0000CH1.CSV", "measurements.md";
        convert Convert: "convert ALL0000 day.mcap --scene magnet-0.61g", "measurements.md";
        arrivals Arrivals: "arrivals day.mcap -o statistics.csv", "traces.md";
        force Force: "force day.mcap --channel CH1", "calibration.md";
        spectrum Spectrum: "spectrum first.mcap --channel CH2 --plot spectrum.svg", "traces.md";
        transfer Transfer: "transfer shot-*.mcap --between CH2,CH3", "traces.md";
        spectrogram Spectrogram: "spectrogram first.mcap --truth p14", "traces.md";
        dispersion Dispersion: "dispersion first.mcap --plot dispersion.svg", "traces.md";
        bands Bands: "bands magnet-0.61g --to 10N", "traces.md";
    }
    "Measurement against model" {
        compare Compare: "compare day.mcap magnet-0.61g --tolerance peak=5%", "measurements.md" => "a score is beyond the tolerance";
        fit Fit: "fit day.mcap magnet-0.61g --free striker.speed", "measurements.md" => "nothing was determined, or more than noise is left";
        calibrate Calibrate: "calibrate plan.toml -o certificate", "calibration.md" => "the plan contradicts itself, nothing is certified";
        budget Budget: "budget magnet-0.61g --samples 200", "uncertainty.md";
    }
    "Studies" {
        effects Effects: "effects magnet-0.61g --why", "scenes.md";
        hard_cases HardCases: "hard-cases --why", "accuracy.md" => "a case fails";
        cost Cost: "cost magnet-0.61g --plot cost.svg", "accuracy.md";
        tunability Tunability: "tunability --vary effects.magnet_preload.force --plot map.png", "paper.md";
        sweep Sweep: "sweep grid.toml", "sweeps.md";
        gather Gather: "gather grid.sweep", "sweeps.md" => "runs are missing";
        paper Paper: "paper --figure 9 --out figures", "paper.md";
    }
    "The program" {
        help Help: "help scene", "scenes.md";
        doctor Doctor: "doctor", "first-trace.md" => "something is wrong";
        completions Completions: "completions bash", "commands.md";
        man Man: "man -o man", "commands.md";
    }
}

impl Guide {
    /// Name of the command.
    fn name(&self) -> String {
        self.module.replace('_', "-")
    }

    fn after_help(&self) -> String {
        let no = match self.answer_no {
            "" => String::new(),
            words => format!("1: {words}; "),
        };
        format!(
            "Example:\n  hertzscope {}\n\nExit code:\n  0: done; {no}2: could not be done\n\nMore:\n  docs/{}",
            self.example, self.page
        )
    }
}

/// Makes a file that outgrows `ulimit -f` an error of that file: the signal that comes with it
/// would end the program without a word.
fn survive_file_limit() {
    #[cfg(unix)]
    {
        let told = std::sync::Arc::new(std::sync::atomic::AtomicBool::new(false));
        // Where it cannot be caught, it ends the program as before.
        let _ = signal_hook::flag::register(signal_hook::consts::SIGXFSZ, told);
    }
}

/// Widest name of a command, with the gap after it.
const NAME_WIDTH: usize = 13;

/// The command line: commands in their groups, each with example, exit codes and page.
fn command_line() -> clap::Command {
    let mut command = Arguments::command();
    let mut page = String::from("{about}\n\n{usage-heading} {usage}\n");
    for guides in GUIDES.chunk_by(|a, b| a.group == b.group) {
        // Writing to a text does not fail.
        let _ = writeln!(page, "\n{}:", guides.first().map_or("", |guide| guide.group));
        for guide in guides {
            let name = guide.name();
            let about = command.find_subcommand(&name).and_then(clap::Command::get_about);
            let about = about.map(ToString::to_string).unwrap_or_default();
            let short = about.split([':', ';', ',']).next().unwrap_or_default();
            let _ = writeln!(page, "  {name:<NAME_WIDTH$}{short}");
            command =
                command.mut_subcommand(name, |found| found.after_long_help(guide.after_help()));
        }
    }
    page.push_str("\nOptions:\n{options}{after-help}");
    command.help_template(page).after_help(
        "A scene is a TOML file that describes one experiment: chain, striker, sensors and oscilloscope (`hertzscope help scene`). A shot is one impact \
         with what the oscilloscope recorded of it; a recording (.mcap) holds one or more shots. `hertzscope help COMMAND` has an example of each command.",
    )
}

/// Parses `words`, the program's name first, and runs nothing.
///
/// # Errors
/// The refusal, or the help that is asked for.
pub fn parse<'a>(words: impl IntoIterator<Item = &'a str>) -> Result<(), String> {
    let parsed = command_line().try_get_matches_from(words);
    parsed.map(|_| ()).map_err(|refused| refused.to_string())
}

/// Runs the program on `words`, its own name first; returns its exit code.
pub fn main(words: impl IntoIterator<Item = OsString>) -> u8 {
    let words: Vec<OsString> = words.into_iter().collect();
    let _ = output::COMMAND_LINE.set(command_line);
    completions::answer(command_line, &words);
    run(&words)
}

/// Runs a command within another program: what it would print and say is the answer.
///
/// `stop` ends it before it is done; then there is no answer.
pub fn answer(words: &[OsString], stop: &Arc<AtomicBool>) -> Option<CommandAnswer> {
    let _ = output::COMMAND_LINE.set(command_line);
    output::captured(stop, || run(words))
}

/// The command's exit code.
fn run(words: &[OsString]) -> u8 {
    let parsed = command_line().try_get_matches_from(words);
    let command = match parsed.and_then(|matches| Arguments::from_arg_matches(&matches)) {
        Ok(arguments) => arguments.command,
        Err(stop) => return help_or_refusal(&stop),
    };
    survive_file_limit();
    if let Err(reason) = InstructionSet::chosen() {
        say(&format!("error: {reason}"));
        return EXIT_FAILURE;
    }
    match command.run() {
        Ok(()) => 0,
        // `head` closes the pipe once it has its lines: not an error.
        Err(error) if is_broken_pipe(&error) => 0,
        Err(error) if error.is::<AnswerIsNo>() => EXIT_ANSWER_NO,
        Err(error) => {
            say(&format!("error: {}", without_numbers(&format!("{error:#}"))));
            EXIT_FAILURE
        }
    }
}

/// Prints the help or version that was asked for, or why the arguments are wrong.
fn help_or_refusal(stop: &clap::Error) -> u8 {
    if output::is_captured() {
        say(stop.to_string().trim_end());
        return u8::try_from(stop.exit_code()).unwrap_or(EXIT_FAILURE);
    }
    match stop.print().and_then(|()| std::io::stdout().flush()) {
        Err(error) if !stop.use_stderr() && error.kind() != std::io::ErrorKind::BrokenPipe => {
            say(&format!("error: {}", without_numbers(&error.to_string())));
            EXIT_FAILURE
        }
        _ => u8::try_from(stop.exit_code()).unwrap_or(EXIT_FAILURE),
    }
}

/// Errors of the operating system without the numbers that Rust puts behind them.
fn without_numbers(words: &str) -> String {
    let mut parts = words.split(" (os error ");
    let mut told = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        told.push_str(part.split_once(')').map_or(part, |(_, rest)| rest));
    }
    told
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every command is in a group, its example is one that it takes, and its page is there.
    #[test]
    fn every_command_is_guided() {
        let command = command_line();
        for found in command.get_subcommands() {
            let name = found.get_name();
            assert!(GUIDES.iter().any(|guide| guide.name() == name), "{name}");
        }
        let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        for Guide { example, page, .. } in GUIDES {
            let words = example.split(' ').take_while(|word| *word != ">");
            let taken =
                command.clone().try_get_matches_from(["hertzscope"].into_iter().chain(words));
            assert!(taken.is_ok(), "{example}: {:?}", taken.err());
            assert!(docs.join(page).is_file(), "{page}");
        }
    }
}
