//! The command line: one file a subcommand. Printing and exit codes happen here and nowhere else.
//!
//! Exit code 0: done; 1: done, and the answer is no; 2: could not.

mod accuracy;
mod acquire;
mod arrivals;
mod bands;
mod budget;
mod by_hand;
mod calibrate;
mod compare;
mod completions;
mod convert;
mod cost;
mod dispersion;
mod doctor;
mod effects;
mod fit;
mod force;
mod gather;
mod guide;
mod hard_cases;
mod help;
mod info;
mod input;
pub mod installation;
mod list;
mod magnet;
mod man;
mod output;
mod overwrite;
mod paper;
mod picture;
mod plain_table;
mod progress;
mod run;
mod saved;
mod scenes;
mod sensor;
#[cfg(feature = "server")]
mod serve;
mod show;
mod signal;
mod spectrogram;
mod spectrum;
mod sweep;
mod transfer;
mod tunability;
#[cfg(feature = "tui")]
mod view;

use std::process::ExitCode;

use clap::{CommandFactory as _, FromArgMatches as _, Parser, Subcommand};

use crate::motion::kernel::InstructionSet;
use output::{AnswerIsNo, is_broken_pipe, is_coloured, print, print_as_it_is, print_toml, say};

/// Exit code of an answer that is no.
const EXIT_ANSWER_NO: u8 = 1;
/// Exit code of what could not be done; clap uses the same for wrong options.
const EXIT_FAILURE: u8 = 2;

/// Digital twin of a granular-chain lab bench: simulates the chain, its sensors and the
/// oscilloscope, and analyses measured traces.
#[derive(Debug, Parser)]
#[command(name = "hertzscope", version, max_term_width = 100, disable_help_subcommand = true)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    Run(run::Arguments),
    Acquire(acquire::Arguments),
    Info(info::Arguments),
    Convert(convert::Arguments),
    Cost(cost::Arguments),
    HardCases(hard_cases::Arguments),
    Effects(effects::Arguments),
    Scenes(scenes::Arguments),
    List(list::Arguments),
    Show(show::Arguments),
    Spectrum(spectrum::Arguments),
    Transfer(transfer::Arguments),
    Spectrogram(spectrogram::Arguments),
    Bands(bands::Arguments),
    Dispersion(dispersion::Arguments),
    Arrivals(arrivals::Arguments),
    Magnet(magnet::Arguments),
    Calibrate(calibrate::Arguments),
    Force(force::Arguments),
    Budget(budget::Arguments),
    Compare(compare::Arguments),
    Fit(fit::Arguments),
    Paper(paper::Arguments),
    Tunability(tunability::Arguments),
    Sweep(sweep::Arguments),
    Gather(gather::Arguments),
    #[cfg(feature = "server")]
    Serve(serve::Arguments),
    #[cfg(feature = "tui")]
    View(view::Arguments),
    Doctor(doctor::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
    Help(help::Arguments),
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

/// The command line with all that its help says.
fn command_line() -> clap::Command {
    guide::guided(Arguments::command())
}

/// Runs the program on the process's own arguments.
pub fn main() -> ExitCode {
    completions::answer(command_line);
    let matches = command_line().get_matches();
    let command = match Arguments::from_arg_matches(&matches) {
        Ok(arguments) => arguments.command,
        Err(error) => error.exit(),
    };
    survive_file_limit();
    if let Err(reason) = InstructionSet::chosen() {
        say(&format!("error: {reason}"));
        return ExitCode::from(EXIT_FAILURE);
    }
    let done = match command {
        Command::Run(arguments) => run::run(&arguments),
        Command::Acquire(arguments) => acquire::run(&arguments),
        Command::Info(arguments) => info::run(&arguments),
        Command::Convert(arguments) => convert::run(&arguments),
        Command::Cost(arguments) => cost::run(&arguments),
        Command::HardCases(arguments) => match hard_cases::run(&arguments) {
            Ok(false) => return ExitCode::from(EXIT_ANSWER_NO),
            done => done.map(|_| ()),
        },
        Command::Effects(arguments) => effects::run(&arguments),
        Command::Scenes(arguments) => scenes::run(&arguments),
        Command::List(arguments) => list::run(&arguments),
        Command::Show(arguments) => show::run(&arguments),
        Command::Spectrum(arguments) => spectrum::run(&arguments),
        Command::Transfer(arguments) => transfer::run(&arguments),
        Command::Spectrogram(arguments) => spectrogram::run(&arguments),
        Command::Bands(arguments) => bands::run(&arguments),
        Command::Dispersion(arguments) => dispersion::run(&arguments),
        Command::Arrivals(arguments) => arrivals::run(&arguments),
        Command::Magnet(arguments) => magnet::run(&arguments),
        Command::Calibrate(arguments) => calibrate::run(&arguments),
        Command::Force(arguments) => force::run(&arguments),
        Command::Budget(arguments) => budget::run(&arguments),
        Command::Compare(arguments) => compare::run(&arguments),
        Command::Fit(arguments) => fit::run(&arguments),
        Command::Paper(arguments) => paper::run(&arguments),
        Command::Tunability(arguments) => tunability::run(&arguments),
        Command::Sweep(arguments) => sweep::run(&arguments),
        Command::Gather(arguments) => gather::run(&arguments),
        #[cfg(feature = "server")]
        Command::Serve(arguments) => serve::run(&arguments),
        #[cfg(feature = "tui")]
        Command::View(arguments) => view::run(&arguments),
        Command::Doctor(arguments) => doctor::run(&arguments),
        Command::Completions(arguments) => completions::run(&arguments),
        Command::Help(arguments) => help::run(&arguments, command_line()),
        Command::Man(arguments) => man::run(&arguments, command_line()),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        // `head` closes the pipe once it has its lines: not an error.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) if error.is::<AnswerIsNo>() => ExitCode::FAILURE,
        Err(error) => {
            say(&format!("error: {}", without_numbers(&format!("{error:#}"))));
            ExitCode::from(EXIT_FAILURE)
        }
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
        let examples = guide::examples();
        for found in command.get_subcommands() {
            assert!(examples.iter().any(|g| g.0 == found.get_name()), "{}", found.get_name());
        }
        let docs = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("docs");
        for (name, example, page) in examples {
            if command.find_subcommand(name).is_none() {
                continue;
            }
            let words = example.split(' ').take_while(|word| *word != ">");
            let taken =
                command.clone().try_get_matches_from(["hertzscope"].into_iter().chain(words));
            assert!(taken.is_ok(), "{example}: {:?}", taken.err());
            assert!(docs.join(page).is_file(), "{page}");
        }
    }
}
